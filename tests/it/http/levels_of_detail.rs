//! A document with several levels, whose buffers are made on request.

use serde_json::{Value, json};

use planish::service::job_key::Tenant;

use super::jobs::mesh;
use super::server::{settings, story};

fn question() -> Value {
    let mut job = mesh(3);
    job["outputs"] = json!([{ "format": "gltf", "compression": "meshopt", "lod": [1, 2, 3] }]);
    job
}

/// Returns the addresses of the buffers of a document, which are relative to its own.
fn addresses(document: &[u8], location: &str) -> Vec<String> {
    let document: Value = serde_json::from_slice(document).expect("JSON");
    let (folder, _) = location.rsplit_once('/').expect("a folder");
    let uris = document["buffers"].as_array().expect("buffers").iter().filter_map(|buffer| buffer["uri"].as_str());
    uris.map(|uri| format!("{folder}/{uri}")).collect()
}

#[test]
fn the_buffers_of_a_document_are_artifacts_beside_it() {
    story(settings(), async |server| {
        let document = server.render(&question()).await.ok();
        let location = document.header("content-location").to_owned();
        let buffers = addresses(&document.body, &location);
        assert_eq!(buffers.len(), 3);
        let mut lengths = Vec::new();
        for buffer in &buffers {
            let first = server.get(buffer).await.ok();
            assert_eq!(first.header("content-type"), "application/gltf-buffer");
            assert_eq!(first.header("cache-status"), "planish; fwd=miss; stored", "it is made when it is asked for");
            assert!(first.header("cache-control").contains("immutable"));
            let second = server.get(buffer).await.ok();
            assert_eq!((second.header("cache-status"), &second.body), ("planish; hit", &first.body));
            lengths.push(first.body.len());
        }
        assert!(lengths.is_sorted() && 4 * lengths[0] < lengths[2], "{lengths:?}");
        assert_eq!(server.get(&location).await.ok().body, document.body);
    });
}

#[test]
fn a_document_that_is_posted_again_has_its_buffers_again() {
    story(settings(), async |server| {
        let document = server.render(&question()).await.ok();
        let buffers = addresses(&document.body, document.header("content-location"));
        let id = server.app.desk.jobs.of_artifact(Tenant::ANYONE, &key(&buffers[0])).expect("a record").job;
        assert!(server.app.desk.jobs.remove(&id));
        server.get(&buffers[0]).await.problem(404, "not-found");
        let again = server.render(&question()).await.ok();
        assert_eq!((again.header("cache-status"), &again.body), ("planish; hit", &document.body));
        server.get(&buffers[0]).await.ok();
        let etag = document.header("etag");
        let same = server.post_with("/v1/render", &question(), &[("if-none-match", etag)]).await;
        assert_eq!(same.status, 304);
    });
}

fn key(address: &str) -> planish::job::key::Key {
    let name = address.rsplit_once('/').expect("a folder").1;
    planish::job::key::Key::parse(name.strip_suffix(".bin").expect("a buffer")).expect("a key")
}
