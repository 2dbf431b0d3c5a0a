//! Channels of corners: numbers that differ on the two sides of seams, and are refined on each side separately.

use planish::math::functions::pow;
use serde_json::{Value, json};

use super::{job, refusal, text, told, written};
use crate::support::nets::{self, Net};

/// Returns a channel with a separate value of `width` numbers for each face; the first is the number of the face.
fn by_face(net: &Net, width: usize) -> Value {
    let value = |f: usize| match width {
        1 => json!(f),
        _ => json!((0..width).map(|k| if k == 0 { f } else { k }).collect::<Vec<_>>()),
    };
    let values: Vec<Value> = (0..net.faces.len()).map(value).collect();
    let faces: Vec<Vec<usize>> = net.faces.iter().enumerate().map(|(f, face)| vec![f; face.len()]).collect();
    json!({ "values": values, "faces": faces })
}

/// Returns a channel with the numbers of vertices, written for corners.
fn of_corners(net: &Net, values: &Value) -> Value {
    json!({ "values": values, "faces": net.faces })
}

#[test]
fn a_channel_without_seams_is_the_same_written_for_corners_and_for_vertices() {
    let net = nets::torus(5, 4);
    let heat: Vec<f64> = (0..20_u8).map(|v| f64::from(v * 7 % 5)).collect();
    for preset in ["catmull-clark", "bilinear"] {
        let plan = json!({ "preset": preset });
        let refined = |channel: Value| told(job(&net, &json!({ "channels": { "heat": channel } }), &plan, 2));
        let (vertices, corners) = (refined(json!(heat)), refined(of_corners(&net, &json!(heat))));
        let heat = |result: &Value| result["channels"]["heat"].clone();
        assert_eq!(heat(&corners)["values"], heat(&vertices), "{preset}");
        assert_eq!(heat(&corners)["faces"], corners["faces"], "{preset}");
    }
}

#[test]
#[expect(clippy::float_cmp, reason = "means of equal numbers are exact")]
fn each_seam_is_refined_for_itself_and_parts_vertices_where_files_need_it() {
    let net = nets::cube();
    // texture coordinates without seams, colours that differ from side to side, and a number with two regions
    let halves: Vec<Vec<usize>> = net.faces.iter().enumerate().map(|(f, face)| vec![f / 3; face.len()]).collect();
    let carried = json!({
        "uvs": { "values": net.positions.iter().map(|p| [p[0], p[1]]).collect::<Vec<_>>(), "faces": net.faces },
        "channels": { "color": by_face(&net, 3), "half": { "values": [-1, 1], "faces": halves } },
    });
    let job = job(&net, &carried, &json!({ "preset": "catmull-clark" }), 1);
    let result = told(job.clone());
    let count = |value: &Value| value.as_array().map_or(0, Vec::len);
    assert_eq!(count(&result["positions"]), 26);
    assert_eq!(count(&result["uvs"]["values"]), 26);
    assert_eq!(count(&result["channels"]["color"]["values"]), 6 * 9);
    let half = &result["channels"]["half"];
    assert!((27..54).contains(&count(&half["values"])), "{half}");
    // every quad has the number of its region
    for (face, origin) in half["faces"].as_array().into_iter().flatten().zip(super::indices(&result["ids"]["faces"])) {
        for place in super::indices(face) {
            assert_eq!(half["values"][place].as_f64(), Some(if origin < 3 { -1.0 } else { 1.0 }));
        }
    }
    let ply = text(&job, &json!({ "format": "ply", "ascii": true }));
    assert!(ply.contains("element vertex 54\n"), "{ply}");
    // each vertex of a side has its colour: red is the number of the side, from 0 on, clamped to 0 to 1
    let rows: Vec<Vec<f64>> = ply
        .lines()
        .skip_while(|line| *line != "end_header")
        .skip(1)
        .take(54)
        .map(|line| line.split(' ').map(|x| x.parse().expect("a number")).collect())
        .collect();
    assert_eq!(rows.iter().filter(|row| row[3] == 0.0).count(), 9);
    assert!(rows.iter().all(|row| row[6].abs() == 1.0));
}

#[test]
fn obj_says_that_it_leaves_colours_with_seams_out() {
    let net = nets::cube();
    let mut job = job(&net, &json!({ "channels": { "color": by_face(&net, 3) } }), &json!({ "preset": "loop" }), 0);
    job["plan"] = json!({ "preset": "catmull-clark" });
    job["outputs"] = json!([{ "format": "obj" }]);
    let (bytes, report) = crate::support::render(&job).expect("it is written");
    assert_eq!(report.warnings.len(), 1);
    assert!(
        report.warnings[0].starts_with("the channel \"color\", which differs on the sides of seams, is left out"),
        "{:?}",
        report.warnings
    );
    let text = String::from_utf8(bytes).expect("text");
    assert!(text.lines().filter(|line| line.starts_with("v ")).all(|line| line.split(' ').count() == 4), "{text}");
}

#[test]
fn pictures_show_seams_as_sharp_as_they_are() {
    let net = nets::cube();
    let palette = json!([[1, 0, 0], [0, 1, 0], [0, 0, 1], [1, 1, 0], [0, 1, 1], [1, 0, 1]]);
    let mut colors = by_face(&net, 3);
    colors["values"] = palette;
    let job = job(&net, &json!({ "channels": { "color": colors } }), &json!({ "preset": "catmull-clark" }), 3);
    let options = json!({ "format": "png", "width": 96, "height": 96, "color_by": "channel", "shading": "flat" });
    let png = written(&job, &options);
    let picture = image::load_from_memory_with_format(&png, image::ImageFormat::Png).expect("a picture").to_rgba8();
    // light adds grey and does not change the hue: without the grey, each component of a side is zero or full
    let light = |x: u8| pow(f64::from(x) / 255.0, 2.2);
    let is_mixed = |p: &&image::Rgba<u8>| {
        let mut rest = [0, 1, 2].map(|k| light(p.0[k]));
        rest.sort_by(f64::total_cmp);
        let share = (rest[1] - rest[0]) / (rest[2] - rest[0]).max(1e-9);
        (0.2..0.8).contains(&share)
    };
    let shown: Vec<_> = picture.pixels().filter(|p| p.0[3] == 255 && p.0[..3] != [255; 3]).collect();
    let mixed = shown.iter().copied().filter(is_mixed).count();
    assert!(shown.len() > 1000 && mixed * 10 < shown.len(), "{mixed} of {}", shown.len());
}

#[test]
fn forms_that_do_not_fit_are_refused_where_they_stand() {
    let net = nets::cube();
    let refused = |channel: &Value| {
        refusal(&job(&net, &json!({ "channels": { "a": channel } }), &json!({ "preset": "catmull-clark" }), 1))
    };
    let mut short = by_face(&net, 1);
    short["faces"].as_array_mut().expect("faces").pop();
    let mut beyond = by_face(&net, 1);
    beyond["faces"][2][1] = json!(6);
    let mut uneven = by_face(&net, 2);
    uneven["values"][3] = json!([1]);
    for (channel, pointer, sentence) in [
        (&json!({ "values": [1, 2] }), "/faces", "\"faces\" is missing"),
        (&json!({ "faces": net.faces }), "/values", "\"values\" is missing"),
        (&json!([1, { "values": [2], "faces": [] }]), "/1", "a number or a list of 1 to 4 numbers"),
        (&short, "/faces", "5 faces; give one for each of the 6 of the mesh"),
        (&beyond, "/faces/2/1", "there is no value 6; there are 6, counted from 0"),
        (&uneven, "/values", "an entry of 1 numbers after entries of 2"),
    ] {
        let found = refused(channel);
        let is_there = |(place, detail): &(String, String)| {
            place.starts_with(&format!("/input/mesh/channels/a{pointer}")) && detail.contains(sentence)
        };
        assert!(found.iter().any(is_there), "{found:?}, not {sentence} at {pointer}");
    }
    let carried = json!({ "channels": { "a": by_face(&net, 1) } });
    let found = refusal(&job(&net, &carried, &json!({ "preset": "doo-sabin" }), 1));
    assert!(found[0].1.contains("channels of corners"), "{found:?}");
}

#[test]
fn a_channel_of_corners_comes_back_from_json_as_it_was() {
    let net = nets::cube();
    let channel = by_face(&net, 4);
    let job = json!({ "input": { "mesh": {
        "positions": net.positions, "faces": net.faces, "channels": { "a": channel } } } });
    let result = crate::support::json(job);
    let again = crate::support::json(json!({ "input": { "mesh": {
        "positions": result["positions"], "faces": result["faces"], "channels": result["channels"] } } }));
    assert_eq!(again, result);
    let colors = |result: &Value| {
        let of_face = |face: &Value| -> Vec<Value> {
            let places = super::indices(face);
            places.into_iter().map(|place| result["channels"]["a"]["values"][place].clone()).collect()
        };
        result["channels"]["a"]["faces"].as_array().into_iter().flatten().map(of_face).collect::<Vec<_>>()
    };
    let expected: Vec<Vec<Value>> = (0..6).map(|f| vec![json!([f, 1, 2, 3]); 4]).collect();
    let floats =
        |rows: Vec<Vec<Value>>| rows.iter().flatten().map(|row| row.to_string().replace(".0", "")).collect::<Vec<_>>();
    assert_eq!(floats(colors(&result)), floats(expected));
}
