//! Pictures of transparent materials, and of metal.

use planish::math::functions::pow;
use serde_json::{Value, json};

use super::looks::{front, uri};
use super::{bytes, job};
use crate::support::nets::{Net, cube};
use crate::support::render;

/// Returns squares one behind the other, the first nearest, all seen from the front; `flipped` ones show their inside.
fn sheets(flipped: &[bool]) -> Net {
    let corners = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
    let depth = |i: usize| -0.25 * f64::from(u8::try_from(i).expect("few"));
    let positions = (0..flipped.len()).flat_map(|i| corners.map(|[x, y]| [x, y, depth(i)])).collect();
    let face = |(i, &flipped): (usize, &bool)| {
        let mut face: Vec<usize> = (4 * i..4 * i + 4).collect();
        if flipped {
            face.reverse();
        }
        face
    };
    Net { positions, faces: flipped.iter().enumerate().map(face).collect() }
}

fn sheet(i: usize, color: [f64; 4]) -> Value {
    json!({ "name": format!("m{i}"), "faces": [i], "color": color })
}

/// Returns the pixel in the middle of a picture of such sheets.
fn middle(flipped: &[bool], materials: &[Value]) -> [u8; 3] {
    let job = job(&sheets(flipped), &json!({ "materials": materials }), &json!({ "word": "U" }), 0);
    front(&job, &json!({ "shading": "flat", "grounding": "none" })).get_pixel(32, 32).0
}

const RED: [f64; 3] = [0.9, 0.05, 0.05];
const BLUE: [f64; 3] = [0.05, 0.05, 0.9];
const GREEN: [f64; 3] = [0.05, 0.8, 0.05];

fn with([r, g, b]: [f64; 3], alpha: f64) -> [f64; 4] {
    [r, g, b, alpha]
}

#[test]
fn alpha_says_how_much_is_seen_of_what_lies_behind() {
    let at = |alpha: f64| middle(&[false, false], &[sheet(0, with(BLUE, alpha)), sheet(1, with(RED, 1.0))]);
    let (clear, half, opaque) = (at(0.0), at(0.5), at(1.0));
    assert!(clear[0] > 150 && clear[2] < 120, "red alone: {clear:?}");
    assert!(opaque[2] > 150 && opaque[0] < 120, "blue alone: {opaque:?}");
    // light is blended linearly, half of each
    let light = |x: u8| pow(f64::from(x) / 255.0, 2.2);
    for k in 0..3 {
        let expected = 0.5 * (light(clear[k]) + light(opaque[k]));
        assert!((light(half[k]) - expected).abs() < 0.03, "{k}: {clear:?} {half:?} {opaque:?}");
    }
    // a surface behind an opaque one is not visible
    let hidden = middle(&[false, false], &[sheet(0, with(RED, 1.0)), sheet(1, with(BLUE, 0.5))]);
    assert_eq!(hidden, middle(&[false, false], &[sheet(0, with(RED, 1.0)), sheet(1, with(BLUE, 1.0))]));
}

#[test]
fn a_glass_has_a_near_and_a_far_wall_whatever_the_order_of_its_faces() {
    // the near wall shows its outside, the far one its inside, and behind them is an opaque sheet
    let near = sheet(0, with(BLUE, 0.5));
    let far = sheet(1, with(GREEN, 0.5));
    let back = sheet(2, with(RED, 1.0));
    let flipped = [false, true, false];
    let all = middle(&flipped, &[near.clone(), far.clone(), back.clone()]);
    assert!(all.iter().all(|&x| x > 60), "all three are seen: {all:?}");
    let without_far = middle(&flipped, &[near, sheet(1, with(GREEN, 0.0)), back]);
    assert!(all[1] > without_far[1] + 20, "{all:?} {without_far:?}");
    // the same faces in reverse order give the same picture
    let net = sheets(&flipped);
    let carried = |order: [usize; 3]| {
        let colors = [with(BLUE, 0.5), with(GREEN, 0.5), with(RED, 1.0)];
        let faces: Vec<_> = order.iter().map(|&i| net.faces[i].clone()).collect();
        let materials: Vec<Value> = order.iter().enumerate().map(|(f, &i)| sheet(f, colors[i])).collect();
        let net = Net { positions: net.positions.clone(), faces };
        let mut job = job(&net, &json!({ "materials": materials }), &json!({ "word": "U" }), 0);
        job["outputs"] = json!([{ "format": "png", "width": 48, "height": 48 }]);
        bytes(&job)
    };
    assert!(carried([0, 1, 2]) == carried([2, 0, 1]));
}

#[test]
fn masked_faces_are_there_or_not() {
    let masked = |alpha: f64, cutoff: f64| {
        let mut front = sheet(0, with(BLUE, alpha));
        front["alpha_mode"] = json!("mask");
        front["alpha_cutoff"] = json!(cutoff);
        middle(&[false, false], &[front, sheet(1, with(RED, 1.0))])
    };
    let alone = |color| middle(&[false, false], &[sheet(0, with(color, 1.0)), sheet(1, with(RED, 1.0))]);
    assert_eq!(masked(0.5, 0.5), alone(BLUE));
    assert_eq!(masked(0.4, 0.5), alone(RED));
    let mut opaque = sheet(0, with(BLUE, 0.1));
    opaque["alpha_mode"] = json!("opaque");
    assert_eq!(middle(&[false, false], &[opaque, sheet(1, with(RED, 1.0))]), alone(BLUE));
}

#[test]
fn metal_mirrors_in_its_own_colour() {
    let at = |metallic: f64| {
        let mut gold = sheet(0, [0.9, 0.7, 0.2, 1.0]);
        gold["metallic"] = json!(metallic);
        middle(&[false], &[gold])
    };
    assert_eq!(at(0.0), middle(&[false], &[sheet(0, [0.9, 0.7, 0.2, 1.0])]));
    let (metal, between, plain) = (at(1.0), at(0.5), at(0.0));
    assert_ne!(metal, plain);
    assert!(metal[0] > metal[1] && metal[1] > metal[2], "{metal:?}");
    let is_between = |k: usize| metal[k].min(plain[k]) <= between[k] && between[k] <= metal[k].max(plain[k]);
    assert!((0..3).all(is_between), "{metal:?} {between:?} {plain:?}");
}

#[test]
fn rough_surfaces_have_wide_and_faint_highlights() {
    // for a ball of one colour: the brightness of its brightest pixel, and the number of nearly as bright ones
    let seen = |roughness: Option<f64>, metallic: f64| {
        let mut ball = json!({ "name": "ball", "faces": [0, 1, 2, 3, 4, 5], "color": [0.5, 0.1, 0.1, 1.0] });
        ball["metallic"] = json!(metallic);
        if let Some(roughness) = roughness {
            ball["roughness"] = json!(roughness);
        }
        let job = job(&cube(), &json!({ "materials": [ball] }), &json!({ "preset": "catmull-clark" }), 4);
        let picture = front(&job, &json!({ "grounding": "none" }));
        let inside = (20..44).flat_map(|y| (20..44).map(move |x| (x, y)));
        let green: Vec<u8> = inside.map(|(x, y)| picture.get_pixel(x, y).0[1]).collect();
        (u32::from(*green.iter().max().expect("some pixels")), green)
    };
    let [polished, plain, chalk] = [Some(0.3), None, Some(1.0)].map(|roughness| seen(roughness, 0.0).0);
    assert!(polished > plain && plain > chalk + 10, "{polished} {plain} {chalk}");
    assert_ne!(seen(Some(1.0), 1.0).1, seen(Some(0.1), 1.0).1, "metal differs, too");
}

/// Returns the pixels in the left and the right half of a blue sheet, textured with two pixels of these alphas, in
/// front of a red sheet.
fn pictured(alphas: [u8; 2], material: &Value) -> [[u8; 3]; 2] {
    let mut file = std::io::Cursor::new(Vec::new());
    let pixels = alphas.iter().flat_map(|&alpha| [255, 255, 255, alpha]).collect();
    let picture = image::RgbaImage::from_raw(2, 1, pixels).expect("two pixels");
    picture.write_to(&mut file, image::ImageFormat::Png).expect("a PNG");
    let mut pictured = sheet(0, with(BLUE, 1.0));
    pictured["texture"] = json!({ "image": uri("png", &file.into_inner()), "mag_filter": "nearest" });
    for (name, value) in material.as_object().expect("fields") {
        pictured[name] = value.clone();
    }
    let uvs = json!({ "values": [[0, 0], [1, 0], [1, 1], [0, 1]], "faces": [[0, 1, 2, 3], [0, 1, 2, 3]] });
    let carried = json!({ "materials": [pictured, sheet(1, with(RED, 1.0))], "uvs": uvs });
    let mut job = job(&sheets(&[false, false]), &carried, &json!({ "word": "U" }), 0);
    job["outputs"] = json!([{ "format": "png", "width": 16, "height": 16 }]);
    let (_, report) = render(&job).expect("it is drawn");
    assert!(report.warnings.is_empty(), "nothing is left out: {:?}", report.warnings);
    let picture = front(&job, &json!({ "shading": "flat", "grounding": "none" }));
    [24, 40].map(|x| picture.get_pixel(x, 32).0)
}

#[test]
fn the_alpha_of_a_texture_cuts_holes() {
    let [blue, red] = [BLUE, RED].map(|color| middle(&[false], &[sheet(0, with(color, 1.0))]));
    let masked = |cutoff: f64| json!({ "alpha_mode": "mask", "alpha_cutoff": cutoff });
    assert_eq!(pictured([0, 255], &masked(0.5)), [red, blue]);
    assert_eq!(pictured([100, 200], &masked(0.5)), [red, blue]);
    assert_eq!(pictured([100, 200], &masked(0.3)), [blue, blue]);
    assert_eq!(pictured([100, 200], &masked(0.9)), [red, red]);
    // the alpha of the colour is a factor
    let mut faint = masked(0.5);
    faint["color"] = json!([0.05, 0.05, 0.9, 0.5]);
    assert_eq!(pictured([200, 255], &faint), [red, blue]);
    assert_eq!(pictured([0, 255], &json!({ "alpha_mode": "opaque" })), [blue, blue]);
}

#[test]
fn the_alpha_of_a_texture_blends() {
    let blend = json!({ "alpha_mode": "blend" });
    let [red, blue] = pictured([0, 255], &blend);
    assert_eq!([red, blue], [RED, BLUE].map(|color| middle(&[false], &[sheet(0, with(color, 1.0))])));
    let light = |x: u8| pow(f64::from(x) / 255.0, 2.2);
    let [half, all] = pictured([128, 255], &blend);
    assert_eq!(all, blue);
    for k in 0..3 {
        let expected = 0.5 * (light(red[k]) + light(blue[k]));
        assert!((light(half[k]) - expected).abs() < 0.03, "{k}: {half:?} of {red:?} and {blue:?}");
    }
}
