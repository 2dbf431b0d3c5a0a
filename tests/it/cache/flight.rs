//! Equal work is done once, and only as long as a client waits for it.

use futures_util::future::join_all;
use planish::service::pool::Lane;

use crate::http::jobs::{endless, mesh, with};
use crate::http::server::{settings, story, until};

#[test]
fn eight_equal_requests_are_one_computation() {
    story(settings(), async |server| {
        let held = server.hold().await;
        let job = mesh(3);
        let answers = join_all((0..8).map(|_| server.render(&job)));
        let freed = async {
            until("all eight wait", || server.app.desk.n_interests() == 8).await;
            assert_eq!(server.app.desk.n_under_way(), 1);
            drop(held);
        };
        let (answers, ()) = tokio::join!(answers, freed);
        let count = |status: &str| answers.iter().filter(|answer| answer.header("cache-status") == status).count();
        assert_eq!(count("planish; fwd=miss; stored"), 1);
        assert_eq!(count("planish; fwd=miss; collapsed"), 7);
        for answer in answers {
            let answer = answer.ok();
            assert_eq!(answer.body, server.render(&job).await.ok().body);
        }
    });
}

#[test]
fn different_jobs_are_different_computations() {
    story(settings(), async |server| {
        let held = server.hold().await;
        let (one, other) = (mesh(2), with(mesh(2), "obj"));
        let both = async { tokio::join!(server.render(&one), server.render(&other)) };
        let freed = async {
            until("both wait", || server.app.desk.n_under_way() == 2).await;
            drop(held);
        };
        let ((one, other), ()) = tokio::join!(both, freed);
        assert_ne!(one.ok().header("etag"), other.ok().header("etag"));
    });
}

#[test]
fn the_job_of_a_client_that_leaves_is_stopped() {
    story(settings(), async |server| {
        let body = with(endless(), "stats").to_string();
        let client = server.said(&server.request("/v1/render", "", &body)).await;
        until("it runs", || server.app.desk.n_under_way() == 1 && server.app.desk.pool.waiting() == [0, 0]).await;
        drop(client);
        until("nobody waits", || server.app.desk.n_under_way() == 0).await;
        // its place is free again: the computation itself has ended
        drop(server.turn(Lane::Long).await);
    });
}

#[test]
fn a_job_goes_on_as_long_as_one_client_stays() {
    story(settings(), async |server| {
        let held = server.hold().await;
        let job = mesh(2);
        let leaving = server.said(&server.request("/v1/render", "", &job.to_string())).await;
        until("the first waits", || server.app.desk.n_interests() == 1).await;
        let staying = server.render(&job);
        let freed = async {
            until("both wait", || server.app.desk.n_interests() == 2).await;
            drop(leaving);
            until("one has left", || server.app.desk.n_interests() == 1).await;
            drop(held);
        };
        let (answer, ()) = tokio::join!(staying, freed);
        assert_eq!(answer.ok().header("cache-status"), "planish; fwd=miss; collapsed");
    });
}

#[test]
fn a_cancelled_job_can_be_posted_again() {
    story(settings(), async |server| {
        let held = server.hold().await;
        let request = server.request("/v1/render", "", &mesh(2).to_string());
        let client = server.said(&request).await;
        until("it waits", || server.app.desk.n_under_way() == 1).await;
        drop(client);
        until("nobody waits", || server.app.desk.n_under_way() == 0).await;
        drop(held);
        assert_eq!(server.render(&mesh(2)).await.ok().header("cache-status"), "planish; fwd=miss; stored");
    });
}

#[test]
fn a_client_that_leaves_gives_its_place_in_line_back() {
    let settings = planish::config::Settings { max_queue: 1, ..settings() };
    story(settings, async |server| {
        let held = server.hold().await;
        for levels in 1..5 {
            let client = server.said(&server.request("/v1/render", "", &mesh(levels).to_string())).await;
            until("it waits", || server.app.desk.n_under_way() == 1).await;
            drop(client);
            until("the line is empty", || server.app.desk.pool.waiting() == [0, 0]).await;
        }
        drop(held);
    });
}
