//! `Range` and related headers are parsed as in RFC 9110: units in any case, positions of digits only.

use crate::http::jobs::{mesh, with};
use crate::http::server::{settings, story};

#[test]
fn l_units_know_no_small_and_large_letters_and_positions_are_digits_alone() {
    story(settings(), async |server| {
        let made = server.render(&with(mesh(1), "stl")).await.ok();
        let (place, n) = (made.header("content-location"), made.body.len());
        let ask = async |range: &str| server.get_with(place, &[("range", range)]).await;
        let beyond_64_bits = format!("{}0", u64::MAX);
        for range in ["BYTES=0-1".to_owned(), "Bytes=00-01".to_owned()] {
            let part = ask(&range).await;
            assert_eq!((part.status, &part.body[..]), (206, &made.body[..2]), "{range}");
        }
        for range in [format!("bytes=2-{beyond_64_bits}"), format!("bytes=-{beyond_64_bits}")] {
            let part = ask(&range).await;
            assert_eq!(part.status, 206, "{range}");
            assert!(part.header("content-range").ends_with(&format!("-{}/{n}", n - 1)), "{range}");
        }
        ask(&format!("bytes={beyond_64_bits}-")).await.problem(416, "range-not-satisfiable");
        for range in [
            "bytes=+0-1",
            "bytes=0-+1",
            "bytes=-+1",
            "bytes=0 -1",
            "bytes= 0-1",
            "bytes =0-1",
            "bytes=0-1x",
            "bytes=99999999-x",
            "bytes=99999999-5",
            "bytes=0x0-1",
            "bytes=--1",
        ] {
            let whole = ask(range).await;
            assert_eq!((whole.status, whole.body.len()), (200, n), "{range}");
        }
    });
}

#[test]
fn l_weights_and_waits_are_digits_alone_too() {
    story(settings(), async |server| {
        let mut job = mesh(1);
        job.as_object_mut().unwrap().remove("outputs");
        for weight in ["+1", "inf", "1e0", "-0"] {
            let accept = format!("model/obj;q={weight}, model/stl;q=0.1");
            let answer = server.post_with("/v1/render", &job, &[("accept", &accept)]).await.ok();
            assert_eq!(answer.header("content-type"), "model/stl", "{weight}");
        }
        let job = with(mesh(2), "stl");
        let held = server.hold().await;
        let later = server.post_with("/v1/render", &job, &[("prefer", "wait=0")]).await;
        assert_eq!((later.status, later.header("preference-applied")), (202, "wait=0"));
        let later = server.post_with("/v1/render", &job, &[("prefer", "wait=+9, wait=0")]).await;
        assert_eq!((later.status, later.header("preference-applied")), (202, "wait=0"), "the first is no number");
        drop(held);
    });
}
