//! Distances from the surface of another job.

use planish::fault::Fault;
use planish::job::limits::{Limits, Refusal};
use serde_json::{Value, json};

use super::{sheet, sphere};
use crate::support::nets;
use crate::support::{parsed, render};

/// Returns a job with one picture of distances from the surface of another job.
fn job(input: &Value, levels: u32, other: &Value, range: [f64; 2]) -> Value {
    let plan = if levels > 0 { json!({ "preset": "catmull-clark" }) } else { Value::Null };
    json!({ "input": input, "plan": plan, "levels": levels, "distance_to": other, "outputs": [
        { "format": "png", "width": 96, "height": 72, "shading": "distance", "range": range, "color_map": "viridis",
            "color_bar": false, "camera": { "projection": "orthographic" } }] })
}

/// Whether all visible pixels have the colour of one end of the range, in any light.
fn is_all_at(job: &Value, end: f64) -> bool {
    let (bytes, _) = render(job).unwrap_or_else(|faults| panic!("{faults:?}"));
    let picture = image::load_from_memory_with_format(&bytes, image::ImageFormat::Png).expect("it is a picture");
    // viridis ends in yellow, and begins in violet
    let is_there = |[red, green, blue]: [u8; 3]| {
        let is_yellow = red > blue && green > blue;
        let is_violet = blue > green && red.abs_diff(blue) < 60;
        if end > 0.5 { is_yellow } else { is_violet }
    };
    let (mut inside, mut there) = (0, 0);
    for (x, y, pixel) in picture.to_rgb8().enumerate_pixels() {
        // the middle, without outlines and the ground
        if (36..60).contains(&x) && (24..48).contains(&y) {
            inside += 1;
            there += u32::from(is_there(pixel.0));
        }
    }
    assert_eq!(inside, 24 * 24);
    there == inside
}

#[test]
fn spheres_about_one_point_are_the_difference_of_their_radii_apart() {
    let outer = sphere(24, 1.0).input();
    let inner = json!({ "input": sphere(23, 0.5).input() });
    // facets lie within their sphere, by 0.5 (1 - cos(2.77 degrees)) at most, as half a diagonal of a face is seen from
    // the centre under that angle at most
    let bound = 0.5 * 0.00117;
    assert!(is_all_at(&job(&outer, 0, &inner, [0.0, 0.5 - 1e-12]), 1.0), "some are nearer");
    assert!(is_all_at(&job(&outer, 0, &inner, [0.5 + bound, 1.0]), 0.0), "some are farther");
    assert!(!is_all_at(&job(&outer, 0, &inner, [0.5 + bound / 8.0, 0.5 + bound / 7.0]), 0.0), "facets are not felt");
    // from inside, the distance is the same number, not its opposite
    let (outer, inner) = (json!({ "input": outer }), inner["input"].clone());
    assert!(is_all_at(&job(&inner, 0, &outer, [0.0, 0.5 - 2.0 * bound]), 1.0));
}

#[test]
fn a_surface_is_nowhere_away_from_itself_but_away_from_its_net() {
    let cube = nets::cube().input();
    let itself = json!({ "input": cube, "plan": { "preset": "catmull-clark" }, "levels": 3 });
    assert!(is_all_at(&job(&cube, 3, &itself, [1e-12, 1.0]), 0.0));
    assert!(!is_all_at(&job(&cube, 3, &json!({ "input": cube }), [1e-12, 1e-6]), 0.0));
    // with limit positions, both surfaces are moved
    let mut limit = job(&cube, 3, &itself, [1e-12, 1e-6]);
    limit["outputs"][0]["positions"] = "limit".into();
    assert!(!is_all_at(&limit, 0.0));
    limit["distance_to"]["outputs"] = json!([{ "format": "glb", "positions": "limit" }]);
    assert!(is_all_at(&limit, 0.0));
}

#[test]
fn without_another_job_distances_are_those_from_the_net() {
    let cube = nets::cube().input();
    let named = job(&cube, 2, &json!({ "input": cube }), [0.0, 0.5]);
    let plain = job(&cube, 2, &Value::Null, [0.0, 0.5]);
    assert_eq!(render(&named).expect("a picture").0, render(&plain).expect("a picture").0);
}

#[test]
fn the_other_surface_is_part_of_the_key_of_what_shows_it_and_of_nothing_else() {
    let cube = nets::cube().input();
    let keys = |other: &Value| {
        let mut job = job(&cube, 2, other, [0.0, 1.0]);
        job["outputs"].as_array_mut().expect("a list").push(json!({ "format": "glb" }));
        parsed(job.to_string().as_bytes()).unwrap_or_else(|faults| panic!("{faults:?}")).keys().to_vec()
    };
    let plain = keys(&Value::Null);
    let other = |levels: u32| json!({ "input": cube, "plan": { "preset": "catmull-clark" }, "levels": levels });
    let one = keys(&other(1));
    assert_eq!(one[1], plain[1]);
    let mut moved = other(1);
    moved["input"]["mesh"]["positions"][0] = json!([-2, -1, -1]);
    let mut at_limit = other(1);
    at_limit["outputs"] = json!([{ "format": "stats", "positions": "limit" }]);
    let all = [plain[0], one[0], keys(&other(2))[0], keys(&moved)[0], keys(&at_limit)[0]];
    for (i, key) in all.iter().enumerate() {
        assert!(!all[i + 1..].contains(key), "{i}");
    }
    let mut same = other(1);
    same["outputs"] = json!([{ "format": "ply", "name": "whatever" }]);
    assert_eq!(keys(&same), one);
}

#[test]
fn what_distances_cannot_be_measured_from_is_refused_at_its_place() {
    let cube = nets::cube().input();
    let faults = |job: &Value| -> Vec<Fault> { render(job).expect_err("it is refused") };
    let refuses = |other: Value, pointer: &str, detail: &str| {
        let faults = faults(&job(&cube, 1, &other, [0.0, 1.0]));
        assert_eq!(faults[0].pointer, pointer, "{faults:?}");
        assert!(faults[0].detail.contains(detail), "{faults:?}");
    };
    let curve = json!({ "polygon": { "points": [[0, 0], [1, 0], [1, 1]] } });
    refuses(json!({ "input": curve }), "/distance_to/input", "give a mesh");
    let mut inches = cube.clone();
    inches["unit"] = "in".into();
    refuses(json!({ "input": inches }), "/distance_to/input", "\"unit\"");
    let plan = json!({ "preset": "catmull-clark" });
    refuses(json!({ "input": cube, "plan": plan, "levels": { "tolerance": 0.1 } }), "/distance_to/levels", "a number");
    refuses(json!({ "input": cube, "plan": plan }), "/distance_to/levels", "");
    let panels = json!({ "panels": [{ "job": { "input": cube } }] });
    refuses(json!({ "figure": panels }), "/distance_to/figure", "a surface");
    let nested = json!({ "input": cube, "distance_to": { "input": cube } });
    refuses(nested, "/distance_to/distance_to", "no output shows distances");
    let mut unasked = job(&cube, 1, &json!({ "input": cube }), [0.0, 1.0]);
    unasked["outputs"] = json!([{ "format": "png" }]);
    assert_eq!(faults(&unasked)[0].pointer, "/distance_to");
}

#[test]
fn the_other_surface_counts_in_what_a_job_comes_to() {
    let (cube, limits) = (nets::cube().input(), Limits::default());
    let of = |other: &Value, limits: &Limits| {
        let job = job(&cube, 2, other, [0.0, 1.0]);
        limits.estimate(&parsed(job.to_string().as_bytes()).unwrap_or_else(|faults| panic!("{faults:?}")))
    };
    let other = |levels: u32| json!({ "input": cube, "plan": { "preset": "catmull-clark" }, "levels": levels });
    let alone = of(&Value::Null, &limits).expect("it is small");
    let beside = of(&other(6), &limits).expect("it is small");
    // level 6 has 24,576 quads, each of which is two triangles in a tree
    assert!(beside.memory_bytes > alone.memory_bytes + 2 * 24_576 * 132, "{beside:?}");
    assert!(beside.forecast.work > alone.forecast.work + 24_576, "{beside:?}");
    let small = Limits { max_faces: 1000, ..limits };
    let refused = of(&other(6), &small).expect_err("it is too large");
    let Refusal::TooLarge { detail, faults } = refused else { panic!("{refused:?}") };
    assert_eq!(faults[0].pointer, "/distance_to/levels", "{detail}");
    let tight = Limits { max_job_bytes: u64::try_from(beside.memory_bytes).expect("small") - 1, ..limits };
    let refused = of(&other(6), &tight).expect_err("it is too large");
    let Refusal::TooLarge { detail, faults } = refused else { panic!("{refused:?}") };
    assert_eq!(faults[0].pointer, "/distance_to", "{detail}");
}

#[test]
fn panels_and_films_measure_from_the_other_surface_too() {
    let plane = sheet(2, |_, _| 0.0).input();
    let above = json!({ "input": sheet(2, |_, _| 1.0).input() });
    let mut panel = job(&plane, 0, &above, [0.0, 0.5]);
    panel["outputs"][0]["camera"]["elevation_deg"] = 0.into();
    let far = render(&panel).expect("a picture").0;
    panel["outputs"][0]["range"] = json!([2, 3]);
    let near = render(&panel).expect("a picture").0;
    assert_ne!(near, far);
    let figure = |range: [f64; 2]| {
        let mut panel = panel.clone();
        panel["outputs"][0]["range"] = json!(range);
        let figure =
            json!({ "figure": { "panels": [{ "job": panel }] }, "outputs": [{ "format": "png", "width": 96 }] });
        render(&figure).expect("a figure").0
    };
    assert_ne!(figure([0.0, 0.5]), figure([2.0, 3.0]));
    assert_eq!(figure([0.0, 0.5]), figure([0.0, 0.25]));
    let film = |range: [f64; 2]| {
        let mut film = job(&nets::cube().input(), 1, &above, range);
        film["outputs"][0]["format"] = "apng".into();
        film["outputs"][0]["frames"] = 2.into();
        render(&film).expect("a film").0
    };
    assert_ne!(film([0.0, 0.01]), film([9.0, 10.0]));
}
