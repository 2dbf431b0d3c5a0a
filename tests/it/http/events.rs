//! Events: the changes of a job, as they happen.

use std::sync::Arc;
use std::time::Duration;

use axum::http::Method;
use planish::config::Settings;
use planish::service::clock::Manual;
use serde_json::Value;

use super::jobs::{endless, mesh, with};
use super::server::{Server, settings, story, story_at, until};

/// One event.
#[derive(Debug, Clone)]
pub(super) struct Event {
    pub(super) id: u64,
    pub(super) name: String,
    pub(super) data: Value,
}

/// A client that listens to events.
pub(super) struct Listening {
    response: reqwest::Response,
    text: String,
}

impl Listening {
    pub(super) async fn to(server: &Server, location: &str, seen: Option<u64>) -> Self {
        let request = server.client.get(server.url(&format!("{location}/events")));
        let request = seen.into_iter().fold(request, |request, seen| request.header("last-event-id", seen));
        let response = request.send().await.unwrap();
        assert_eq!(response.status(), 200);
        assert_eq!(response.headers()["content-type"], "text/event-stream");
        Self { response, text: String::new() }
    }

    /// Returns the next block of lines; `None` at the end.
    async fn block(&mut self) -> Option<String> {
        loop {
            if let Some((block, rest)) = self.text.split_once("\n\n") {
                let (block, rest) = (block.to_owned(), rest.to_owned());
                self.text = rest;
                return Some(block);
            }
            let chunk = self.response.chunk().await.unwrap()?;
            self.text.push_str(std::str::from_utf8(&chunk).unwrap());
        }
    }

    /// Returns the next event; `None` at the end.
    pub(super) async fn event(&mut self) -> Option<Event> {
        loop {
            let block = self.block().await?;
            if block.starts_with(':') {
                continue;
            }
            let field = |name: &str| block.lines().find_map(|line| line.strip_prefix(&format!("{name}: "))).unwrap();
            let data = serde_json::from_str(field("data")).unwrap();
            return Some(Event { id: field("id").parse().unwrap(), name: field("event").to_owned(), data });
        }
    }

    pub(super) async fn rest(&mut self) -> Vec<Event> {
        let mut all = Vec::new();
        while let Some(event) = self.event().await {
            all.push(event);
        }
        all
    }
}

async fn posted(server: &Server, job: &Value) -> String {
    let answer = server.post("/v1/jobs", job).await;
    assert_eq!(answer.status, 202, "{}", answer.text());
    answer.header("location").to_owned()
}

#[test]
fn a_listener_is_told_the_whole_at_first_and_at_the_end_with_growing_numbers() {
    story(settings(), async |server| {
        let held = server.hold().await;
        let location = posted(server, &with(mesh(3), "stats")).await;
        let mut listening = Listening::to(server, &location, None).await;
        let first = listening.event().await.unwrap();
        assert_eq!((first.name.as_str(), &first.data["state"]), ("state", &"queued".into()));
        assert_eq!(format!("/v1/jobs/{}", first.data["id"].as_str().unwrap()), location);
        drop(held);
        let rest = listening.rest().await;
        let last = rest.last().unwrap();
        assert_eq!((last.name.as_str(), &last.data["state"]), ("done", &"done".into()));
        assert_eq!(last.data["outputs"][0]["state"], "done");
        let ids: Vec<u64> = std::iter::once(&first).chain(&rest).map(|event| event.id).collect();
        assert!(ids.windows(2).all(|pair| pair[0] < pair[1]), "{ids:?}");
        assert!(rest.iter().all(|event| ["state", "progress", "done"].contains(&event.name.as_str())));
        assert_eq!(rest.iter().filter(|event| event.name == "done").count(), 1, "the stream ends with it");
    });
}

#[test]
fn a_listener_that_comes_back_is_told_what_is_new_and_after_the_end_nothing() {
    story(settings(), async |server| {
        let location = posted(server, &with(mesh(2), "stats")).await;
        server.settled(&location).await;
        let events = Listening::to(server, &location, None).await.rest().await;
        let names: Vec<&str> = events.iter().map(|event| event.name.as_str()).collect();
        assert_eq!(names, ["state", "done"]);
        let [state, done] = [&events[0], &events[1]];
        let missed = Listening::to(server, &location, Some(state.id)).await.rest().await;
        assert_eq!(missed.last().map(|event| (event.id, event.name.as_str())), Some((done.id, "done")));
        let seen = done.id.to_string();
        let path = format!("{location}/events");
        assert_eq!(server.get_with(&path, &[("last-event-id", &seen)]).await.status, 204);
        // an id of an earlier attempt, or an invalid id, is answered with the current state
        for other in ["7", "x", "-1"] {
            let answer = server.get_with(&path, &[("last-event-id", other)]).await.ok();
            assert!(answer.text().contains("event: state\n"), "{other}: {}", answer.text());
        }
    });
}

#[test]
fn cancel_and_forget_end_the_stream() {
    story(settings(), async |server| {
        let location = posted(server, &with(endless(), "stats")).await;
        let mut listening = Listening::to(server, &location, None).await;
        listening.event().await.unwrap();
        let cancelled = server.ask(Method::POST, &format!("{location}/cancel"), &[], Vec::new()).await;
        assert_eq!(cancelled.status, 202);
        let last = listening.rest().await.pop().unwrap();
        assert_eq!((last.name.as_str(), &last.data["state"]), ("done", &"cancelled".into()));
        let location = posted(server, &with(endless(), "stats")).await;
        let mut listening = Listening::to(server, &location, Some(last.id)).await;
        let again = listening.event().await.unwrap();
        assert!(again.id > last.id && again.data["attempts"] == 2, "{again:?}");
        assert_eq!(server.ask(Method::DELETE, &location, &[], Vec::new()).await.status, 204);
        let last = listening.rest().await.pop().unwrap();
        assert_eq!((last.name.as_str(), &last.data["state"]), ("done", &"cancelled".into()));
        server.get(&format!("{location}/events")).await.problem(404, "not-found");
    });
}

#[test]
fn silence_is_broken_every_fifteen_seconds_of_the_clock() {
    let clock = Arc::new(Manual::default());
    story_at(settings(), clock.clone(), async |server| {
        let held = server.hold().await;
        let location = posted(server, &with(mesh(2), "stats")).await;
        let mut listening = Listening::to(server, &location, None).await;
        listening.event().await.unwrap();
        for _ in 0..3 {
            clock.advance(Duration::from_secs(15));
            let block = listening.block().await.unwrap();
            assert!(block.starts_with(": "), "{block}");
        }
        drop(held);
        assert_eq!(listening.rest().await.pop().unwrap().name, "done");
    });
}

#[test]
fn listeners_are_counted_and_one_that_leaves_makes_room() {
    // of eight connections, listeners may have a quarter, two, and one peer half of that
    story(Settings { max_connections: 8, ..settings() }, async |server| {
        let held = server.hold().await;
        let location = posted(server, &with(mesh(2), "stats")).await;
        let first = Listening::to(server, &location, None).await;
        let path = format!("{location}/events");
        let refused = server.get(&path).await;
        refused.problem(503, "busy");
        assert!(!refused.header("retry-after").is_empty());
        let answers = &server.app.desk.account.answers;
        assert_eq!(answers.usage().taken, 64 << 10);
        drop(first);
        until("its room is free", || answers.usage().taken == 0).await;
        drop(Listening::to(server, &location, None).await);
        // a listener has no interest in the job
        assert_eq!(server.ask(Method::DELETE, &location, &[], Vec::new()).await.status, 204);
        until("nothing is wanted", || server.app.desk.n_interests() == 0).await;
        drop(held);
    });
}
