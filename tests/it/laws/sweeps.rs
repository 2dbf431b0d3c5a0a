//! Latitude lines of tori around their main axis remain circles; those of sweeps and skins along a bent axis remain
//! plane ellipses.

use planish::analysis::circles::outlooks;
use planish::math::functions::{cos, sin, sqrt};
use serde_json::{Value, json};

use crate::support::nets::{Net, distance};
use crate::support::{json_with, parsed};

type Point = [f64; 3];

fn real(n: usize) -> f64 {
    f64::from(u32::try_from(n).expect("a small number"))
}

/// A ring of a sweep: its centre and two half axes.
type Ring = [Point; 3];

/// Returns the point at an angle of a ring: `c + a cos + b sin`.
fn at(&[c, a, b]: &Ring, angle: f64) -> Point {
    [0, 1, 2].map(|k| c[k] + a[k] * cos(angle) + b[k] * sin(angle))
}

/// Returns a tagged tube through rings of n points, open or closed along the axis.
fn tube(n: usize, rings: &[Ring], closed: bool) -> Value {
    let point = |ring: Ring| (0..n).map(move |i| at(&ring, std::f64::consts::TAU * real(i) / real(n)));
    let positions: Vec<Point> = rings.iter().flat_map(|&ring| point(ring)).collect();
    let number = |u: usize, i: usize| u % rings.len() * n + i % n;
    let all = |rows: usize| (0..rows).flat_map(move |u| (0..n).map(move |i| (u, i)));
    let rows = rings.len() - usize::from(!closed);
    let face = |(u, i): (usize, usize)| [number(u, i), number(u, i + 1), number(u + 1, i + 1), number(u + 1, i)];
    json!({
        "positions": positions,
        "faces": all(rows).map(face).collect::<Vec<_>>(),
        "latitude": all(rings.len()).map(|(u, i)| [number(u, i), number(u, i + 1)]).collect::<Vec<_>>(),
        "longitude": all(rows).map(|(u, i)| [number(u, i), number(u + 1, i)]).collect::<Vec<_>>(),
    })
}

fn push_back(delta: f64, k: u32, rule: &str) -> Value {
    json!({ "preset": "push-back", "boundary": "edge-only",
        "parameters": { "delta": delta, "k": k, "latitude_rule": rule } })
}

/// Returns the latitude lines after some levels, without the last line of an open tube: faces come row by row, the
/// first axis of each along the line.
fn lines(n: usize, mesh: &Value, plan: &Value, levels: u32, positions: &str) -> Vec<Vec<Point>> {
    let job = json!({ "input": { "mesh": mesh }, "plan": plan, "levels": levels });
    let net = Net::of(&json_with(job, &json!({ "positions": positions })));
    let side = 1 << levels;
    let tiles: Vec<&[Vec<usize>]> = net.faces.chunks(side * side).collect();
    let line = |row: &[&[Vec<usize>]], j: usize| -> Vec<Point> {
        let starts = row.iter().flat_map(|tile| &tile[j * side..(j + 1) * side]);
        starts.map(|face| net.positions[face[0]]).collect()
    };
    tiles.chunks(n).flat_map(|row| (0..side).map(|j| line(row, j)).collect::<Vec<_>>()).collect()
}

/// Returns the ring through the points of a line, and the largest deviation of a point from its place on the ring.
fn ring_of(line: &[Point]) -> (Ring, f64) {
    let n = real(line.len());
    let angle = |j: usize| std::f64::consts::TAU * real(j) / n;
    let mut ring = [[0.0; 3]; 3];
    for (j, p) in line.iter().enumerate() {
        let weights = [1.0 / n, 2.0 / n * cos(angle(j)), 2.0 / n * sin(angle(j))];
        ring = [0, 1, 2].map(|i| [0, 1, 2].map(|k| ring[i][k] + weights[i] * p[k]));
    }
    let off = line.iter().enumerate().map(|(j, p)| distance(p, &at(&ring, angle(j))));
    (ring, off.fold(0.0, f64::max))
}

fn dot(a: Point, b: Point) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// Returns rings of regular polygons across an axis that rises and turns by half a circle, with uneven spacing and
/// width.
fn bent() -> Vec<Ring> {
    let ring = |u: usize| {
        let t = 0.4 * real(u) + 0.05 * real(u % 3);
        let radius = 0.5 + 0.1 * real((3 * u) % 5);
        let centre = [3.0 * cos(t), 3.0 * sin(t), 0.3 * t * t];
        [centre, [radius * cos(t), radius * sin(t), 0.0], [0.0, 0.0, radius]]
    };
    (0..8).map(ring).collect()
}

/// Returns ellipses of various shapes and places, as the sections of a skin.
fn skin() -> Vec<Ring> {
    let vector =
        |u: usize, k: usize, size: f64| [0, 1, 2].map(|i| size * sin(1.7 * real(u * (k + 2)) + real(3 * i + k)));
    (0..7).map(|u| [[real(u), 0.2 * real(u * u), sin(real(u))], vector(u, 1, 1.2), vector(u, 2, 0.8)]).collect()
}

const DELTAS: [f64; 4] = [-0.1, 0.0, 0.5, 1.0];

#[test]
fn rings_of_bent_sweeps_and_skins_stay_plane_ellipses() {
    for (rings, name) in [(bent(), "bent"), (skin(), "skin")] {
        for n in [3, 5, 8] {
            let mesh = tube(n, &rings, false);
            for delta in DELTAS {
                for (k, rule) in [(1, "difference"), (1, "position"), (2, "difference"), (2, "position")] {
                    for line in lines(n, &mesh, &push_back(delta, k, rule), 2, "refined") {
                        let (_, off) = ring_of(&line);
                        assert!(off < 1e-12, "{name}, {n} points, delta {delta}, k {k}, {rule}: off by {off}");
                    }
                }
            }
        }
    }
}

/// Limits are plane ellipses, too; with delta 1 the rings themselves are among them.
#[test]
fn limits_of_bent_sweeps_are_plane_ellipses() {
    for (delta, interpolates) in [(0.5, false), (1.0, true)] {
        let (rings, n) = (bent(), 6);
        let found = lines(n, &tube(n, &rings, false), &push_back(delta, 1, "difference"), 1, "limit");
        for (j, line) in found.iter().enumerate() {
            let (ring, off) = ring_of(line);
            assert!(off < 1e-12, "delta {delta}: line {j} is off by {off}");
            if interpolates && j % 2 == 0 {
                let off = (0..3).map(|i| distance(&ring[i], &rings[j / 2][i])).fold(0.0, f64::max);
                assert!(off < 1e-12, "ring {} moves by {off}", j / 2);
            }
        }
    }
}

/// Without the tags, and with a kernel for circles, the rings of a bent sweep do not remain plane.
#[test]
fn without_the_rule_rings_of_bent_sweeps_are_not_plane() {
    let plan = json!({ "preset": "push-back", "boundary": "edge-only", "parameters": { "latitude_rule": "isotropic",
        "alpha": "2*pi/5", "kernel": "cos(alpha/2)", "compensation": "1/cos(alpha/2)", "delta": 1 } });
    let worst =
        lines(5, &tube(5, &bent(), false), &plan, 2, "refined").iter().map(|line| ring_of(line).1).fold(0.0, f64::max);
    assert!(worst > 1e-3, "{worst}");
}

/// Returns regular polygons around the main axis, placed unevenly along the small circle.
fn torus(sections: usize) -> Vec<Ring> {
    let ring = |u: usize| {
        let t = std::f64::consts::TAU * (real(u) + 0.2 * real(u % 2)) / real(sections);
        let radius = 2.0 + 0.75 * cos(t);
        [[0.0, 0.0, -0.75 * sin(t)], [radius, 0.0, 0.0], [0.0, radius, 0.0]]
    };
    (0..sections).map(ring).collect()
}

#[test]
fn latitude_lines_of_tori_are_circles_around_the_main_axis() {
    for (n, sections) in [(3, 4), (5, 6), (12, 5)] {
        let mesh = tube(n, &torus(sections), true);
        for delta in DELTAS {
            for (k, rule) in [(1, "difference"), (1, "position"), (2, "difference")] {
                let plan = push_back(delta, k, rule);
                let limit = (k == 1 && delta > 0.0).then_some((1, "limit"));
                for (levels, positions) in [(2, "refined")].into_iter().chain(limit) {
                    for line in lines(n, &mesh, &plan, levels, positions) {
                        let ([c, a, b], off) = ring_of(&line);
                        let radii = [a, b].map(|axis| sqrt(dot(axis, axis)));
                        let round =
                            [off, (radii[0] - radii[1]).abs(), dot(a, b).abs(), c[0].abs(), c[1].abs(), a[2].abs()];
                        let worst = round.into_iter().fold(0.0, f64::max);
                        assert!(
                            worst < 1e-12,
                            "{n} x {sections}, delta {delta}, k {k}, {rule}, {positions}: {round:?}"
                        );
                    }
                }
            }
        }
    }
}

/// The reports about lines: radii of tori in the limit, the deviating axis of adjacent rings for bent sweeps.
#[test]
fn lines_of_tori_are_told_exact_and_those_of_bent_sweeps_are_not() {
    let told = |mesh: &Value, plan: &Value| {
        let job = json!({ "input": { "mesh": mesh }, "plan": plan, "levels": 1, "outputs": [{ "format": "json" }] });
        let job = parsed(job.to_string().as_bytes()).unwrap_or_else(|faults| panic!("{faults:?}"));
        let planish::job::Input::Mesh(read) = &*job.input else { panic!("a mesh was given") };
        outlooks(read, Ok(&job.plan))
            .into_iter()
            .map(|line| line.circle.map(|circle| circle.radius))
            .collect::<Vec<_>>()
    };
    for delta in DELTAS {
        let (mesh, plan) = (tube(7, &torus(6), true), push_back(delta, 1, "difference"));
        let radii = told(&mesh, &plan);
        assert_eq!(radii.len(), 6);
        for (line, radius) in lines(7, &mesh, &plan, 0, "limit").iter().zip(radii) {
            let radius = radius.unwrap_or_else(|reason| panic!("delta {delta}: {reason}"));
            let [_, axis, _] = ring_of(line).0;
            assert!((sqrt(dot(axis, axis)) - radius).abs() < 1e-12, "delta {delta}: {radius}");
        }
    }
    let bent = told(&tube(6, &bent(), false), &push_back(1.0, 1, "difference"));
    let (ends, inside) = ([&bent[0], &bent[bent.len() - 1]], &bent[1..bent.len() - 1]);
    assert!(ends.iter().all(|line| line.is_ok()), "boundaries depend on themselves alone: {ends:?}");
    for line in inside {
        assert!(line.as_ref().is_err_and(|reason| reason.contains("another axis")), "{line:?}");
    }
}
