//! Comparisons over HTTP.

use std::io::Cursor;

use axum::http::Method;
use serde_json::{Value, json};

use super::jobs::{cube, endless, mesh, polygon, with};
use super::server::{Server, settings, story, until};

/// Returns a cube with this half side, unrefined.
fn box_of(half: f64) -> Value {
    let mut input = cube();
    for x in input["mesh"]["positions"].as_array_mut().unwrap().iter_mut().flat_map(|p| p.as_array_mut().unwrap()) {
        *x = json!(x.as_f64().unwrap() * half);
    }
    json!({ "input": input })
}

fn near(found: &Value, wanted: f64) {
    let found = found.as_f64().unwrap_or_else(|| panic!("{found} is no number"));
    assert!((found - wanted).abs() < 1e-12, "{found}, not {wanted}");
}

async fn compare(server: &Server, asked: &Value) -> Value {
    server.post("/v1/compare", asked).await.ok().json()
}

fn picture(azimuth: f64) -> Value {
    let mut job = with(mesh(2), "png");
    job["outputs"][0]["width"] = 96.into();
    job["outputs"][0]["height"] = 64.into();
    job["outputs"][0]["camera"] = json!({ "azimuth_deg": azimuth });
    job
}

#[test]
fn two_boxes_are_as_far_apart_as_their_corners_and_their_faces() {
    story(settings(), async |server| {
        let asked = json!({ "a": box_of(1.0), "b": box_of(1.5) });
        let found = compare(server, &asked).await;
        assert_eq!(found["equal"], false);
        let hausdorff = &found["hausdorff"];
        near(&hausdorff["a_to_b"], 0.5);
        near(&hausdorff["b_to_a"], 0.75_f64.sqrt());
        for x in hausdorff["at"]["b_to_a"].as_array().unwrap() {
            near(&json!(x.as_f64().unwrap().abs()), 1.5);
        }
        near(&hausdorff["at_most"]["b_to_a"], 0.75_f64.sqrt());
        assert_eq!((&found["area"]["change"], &found["volume"]["change"]), (&json!(30.0), &json!(19.0)));
        assert_eq!(found["box"]["change"], json!([[-0.5, -0.5, -0.5], [0.5, 0.5, 0.5]]));
        assert_eq!(found["shape_hash"]["equal"], false);
        let again = server.post("/v1/compare", &asked).await.ok();
        assert_eq!((again.header("cache-status"), again.json()), ("planish; hit", found), "it is made once");
        let allowed = json!({ "a": box_of(1.0), "b": box_of(1.5), "tolerance": 0.9 });
        assert_eq!(compare(server, &allowed).await["equal"], true);
    });
}

#[test]
fn jobs_artifacts_and_uploads_of_one_shape_are_equal() {
    story(settings(), async |server| {
        let made = server.render(&with(mesh(2), "ply")).await.ok();
        let artifact = made.header("etag").trim_matches('"').to_owned();
        let sent = server.ask(Method::POST, "/v1/blobs", &[("content-type", "model/ply")], made.body.to_vec()).await;
        let upload = sent.json()["id"].as_str().unwrap().to_owned();
        let others = [json!(artifact), json!(upload), mesh(2), with(mesh(2), "stl")];
        for other in &others {
            let found = compare(server, &json!({ "a": mesh(2), "b": other })).await;
            assert_eq!(found["equal"], true);
            near(&found["hausdorff"]["at_most"]["a_to_b"], 0.0);
        }
        let rounded = server.render(&with(mesh(2), "glb")).await.ok();
        let rounded = json!(rounded.header("etag").trim_matches('"'));
        let found = compare(server, &json!({ "a": mesh(2), "b": rounded, "tolerance": 1e-6 })).await;
        assert_eq!(found["equal"], true, "glb rounds to f32: {found}");
        let limit = json!({ "input": cube(), "plan": { "preset": "catmull-clark" }, "levels": 2,
            "outputs": [{ "format": "obj", "positions": "limit" }] });
        let found = compare(server, &json!({ "a": mesh(2), "b": limit })).await;
        assert!(found["hausdorff"]["a_to_b"].as_f64().unwrap() > 1e-3, "the option of the output counts: {found}");
    });
}

#[test]
fn curves_have_a_length_and_a_distance() {
    story(settings(), async |server| {
        let found = compare(server, &json!({ "a": polygon(0), "b": polygon(1) })).await;
        // each corner of the unit square is cut from 1/4 to 1/4
        near(&found["hausdorff"]["a_to_b"], 0.125 * 2.0_f64.sqrt());
        // not a vertex, but the middle of the cut is farthest from the square
        near(&found["hausdorff"]["b_to_a"], 0.125);
        near(&found["hausdorff"]["at_most"]["b_to_a"], 0.125);
        near(&found["length"]["b"], 2.0 + 2.0_f64.sqrt());
        near(&found["area"]["change"], -0.125);
        let mixed = server.post("/v1/compare", &json!({ "a": polygon(0), "b": mesh(0) })).await;
        assert_eq!(mixed.problem(422, "invalid-job")["errors"][0]["pointer"], "/b");
    });
}

#[test]
fn own_pictures_are_compared_by_equality_and_others_as_they_are_seen() {
    story(settings(), async |server| {
        let asked = json!({ "a": picture(30.0), "b": picture(33.0), "outputs": [{ "format": "png" }] });
        let found = compare(server, &asked).await;
        let pixels = &found["pixels"];
        assert_eq!((&found["equal"], &pixels["of"], &pixels["smoothed"]), (&json!(false), &json!(96 * 64), &json!(0)));
        let drawn = server.get(found["outputs"][0]["href"].as_str().unwrap()).await.ok();
        let drawn = image::load_from_memory(&drawn.body).unwrap().into_rgb8();
        assert_eq!(drawn.dimensions(), (96, 64));
        let red = drawn.pixels().filter(|pixel| pixel.0 == [255, 0, 0]).count();
        assert_eq!(pixels["different"], red);
        assert_eq!(compare(server, &json!({ "a": picture(30.0), "b": picture(30.0) })).await["equal"], true);
        // one slightly different pixel
        let own = server.render(&picture(30.0)).await.ok();
        let mut changed = image::load_from_memory(&own.body).unwrap().into_rgba8();
        changed.get_pixel_mut(5, 5).0[1] ^= 1;
        let mut bytes = Cursor::new(Vec::new());
        changed.write_to(&mut bytes, image::ImageFormat::Png).unwrap();
        let sent = server.ask(Method::POST, "/v1/blobs", &[("content-type", "image/png")], bytes.into_inner()).await;
        assert_eq!(sent.json()["format"], "png");
        let id = sent.json()["id"].clone();
        let own = json!(own.header("etag").trim_matches('"'));
        let seen = compare(server, &json!({ "a": own, "b": id })).await;
        assert_eq!((&seen["equal"], &seen["pixels"]["different"]), (&json!(true), &json!(0)));
        let strict = compare(server, &json!({ "a": own, "b": id, "threshold": 0 })).await;
        assert_eq!((&strict["equal"], &strict["pixels"]["different"]), (&json!(false), &json!(1)));
        let job = json!({ "input": { "blob": id }, "levels": 0 });
        assert!(server.render(&job).await.problem(422, "invalid-job")["detail"].to_string().contains("picture"));
    });
}

#[test]
fn pictures_of_two_sizes_differ_and_have_no_picture_of_it() {
    story(settings(), async |server| {
        let mut wide = picture(30.0);
        wide["outputs"][0]["width"] = 97.into();
        let found = compare(server, &json!({ "a": picture(30.0), "b": wide })).await;
        assert_eq!((&found["equal"], &found["sizes"]), (&json!(false), &json!([[96, 64], [97, 64]])));
        let asked = json!({ "a": picture(30.0), "b": wide, "outputs": [{ "format": "png" }] });
        let refused = server.post("/v1/compare", &asked).await.problem(422, "invalid-job");
        assert_eq!(refused["errors"][0]["pointer"], "/outputs");
    });
}

#[test]
fn what_cannot_be_compared_is_refused_with_its_place() {
    story(settings(), async |server| {
        let unknown = "0".repeat(64);
        let mut typo = mesh(1);
        typo["level"] = 2.into();
        for (asked, place) in [
            (json!({ "a": "nothing", "b": mesh(1) }), "/a"),
            (json!({ "a": mesh(1), "b": unknown }), "/b"),
            (json!({ "a": mesh(1), "b": format!("b3-{unknown}") }), "/b"),
            (json!({ "a": 7, "b": mesh(1) }), "/a"),
            (json!({ "a": mesh(1), "b": typo }), "/b/level"),
            (json!({ "a": mesh(1), "b": picture(0.0) }), "/b"),
            (json!({ "a": mesh(1), "b": mesh(1), "threshold": 0.5 }), "/threshold"),
            (json!({ "a": mesh(1), "b": mesh(1), "tolerance": -1 }), "/tolerance"),
            (json!({ "a": picture(0.0), "b": picture(0.0), "threshold": 1.5 }), "/threshold"),
            (json!({ "a": picture(0.0), "b": picture(0.0), "tolerance": 0 }), "/tolerance"),
            (json!({ "a": mesh(1), "b": mesh(1), "outputs": [{ "format": "png" }] }), "/outputs"),
            (json!({ "a": mesh(1), "b": mesh(1), "outputs": [{ "format": "svg" }] }), "/outputs/0/format"),
        ] {
            let refused = server.post("/v1/compare", &asked).await.problem(422, "invalid-job");
            assert_eq!(refused["errors"][0]["pointer"], place, "{refused}");
        }
    });
}

#[test]
fn pictures_that_lie_about_their_size_are_refused() {
    story(settings(), async |server| {
        let own = server.render(&picture(30.0)).await.ok().body.to_vec();
        let mut huge = own.clone();
        huge[16..24].copy_from_slice(&[0, 1, 0, 0, 0, 1, 0, 0]);
        let mut crc = flate2::Crc::new();
        crc.update(&huge[12..29]);
        huge[29..33].copy_from_slice(&crc.sum().to_be_bytes());
        let short = own[..own.len() / 2].to_vec();
        for (file, told) in
            [(huge, "65536 x 65536 pixels"), (short, "cannot be decoded"), (own[..20].to_vec(), "no PNG")]
        {
            let sent = server.ask(Method::POST, "/v1/blobs", &[("content-type", "image/png")], file).await;
            let asked = json!({ "a": picture(30.0), "b": sent.json()["id"] });
            let refused = server.post("/v1/compare", &asked).await.problem(422, "invalid-job");
            assert_eq!(refused["errors"][0]["pointer"], "/b");
            assert!(refused["detail"].as_str().unwrap().contains(told), "{refused}");
        }
    });
}

#[test]
fn a_mesh_file_is_described_as_the_job_that_it_is() {
    story(settings(), async |server| {
        let file = b"v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n".to_vec();
        let path = "/v1/render?preset=loop&levels=1&format=ply&output.describe=true";
        let made = server.ask(Method::POST, path, &[("content-type", "model/obj")], file).await.ok();
        let said = planish::output::description::description(&made.body).unwrap();
        let said: Value = serde_json::from_str(&said).unwrap();
        let again = server.render(&said["job"]).await.ok();
        assert_eq!(again.header("cache-status"), "planish; hit", "its key is that of the job that it tells");
        assert_eq!(again.body, made.body);
        let posted = server.post_with("/v1/jobs", &said["job"], &[("prefer", "wait=60")]).await.ok().json();
        assert_eq!(posted["outputs"][0]["key"], made.header("etag").trim_matches('"'));
    });
}

#[test]
fn a_comparison_whose_client_has_gone_stops() {
    story(settings(), async |server| {
        let asked = json!({ "a": endless(), "b": endless() });
        let going = tokio::spawn(server.client.post(server.url("/v1/compare")).json(&asked).send());
        until("the comparison runs", || server.app.desk.n_under_way() == 1).await;
        going.abort();
        until("nobody compares any more", || server.app.desk.n_under_way() == 0).await;
    });
}
