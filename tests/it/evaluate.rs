//! Laws of values of the limit surface: they agree with refinement, a known spline, and calculus.

use planish::analysis::limit::{LimitRequest, refine_mesh_to_limit};
use planish::math::functions::{cos, real, sin};
use planish::math::vector::{Vector, cross, dot, length, minus, plus, times};
use planish::scheme::tags::Boundary;
use planish::shape::source::{FaceChunk, MeshSource};
use planish::solid::SolidError;
use planish::solid::evaluate::{Closest, Jet, Place, closest, evaluate};
use planish::watch::Watch;

use crate::support::cages::{self, Cage, sheet};

impl Cage {
    fn at(&self, places: &[Place]) -> Vec<Jet> {
        evaluate(&self.mesh(), &self.plan(), places, &Watch::new()).expect("places of the mesh")
    }

    fn closest(&self, points: &[Vector]) -> Vec<Closest> {
        closest(&self.mesh(), &self.plan(), points, &Watch::new()).expect("it has a surface")
    }
}

/// Returns a cube without symmetries.
fn cube() -> Cage {
    let mut cage = cages::cube(1.0);
    for (i, [_, y, z]) in cage.points.iter_mut().enumerate() {
        (*y, *z) = (*y * 0.9, *z + 0.1 * real(i));
    }
    cage
}

fn prism(n: u32) -> Cage {
    let cage = cages::prism(n);
    Cage { points: cage.points.iter().map(|[x, y, z]| [0.2 * x, 0.1 * y, 0.1 * z]).collect(), ..cage }
}

fn bent(i: f64, j: f64) -> Vector {
    [i, j, sin(1.3 * i) * cos(0.9 * j)]
}

/// Returns cages of every kind that the surface supports.
fn cages() -> Vec<(&'static str, Cage)> {
    let creased = |creases: &[[u64; 2]], sharpness: f64| creases.iter().map(|&edge| (edge, sharpness)).collect();
    let ring = [[1, 3], [3, 7], [7, 5], [5, 1]];
    vec![
        ("cube", cube()),
        ("sheet", sheet(3, 2, bent)),
        ("sheet with round corners", Cage { boundary: Boundary::EdgeOnly, ..sheet(3, 2, bent) }),
        ("creased", Cage { creases: creased(&ring, 10.0), ..cube() }),
        ("semi-sharp", Cage { creases: creased(&ring, 1.5), ..cube() }),
        ("dart", Cage { creases: creased(&ring[..1], 10.0), ..cube() }),
        ("corners", Cage { corners: vec![(0, 10.0), (5, 0.5)], ..cube() }),
        ("three creases", Cage { creases: creased(&[[1, 3], [3, 7], [3, 2]], 10.0), ..cube() }),
        ("pentagons", prism(5)),
        ("triangles", prism(3)),
        ("holes", Cage { holes: vec![2], ..prism(6) }),
    ]
}

/// Returns the place of the first vertex of each output face after some levels, in the documented order of the faces.
fn dyadic(cage: &Cage, levels: u32) -> Vec<Place> {
    let grid = |face: u32, corner: u32, n: u32| {
        let at = move |i: u32| f64::from(i) / f64::from(n);
        (0..n).flat_map(move |j| (0..n).map(move |i| Place { face, corner, uv: [at(i), at(j)] }))
    };
    let of_face = |(face, corners): (u32, &Vec<u32>)| -> Vec<Place> {
        match corners.len() {
            4 => grid(face, 0, 1 << levels).collect(),
            n => (0..).take(n).flat_map(|corner| grid(face, corner, 1 << (levels - 1))).collect(),
        }
    };
    let shown = |face: &u32| !cage.holes.contains(&u64::from(*face));
    (0..).zip(&cage.faces).filter(|(face, _)| shown(face)).flat_map(of_face).collect()
}

#[test]
fn values_at_dyadic_places_are_the_limits_of_refined_vertices() {
    let levels = 4;
    for (name, cage) in cages() {
        let places = dyadic(&cage, levels);
        let asked = LimitRequest { positions: true, normals: true };
        let (refined, _) = refine_mesh_to_limit(&cage.mesh(), &cage.plan(), levels, asked, &Watch::new()).expect(name);
        let (mut points, mut faces) = (Vec::new(), FaceChunk::default());
        refined.positions(0..refined.n_vertices(), &mut points);
        refined.faces(0..refined.n_faces(), &mut faces);
        assert_eq!(faces.iter().count(), places.len(), "{name}");
        for ((face, place), found) in faces.iter().zip(&places).zip(cage.at(&places)) {
            let apart = length(minus(points[face[0] as usize], found.at));
            assert!(apart <= 2.0 * 1e-13, "{name}: {apart:e} at {place:?}");
        }
    }
}

#[test]
fn a_bicubic_spline_has_its_known_values() {
    // inside, the limit of a regular net of the points (i, j, i^2 - 3 i j + j^2) is z = x^2 - 3 x y + y^2 + 2/3
    let cage = sheet(4, 4, |i, j| [i, j, i * i - 3.0 * i * j + j * j]);
    for [u, v] in [[0.0, 0.0], [0.3, 0.7], [1.0, 0.25], [0.9, 1.0]] {
        let found = cage.at(&[Place { face: 5, corner: 0, uv: [u, v] }])[0];
        let [x, y] = [1.0 + u, 1.0 + v];
        let z = x * x - 3.0 * x * y + y * y + 2.0 / 3.0;
        assert!(length(minus(found.at, [x, y, z])) < 1e-13, "{found:?}");
        let [zx, zy] = [2.0 * x - 3.0 * y, 2.0 * y - 3.0 * x];
        let [du, dv] = found.first.expect("it is bicubic");
        assert!(length(minus(du, [1.0, 0.0, zx])) < 1e-13 && length(minus(dv, [0.0, 1.0, zy])) < 1e-13, "{found:?}");
        let second = found.second.expect("it is bicubic");
        for (second, expected) in second.into_iter().zip([2.0, -3.0, 2.0]) {
            assert!(length(minus(second, [0.0, 0.0, expected])) < 1e-12, "{found:?}");
        }
        // curvatures of a graph; the surface bends towards its normal if it is a bowl
        let w = 1.0 + zx * zx + zy * zy;
        let gaussian = (2.0 * 2.0 - 9.0) / (w * w);
        let mean = -((1.0 + zy * zy) * 2.0 + 2.0 * 3.0 * zx * zy + (1.0 + zx * zx) * 2.0) / (2.0 * w * w.sqrt());
        let [first, last] = found.principal.expect("it is smooth");
        assert!((first * last - gaussian).abs() < 1e-12 && (0.5 * (first + last) - mean).abs() < 1e-12, "{found:?}");
    }
}

#[test]
fn derivatives_are_those_of_differences() {
    let step = 1.0 / 4096.0;
    for (name, cage) in cages() {
        for face in 0..u32::try_from(cage.faces.len()).expect("few") {
            let near = |du: f64, dv: f64| Place { face, corner: 0, uv: [0.3 + du * step, 0.6 + dv * step] };
            let found = cage.at(&[near(0.0, 0.0), near(1.0, 0.0), near(-1.0, 0.0), near(0.0, 1.0), near(0.0, -1.0)]);
            let at = |i: usize| found[i].at;
            let difference = |a: usize, b: usize| times(0.5 / step, minus(at(a), at(b)));
            let second = |a: usize, b: usize| times(1.0 / (step * step), minus(plus(at(a), at(b)), times(2.0, at(0))));
            let ([du, dv], [duu, _, dvv]) = (found[0].first.expect(name), found[0].second.expect(name));
            let twist = {
                let [[_, above], [_, below]] = [found[1].first.expect(name), found[2].first.expect(name)];
                times(0.5 / step, minus(above, below))
            };
            let pairs = [
                (du, difference(1, 2), 1e-5),
                (dv, difference(3, 4), 1e-5),
                (duu, second(1, 2), 1e-2),
                (dvv, second(3, 4), 1e-2),
                (found[0].second.expect(name)[1], twist, 1e-2),
            ];
            for (exact, by_difference, most) in pairs {
                assert!(length(minus(exact, by_difference)) < most, "{name} face {face}: {exact:?} {by_difference:?}");
            }
            let normal = found[0].normal.expect(name);
            assert!(dot(normal, du).abs() + dot(normal, dv).abs() < 1e-12 && dot(cross(du, dv), normal) > 0.0);
        }
    }
}

#[test]
fn neighbours_agree_along_their_common_edge() {
    for (name, cage) in cages() {
        let mesh = cage.mesh();
        let topology = &mesh.topology;
        let edges = (0..topology.n_edges()).filter(|&e| !topology.is_boundary_edge(e));
        for [a, b] in edges.map(|e| topology.halves(e)) {
            for t in [0.0, 1e-9, 0.125, 0.3, 0.5] {
                let on = |half_edge: u32, t: f64| {
                    let face = topology.face_of(half_edge);
                    let range = topology.half_edges(face);
                    let side = half_edge - range.start;
                    let (corner, uv) = match (range.len(), side) {
                        (4, 0) => (0, [t, 0.0]),
                        (4, 1) => (0, [1.0, t]),
                        (4, 2) => (0, [1.0 - t, 1.0]),
                        (4, _) => (0, [0.0, 1.0 - t]),
                        (_, side) if t <= 0.5 => (side, [2.0 * t, 0.0]),
                        (n, side) => ((side + 1) % u32::try_from(n).expect("few"), [0.0, 2.0 * (1.0 - t)]),
                    };
                    Place { face: u32::try_from(face).expect("few"), corner, uv }
                };
                let [a, b] = [cage.at(&[on(a, t)])[0], cage.at(&[on(b, 1.0 - t)])[0]];
                assert!(length(minus(a.at, b.at)) < 2.0 * 1e-13, "{name}: {a:?} {b:?}");
                let is_sharp = matches!(name, "creased" | "dart" | "three creases" | "corners");
                if let (false, Some(a), Some(b)) = (is_sharp, a.normal, b.normal) {
                    assert!(length(minus(a, b)) < 1e-9, "{name} at {t}: {a:?} {b:?}");
                }
            }
        }
    }
}

#[test]
fn maps_of_space_move_values_along() {
    // x -> A x + b, with det A > 0
    let map = |p: Vector| [p[0] + 0.5 * p[1] + 3.0, 2.0 * p[1] - 0.25 * p[2], p[2] + 0.125 * p[0] - 7.0];
    let linear = |p: Vector| minus(map(p), map([0.0; 3]));
    for (name, cage) in cages() {
        let moved = Cage { points: cage.points.iter().map(|&p| map(p)).collect(), ..cage.clone() };
        let places: Vec<Place> =
            [[0.0, 0.0], [1e-6, 2e-6], [0.2, 0.9], [1.0, 1.0]].map(|uv| Place { face: 0, corner: 0, uv }).into();
        for (a, b) in cage.at(&places).into_iter().zip(moved.at(&places)) {
            assert!(length(minus(map(a.at), b.at)) < 2e-14 * 10.0, "{name}");
            assert_eq!(a.first.is_some(), b.first.is_some(), "{name}");
            for (a, b) in a.first.into_iter().flatten().zip(b.first.into_iter().flatten()) {
                assert!(length(minus(linear(a), b)) < 1e-8 * (1.0 + length(b)), "{name}: {a:?} {b:?}");
            }
        }
    }
}

#[test]
fn normals_at_vertices_are_the_limits_of_those_beside_them() {
    for (name, cage) in [("cube", cube()), ("prism", prism(5)), ("sheet", tee())] {
        let mut vertices = 0;
        for face in 0..u32::try_from(cage.faces.len()).expect("few") {
            let place = |t: f64| Place { face, corner: 0, uv: [t, t] };
            let found = cage.at(&[place(0.0), place(1e-13)]);
            let [Some(there), Some(beside)] = [found[0].normal, found[1].normal] else { continue };
            vertices += usize::from(found[0].first.is_none());
            let apart = length(minus(there, beside));
            assert!(apart < 2e-3, "{name} face {face}: {apart:e}");
        }
        assert!(vertices > 0, "{name}");
    }
}

/// Returns three quads around a boundary vertex that is corner 0 of each.
fn tee() -> Cage {
    let points = (0..7_u32).map(|i| {
        let (angle, far) = (f64::from(i) * std::f64::consts::PI / 6.0, 1.0 + 0.3 * f64::from(i % 2));
        [far * cos(angle), far * sin(angle), 0.2 * f64::from(i * i % 5)]
    });
    let points = std::iter::once([0.0; 3]).chain(points).collect();
    Cage { points, faces: vec![vec![0, 1, 2, 3], vec![0, 3, 4, 5], vec![0, 5, 6, 7]], ..Cage::default() }
}

#[test]
fn a_place_next_to_a_vertex_keeps_its_digits_far_from_the_origin() {
    let far = Cage { points: cube().points.into_iter().map(|p| plus(p, [1e3, 0.0, 0.0])).collect(), ..cube() };
    let place = [Place { face: 0, corner: 0, uv: [1e-12, 3e-12] }];
    let [near, far] = [cube(), far].map(|cage| cage.at(&place)[0]);
    let [a, b] = [near, far].map(|found| found.normal.expect("it is smooth"));
    // the cage itself has lost three digits
    assert!(length(minus(a, b)) < 1e-11, "{a:?} {b:?}");
}

/// Next to a vertex, heights above the tangent plane are far below the rounding of the tangential coordinates.
#[test]
fn curvatures_next_to_a_vertex_keep_their_digits_whichever_way_it_looks() {
    let tip = |n: u32| {
        let at = |k: u32| {
            let turn = std::f64::consts::PI * f64::from(k) / f64::from(n);
            [cos(turn), sin(turn), if k.is_multiple_of(2) { 0.4 } else { -0.3 }]
        };
        let between = |k: u32| 1 + k % (2 * n);
        Cage {
            points: std::iter::once([0.0, 0.0, 1.7]).chain((0..2 * n).map(at)).collect(),
            faces: (0..n).map(|i| vec![0, between(2 * i), between(2 * i + 1), between(2 * i + 2)]).collect(),
            ..Cage::default()
        }
    };
    let turned = |p: Vector| [[0.36, 0.48, -0.8], [-0.8, 0.6, 0.0], [0.48, 0.64, 0.6]].map(|row| dot(row, p) + 0.3);
    for cage in [3, 5, 8].map(tip) {
        let other = Cage { points: cage.points.iter().map(|&p| turned(p)).collect(), ..cage.clone() };
        for k in [10, 25, 40, 58] {
            let far = 1.0 / real(1 << k);
            let place = [Place { face: 0, corner: 0, uv: [0.75 * far, 0.625 * far] }];
            let [a, b] = [&cage, &other].map(|cage| cage.at(&place)[0].principal.expect("it is smooth"));
            let apart = (a[0] - b[0]).abs().max((a[1] - b[1]).abs());
            assert!(apart <= 1e-12 * a[0].abs().max(a[1].abs()), "2^-{k}: {a:?} {b:?}");
        }
    }
}

/// Returns the places of a grid on each square of the visible faces.
fn grid(cage: &Cage, n: u32) -> Vec<Place> {
    let shown = (0..).zip(&cage.faces).filter(|(face, _)| !cage.holes.contains(&u64::from(*face)));
    let squares = shown.flat_map(|(face, corners)| {
        let squares = if corners.len() == 4 { 1 } else { corners.len() };
        (0..).take(squares).map(move |corner| (face, corner))
    });
    let at = |i: u32| f64::from(i) / f64::from(n);
    let places = squares.flat_map(|(face, corner)| {
        (0..=n).flat_map(move |i| (0..=n).map(move |j| Place { face, corner, uv: [at(i), at(j)] }))
    });
    places.collect()
}

#[test]
fn closest_places_are_as_near_as_any_sample_and_as_they_say() {
    for (name, cage) in cages() {
        let samples: Vec<Vector> = cage.at(&grid(&cage, 24)).iter().map(|jet| jet.at).collect();
        let mut state = 9_u64;
        let mut random = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            f64::from(u32::try_from(state >> 32).expect("32 bits")) / f64::from(u32::MAX)
        };
        let mut points: Vec<Vector> = (0..24).map(|_| [0, 1, 2].map(|_| 5.0 * random() - 2.0)).collect();
        points.extend(&cage.points);
        for (&point, found) in points.iter().zip(cage.closest(&points)) {
            let sampled = samples.iter().map(|&p| length(minus(p, point))).fold(f64::INFINITY, f64::min);
            assert!(found.distance <= sampled + 1e-9, "{name}: {found:?}, a sample is at {sampled} of {point:?}");
            assert!(sampled - found.distance < 0.15, "{name}: {found:?}, the best sample is at {sampled}");
            assert!((length(minus(found.at, point)) - found.distance).abs() < 1e-13, "{name}: {found:?}");
            let there = cage.at(&[found.place])[0];
            assert!(length(minus(there.at, found.at)) < 1e-8, "{name}: {found:?} {there:?}");
            assert!(found.is_certain, "{name}: {found:?} of {point:?}");
        }
    }
}

#[test]
fn points_of_the_surface_are_their_own_closest_places() {
    for (name, cage) in cages() {
        let places = grid(&cage, 5);
        let points: Vec<Vector> = cage.at(&places).iter().map(|jet| jet.at).collect();
        for ((place, &point), found) in places.iter().zip(&points).zip(cage.closest(&points)) {
            // distances below 1e-9 of sizes of at most 5 are not distinguished; ends of creases have no exact mask
            assert!(found.distance < 5e-9, "{name}: {found:?} is not at {place:?}");
            let is_inside = place.uv.iter().all(|x| *x > 0.0 && *x < 1.0);
            if is_inside {
                assert_eq!((found.place.face, found.place.corner), (place.face, place.corner), "{name}: {place:?}");
                let apart = [0, 1].map(|k| (found.place.uv[k] - place.uv[k]).abs());
                assert!(apart.iter().all(|x| *x < 1e-4), "{name}: {found:?} is not at {place:?}");
            }
            assert!((length(minus(point, found.at)) - found.distance).abs() < 1e-13, "{name}: {found:?}");
        }
    }
}

#[test]
fn of_faces_that_share_a_place_the_lowest_is_told() {
    let cage = sheet(2, 2, |i, j| [i, j, 0.0]);
    let places = [[1.0, 0.5], [0.5, 1.0], [1.0, 1.0], [1.5, 1.0], [2.0, 2.0]];
    let found = cage.closest(&places.map(|[x, y]| [x, y, 3.0]));
    let faces: Vec<u32> = found.iter().map(|found| found.place.face).collect();
    assert_eq!(faces, [0, 0, 0, 2, 3]);
    let holed = Cage { holes: vec![0], ..cage };
    let found = holed.closest(&places.map(|[x, y]| [x, y, 3.0]));
    let faces: Vec<u32> = found.iter().map(|found| found.place.face).collect();
    assert_eq!(faces, [2, 1, 1, 2, 3]);
    let pentagon = prism(5);
    let middle = pentagon.at(&[Place { face: 1, corner: 3, uv: [1.0; 2] }])[0];
    let found = pentagon.closest(&[plus(middle.at, [0.0, 0.0, 1.0])])[0];
    assert_eq!((found.place.face, found.place.corner), (1, 0));
}

#[test]
fn the_middle_of_a_ball_has_a_closest_place_in_bounded_time() {
    // on a nearly round cage, every place is about equally close to the centre
    let round = Cage { points: cube().points.iter().map(|p| times(1.0 / length(*p), *p)).collect(), ..cube() };
    let found = round.closest(&[[0.0; 3]])[0];
    let sampled = round.at(&grid(&round, 24)).iter().map(|jet| length(jet.at)).fold(f64::INFINITY, f64::min);
    assert!(found.distance <= sampled + 1e-9, "{found:?} {sampled}");
}

#[test]
fn evaluations_stop_when_they_are_told_to() {
    let watch = Watch::new();
    watch.stop();
    let (mesh, plan) = (cube().mesh(), cube().plan());
    let place = Place { face: 0, corner: 0, uv: [0.3, 0.7] };
    let stopped = |error: &SolidError| matches!(error, SolidError::Stopped(_));
    assert!(evaluate(&mesh, &plan, &[place], &watch).is_err_and(|error| stopped(&error)));
    assert!(closest(&mesh, &plan, &[[1.0, 2.0, 3.0]], &watch).is_err_and(|error| stopped(&error)));
}
