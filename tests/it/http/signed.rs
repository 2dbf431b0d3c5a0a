//! Signed addresses: what they open, and what they do not.

use std::io::Write;

use axum::http::Method;
use base64::Engine;
use base64::engine::general_purpose::URL_SAFE_NO_PAD;
use flate2::Compression;
use flate2::write::DeflateEncoder;
use planish::config::keys::{KeyFile, KeyRole, Link, Token};
use serde_json::{Value, json};

use super::jobs::{mesh, polygon, with};
use super::keys::{bearer, key, key_with, keyed};
use super::server::{Folder, Server, story, until};

/// The year 2100, in seconds since 1970.
const LATER: u64 = 4_102_444_800;

fn deflated(bytes: &[u8]) -> String {
    let mut encoder = DeflateEncoder::new(Vec::new(), Compression::best());
    encoder.write_all(bytes).unwrap();
    URL_SAFE_NO_PAD.encode(encoder.finish().unwrap())
}

fn named(job: &Value, extension: &str) -> String {
    format!("{}.{extension}", deflated(job.to_string().as_bytes()))
}

fn signed(token: &Token, expires: u64, rest: &str) -> String {
    Link::sign(token.id(), &token.link_secret(), expires, rest)
}

#[test]
fn a_signed_address_shows_a_render_without_a_key_and_only_that() {
    let folder = Folder::new();
    let own = key(&folder, "acme", KeyRole::Render);
    story(keyed(&folder), async |server| {
        let rest = named(&polygon(3), "svg");
        let address = signed(&own, LATER, &rest);
        let shown = server.get(&address).await.ok();
        assert_eq!(shown.header("content-type"), "image/svg+xml");
        assert_eq!(shown.header("cache-status"), "planish; fwd=miss; stored");
        assert_eq!(shown.header("cache-control"), "public, max-age=86400");
        assert_eq!(shown.header("cross-origin-resource-policy"), "cross-origin");
        // another expiry is another address of the same result, which is that of the equal job
        let again = server.get(&signed(&own, LATER + 1, &rest)).await.ok();
        assert_eq!((again.header("cache-status"), again.header("etag")), ("planish; hit", shown.header("etag")));
        let posted =
            server.post_with("/v1/render", &with(polygon(3), "svg"), &[("authorization", &bearer(&own))]).await;
        assert_eq!((posted.clone().ok().header("cache-status"), posted.body), ("planish; hit", shown.body.clone()));
        let tagged = server.get_with(&address, &[("if-none-match", shown.header("etag"))]).await;
        assert_eq!(tagged.status, 304);
        let head = server.ask(Method::HEAD, &address, &[], Vec::new()).await.ok();
        assert_eq!(head.header("etag"), shown.header("etag"));
        // the result itself still requires the key
        server.get(shown.header("content-location")).await.problem(401, "unauthorized");
    });
}

/// A loader fetches the buffers relative to the address of the model.
#[test]
fn a_signed_model_opens_the_buffers_to_which_it_refers_and_no_others() {
    let folder = Folder::new();
    let own = key(&folder, "acme", KeyRole::Render);
    story(keyed(&folder), async |server| {
        let levels = |lod: &[u32]| {
            let mut job = mesh(3);
            job["outputs"] = json!([{ "format": "gltf", "lod": lod }]);
            deflated(job.to_string().as_bytes())
        };
        let buffers = async |address: &str| -> Vec<String> {
            let model: Value = serde_json::from_slice(&server.get(address).await.ok().body).expect("JSON");
            let (beside, _) = address.rsplit_once('/').expect("a folder");
            let all = model["buffers"].as_array().expect("buffers").iter();
            all.map(|buffer| format!("{beside}/{}", buffer["uri"].as_str().expect("an address"))).collect()
        };
        let address = signed(&own, LATER, &format!("{}/model.gltf", levels(&[1, 3])));
        let own_buffers = buffers(&address).await;
        assert_eq!(own_buffers.len(), 2);
        for buffer in &own_buffers {
            let found = server.get(buffer).await.ok();
            assert_eq!(found.header("content-type"), "application/gltf-buffer");
            let range = server.get_with(buffer, &[("range", "bytes=0-3")]).await;
            assert_eq!((range.status, &range.body[..]), (206, &found.body[..4]));
        }
        let others = buffers(&signed(&own, LATER, &format!("{}/model.gltf", levels(&[0, 2, 3])))).await;
        let file = |address: &str| address.rsplit_once('/').expect("a folder").1.to_owned();
        let foreign = others.iter().find(|other| !own_buffers.iter().any(|own| file(own) == file(other)));
        let (beside, _) = address.rsplit_once('/').expect("a folder");
        let foreign = format!("{beside}/{}", file(foreign.expect("level 0 is another buffer")));
        server.get(&foreign).await.problem(404, "not-found");
        server.get(&format!("{beside}/{}.bin", "0".repeat(64))).await.problem(404, "not-found");
        server.get(&format!("{beside}/x.bin")).await.problem(404, "not-found");
        server.get(&format!("{beside}/other.gltf")).await.problem(403, "bad-link");
        server.get(&own_buffers[0].replace("/v1/r/", "/v1/r/0")).await.problem(403, "bad-link");
        let plain = signed(&own, LATER, &format!("{}.gltf", levels(&[1, 3])));
        server.get(&plain.replace(".gltf", "/model.gltf")).await.problem(403, "bad-link");
    });
}

#[test]
fn the_job_may_name_its_output_and_the_extension_has_to_be_that_of_its_format() {
    let folder = Folder::new();
    let own = key(&folder, "acme", KeyRole::Render);
    story(keyed(&folder), async |server| {
        let mut job = mesh(1);
        job["outputs"] = json!([{ "format": "png", "width": 64, "height": 48 }]);
        server.get_with(&signed(&own, LATER, &named(&job, "png")), &[("accept", "text/html")]).await.ok();
        server.get(&signed(&own, LATER, &named(&job, "svg"))).await.problem(406, "not-acceptable");
        server.get(&signed(&own, LATER, &named(&job, "exe"))).await.problem(404, "not-found");
        server.get(&signed(&own, LATER, &deflated(b"{}"))).await.problem(404, "not-found");
        server.get(&signed(&own, LATER, &format!("{}.svg", deflated(b"[")))).await.problem(400, "not-json");
        server.get(&signed(&own, LATER, "bm90IGRlZmxhdGU.svg")).await.problem(422, "invalid-job");
        server.get(&signed(&own, LATER, "*.svg")).await.problem(422, "invalid-job");
    });
}

#[test]
fn what_is_altered_expired_or_signed_by_another_is_refused_and_told_apart() {
    let folder = Folder::new();
    let (own, reader) = (key(&folder, "acme", KeyRole::Render), key(&folder, "acme", KeyRole::Read));
    let ended = key_with(&folder, "acme", KeyRole::Render, |entry| entry.expires = Some(1));
    let foreign = key(&Folder::new(), "acme", KeyRole::Render);
    story(keyed(&folder), async |server| {
        let rest = named(&polygon(2), "svg");
        let good = signed(&own, LATER, &rest);
        server.get(&good).await.ok();
        let refused = async |address: &str, says: &str| {
            let problem = server.get(address).await.problem(403, "bad-link");
            assert!(problem["detail"].as_str().unwrap().contains(says), "{address}: {problem}");
        };
        // the signature is valid before the second of its expiry, and not from that second on
        let now = server.app.desk.clock().wall().as_secs();
        for (expires, opens) in
            [(0, false), (1, false), (now - 1, false), (now, false), (now + 60, true), (LATER, true)]
        {
            let address = signed(&own, expires, &rest);
            match opens {
                true => drop(server.get(&address).await.ok()),
                false if expires == 0 => refused(&address, "is no signed one").await,
                false => refused(&address, "time of the signed address is over").await,
            }
        }
        refused(&good.replace(&LATER.to_string(), &(LATER + 1).to_string()), "not that of this address").await;
        refused(&good.replace(".svg", ".png"), "not that of this address").await;
        refused(&good.replace(own.id(), reader.id()), "not that of this address").await;
        refused(&good.replace(own.id(), "ffffffffffff"), "not that of this address").await;
        let swapped = signed(&own, LATER, &named(&polygon(1), "svg"));
        let (signature, _) = swapped.split_once(&format!("/{LATER}/")).unwrap();
        refused(&format!("{signature}/{LATER}/{rest}"), "not that of this address").await;
        refused(&signed(&foreign, LATER, &rest), "not that of this address").await;
        refused(&signed(&ended, LATER, &rest), "key that signed the address has expired").await;
        refused(&signed(&reader, LATER, &rest), "may read only").await;
        refused(&format!("{good}?keep=true"), "has no query").await;
        for form in [
            "/v1/r/a/b/c.svg",
            "/v1/r/",
            "/v1/r/x",
            &good.replace('.', ""),
            &format!("/v1/r/{}.AAAA/9/a.svg", own.id()),
        ] {
            refused(form, "is no signed one").await;
        }
        server.ask(Method::POST, &good, &[], b"{}".to_vec()).await.problem(403, "bad-link");
        // removing a key revokes the addresses that it signed
        KeyFile::of(folder.path())
            .change(|keys| {
                keys.retain(|key| key.id != own.id());
                Ok(())
            })
            .unwrap();
        until("the key is revoked", || server.app.gate.n_keys() == 2).await;
        refused(&good, "or its key was revoked").await;
    });
}

#[test]
fn an_address_that_is_too_long_or_inflates_to_too_much_is_refused_before_it_is_read() {
    let folder = Folder::new();
    let own = key(&folder, "acme", KeyRole::Render);
    story(keyed(&folder), async |server| {
        let bomb = format!("{}.svg", deflated(&vec![b' '; 16 << 20]));
        // 16 MiB of blanks still take 16 KiB deflated; a smaller bomb fits into an address
        assert!(bomb.len() > 8 << 10);
        server.get(&signed(&own, LATER, &bomb)).await.problem(414, "address-too-long");
        let bomb = format!("{}.svg", deflated(&vec![b' '; 4 << 20]));
        assert!(bomb.len() < 8 << 10, "{}", bomb.len());
        let problem = server.get(&signed(&own, LATER, &bomb)).await.problem(413, "body-too-long");
        assert!(problem["detail"].as_str().unwrap().contains("65536"), "{problem}");
        let most = server.app.desk.account.bodies.usage().most;
        assert_eq!(most, 0);
    });
}

#[test]
fn a_signed_address_whose_result_is_not_there_in_time_says_when_to_come_back() {
    let folder = Folder::new();
    let own = key(&folder, "acme", KeyRole::Render);
    story(keyed(&folder), async |server| {
        let held = server.hold().await;
        let address = signed(&own, LATER, &named(&mesh(2), "obj"));
        let later = server.get_with(&address, &[("prefer", "wait=0")]).await;
        later.problem(503, "not-finished");
        assert_eq!(later.header("retry-after"), "1");
        drop(held);
        until_ok(server, &address).await;
    });
}

async fn until_ok(server: &Server, address: &str) {
    loop {
        let answer = server.get(address).await;
        if answer.status == 200 {
            return;
        }
        answer.problem(503, "not-finished");
    }
}

#[test]
fn events_and_results_can_be_signed_too() {
    let folder = Folder::new();
    let (own, reader) = (key(&folder, "acme", KeyRole::Render), key(&folder, "acme", KeyRole::Read));
    let other = key(&folder, "bolt", KeyRole::Read);
    story(keyed(&folder), async |server| {
        let shown = bearer(&own);
        let headers = [("authorization", shown.as_str()), ("prefer", "wait=60")];
        let done = server.post_with("/v1/jobs", &with(mesh(2), "obj"), &headers).await.ok().json();
        let id = done["id"].as_str().unwrap();
        let events = server.get(&signed(&reader, LATER, &format!("jobs/{id}/events"))).await.ok();
        assert_eq!(events.header("content-type"), "text/event-stream");
        assert!(events.text().contains("event: done"), "{}", events.text());
        let file = done["outputs"][0]["href"].as_str().unwrap().trim_start_matches("/v1/").to_owned();
        let bytes = server.get_with(&signed(&reader, LATER, &file), &[("range", "bytes=0-9")]).await;
        assert_eq!((bytes.status, bytes.body.len()), (206, 10));
        let list = json!({ "jobs": [with(mesh(2), "obj"), with(mesh(1), "stl")] });
        let batch = server.post_with("/v1/batches", &list, &headers).await.ok().json();
        let of_batch = format!("batches/{}/events", batch["id"].as_str().unwrap());
        let events = server.get(&signed(&reader, LATER, &of_batch)).await.ok();
        assert!(events.text().contains("event: done"), "{}", events.text());
        for rest in [&format!("jobs/{id}/events"), &of_batch, &file] {
            server.get(&signed(&other, LATER, rest)).await.problem(404, "not-found");
        }
        // no other path below /v1 can be reached by a signature
        for rest in [&format!("jobs/{id}"), "jobs", "blobs/b3-0", "../../metrics", "jobs/0/cancel"] {
            let status = server.get(&signed(&reader, LATER, rest)).await.status;
            assert!([403, 404].contains(&status), "{rest}: {status}");
        }
    });
}

#[test]
fn without_keys_nothing_can_be_signed() {
    let folder = Folder::new();
    story(keyed(&folder), async |server| {
        let token = Token::parse(&format!("planish_0123456789ab_{}", "A".repeat(43))).unwrap();
        let problem = server.get(&signed(&token, LATER, &named(&polygon(1), "svg"))).await.problem(403, "bad-link");
        assert!(problem["detail"].as_str().unwrap().contains("no keys"), "{problem}");
    });
}
