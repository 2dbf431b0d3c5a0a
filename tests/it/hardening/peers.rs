//! Clients share the service by their addresses: none can use it up for the others.

use std::net::{IpAddr, Ipv4Addr, SocketAddr};

use planish::config::Settings;
use planish::service::peer::Peer;
use planish::service::pool::Lane;
use serde_json::json;
use tokio::io::AsyncWriteExt;
use tokio::net::{TcpSocket, TcpStream};

use crate::http::jobs::{endless, mesh, with};
use crate::http::server::{Server, rest, settings, story, until};

/// Opens a connection from another loopback address.
async fn from(server: &Server, last: u8) -> TcpStream {
    let socket = TcpSocket::new_v4().unwrap();
    socket.bind(SocketAddr::from(([127, 0, 0, last], 0))).unwrap();
    socket.connect(server.address).await.unwrap()
}

/// Returns the answer to a job that a client at another address sends.
async fn stranger(server: &Server, last: u8, headers: &str, job: &serde_json::Value) -> String {
    let mut stream = from(server, last).await;
    let request = server.request("/v1/render", &format!("connection: close\r\n{headers}"), &job.to_string());
    stream.write_all(request.as_bytes()).await.unwrap();
    rest(stream).await
}

/// Returns a job of the same cost that is different for each number.
fn distinct(i: u32) -> serde_json::Value {
    let mut job = with(mesh(1), "stats");
    job["input"]["mesh"]["positions"][0][0] = json!(f64::from(i) / 8.0);
    job
}

#[test]
fn peers_are_addresses_and_networks_of_sixty_four_bits() {
    let peer = |text: &str| Peer::new(text.parse::<IpAddr>().unwrap());
    assert_eq!(peer("::ffff:10.1.2.3"), peer("10.1.2.3"));
    assert_ne!(peer("10.1.2.3"), peer("10.1.2.4"));
    assert_eq!(peer("2001:db8:1:2:3::1"), peer("2001:db8:1:2:ffff::2"));
    assert_ne!(peer("2001:db8:1:2::1"), peer("2001:db8:1:3::1"));
}

#[test]
fn h2_many_jobs_of_one_client_leave_room_for_others() {
    story(Settings { max_queue_per_peer: 4, ..settings() }, async |server| {
        let held = server.hold().await;
        for i in 0..4 {
            let answer = server.post_with("/v1/render", &distinct(i), &[("prefer", "respond-async")]).await;
            assert_eq!(answer.status, 202);
        }
        for i in 4..20 {
            let answer = server.post_with("/v1/render", &distinct(i), &[("prefer", "respond-async")]).await;
            answer.problem(503, "busy");
            assert!(answer.header("retry-after").parse::<u64>().unwrap() >= 1);
        }
        let answer = stranger(server, 2, "prefer: respond-async\r\n", &distinct(100)).await;
        assert!(answer.starts_with("HTTP/1.1 202"), "{answer}");
        drop(held);
        until("all are done", || server.app.desk.n_under_way() == 0).await;
        // settled jobs do not count
        let held = server.hold().await;
        let answer = server.post_with("/v1/render", &distinct(21), &[("prefer", "respond-async")]).await;
        assert_eq!(answer.status, 202);
        drop(held);
    });
}

#[test]
fn h2_peers_take_turns_however_many_jobs_one_has() {
    story(settings(), async |server| {
        let pool = &server.app.desk.pool;
        let held = server.turn(Lane::Short).await;
        let peer = |last| Peer::new(IpAddr::V4(Ipv4Addr::new(10, 0, 0, last)));
        let (sender, mut turns) = tokio::sync::mpsc::unbounded_channel();
        let line_up = |name: &'static str, last| {
            let waiting = pool.line_up(Lane::Short, peer(last), 0).unwrap();
            let (app, sender) = (server.app.clone(), sender.clone());
            tokio::spawn(async move {
                let turn = app.desk.pool.compute_place(Lane::Short, waiting).await;
                sender.send(name).unwrap();
                drop(turn);
            });
        };
        for name in ["a1", "a2", "a3", "a4"] {
            line_up(name, 1);
        }
        line_up("b1", 2);
        line_up("c1", 3);
        line_up("b2", 2);
        drop(held);
        let mut order = Vec::new();
        for _ in 0..7 {
            order.push(turns.recv().await.unwrap());
        }
        assert_eq!(order, ["a1", "b1", "c1", "a2", "b2", "a3", "a4"]);
    });
}

#[test]
fn h2_a_job_that_is_deleted_is_cancelled_and_forgotten() {
    story(settings(), async |server| {
        let job = with(endless(), "stats");
        let later = server.post_with("/v1/render", &job, &[("prefer", "wait=0")]).await;
        assert_eq!(later.status, 202);
        let location = later.header("location").to_owned();
        until("it runs", || server.app.desk.pool.waiting() == [0, 0]).await;
        let deleted = server.ask(axum::http::Method::DELETE, &location, &[], Vec::new()).await;
        assert_eq!((deleted.status, deleted.body.len()), (204, 0));
        until("it has stopped", || server.app.desk.n_under_way() == 0).await;
        server.get(&location).await.problem(404, "not-found");
        let again = server.ask(axum::http::Method::DELETE, &location, &[], Vec::new()).await;
        again.problem(404, "not-found");
        until("the place is free", || server.app.desk.account.long.usage().taken == 0).await;
    });
}

#[test]
fn h2_deleting_a_job_ends_one_interest_and_not_that_of_others() {
    story(settings(), async |server| {
        let held = server.hold().await;
        let job = with(mesh(2), "stats");
        let later = server.post_with("/v1/render", &job, &[("prefer", "wait=0")]).await;
        let waiting = server.said(&server.request("/v1/render", "connection: close\r\n", &job.to_string())).await;
        until("both wait", || server.app.desk.n_interests() == 2).await;
        let deleted = server.ask(axum::http::Method::DELETE, later.header("location"), &[], Vec::new()).await;
        assert_eq!(deleted.status, 204);
        drop(held);
        let answer = rest(waiting).await;
        assert!(answer.starts_with("HTTP/1.1 200"), "{answer}");
    });
}

#[test]
fn h1_requests_that_join_a_computation_count_as_those_that_wait() {
    story(Settings { max_queue_per_peer: 3, ..settings() }, async |server| {
        let held = server.hold().await;
        let request = server.request("/v1/render", "", &mesh(2).to_string());
        let mut joined = Vec::new();
        for _ in 0..3 {
            joined.push(server.said(&request).await);
        }
        until("three wait", || server.app.desk.n_interests() == 3).await;
        server.render(&mesh(2)).await.problem(503, "busy");
        assert!(server.get("/livez").await.status == 200);
        let other = tokio::spawn({
            let mut stream = from(server, 2).await;
            let request = server.request("/v1/render", "connection: close\r\n", &mesh(2).to_string());
            async move {
                stream.write_all(request.as_bytes()).await.unwrap();
                rest(stream).await
            }
        });
        until("the stranger has joined", || server.app.desk.n_interests() == 4).await;
        drop(held);
        assert!(other.await.unwrap().starts_with("HTTP/1.1 200"));
    });
}

#[test]
fn h1_a_quarter_of_the_connections_never_waits_for_computations() {
    story(Settings { max_connections: 8, ..settings() }, async |server| {
        let held = server.hold().await;
        let mut waiting = Vec::new();
        for i in 0..6 {
            waiting.push(server.said(&server.request("/v1/render", "", &distinct(i).to_string())).await);
        }
        until("six wait", || server.app.desk.n_interests() == 6).await;
        server.render(&distinct(7)).await.problem(503, "busy");
        drop(held);
    });
}

#[test]
fn h1_a_peer_with_all_its_connections_loses_its_own_and_not_those_of_others() {
    let settings = Settings { max_connections: 6, max_connections_per_peer: 3, header_timeout_s: 60, ..settings() };
    story(settings, async |server| {
        let connections = &server.app.connections;
        let mut other = from(server, 2).await;
        until("the other is in", || connections.n_open() == 1).await;
        let mut own = Vec::new();
        for i in 0..5 {
            own.push(server.connect().await);
            until("it is in", || connections.n_open() == 1 + (i + 1).min(3)).await;
        }
        let oldest = own.drain(..2).collect::<Vec<_>>();
        for stream in oldest {
            assert_eq!(rest(stream).await, "", "the peer's oldest made room");
        }
        other.write_all(b"GET /livez HTTP/1.1\r\nhost: localhost\r\nconnection: close\r\n\r\n").await.unwrap();
        assert!(rest(other).await.starts_with("HTTP/1.1 200"));
        assert_eq!(connections.crowding(), [2, 0]);
    });
}

#[test]
fn h1_a_full_house_that_waits_for_the_service_turns_newcomers_away_in_words() {
    story(Settings { max_connections: 4, max_connections_per_peer: 4, ..settings() }, async |server| {
        let held = server.hold().await;
        let mut waiting = Vec::new();
        for i in 0..3 {
            waiting.push(server.said(&server.request("/v1/render", "", &distinct(i).to_string())).await);
        }
        until("three wait", || server.app.desk.n_interests() == 3).await;
        // the fourth connection is free for quick requests
        for _ in 0..3 {
            let asked = server.said("GET /livez HTTP/1.1\r\nhost: localhost\r\nconnection: close\r\n\r\n").await;
            assert!(rest(asked).await.starts_with("HTTP/1.1 200"));
        }
        let reading = server.turn(Lane::Reading).await;
        let read = server.said(&server.request("/v1/render", "", &distinct(9).to_string())).await;
        until("a fourth is read", || server.app.desk.pool.waiting_to_be_read() == 1).await;
        let answer = rest(server.connect().await).await;
        assert!(answer.starts_with("HTTP/1.1 503") && answer.contains("/docs/problems/busy"), "{answer}");
        assert!(answer.contains("retry-after: 1\r\n"), "{answer}");
        drop((reading, read, held));
    });
}
