//! Parts of artifacts (RFC 9110, section 14).

use super::jobs::{mesh, with};
use super::server::{Answer, settings, story};

#[test]
fn the_part_that_was_asked_for_is_answered() {
    story(settings(), async |server| {
        // more than one part of the store
        let made = server.render(&with(mesh(7), "json")).await.ok();
        let (place, etag) = (made.header("content-location"), made.header("etag"));
        let n = made.body.len();
        assert!(n > (2 << 20) + 5, "{n} bytes");
        let middle = (1 << 20) - 2;
        let ranges = [
            (format!("bytes=0-{}", n - 1), 0, n - 1),
            ("bytes=0-0".to_owned(), 0, 0),
            ("bytes=5-99".to_owned(), 5, 99),
            (format!("bytes={middle}-{}", middle + 3), middle, middle + 3),
            (format!("bytes={middle}-{}", (2 << 20) + 1), middle, (2 << 20) + 1),
            ("bytes=7-".to_owned(), 7, n - 1),
            (format!("bytes={}-", n - 1), n - 1, n - 1),
            (format!("bytes=10-{}", n + 1000), 10, n - 1),
            ("bytes=-3".to_owned(), n - 3, n - 1),
            (format!("bytes=-{}", n + 1), 0, n - 1),
        ];
        for (range, first, last) in ranges {
            for headers in [vec![("range", range.as_str())], vec![("range", range.as_str()), ("if-range", etag)]] {
                let part = server.get_with(place, &headers).await;
                assert_eq!(part.status, 206, "{range}");
                assert_eq!(part.header("content-range"), format!("bytes {first}-{last}/{n}"), "{range}");
                assert_eq!(part.header("content-length"), (last - first + 1).to_string(), "{range}");
                assert_eq!(part.header("etag"), etag);
                assert_eq!(part.body, made.body.slice(first..=last), "{range}");
            }
        }
    });
}

#[test]
fn a_part_beyond_the_end_is_refused_with_the_length() {
    story(settings(), async |server| {
        let made = server.render(&with(mesh(1), "stl")).await.ok();
        let n = made.body.len();
        for range in [format!("bytes={n}-"), format!("bytes={}-{}", n + 5, n + 9), "bytes=-0".to_owned()] {
            let answer = server.get_with(made.header("content-location"), &[("range", &range)]).await;
            answer.problem(416, "range-not-satisfiable");
            assert_eq!(answer.header("content-range"), format!("bytes */{n}"), "{range}");
        }
    });
}

#[test]
fn what_is_no_single_range_of_these_bytes_is_answered_with_the_whole() {
    story(settings(), async |server| {
        let made = server.render(&with(mesh(1), "stl")).await.ok();
        let whole = |answer: Answer, why: &str| {
            assert_eq!(answer.status, 200, "{why}");
            assert_eq!(answer.body, made.body, "{why}");
        };
        let place = made.header("content-location");
        for range in ["bytes=0-1,5-9", "bytes=9-5", "lines=1-2", "bytes=a-b", "bytes=-", "bytes", "bytes=1"] {
            whole(server.get_with(place, &[("range", range)]).await, range);
        }
        for stale in ["\"other\"", "Wed, 21 Oct 2015 07:28:00 GMT"] {
            whole(server.get_with(place, &[("range", "bytes=0-1"), ("if-range", stale)]).await, stale);
        }
        let weak = format!("W/{}", made.header("etag"));
        whole(
            server.get_with(place, &[("range", "bytes=0-1"), ("if-range", &weak)]).await,
            "If-Range compares strongly",
        );
        let posted = server.post_with("/v1/render", &with(mesh(1), "stl"), &[("range", "bytes=0-1")]).await;
        whole(posted, "POST knows no ranges");
    });
}

#[test]
fn what_the_client_has_comes_before_the_range() {
    story(settings(), async |server| {
        let made = server.render(&with(mesh(1), "stl")).await.ok();
        let headers = [("range", "bytes=0-1"), ("if-none-match", made.header("etag"))];
        assert_eq!(server.get_with(made.header("content-location"), &headers).await.status, 304);
    });
}
