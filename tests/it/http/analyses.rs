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
