//! Pictures of inspected surfaces.

use planish::math::functions::{cos, pow, sin, sqrt};
use serde_json::{Value, json};

use super::{TURN, picture, sheet, torus};
use crate::support::nets::{self, Net};
use crate::support::render;

/// Returns the hue of a colour in linear light, independent of its brightness.
fn tone([r, g, b]: [u8; 3]) -> [f64; 3] {
    let linear = |c: f64| if c <= 0.04045 { c / 12.92 } else { pow((c + 0.055) / 1.055, 2.4) };
    let light = [r, g, b].map(|byte| linear(f64::from(byte) / 255.0));
    let sum: f64 = light.iter().sum();
    light.map(|x| x / sum)
}

fn rgb([r, g, b, _]: [u8; 4]) -> [u8; 3] {
    [r, g, b]
}

/// A shading with the curvature of a torus that it shows, as a function of the cosine of the angle on the tube.
type ClosedForm = (&'static str, fn(f64) -> f64);

#[test]
fn the_colours_of_a_torus_are_those_of_its_curvature() {
    // from above, with the y axis through the middle of the picture: 0.88 of its height are 6 units
    let above = json!({ "projection": "orthographic", "azimuth_deg": 0, "elevation_deg": 90 });
    let closed_forms: [ClosedForm; 2] =
        [("gaussian-curvature", |c| c / (2.0 + c)), ("mean-curvature", |c| (1.0 + c) / (2.0 + c))];
    for (shading, curvature) in closed_forms {
        let options = json!({ "shading": shading, "camera": above, "color_map": "viridis", "range": [-1, 1],
            "color_bar": false, "crease_angle": 180 });
        let (width, pixels) = picture(&torus(128, 96).input(), &options);
        let scale = 6.0 / (0.88 * 120.0);
        let mut seen = 0;
        for (i, pixel) in pixels.iter().enumerate() {
            let [x, y] = [i % width, i / width].map(|k| f64::from(u32::try_from(k).expect("small")) + 0.5);
            let cosine = sqrt((x - 80.0) * (x - 80.0) + (y - 60.0) * (y - 60.0)) * scale - 2.0;
            // near the silhouettes, a pixel covers much of the torus
            if cosine.abs() < 0.9 {
                let expected = colorous::VIRIDIS.eval_continuous(0.5 + 0.5 * curvature(cosine));
                let (found, expected) = (tone(rgb(*pixel)), tone([expected.r, expected.g, expected.b]));
                let off = found.iter().zip(expected).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
                assert!(off < 0.04, "{shading} at {cosine}: {found:?} is not {expected:?}");
                seen += 1;
            }
        }
        assert!(seen > 4000, "{seen}");
    }
}

const SHADINGS: [&str; 8] =
    ["matcap", "normals", "gaussian-curvature", "mean-curvature", "zebra", "reflection-lines", "isophotes", "distance"];

#[test]
fn a_plane_looks_alike_all_over_under_every_inspection() {
    let planes = [sheet(6, |x, y| 0.25 * x - 0.5 * y).input(), sheet(6, |_, _| 0.0).input()];
    for (plane, shading) in planes.iter().flat_map(|plane| SHADINGS.map(|shading| (plane, shading))) {
        let (width, pixels) = picture(plane, &json!({ "shading": shading }));
        let middle = pixels[60 * width + 80];
        for (x, y) in (70..91).flat_map(|x| (50..71).map(move |y| (x, y))) {
            assert_eq!(pixels[y * width + x], middle, "{shading}");
        }
    }
    let plane = &planes[0];
    // flat is neither red nor blue
    let (width, pixels) = picture(plane, &json!({ "shading": "mean-curvature" }));
    let [r, g, b, _] = pixels[60 * width + 80];
    assert!(r.abs_diff(g) < 8 && b.abs_diff(g) < 8, "{r} {g} {b}");
}

#[test]
fn the_colour_of_a_normal_is_the_normal() {
    let (width, pixels) = picture(&sheet(2, |_, _| 0.0).input(), &json!({ "shading": "normals" }));
    assert_eq!(rgb(pixels[60 * width + 80]), [128, 128, 255]);
    // normalised, the normal is (-3, 0, 4) / 5
    let (width, pixels) = picture(&sheet(2, |x, _| 0.75 * x).input(), &json!({ "shading": "normals" }));
    assert_eq!(rgb(pixels[60 * width + 80]), [51, 128, 230]);
}

/// Returns half a cylinder about the y axis, seen from +z: its outside, smooth.
fn cylinder() -> Net {
    let net = sheet(64, |_, _| 0.0);
    let bent = |[x, y, _]: [f64; 3]| [sin(0.25 * TURN * x), 0.75 * y, cos(0.25 * TURN * x)];
    Net { positions: net.positions.into_iter().map(bent).collect(), faces: net.faces }
}

/// Counts the changes between dark and light in a row through the middle of a picture, over x from -0.7 to 0.7.
fn changes(options: &Value) -> usize {
    let mut options = options.clone();
    (options["width"], options["height"]) = (640.into(), 480.into());
    let (width, pixels) = picture(&cylinder().input(), &options);
    let row = &pixels[240 * width..241 * width];
    // the cylinder is 2 wide, and its height of 1.5 takes 0.88 of 480 pixels
    let reach = 0.7 * 0.88 * 480.0 / 1.5;
    let place = |x: usize| f64::from(u32::try_from(x).expect("small")) + 0.5 - 320.0;
    let inside = row.iter().enumerate().filter(|(x, _)| place(*x).abs() < reach);
    let dark: Vec<bool> = inside.map(|(_, pixel)| pixel[1] < 200).collect();
    assert!(dark.len() > 380, "{}", dark.len());
    dark.windows(2).filter(|pair| pair[0] != pair[1]).count()
}

#[test]
fn stripes_count_what_the_mirrored_direction_passes() {
    // normals at x are (x, 0, sqrt(1 - x^2)): the reflected line of sight has the component 2 x sqrt(1 - x^2) along x,
    // which grows from -1 to 1 over this range
    for stripes in [3, 5] {
        let across = json!({ "shading": "zebra", "stripes": stripes, "stripe_direction": [1, 0, 0] });
        assert_eq!(changes(&across), 2 * stripes);
    }
    // along the axis nothing changes
    for shading in ["zebra", "isophotes"] {
        assert_eq!(changes(&json!({ "shading": shading, "stripe_direction": [0, 7, 0] })), 0, "{shading}");
    }
    // n . a is x: with steps of a quarter, five lines, 0.5 and 0 among them, are between -0.7 and 0.7
    assert_eq!(changes(&json!({ "shading": "isophotes", "stripes": 4, "stripe_direction": [2, 0, 0] })), 2 * 5);
    // the angle about the axis grows from -88.9 to 88.9 degrees: of lines at steps of 30 degrees, each 6 wide, five are
    // inside, and half of one at each end
    let lines = json!({ "shading": "reflection-lines", "stripes": 6, "stripe_direction": [0, 1, 0] });
    assert_eq!(changes(&lines), 2 * 5 + 2);
}

#[test]
fn a_hidden_line_drawing_has_paper_and_ink_only() {
    let brick: Vec<[u32; 3]> = (0..8).map(|i| [i & 1, i >> 1 & 1, i >> 2]).collect();
    let mesh = json!({ "mesh": { "positions": brick, "faces": nets::cube().faces } });
    let camera = json!({ "projection": "orthographic", "azimuth_deg": 30, "elevation_deg": 30 });
    let options = json!({ "shading": "hidden-line", "camera": camera, "background": "#ffeedd", "width": 640,
        "height": 480 });
    let (width, pixels) = picture(&mesh, &options);
    let paper = pixels.iter().filter(|pixel| rgb(**pixel) == [255, 238, 221]).count();
    let ink = pixels.iter().filter(|pixel| pixel[0] < 60).count();
    assert!(paper > 280_000 && ink > 2000, "{paper} {ink}");
    // nine edges are visible, so that a row through the middle meets the outline twice and one edge between
    let row = &pixels[264 * width..265 * width];
    let dark: Vec<bool> = row.iter().map(|pixel| pixel[0] < 150).collect();
    assert_eq!(dark.windows(2).filter(|pair| pair[0] != pair[1]).count(), 6);
}

#[test]
fn distances_are_those_from_the_control_net() {
    let net = nets::cube();
    let far = |range: [f64; 2]| {
        let job = json!({ "input": net.input(), "plan": { "preset": "catmull-clark" }, "levels": 3, "outputs": [
            { "format": "png", "width": 64, "height": 48, "shading": "distance", "range": range,
                "color_map": "greys" }] });
        render(&job).expect("a picture").0
    };
    // the farthest point of a Catmull-Clark cube is less than half a side away from it: beyond that range, only the
    // brightness changes
    assert_ne!(far([0.0, 0.5]), far([0.0, 1.0]));
    // a net has distance 0 from itself
    let options = json!({ "shading": "distance", "color_map": "greys", "range": [0, 1] });
    let (width, pixels) = picture(&sheet(4, |_, _| 0.0).input(), &options);
    let [r, g, b, _] = pixels[60 * width + 80];
    assert!(r > 200 && r.abs_diff(g) < 8 && b.abs_diff(g) < 8, "{r} {g} {b}");
}

#[test]
fn a_legend_shows_the_colours_of_the_range_from_below_to_above() {
    let options = json!({ "shading": "mean-curvature", "width": 400, "height": 300, "color_map": "viridis" });
    let (width, pixels) = picture(&torus(24, 16).input(), &options);
    let of = |share: f64| {
        let color = colorous::VIRIDIS.eval_continuous(share);
        [color.r, color.g, color.b]
    };
    let rows = |color: [u8; 3]| {
        let is_near = |pixel: &&[u8; 4]| pixel.iter().zip(color).all(|(a, b)| a.abs_diff(b) < 8);
        let here = |y: &usize| pixels[y * width + 320..(y + 1) * width].iter().filter(is_near).count() > 4;
        (0..300).filter(here).collect::<Vec<_>>()
    };
    let (high, low) = (rows(of(1.0)), rows(of(0.0)));
    assert!(!high.is_empty() && !low.is_empty() && high[high.len() - 1] < low[0], "{high:?} {low:?}");
    let without = picture(
        &torus(24, 16).input(),
        &json!({ "shading": "mean-curvature", "width": 400, "height": 300,
        "color_map": "viridis", "color_bar": false }),
    );
    assert_ne!(without.1, pixels);
}

#[test]
fn inspected_pictures_are_the_same_bytes_for_any_number_of_threads() {
    for shading in ["matcap", "hidden-line", "gaussian-curvature", "zebra", "reflection-lines", "isophotes", "distance"]
    {
        let draw = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
            pool.install(|| {
                let job = json!({ "input": nets::cube().input(), "plan": { "preset": "catmull-clark" }, "levels": 5,
                    "outputs": [{ "format": "png", "width": 96, "height": 64, "shading": shading }] });
                render(&job).expect("a picture").0
            })
        };
        let one = draw(1);
        assert!(draw(2) == one && draw(8) == one, "{shading}");
    }
}
