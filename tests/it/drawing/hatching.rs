//! Hatching: the density of its strokes, and their ends.

use planish::math::functions::sqrt;
use serde_json::{Value, json};

use super::hidden_lines::{distance, drawn, lines};
use crate::support::nets::Net;

/// The distance of the densest lines in a picture of 768 pixels, and the light below which the first, second and third
/// kind of lines are drawn.
const APART: f64 = 3.5;
const BELOW: [f64; 3] = [0.82, 0.60, 0.36];
/// The direction of the brightest lamp: to the right, up, and towards the viewer.
const LAMP: [f64; 3] = [-0.48, 0.62, 0.62];

/// Returns the cosine of the angle between a normal, in the same axes as the lamp, and the direction of the lamp.
fn light(normal: [f64; 3]) -> f64 {
    let dot = |a: [f64; 3], b: [f64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    dot(normal, LAMP) / sqrt(dot(normal, normal) * dot(LAMP, LAMP))
}

/// Returns the hatching lines of a net seen from the front; the height of the visible part takes 88 % of 768 pixels.
fn hatched(net: &Net) -> Vec<[[f64; 2]; 2]> {
    let camera = json!({ "projection": "orthographic", "azimuth_deg": 0, "elevation_deg": 0 });
    let svg = drawn(&net.input(), 0, &options(&camera));
    lines(&svg, "hatching").into_iter().map(|line| [line[0], line[1]]).collect()
}

fn options(camera: &Value) -> Value {
    json!({ "show": ["hatching"], "width": 1024, "height": 768, "camera": camera, "crease_angle": 180 })
}

fn length(strokes: &[[[f64; 2]; 2]]) -> f64 {
    strokes.iter().map(|[a, b]| distance(*a, *b)).sum()
}

/// Returns a square facing the viewer at a depth, whose upper end leans back by a slope.
fn square(half: f64, slope: f64, depth: f64) -> Net {
    let at = |[x, y]: [f64; 2]| [half * x, half * y, depth - slope * half * y];
    let corners = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];
    Net { positions: corners.map(at).to_vec(), faces: vec![vec![0, 1, 2, 3]] }
}

fn both(one: Net, other: Net) -> Net {
    let n = one.positions.len();
    let moved = other.faces.into_iter().map(|face| face.into_iter().map(|v| v + n).collect::<Vec<_>>());
    Net { positions: [one.positions, other.positions].concat(), faces: one.faces.into_iter().chain(moved).collect() }
}

#[test]
fn the_darker_a_plane_is_the_closer_are_its_strokes() {
    // lines at this distance cover the square with a total length of `side^2 / distance`
    let whole = 0.88 * 768.0 * 0.88 * 768.0 / APART;
    for (slope, share) in [(0.8, 0.0), (0.0, 0.25), (-0.3, 0.5), (-0.5, 1.0), (-0.9, 1.25), (-1.6, 1.5), (-4.0, 2.0)] {
        let net = square(1.0, slope, 0.0);
        let light = light([0.0, slope, 1.0]);
        let strokes = length(&hatched(&net));
        let found = strokes / whole;
        assert!((found - share).abs() < 0.02, "{found} in place of {share} where the light is {light}");
    }
}

#[test]
fn what_lies_in_front_takes_its_share_of_the_strokes_and_no_more() {
    let back = square(1.0, 0.0, 0.0);
    let whole = length(&hatched(&back));
    // as bright as the square that it hides: the same lines, cut at its sides and joined again
    let front = both(back.clone(), square(0.5, 0.0, 1.0));
    assert!((length(&hatched(&front)) / whole - 1.0).abs() < 0.01);
    // four times as dark on a quarter of the square
    let dark = both(back.clone(), square(0.5, -0.5, 2.0));
    assert!((length(&hatched(&dark)) / whole - 1.75).abs() < 0.02);
    // behind the square it changes nothing
    let behind = both(back, square(0.5, -0.5, -2.0));
    assert!((length(&hatched(&behind)) / whole - 1.0).abs() < 0.01);
}

/// Returns a sphere of radius 1, divided along circles through its poles.
fn sphere(n: u32) -> Net {
    use planish::math::functions::{cos, sin};
    let angle = |i: u32, n: u32| std::f64::consts::TAU * f64::from(i) / f64::from(n);
    let mut positions = Vec::new();
    for ring in 0..=n {
        for i in 0..2 * n {
            let (up, around) = (angle(ring, 2 * n), angle(i, 2 * n));
            positions.push([sin(up) * cos(around), cos(up), sin(up) * sin(around)]);
        }
    }
    let side = 2 * n as usize;
    let face = |(ring, i): (usize, usize)| {
        let next = (i + 1) % side;
        vec![ring * side + i, ring * side + next, (ring + 1) * side + next, (ring + 1) * side + i]
    };
    let places = (0..n as usize).flat_map(|ring| (0..side).map(move |i| (ring, i)));
    Net { positions, faces: places.map(face).collect() }
}

#[test]
fn strokes_on_a_sphere_lie_where_it_is_dark_and_nowhere_else() {
    let strokes = hatched(&sphere(48));
    let radius = 0.44 * 768.0;
    let mut most = -1.0_f64;
    for [a, b] in &strokes {
        for k in 0..=8 {
            let t = f64::from(k) / 8.0;
            let [x, y] = [0, 1].map(|k| a[k] + t * (b[k] - a[k]));
            let [x, y] = [(x - 512.0) / radius, (384.0 - y) / radius];
            let square = x * x + y * y;
            assert!(square < 1.01, "a stroke leaves the sphere at {x} {y}");
            most = most.max(light([x, y, sqrt((1.0 - square).max(0.0))]));
        }
    }
    assert!(most < BELOW[0] + 0.02 && most > BELOW[0] - 0.05, "{most}");
    // in areas darker than the threshold of the third kind, each line is present: at eleven points across them, one
    // line apart
    let across = |k: u32| {
        let middle = [512.0 + 0.55 * radius, 384.0 + 0.35 * radius];
        let off = APART * f64::from(k) / sqrt(2.0);
        [middle[0] + off, middle[1] + off]
    };
    let near = |place: [f64; 2]| {
        let is_near = |[a, b]: &&[[f64; 2]; 2]| {
            let (u, w) = ([b[0] - a[0], b[1] - a[1]], [place[0] - a[0], place[1] - a[1]]);
            let t = (u[0] * w[0] + u[1] * w[1]) / (u[0] * u[0] + u[1] * u[1]);
            (0.0..=1.0).contains(&t) && distance(place, [a[0] + t * u[0], a[1] + t * u[1]]) <= 0.5 * APART + 0.01
        };
        strokes.iter().any(|stroke| is_near(&stroke))
    };
    assert!((0..11).all(|k| near(across(k))));
}

#[test]
fn hatching_is_the_same_for_any_number_of_threads_and_lies_below_the_lines() {
    let draw = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
        let show = json!({ "show": ["hatching", "silhouettes", "creases"] });
        pool.install(|| drawn(&sphere(12).input(), 0, &show))
    };
    let one = draw(1);
    assert!(draw(2) == one && draw(8) == one);
    assert!(one.find("class=\"hatching\"") < one.find("class=\"silhouettes\""));
    let none = drawn(&sphere(12).input(), 0, &json!({ "show": ["silhouettes"] }));
    assert!(!none.contains("hatching"));
}
