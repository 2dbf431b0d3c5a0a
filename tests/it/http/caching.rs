//! Hits and misses, and the cache headers for clients that keep results.

use axum::http::Method;
use serde_json::{Value, json};

use super::jobs::{mesh, polygon, with};
use super::server::{settings, story, until};

#[test]
fn the_second_request_is_answered_from_the_cache_with_the_same_bytes() {
    story(settings(), async |server| {
        let first = server.render(&mesh(2)).await.ok();
        let second = server.render(&mesh(2)).await.ok();
        assert_eq!(first.header("cache-status"), "planish; fwd=miss; stored");
        assert_eq!(second.header("cache-status"), "planish; hit");
        assert_eq!(first.body, second.body);
        for header in ["etag", "content-location", "content-type"] {
            assert_eq!(first.header(header), second.header(header), "{header}");
            assert!(!first.header(header).is_empty(), "{header}");
        }
    });
}

#[test]
fn another_format_of_a_mesh_that_was_refined_is_made_without_refining_it() {
    story(settings(), async |server| {
        let first = server.render(&with(mesh(3), "ply")).await.ok();
        let other = server.render(&with(mesh(3), "obj")).await.ok();
        assert!(first.header("server-timing").contains("desc=\"sweep\""), "{:?}", first.headers);
        assert!(!other.header("server-timing").contains("desc=\"sweep\""), "{:?}", other.headers);
        assert_eq!(server.app.desk.work.usage().artifacts, 2, "a program and a mesh");
    });
}

#[test]
fn equal_jobs_written_differently_are_one() {
    story(settings(), async |server| {
        let first = server.render(&with(polygon(2), "json")).await.ok();
        let input = polygon(2)["input"].clone();
        let word = json!({ "outputs": [{ "name": "other", "format": "json" }], "spec": 1, "levels": 2,
            "plan": { "parameters": {}, "word": "UD", "ends": "clamped" }, "input": input });
        let second = server.render(&word).await.ok();
        assert_eq!(second.header("cache-status"), "planish; hit");
        assert_eq!(first.header("etag"), second.header("etag"));
    });
}

#[test]
fn two_at_once_share_one_computation() {
    story(settings(), async |server| {
        let held = server.hold().await;
        let job = mesh(2);
        let both = async { tokio::join!(server.render(&job), server.render(&job)) };
        let freed = async {
            until("both wait", || server.app.desk.n_interests() == 2).await;
            drop(held);
        };
        let ((first, second), ()) = tokio::join!(both, freed);
        let (first, second) = (first.ok(), second.ok());
        let mut seen = [first.header("cache-status"), second.header("cache-status")];
        seen.sort_unstable();
        assert_eq!(seen, ["planish; fwd=miss; collapsed", "planish; fwd=miss; stored"]);
        assert_eq!(first.body, second.body);
    });
}

#[test]
fn the_content_location_gives_the_same_bytes_for_ever() {
    story(settings(), async |server| {
        let made = server.render(&with(mesh(2), "obj")).await.ok();
        let kept = server.get(made.header("content-location")).await.ok();
        assert_eq!(kept.body, made.body);
        assert_eq!(kept.header("cache-control"), "public, max-age=31536000, immutable");
        assert_eq!(kept.header("accept-ranges"), "bytes");
        assert_eq!(kept.header("x-content-type-options"), "nosniff");
        assert!(kept.header("content-security-policy").contains("default-src 'none'"));
        for header in ["etag", "content-type", "content-location", "content-length"] {
            assert_eq!(kept.header(header), made.header(header), "{header}");
        }
    });
}

#[test]
fn head_tells_what_get_would_without_the_bytes() {
    story(settings(), async |server| {
        let made = server.render(&mesh(2)).await.ok();
        let place = made.header("content-location");
        let got = server.get(place).await.ok();
        let head = server.ask(Method::HEAD, place, &[], Vec::new()).await.ok();
        assert!(head.body.is_empty());
        for header in ["etag", "content-type", "content-length", "cache-control", "accept-ranges"] {
            assert_eq!(head.header(header), got.header(header), "{header}");
        }
        let ranged = server.ask(Method::HEAD, place, &[("range", "bytes=0-3")], Vec::new()).await;
        assert_eq!(ranged.status, 200, "RFC 9110: ranges are for GET alone");
        assert_eq!(ranged.header("content-length"), got.header("content-length"));
    });
}

#[test]
fn what_the_client_has_already_is_not_sent_again() {
    story(settings(), async |server| {
        let made = server.render(&mesh(2)).await.ok();
        let (etag, place) = (made.header("etag"), made.header("content-location"));
        let weak = format!("W/{etag}");
        let list = format!("\"other\", {etag}");
        for tag in [etag, &weak, &list] {
            let posted = server.post_with("/v1/render", &mesh(2), &[("if-none-match", tag)]).await;
            let got = server.get_with(place, &[("if-none-match", tag)]).await;
            for answer in [posted, got] {
                assert_eq!(answer.status, 304, "{tag}");
                assert!(answer.body.is_empty());
                assert_eq!(answer.header("etag"), etag);
                assert_eq!(answer.header("content-location"), place);
            }
        }
        assert_eq!(server.get_with(place, &[("if-none-match", "*")]).await.status, 304);
        let posted = server.post_with("/v1/render", &mesh(2), &[("if-none-match", "\"other\"")]).await;
        assert_eq!(posted.status, 200);
        assert_eq!(posted.body, made.body);
    });
}

#[test]
fn a_known_etag_is_answered_before_any_work() {
    let etag = story(settings(), async |server| server.render(&mesh(2)).await.ok().header("etag").to_owned());
    story(settings(), async |server| {
        let held = server.hold().await;
        let answer = server.post_with("/v1/render", &mesh(2), &[("if-none-match", &etag)]).await;
        assert_eq!(answer.status, 304, "a fresh server knows the key, too");
        drop(held);
    });
}

#[test]
fn a_star_matches_only_what_is_there() {
    story(settings(), async |server| {
        let star = [("if-none-match", "*")];
        assert_eq!(server.post_with("/v1/render", &mesh(2), &star).await.status, 200, "nobody has made it yet");
        assert_eq!(server.post_with("/v1/render", &mesh(2), &star).await.status, 304);
    });
}

#[test]
fn an_impossible_job_is_refused_even_to_a_client_that_says_it_has_it() {
    story(settings(), async |server| {
        let mut job = mesh(2);
        job["input"]["mesh"]["faces"][0][0] = json!(99);
        for tag in ["*", "\"0\""] {
            server.post_with("/v1/render", &job, &[("if-none-match", tag)]).await.problem(422, "invalid-job");
        }
    });
}

#[test]
fn server_timing_names_every_stage() {
    story(settings(), async |server| {
        let answer = server.render(&with(mesh(2), "png")).await.ok();
        let timing = answer.header("server-timing").to_owned();
        let names: Vec<&str> = timing.split(", ").map(|entry| entry.split(";dur=").next().unwrap()).collect();
        assert_eq!(names, ["queue", "refine", "render", "encode"]);
        for entry in timing.split(", ") {
            let ms = entry.split(";dur=").nth(1).and_then(|rest| rest.split(';').next()).unwrap();
            let ms: f64 = ms.parse().unwrap();
            assert!(ms >= 0.0, "{timing}");
        }
        assert_eq!(answer.header("timing-allow-origin"), "*");
    });
}

#[test]
fn warnings_travel_with_hits_as_with_misses() {
    story(settings(), async |server| {
        // two triangles that share one vertex: two fans
        let job = json!({ "input": { "mesh": { "positions": [[0,0,0],[1,0,0],[0,1,0],[-1,0,0],[0,-1,0]],
            "faces": [[0,1,2],[0,3,4]] } }, "plan": { "preset": "catmull-clark" }, "levels": 1 });
        let made = server.render(&job).await.ok();
        let hit = server.render(&job).await.ok();
        let kept = server.get(made.header("content-location")).await.ok();
        assert!(made.header("planish-warnings").contains("5 from 0"), "{:?}", made.headers);
        assert_eq!(hit.header("planish-warnings"), made.header("planish-warnings"));
        assert_eq!(kept.header("planish-warnings"), made.header("planish-warnings"));
    });
}

#[test]
fn an_artifact_answers_to_its_own_extension_alone() {
    story(settings(), async |server| {
        let made = server.render(&with(mesh(1), "obj")).await.ok();
        let place = made.header("content-location");
        let other = place.replace(".obj", ".png");
        let problem = server.get(&other).await.problem(404, "not-found");
        assert!(problem["detail"].as_str().unwrap().contains(place), "{problem}");
        server.get(place.trim_end_matches(".obj")).await.problem(404, "not-found");
    });
}

#[test]
fn only_requests_whose_jobs_are_admitted_are_remembered() {
    story(settings(), async |server| {
        server.render(&mesh(40)).await.problem(422, "too-large");
        assert!(server.app.memo.n_requests() == 0, "a refused job leaves no trace");
        server.render(&mesh(2)).await.ok();
        assert_eq!(server.app.memo.n_requests(), 1);
        let named = json!({ "outputs": [{ "name": "other", "format": "glb" }] });
        let mut other = mesh(2);
        other["outputs"] = named["outputs"].clone();
        assert_eq!(server.render(&other).await.ok().header("cache-status"), "planish; hit");
        assert_eq!(server.app.memo.n_requests(), 2, "its result was there, so that its job was admitted before");
    });
}

/// Returns the job with its polygon in a list.
fn in_a_list(mut job: Value) -> Value {
    let polygon = job["input"]["polygon"].take();
    job["input"] = json!({ "polygons": [polygon] });
    job
}

#[test]
fn requests_that_share_a_computation_are_each_told_of_their_own_entries() {
    story(settings(), async |server| {
        let held = server.hold().await;
        let mut alone = with(polygon(1), "json");
        // the first midpoint has the weight 0
        alone["input"]["polygon"] = json!({ "points": [[0, 0, 1], [1, 0, -1], [1, 1, 1]], "closed": true,
            "rational": true });
        alone["plan"] = json!({ "word": "U" });
        let listed = in_a_list(alone.clone());
        let both = async { tokio::join!(server.render(&alone), server.render(&listed)) };
        let freed = async {
            until("both wait", || server.app.desk.n_interests() == 2).await;
            assert_eq!(server.app.desk.n_under_way(), 1);
            drop(held);
        };
        let ((alone, listed), ()) = tokio::join!(both, freed);
        let pointer =
            |answer: super::server::Answer| answer.problem(422, "invalid-job")["errors"][0]["pointer"].clone();
        assert_eq!([pointer(alone), pointer(listed)], ["/input/polygon", "/input/polygons/0"]);
    });
}
