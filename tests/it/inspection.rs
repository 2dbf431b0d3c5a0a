//! Inspection of surfaces: curvature against closed forms, and pictures whose colours and lines follow laws.

mod curvature;
mod legends;
mod others;
mod pictures;
mod refused;

use planish::math::functions::{cos, real, sin};
use serde_json::{Value, json};

use crate::support::nets::Net;
use crate::support::render;

const TURN: f64 = 2.0 * std::f64::consts::PI;

/// Returns a torus about the y axis, with radii 2 and 1, `n` points around the axis and `m` around the tube.
fn torus(n: usize, m: usize) -> Net {
    let angle = |i: usize, n: usize| TURN * real(i) / real(n);
    let point = |(j, i): (usize, usize)| {
        let (around, tube) = (angle(i, n), angle(j, m));
        let radius = 2.0 + cos(tube);
        [radius * cos(around), sin(tube), -radius * sin(around)]
    };
    let places = || (0..m).flat_map(|j| (0..n).map(move |i| (j, i)));
    let at = |j: usize, i: usize| (j % m) * n + i % n;
    let face = |(j, i): (usize, usize)| vec![at(j, i), at(j, i + 1), at(j + 1, i + 1), at(j + 1, i)];
    Net { positions: places().map(point).collect(), faces: places().map(face).collect() }
}

/// Returns a sheet of `n x n` quads over the square from -1 to 1, with the heights of a function.
fn sheet(n: usize, height: impl Fn(f64, f64) -> f64) -> Net {
    let at = |i: usize| 2.0 * real(i) / real(n) - 1.0;
    let places = (0..=n).flat_map(|j| (0..=n).map(move |i| (i, j)));
    let positions = places.map(|(i, j)| [at(i), at(j), height(at(i), at(j))]).collect();
    let first = (0..n).flat_map(|j| (0..n).map(move |i| j * (n + 1) + i));
    Net { positions, faces: first.map(|a| vec![a, a + 1, a + n + 2, a + n + 1]).collect() }
}

/// Returns a sphere about the origin: a cube of `6 n^2` quads, with each point moved to the distance `radius`.
fn sphere(n: usize, radius: f64) -> Net {
    let side = sheet(n, |_, _| 1.0);
    let mut net = Net::default();
    for turn in 0..6 {
        let first = net.positions.len();
        for &[x, y, z] in &side.positions {
            // equal steps of angles instead of lengths make faces of about one size
            let [x, y] = [x, y].map(|t| planish::math::functions::tan(TURN / 8.0 * t));
            let p = match turn {
                0 => [x, y, z],
                1 => [y, x, -z],
                2 => [z, x, y],
                3 => [-z, y, x],
                4 => [y, z, x],
                _ => [x, -z, y],
            };
            let length = planish::math::functions::sqrt(p.iter().map(|x| x * x).sum());
            net.positions.push(p.map(|x| x * (radius / length)));
        }
        net.faces.extend(side.faces.iter().map(|face| face.iter().map(|v| first + v).collect::<Vec<_>>()));
    }
    net
}

fn stats(job: Value) -> Value {
    let mut job = job;
    job["outputs"] = json!([{ "format": "stats", "curvature": true }]);
    let (bytes, _) = render(&job).unwrap_or_else(|faults| panic!("{faults:?}"));
    serde_json::from_slice(&bytes).expect("stats are JSON")
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("{value} is no number"))
}

/// Returns the picture of a mesh as it is, from the front unless the options differ: its width, and its pixels row by
/// row.
fn picture(input: &Value, options: &Value) -> (usize, Vec<[u8; 4]>) {
    let mut output = json!({ "format": "png", "width": 160, "height": 120,
        "camera": { "projection": "orthographic", "azimuth_deg": 0, "elevation_deg": 0 } });
    for (name, value) in options.as_object().expect("options") {
        output[name] = value.clone();
    }
    let job = json!({ "input": input, "outputs": [output] });
    let (bytes, _) = render(&job).unwrap_or_else(|faults| panic!("{faults:?} for {options}"));
    let picture = image::load_from_memory_with_format(&bytes, image::ImageFormat::Png).expect("it is a picture");
    let width = usize::try_from(picture.width()).expect("small");
    (width, picture.to_rgba8().pixels().map(|pixel| pixel.0).collect())
}
