//! Uploads: sent once, named by their content, and kept for those who need them.

use std::sync::Arc;

use axum::http::Method;
use planish::config::Settings;
use planish::job::key::{Key, content};
use planish::service::store::{ArtifactDescription, MemoryStore, Owners, Pin, Store, StoreError};
use serde_json::{Value, json};

use super::jobs::cube;
use super::server::{Answer, Folder, Server, rest, settings, story, until};

const OBJ: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n";

async fn send(server: &Server, kind: &str, file: &[u8]) -> Answer {
    let headers = [("content-type", kind)];
    let headers = if kind.is_empty() { &headers[..0] } else { &headers[..] };
    server.ask(Method::POST, "/v1/blobs", headers, file.to_vec()).await
}

fn job(id: &str) -> Value {
    json!({ "input": { "blob": id }, "plan": { "preset": "loop" }, "levels": 2, "outputs": [{ "format": "stl" }] })
}

#[test]
fn a_file_is_named_by_its_content_and_comes_back_as_it_was() {
    story(settings(), async |server| {
        let kept = send(server, "model/obj", OBJ.as_bytes()).await;
        assert_eq!(kept.status, 201, "{}", kept.text());
        let id = format!("b3-{}", blake3::hash(OBJ.as_bytes()));
        let told = kept.json();
        assert_eq!(told, json!({ "id": id, "bytes": OBJ.len(), "format": "obj", "href": format!("/v1/blobs/{id}") }));
        assert_eq!(kept.header("location"), format!("/v1/blobs/{id}"));
        let back = server.get(&format!("/v1/blobs/{id}")).await.ok();
        assert_eq!((back.text().as_str(), back.header("etag")), (OBJ, format!("\"{id}\"").as_str()));
        assert_eq!(back.header("content-type"), "model/obj");
        assert!(back.header("content-security-policy").contains("sandbox"));
        let has = [("if-none-match", back.header("etag"))];
        assert_eq!(server.get_with(&format!("/v1/blobs/{id}"), &has).await.status, 304);
        let head = server.ask(Method::HEAD, &format!("/v1/blobs/{id}"), &[], Vec::new()).await;
        assert_eq!((head.status, head.header("content-length")), (200, OBJ.len().to_string().as_str()));
        for other in [id[3..].to_owned(), format!("b3-{}", "0".repeat(64)), "b3-".to_owned() + &id[3..].to_uppercase()]
        {
            server.get(&format!("/v1/blobs/{other}")).await.problem(404, "not-found");
        }
    });
}

#[test]
fn a_job_of_an_upload_has_the_bytes_of_the_job_with_the_file_in_it() {
    story(settings(), async |server| {
        let id = send(server, "", OBJ.as_bytes()).await.json()["id"].as_str().unwrap().to_owned();
        let mut inline = job(&id);
        inline["input"] = json!({ "text": { "format": "obj", "data": OBJ } });
        let inline = server.render(&inline).await.ok();
        let named = server.render(&job(&id)).await.ok();
        assert_eq!((named.header("cache-status"), &named.body), ("planish; hit", &inline.body));
        let posted = server.post_with("/v1/jobs", &job(&id), &[("prefer", "wait=60")]).await.ok();
        assert_eq!(posted.json()["state"], "done");
        assert_eq!(server.post("/v1/estimate", &job(&id)).await.ok().json()["levels"][2]["faces"], 64);
        let mesh = send(server, "application/json", cube()["mesh"].to_string().as_bytes()).await.json();
        assert_eq!(mesh["format"], "json", "{mesh}");
        let mut of_mesh = job(mesh["id"].as_str().unwrap());
        of_mesh["plan"]["preset"] = "catmull-clark".into();
        server.render(&of_mesh).await.ok();
    });
}

#[test]
fn a_job_that_names_no_upload_says_so_at_its_place() {
    story(settings(), async |server| {
        for (id, said) in [(format!("b3-{}", "0".repeat(64)), "/v1/blobs"), ("teapot".to_owned(), "64 hexadecimal")] {
            for path in ["/v1/render", "/v1/jobs", "/v1/estimate"] {
                let problem = server.post(path, &job(&id)).await.problem(422, "invalid-job");
                assert_eq!(problem["errors"][0]["pointer"], "/input/blob", "{problem}");
                assert!(problem["errors"][0]["detail"].as_str().unwrap().contains(said), "{problem}");
            }
        }
        let broken = send(server, "model/obj", b"f 1 2 3\n").await.json();
        let problem = server.render(&job(broken["id"].as_str().unwrap())).await.problem(422, "invalid-job");
        assert!(problem["errors"][0]["pointer"].as_str().unwrap().starts_with("/input/blob"), "{problem}");
        let mut two = job(broken["id"].as_str().unwrap());
        two["input"]["mesh"] = cube()["mesh"].clone();
        server.render(&two).await.problem(422, "invalid-job");
    });
}

#[test]
fn an_upload_that_the_client_has_is_not_sent_again() {
    story(settings(), async |server| {
        let kept = send(server, "model/obj", OBJ.as_bytes()).await.json();
        let (place, etag) = (kept["href"].as_str().unwrap(), format!("\"{}\"", kept["id"].as_str().unwrap()));
        for (tags, status) in
            [(etag.clone(), 304), (format!("\"x\", W/{etag}"), 304), ("*".into(), 304), ("x".into(), 200)]
        {
            assert_eq!(server.get_with(place, &[("if-none-match", &tags)]).await.status, status, "{tags}");
        }
    });
}

#[test]
fn what_is_no_file_of_a_reader_or_too_long_is_refused_and_leaves_nothing() {
    story(Settings { max_body_bytes: 1 << 20, ..settings() }, async |server| {
        for (media_type, bytes, said, meant) in [
            ("text/html", &b"<p>"[..], "Content-Type is text/html;", "model/obj"),
            ("", b"what is this", "Content-Type is missing, and the first bytes are those of no format", "model/obj"),
            ("image/png", b"no picture", "Content-Type is image/png, and the first bytes are those", "model/obj"),
            ("", b"{\"positions\": []}", "Content-Type is missing, and", "application/json"),
            ("", b"{\"asset\": {}}", "Content-Type is missing, and", "model/gltf+json"),
        ] {
            let problem = send(server, media_type, bytes).await.problem(415, "unsupported-media-type");
            let told = problem["detail"].as_str().unwrap();
            assert!(told.starts_with(said) && told.contains("a picture as image/png"), "{problem}");
            assert!(told.ends_with(&format!("-H 'Content-Type: {meant}'")) && !told.contains("job"), "{problem}");
        }
        for (media_type, bytes, said) in [
            ("model/stl", OBJ.as_bytes(), "like obj, not like stl; send it as model/obj"),
            ("application/json", OBJ.as_bytes(), "like obj, not like json; send it as model/obj"),
            ("model/gltf+json", b"ply\nformat ascii 1.0\n", "like ply, not like gltf; send it as model/ply"),
            ("model/obj", b"glTF\x02\0\0\0", "like glb, not like obj; send it as model/gltf-binary"),
        ] {
            let problem = send(server, media_type, bytes).await.problem(415, "unsupported-media-type");
            assert!(problem["detail"].as_str().unwrap().ends_with(said), "{problem}");
        }
        // refused files are not kept under the wrong type
        assert_eq!(send(server, "model/obj", OBJ.as_bytes()).await.json()["format"], "obj");
        let coded = [("content-type", "model/obj"), ("content-encoding", "gzip")];
        let coded = server.ask(Method::POST, "/v1/blobs", &coded, OBJ.into()).await;
        coded.problem(415, "unsupported-media-type");
        send(server, "model/obj", &vec![b'v'; (1 << 20) + 1]).await.problem(413, "body-too-long");
        // half a file, after which the client disconnects
        let head = format!(
            "POST /v1/blobs HTTP/1.1\r\nhost: {}\r\ncontent-type: model/obj\r\ncontent-length: 1000\r\n\r\nv 0 0 0\n",
            server.address
        );
        let half = server.said(&head).await;
        let bodies = &server.app.desk.account.bodies;
        until("it arrives", || bodies.usage().taken == 2 << 20).await;
        drop(half);
        until("its memory is back", || bodies.usage().taken == 0).await;
        let refused = rest(server.said(&head.replace("1000", "2000000")).await).await;
        assert!(refused.starts_with("HTTP/1.1 413"), "{refused}");
    });
}

#[test]
fn uploads_outlast_the_process_and_results_do_not_push_them_out() {
    let folder = Folder::new();
    let lasting = || Settings { data_dir: folder.path().join("data"), cache_bytes: 1 << 20, ..settings() };
    let id = story(lasting(), async |server| {
        let id = send(server, "", OBJ.as_bytes()).await.json()["id"].as_str().unwrap().to_owned();
        for levels in 1..6 {
            let mut job = job(&id);
            job["levels"] = levels.into();
            server.render(&job).await.ok();
        }
        id
    });
    story(lasting(), async |server| {
        assert_eq!(server.get(&format!("/v1/blobs/{id}")).await.ok().text(), OBJ);
        server.render(&job(&id)).await.ok();
    });
}

#[test]
fn an_upload_that_a_job_needs_does_not_leave_for_others() {
    let folder = Folder::new();
    let file = |n: usize| format!("{OBJ}# {}\n", "x".repeat(40_000 + n));
    let settings = Settings { data_dir: folder.path().join("data"), uploads_bytes: 150_000, ..settings() };
    story(settings, async |server| {
        let needed = send(server, "", file(0).as_bytes()).await.json()["id"].as_str().unwrap().to_owned();
        let held = server.hold().await;
        let posted = server.post("/v1/jobs", &job(&needed)).await;
        assert_eq!(posted.status, 202, "{}", posted.text());
        let other = send(server, "", file(1).as_bytes()).await.json()["id"].as_str().unwrap().to_owned();
        for n in 2..6 {
            assert_eq!(send(server, "", file(n).as_bytes()).await.status, 201);
        }
        server.get(&format!("/v1/blobs/{needed}")).await.ok();
        server.get(&format!("/v1/blobs/{other}")).await.problem(404, "not-found");
        drop(held);
        assert_eq!(server.settled(posted.header("location")).await["state"], "done");
        for n in 6..9 {
            assert_eq!(send(server, "", file(n).as_bytes()).await.status, 201);
        }
        server.get(&format!("/v1/blobs/{needed}")).await.problem(404, "not-found");
    });
}

/// Puts an upload of equal bytes into a store.
fn put(store: &Arc<dyn Store>, number: u8, length: usize) -> Result<Key, StoreError> {
    let mut spool = store.spool(Key::from_bytes([number; 32])).unwrap();
    spool.write_all(&vec![number; length]).unwrap();
    let description =
        ArtifactDescription { media_type: "model/obj".to_owned(), warnings: Vec::new(), owners: Owners::default() };
    spool.commit_by_content(description).map(|manifest| manifest.key)
}

#[test]
fn what_is_pinned_stays_and_a_store_full_of_it_refuses() {
    let store: Arc<dyn Store> = Arc::new(MemoryStore::new(10_000));
    let put = |number| put(&store, number, 3000);
    let first = put(1).unwrap();
    assert_eq!(first, content(&[1; 3000]));
    let pin = Pin::new(&store, first).unwrap();
    let second = put(2).unwrap();
    let other = Pin::new(&store, second).unwrap();
    assert!(matches!(put(3), Err(StoreError::InUse)));
    drop(other);
    put(3).unwrap();
    assert!(store.manifest(&first).unwrap().is_some() && store.manifest(&second).unwrap().is_none());
    drop(pin);
    put(4).unwrap();
    put(5).unwrap();
    assert!(store.manifest(&first).unwrap().is_none());
}

#[test]
fn nothing_is_evicted_for_what_does_not_fit_beside_what_is_pinned() {
    let store: Arc<dyn Store> = Arc::new(MemoryStore::new(12_000));
    let put = |number, length| put(&store, number, length);
    let [first, second, third] = [1, 2, 3].map(|number| put(number, 3000).unwrap());
    let pins = [first, second].map(|key| Pin::new(&store, key).unwrap());
    assert!(matches!(put(4, 5000), Err(StoreError::InUse)));
    assert!(store.manifest(&third).unwrap().is_some(), "it would have been evicted in vain");
    drop(pins);
    put(4, 5000).unwrap();
}

#[test]
fn panels_of_a_figure_may_name_uploads_and_validate_looks_at_them() {
    story(settings(), async |server| {
        let id = send(server, "", OBJ.as_bytes()).await.json()["id"].as_str().unwrap().to_owned();
        let figure = |input: &Value| {
            let panel = |levels: u32| {
                let output = json!([{ "format": "png", "width": 32, "height": 32 }]);
                json!({ "job": { "input": input, "plan": { "preset": "loop" }, "levels": levels, "outputs": output } })
            };
            json!({ "figure": { "panels": [panel(0), panel(1)] }, "outputs": [{ "format": "png", "width": 80 }] })
        };
        let inline = figure(&json!({ "text": { "format": "obj", "data": OBJ } }));
        let inline = server.render(&inline).await.ok();
        let named = server.render(&figure(&json!({ "blob": id }))).await.ok();
        assert_eq!((named.header("cache-status"), &named.body), ("planish; hit", &inline.body));
        let mut missing = figure(&json!({ "blob": id }));
        missing["figure"]["panels"][1]["job"]["input"]["blob"] = format!("b3-{}", "1".repeat(64)).into();
        let problem = server.render(&missing).await.problem(422, "invalid-job");
        assert_eq!(problem["errors"][0]["pointer"], "/figure/panels/1/job/input/blob", "{problem}");

        let good = server.post("/v1/validate", &job(&id)).await.ok().json();
        assert_eq!((&good["valid"], &good["report"]["closed"]), (&true.into(), &true.into()), "{good}");
        let mut bad = job(&id);
        bad["input"]["blob"] = format!("b3-{}", "1".repeat(64)).into();
        let told = server.post("/v1/validate", &bad).await.ok().json();
        assert_eq!((&told["valid"], &told["errors"][0]["pointer"]), (&false.into(), &"/input/blob".into()), "{told}");
    });
}

#[test]
fn the_surface_that_distances_are_measured_from_may_be_an_upload() {
    story(settings(), async |server| {
        let id = send(server, "", OBJ.as_bytes()).await.json()["id"].as_str().unwrap().to_owned();
        let measured = |other: &Value| {
            let mut job = job(&id);
            job["outputs"] = json!([{ "format": "png", "width": 32, "height": 32, "shading": "distance" }]);
            job["distance_to"] = json!({ "input": other });
            job
        };
        let inline = measured(&json!({ "text": { "format": "obj", "data": OBJ } }));
        let inline = server.render(&inline).await.ok();
        let named = server.render(&measured(&json!({ "blob": id }))).await.ok();
        assert_eq!((named.header("cache-status"), &named.body), ("planish; hit", &inline.body));
        let panel = json!({ "figure": { "panels": [{ "job": measured(&json!({ "blob": id })) }] },
            "outputs": [{ "format": "png", "width": 80 }] });
        server.render(&panel).await.ok();
        let missing = measured(&json!({ "blob": format!("b3-{}", "1".repeat(64)) }));
        let problem = server.render(&missing).await.problem(422, "invalid-job");
        assert_eq!(problem["errors"][0]["pointer"], "/distance_to/input/blob", "{problem}");
    });
}
