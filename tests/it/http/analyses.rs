//! Analyses over HTTP.

use serde_json::json;

use super::server::{settings, story};

#[test]
fn an_analysis_is_made_once_and_kept_like_an_artifact() {
    story(settings(), async |server| {
        let question = json!({ "plan": { "preset": "four-point", "parameters": { "w": "1/16" } } });
        let made = server.post("/v1/analyses", &question).await.ok();
        assert!(made.header("cache-status").contains("stored"), "{}", made.header("cache-status"));
        let answer = made.json();
        assert_eq!((&answer["smoothness"]["proved_c"], &answer["smoothness"]["disproved_c"]), (&json!(1), &json!(2)));
        let word = json!({ "plan": { "word": "UCP" }, "nodes": 100_000 });
        let again = server.post("/v1/analyses", &word).await.ok();
        assert_eq!(again.header("cache-status"), "planish; hit", "a preset and its word are one scheme");
        assert_eq!((again.header("etag"), &again.body), (made.header("etag"), &made.body));
        let kept = server.get(made.header("content-location")).await.ok();
        assert_eq!(kept.body, made.body, "the answer has an address");
        let known = server.post_with("/v1/analyses", &question, &[("if-none-match", made.header("etag"))]).await;
        assert_eq!(known.status, 304);
    });
}

#[test]
fn a_question_that_cannot_be_answered_is_refused_with_its_place() {
    story(settings(), async |server| {
        let refused = server.post("/v1/analyses", &json!({ "plan": { "preset": "loop" } })).await;
        assert_eq!(refused.status, 422);
        assert_eq!(refused.json()["errors"][0]["pointer"], "/plan/preset");
        let typo = server.post("/v1/analyses", &json!({ "plan": { "word": "UC" }, "node": 7 })).await;
        assert_eq!(typo.status, 422);
        assert_eq!(typo.json()["errors"][0]["pointer"], "/node");
    });
}

#[test]
fn accept_chooses_a_report_or_a_figure_each_with_a_tag_and_an_address_of_its_own() {
    story(settings(), async |server| {
        let question = json!({ "plan": { "preset": "chaikin" } });
        let mut tags = Vec::new();
        for (accept, media_type, extension, starts) in [
            ("application/json", "application/json", "json", "{".as_bytes()),
            ("text/markdown", "text/markdown", "md", b"# A curve scheme"),
            ("image/svg+xml", "image/svg+xml", "svg", b"<svg"),
            ("image/png, */*;q=0.1", "image/png", "png", b"\x89PNG"),
        ] {
            let answer = server.post_with("/v1/analyses", &question, &[("accept", accept)]).await.ok();
            assert!(answer.header("content-type").starts_with(media_type), "{}", answer.header("content-type"));
            assert!(answer.body.starts_with(starts), "{accept}");
            let address = answer.header("content-location");
            assert!(address.ends_with(&format!(".{extension}")), "{address}");
            assert_eq!(server.get(address).await.ok().body, answer.body, "{address}");
            tags.push(answer.header("etag").to_owned());
        }
        tags.sort();
        tags.dedup();
        assert_eq!(tags.len(), 4);
        let none = server.post_with("/v1/analyses", &question, &[("accept", "model/obj")]).await;
        assert_eq!(none.status, 406);
        let usual = server.post_with("/v1/analyses", &question, &[("accept", "*/*")]).await.ok();
        assert!(usual.header("content-type").starts_with("application/json"));
    });
}
