//! Tenants: results, uploads and jobs of one tenant do not exist for another.

use axum::http::Method;
use planish::config::Settings;
use planish::config::keys::{KeyRole, SHARED, Token};
use serde_json::{Value, json};
use tokio::task::JoinHandle;

use super::jobs::{cube, endless, mesh, with};
use super::keys::{bearer, key, keyed};
use super::server::{Answer, Folder, Server, story, until};

struct Two {
    a: Token,
    b: Token,
    folder: Folder,
}

fn two() -> Two {
    let folder = Folder::new();
    let (a, b) = (key(&folder, "acme", KeyRole::Render), key(&folder, "bolt", KeyRole::Render));
    Two { a, b, folder }
}

async fn ask(server: &Server, of: &Token, method: Method, path: &str, body: &Value) -> Answer {
    with_headers(server, of, method, path, body, &[]).await
}

async fn with_headers(
    server: &Server,
    of: &Token,
    method: Method,
    path: &str,
    body: &Value,
    more: &[(&str, &str)],
) -> Answer {
    let shown = bearer(of);
    let mut headers = vec![("authorization", shown.as_str()), ("content-type", "application/json")];
    headers.extend_from_slice(more);
    let body = if body.is_null() { Vec::new() } else { body.to_string().into_bytes() };
    server.ask(method, path, &headers, body).await
}

async fn get(server: &Server, of: &Token, path: &str) -> Answer {
    ask(server, of, Method::GET, path, &Value::Null).await
}

async fn post(server: &Server, of: &Token, path: &str, body: &Value) -> Answer {
    ask(server, of, Method::POST, path, body).await
}

#[test]
fn a_batch_of_one_tenant_is_not_there_for_another() {
    let two = two();
    story(keyed(&two.folder), async |server| {
        let list = json!({ "jobs": [with(mesh(2), "obj"), with(mesh(1), "stl")] });
        let wait = [("prefer", "wait=60")];
        let made = with_headers(server, &two.a, Method::POST, "/v1/batches", &list, &wait).await.ok().json();
        let place = format!("/v1/batches/{}", made["id"].as_str().unwrap());
        let result = made["items"][0]["outputs"][0]["href"].as_str().unwrap().to_owned();
        let zip = format!("{place}/archive.zip");
        for path in [&place, &zip, &format!("{place}/events"), &result] {
            get(server, &two.a, path).await.ok();
            get(server, &two.b, path).await.problem(404, "not-found");
        }
        post(server, &two.b, &format!("{place}/cancel"), &Value::Null).await.problem(404, "not-found");
        ask(server, &two.b, Method::DELETE, &place, &Value::Null).await.problem(404, "not-found");
        assert_eq!(get(server, &two.b, "/v1/batches").await.ok().json()["batches"], json!([]));
        // the same batch of the other tenant is a separate one, whose jobs are computed again
        let again = with_headers(server, &two.b, Method::POST, "/v1/batches", &list, &wait).await.ok().json();
        assert_eq!((&again["id"], &again["counts"]["cache_hits"]), (&made["id"], &json!(0)));
        assert_eq!(ask(server, &two.b, Method::DELETE, &place, &Value::Null).await.status, 204);
        assert_eq!(get(server, &two.a, &zip).await.ok().status, 200);
    });
}

#[test]
fn a_result_of_one_tenant_is_made_again_for_another_and_found_by_neither_name_nor_tag() {
    let two = two();
    for settings in [keyed(&two.folder), Settings { cache_bytes: 8 << 30, ..keyed(&two.folder) }] {
        story(settings, async |server| {
            let job = with(mesh(2), "obj");
            let first = post(server, &two.a, "/v1/render", &job).await.ok();
            let (place, tag) = (first.header("content-location").to_owned(), first.header("etag").to_owned());
            assert_eq!(post(server, &two.a, "/v1/render", &job).await.ok().header("cache-status"), "planish; hit");
            assert_eq!(
                get(server, &two.a, &place).await.ok().header("cache-control"),
                "private, max-age=31536000, immutable"
            );
            for _ in 0..2 {
                get(server, &two.b, &place).await.problem(404, "not-found");
                let tagged = [("if-none-match", tag.as_str())];
                let known = with_headers(server, &two.b, Method::GET, &place, &Value::Null, &tagged).await;
                known.problem(404, "not-found");
                get(server, &two.b, &format!("{place}?x=1")).await.problem(404, "not-found");
            }
            let second = post(server, &two.b, "/v1/render", &job).await.ok();
            assert_eq!(second.header("cache-status"), "planish; fwd=miss; stored", "as if it were the first");
            assert_eq!((&second.body, second.header("etag")), (&first.body, tag.as_str()));
            // from now on both have it
            for token in [&two.a, &two.b] {
                assert_eq!(post(server, token, "/v1/render", &job).await.ok().header("cache-status"), "planish; hit");
                get(server, token, &place).await.ok();
                let tagged = [("if-none-match", tag.as_str())];
                let known = with_headers(server, token, Method::GET, &place, &Value::Null, &tagged).await;
                assert_eq!(known.status, 304);
            }
        });
    }
}

#[test]
fn who_may_see_a_result_is_still_known_after_a_restart() {
    let two = two();
    let lasting = Settings { cache_bytes: 8 << 30, ..keyed(&two.folder) };
    let job = with(mesh(2), "ply");
    let place = story(lasting.clone(), async |server| {
        post(server, &two.a, "/v1/render", &job).await.ok().header("content-location").to_owned()
    });
    story(lasting.clone(), async |server| {
        get(server, &two.b, &place).await.problem(404, "not-found");
        get(server, &two.a, &place).await.ok();
        let made = post(server, &two.b, "/v1/render", &job).await.ok();
        assert_eq!(made.header("cache-status"), "planish; fwd=miss; stored");
    });
    story(lasting, async |server| {
        get(server, &two.a, &place).await.ok();
        get(server, &two.b, &place).await.ok();
    });
}

#[test]
fn shared_keys_share_with_each_other_and_with_no_tenant() {
    let two = two();
    let shared = [key(&two.folder, SHARED, KeyRole::Render), key(&two.folder, SHARED, KeyRole::Render)];
    story(keyed(&two.folder), async |server| {
        let job = with(mesh(2), "stl");
        post(server, &two.a, "/v1/render", &job).await.ok();
        let made = post(server, &shared[0], "/v1/render", &job).await.ok();
        assert_eq!(made.header("cache-status"), "planish; fwd=miss; stored", "what acme has is not shared");
        let found = post(server, &shared[1], "/v1/render", &job).await.ok();
        assert_eq!(found.header("cache-status"), "planish; hit");
        let place = found.header("content-location").to_owned();
        let answer = get(server, &shared[1], &place).await.ok();
        assert_eq!(answer.header("cache-control"), "public, max-age=31536000, immutable");
        get(server, &two.b, &place).await.problem(404, "not-found");
    });
}

#[test]
fn variants_searches_and_analyses_are_made_for_each_tenant() {
    let two = two();
    story(keyed(&two.folder), async |server| {
        let found = || server.app.desk.tally.lookups().map(|(_, n)| n).last().unwrap();
        let tolerant = json!({ "input": cube(), "plan": { "preset": "catmull-clark" }, "levels": { "tolerance": 0.05 },
            "outputs": [{ "format": "obj" }] });
        let analysis = json!({ "plan": { "preset": "four-point" } });
        let mut missed = Vec::new();
        for token in [&two.a, &two.b] {
            let before = found();
            let zipped = [("accept-encoding", "gzip")];
            let answer = with_headers(server, token, Method::POST, "/v1/render", &with(mesh(3), "obj"), &zipped).await;
            assert_eq!(answer.ok().header("content-encoding"), "gzip");
            post(server, token, "/v1/render", &tolerant).await.ok();
            let answer = post(server, token, "/v1/analyses", &analysis).await.ok();
            assert!(answer.header("cache-status").contains("miss"), "{}", answer.header("cache-status"));
            missed.push(found() - before);
        }
        assert_eq!(missed[0], missed[1], "the second tenant finds as little as the first");
    });
}

#[test]
fn jobs_of_one_tenant_are_unknown_to_another_whatever_is_done_to_them() {
    let two = two();
    story(keyed(&two.folder), async |server| {
        let held = server.hold().await;
        let posted = post(server, &two.a, "/v1/jobs", &with(mesh(2), "obj")).await;
        assert_eq!(posted.status, 202, "{}", posted.text());
        let place = posted.header("location").to_owned();
        get(server, &two.b, &place).await.problem(404, "not-found");
        get(server, &two.b, &format!("{place}/events")).await.problem(404, "not-found");
        post(server, &two.b, &format!("{place}/cancel"), &Value::Null).await.problem(404, "not-found");
        ask(server, &two.b, Method::DELETE, &place, &Value::Null).await.problem(404, "not-found");
        assert_eq!(get(server, &two.b, "/v1/jobs").await.ok().json(), json!({ "jobs": [] }));
        assert_eq!(get(server, &two.a, "/v1/jobs").await.ok().json()["jobs"].as_array().unwrap().len(), 1);
        // the same job of the other tenant is a separate resource of the same name
        let own = post(server, &two.b, "/v1/jobs", &with(mesh(2), "obj")).await;
        assert_eq!((own.status, own.json()["attempts"].clone()), (202, json!(1)));
        assert_eq!(own.header("location"), place);
        assert_eq!(ask(server, &two.b, Method::DELETE, &place, &Value::Null).await.status, 204);
        assert_eq!(get(server, &two.a, &place).await.ok().json()["state"], "queued", "it is still that of acme");
        drop(held);
    });
}

/// The way in which a tenant leaves the job that both have posted.
#[derive(Debug, Clone, Copy)]
enum Leave {
    Cancel,
    Delete,
    Disconnect,
}

/// A tenant who requests a job, and leaves it.
struct Party<'a> {
    server: &'a Server,
    token: &'a Token,
    leave: Leave,
    job: Value,
    /// The path of the job, once it is posted.
    place: String,
    /// The waiting request, if there is one.
    request: Option<JoinHandle<()>>,
}

impl<'a> Party<'a> {
    fn new(server: &'a Server, token: &'a Token, leave: Leave, job: &Value) -> Self {
        Self { server, token, leave, job: job.clone(), place: String::new(), request: None }
    }

    async fn submit(&mut self) {
        if matches!(self.leave, Leave::Disconnect) {
            let request = self.server.client.post(self.server.url("/v1/render")).json(&self.job);
            let request = request.header("authorization", bearer(self.token)).header("prefer", "wait=300");
            self.request = Some(tokio::spawn(async move { drop(request.send().await) }));
        } else {
            let posted = post(self.server, self.token, "/v1/jobs", &self.job).await;
            posted.header("location").clone_into(&mut self.place);
        }
    }

    async fn leaves(&mut self) {
        let (server, token, place) = (self.server, self.token, &self.place);
        match self.leave {
            Leave::Cancel => {
                let left = post(server, token, &format!("{place}/cancel"), &Value::Null).await;
                assert!([200, 202].contains(&left.status), "{}", left.text());
            }
            Leave::Delete => assert_eq!(ask(server, token, Method::DELETE, place, &Value::Null).await.status, 204),
            Leave::Disconnect => self.request.take().unwrap().abort(),
        }
    }

    /// Returns the state of the job for the tenant, if it was posted as a job.
    async fn state(&self) -> Option<Value> {
        let is_job = !self.place.is_empty();
        if is_job { Some(get(self.server, self.token, &self.place).await.ok().json()["state"].clone()) } else { None }
    }
}

#[test]
fn a_computation_goes_on_for_the_tenant_that_stays_in_every_order_of_leaving() {
    let two = two();
    story(keyed(&two.folder), async |server| {
        let desk = &server.app.desk;
        let ended = || desk.tally.computations().map(|(_, n)| n).sum::<u64>();
        let ways = [Leave::Cancel, Leave::Delete, Leave::Disconnect];
        let mut n = 0;
        for (a, b) in ways.into_iter().flat_map(|a| ways.map(|b| (a, b))) {
            for (first, last) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
                let case = format!("{a:?} and {b:?}, {first} leaves first and {last} at last");
                let job = with(endless_of(n), "stats");
                let mut parties = [Party::new(server, &two.a, a, &job), Party::new(server, &two.b, b, &job)];
                let before = ended();
                for party in &mut parties {
                    party.submit().await;
                }
                let want = |n: usize| (desk.n_under_way(), desk.n_interests()) == (1, n);
                until(&format!("both wait for one computation: {case}"), || want(2)).await;
                parties[first].leaves().await;
                until(&format!("one is left: {case}"), || want(1)).await;
                if let Some(state) = parties[1 - first].state().await {
                    assert!([json!("queued"), json!("running")].contains(&state), "{state}: {case}");
                }
                // the tenant that has left comes back, and joins the running computation
                parties[first].submit().await;
                until(&format!("both wait again: {case}"), || want(2)).await;
                assert_eq!(ended(), before, "no computation has ended: {case}");
                parties[1 - last].leaves().await;
                until(&format!("the last one is left: {case}"), || want(1)).await;
                parties[last].leaves().await;
                until(&format!("it stops with the last interest: {case}"), || desk.n_under_way() == 0).await;
                until(&format!("it was one computation: {case}"), || ended() == before + 1).await;
                n += 1;
            }
        }
        assert_eq!(n, 36);
    });
}

#[test]
fn who_leaves_before_the_end_has_nothing_of_what_was_made_for_another() {
    let two = two();
    story(keyed(&two.folder), async |server| {
        let held = server.hold().await;
        let job = with(mesh(3), "obj");
        let place = post(server, &two.a, "/v1/jobs", &job).await.header("location").to_owned();
        post(server, &two.b, "/v1/jobs", &job).await;
        assert_eq!(ask(server, &two.a, Method::DELETE, &place, &Value::Null).await.status, 204);
        drop(held);
        let mut status = get(server, &two.b, &place).await.ok().json();
        while status["state"] != "done" {
            tokio::time::sleep(std::time::Duration::from_millis(5)).await;
            status = get(server, &two.b, &place).await.ok().json();
        }
        let href = status["outputs"][0]["href"].as_str().unwrap().to_owned();
        get(server, &two.b, &href).await.ok();
        get(server, &two.a, &href).await.problem(404, "not-found");
        let again = post(server, &two.a, "/v1/render", &job).await.ok();
        assert_eq!(again.header("cache-status"), "planish; fwd=miss; stored");
    });
}

#[test]
fn an_upload_opens_nothing_for_a_tenant_that_has_not_sent_it() {
    let two = two();
    for settings in [keyed(&two.folder), Settings { cache_bytes: 8 << 30, ..keyed(&two.folder) }] {
        story(settings, async |server| {
            let file = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n";
            let send = async |of: &Token| {
                let shown = bearer(of);
                let headers = [("authorization", shown.as_str()), ("content-type", "model/obj")];
                server.ask(Method::POST, "/v1/blobs", &headers, file.into()).await
            };
            let sent = send(&two.a).await;
            assert_eq!(sent.status, 201, "{}", sent.text());
            let id = sent.json()["id"].as_str().unwrap().to_owned();
            let place = format!("/v1/blobs/{id}");
            let job = json!({ "input": { "blob": id }, "plan": { "preset": "loop" }, "levels": 2,
                "outputs": [{ "format": "obj" }] });
            let key = post(server, &two.a, "/v1/render", &job).await.ok().header("etag").to_owned();
            get(server, &two.a, &place).await.ok();
            get(server, &two.b, &place).await.problem(404, "not-found");
            let tagged = [("if-none-match", key.as_str())];
            let known = with_headers(server, &two.b, Method::POST, "/v1/render", &job, &tagged).await;
            known.problem(422, "invalid-job");
            post(server, &two.b, "/v1/jobs", &job).await.problem(422, "invalid-job");
            let tag = format!("\"{id}\"");
            let tagged = [("if-none-match", tag.as_str())];
            with_headers(server, &two.b, Method::GET, &place, &Value::Null, &tagged).await.problem(404, "not-found");

            assert_eq!(send(&two.b).await.status, 201);
            get(server, &two.b, &place).await.ok();
            get(server, &two.a, &place).await.ok();
            let made = post(server, &two.b, "/v1/render", &job).await.ok();
            assert_eq!(made.header("cache-status"), "planish; fwd=miss; stored");
        });
    }
}

/// Returns a long job, different for each number.
fn endless_of(number: usize) -> Value {
    let mut job = endless();
    job["input"]["polygon"]["points"][0][0] = json!(number);
    job
}
