//! The format of an answer: that of the named output, else from `Accept`, else the default.

use serde_json::{Value, json};

use super::jobs::{mesh, polygon, with};
use super::server::{Server, settings, story};

async fn chosen(server: &Server, job: &Value, accept: Option<&str>) -> String {
    let headers: Vec<_> = accept.map(|accept| ("accept", accept)).into_iter().collect();
    let answer = server.post_with("/v1/render", job, &headers).await;
    if answer.status == 406 {
        let problem = answer.problem(406, "not-acceptable");
        assert!(problem["detail"].as_str().unwrap().contains("application/json"), "it says what there is: {problem}");
        return "406".to_owned();
    }
    answer.ok().header("content-type").to_owned()
}

#[test]
fn accept_chooses_the_format_where_no_output_does() {
    let table = [
        (None, "model/gltf-binary", "application/json"),
        (Some("*/*"), "model/gltf-binary", "application/json"),
        (Some(""), "model/gltf-binary", "application/json"),
        (Some("application/json"), "application/json", "application/json"),
        (Some("image/png"), "image/png", "image/png"),
        (Some("IMAGE/PNG"), "image/png", "image/png"),
        (Some("model/*"), "model/gltf-binary", "model/obj"),
        (Some("image/*"), "image/png", "image/png"),
        (Some("image/svg+xml"), "image/svg+xml", "image/svg+xml"),
        (Some("image/svg+xml, image/png;q=0.5"), "image/svg+xml", "image/svg+xml"),
        (Some("model/obj;q=0.3, model/ply;q=0.7"), "model/ply", "model/ply"),
        (Some("model/obj;Q=0.3, model/ply; q=0.7"), "model/ply", "model/ply"),
        (Some("*/*;q=0.1, model/stl"), "model/stl", "application/json"),
        (Some("model/gltf-binary;q=0, */*;q=0.5"), "application/json", "application/json"),
        (Some("text/html, application/xhtml+xml, */*;q=0.8"), "model/gltf-binary", "application/json"),
        (Some("text/html"), "406", "406"),
        (Some("image/png;q=0"), "406", "406"),
        (Some("model/stl"), "model/stl", "406"),
    ];
    story(settings(), async |server| {
        for (accept, of_mesh, of_polygon) in table {
            assert_eq!(chosen(server, &mesh(1), accept).await, of_mesh, "mesh, Accept: {accept:?}");
            assert_eq!(chosen(server, &polygon(1), accept).await, of_polygon, "polygon, Accept: {accept:?}");
        }
    });
}

#[test]
fn an_output_that_accept_does_not_allow_is_refused_and_the_refusal_says_what_is_acceptable() {
    story(settings(), async |server| {
        let job = with(mesh(1), "obj");
        // also for results that are already known
        server.render(&job).await.ok();
        for accept in ["image/png", "application/json", "*/*, model/obj;q=0", "model/*;q=0, image/*", "text/html"] {
            let answer = server.post_with("/v1/render", &job, &[("accept", accept)]).await;
            let problem = answer.problem(406, "not-acceptable");
            let detail = problem["detail"].as_str().unwrap();
            assert!(detail.contains("accept model/obj, or"), "Accept: {accept}: {detail}");
        }
        let fitting = [None, Some("*/*"), Some("model/*"), Some("image/png, */*;q=0.1"), Some("*/*;q=0, model/obj")];
        for accept in fitting {
            assert_eq!(chosen(server, &job, accept).await, "model/obj", "Accept: {accept:?}");
        }
        let unknown = server.post_with("/v1/render", &with(mesh(1), "png "), &[("accept", "image/jpeg")]).await;
        unknown.problem(422, "invalid-job");
    });
}

#[test]
fn the_same_result_has_the_same_address_however_its_format_was_chosen() {
    story(settings(), async |server| {
        let named = server.render(&with(mesh(1), "glb")).await.ok();
        let unnamed = server.render(&mesh(1)).await.ok();
        let accepted = server.post_with("/v1/render", &mesh(1), &[("accept", "model/gltf-binary")]).await.ok();
        for other in [unnamed, accepted] {
            assert_eq!(other.header("etag"), named.header("etag"));
            assert_eq!(other.header("content-location"), named.header("content-location"));
            assert_eq!(other.header("cache-status"), "planish; hit");
        }
    });
}

#[test]
fn a_fault_in_an_output_that_accept_chose_points_at_the_outputs_that_nobody_wrote() {
    story(settings(), async |server| {
        let mut far = mesh(1);
        far["input"]["mesh"]["positions"][0][0] = json!(1e300);
        let of = async |job: &Value| {
            let problem = server.post_with("/v1/render", job, &[("accept", "model/gltf-binary")]).await;
            problem.problem(422, "invalid-job")["errors"][0]["pointer"].clone()
        };
        assert_eq!(of(&far).await, "/outputs");
        assert_eq!(of(&with(far, "glb")).await, "/outputs/0");
    });
}
