//! Solids of cages: exact faces are exact, the solids are closed, and they stay within the bounds of their
//! certificates.

use std::collections::BTreeMap;

use planish::analysis::limit::{LimitRequest, refine_mesh_to_limit};
use planish::math::functions::{cos, ratio, sin};
use planish::math::vector::{Vector, length, minus, plus};
use planish::scheme::tags::Boundary;
use planish::shape::source::{FaceChunk, MeshSource};
use planish::solid::evaluate::closest;
use planish::solid::{
    BSplineSurface, Continuity, DeviationMethod, Isolated, Pack, Solid, SolidError, SolidRequest, solid,
};
use planish::watch::Watch;
use serde_json::json;

use crate::support::cages::{Cage, cube, prism, sheet};
use crate::support::render;

impl Cage {
    fn solid(&self, request: &SolidRequest) -> Result<Solid, SolidError> {
        solid(&self.mesh(), &self.plan(), request, &[], &Watch::new())
    }
}

/// The request for most solids here: coarse, and without the tables of smooth caps.
const COARSE: SolidRequest = SolidRequest {
    tolerance: 1e-2,
    continuity: Continuity::Bicubic,
    pack: Pack::Patch,
    max_faces: 20_000,
    max_level: 14,
    shortest: 1e-9,
    closed: false,
};

fn torus(n: u32, m: u32) -> Cage {
    let turn = |i: u32, n: u32| std::f64::consts::TAU * f64::from(i) / f64::from(n);
    let at = |i, j| {
        let [(s, c), (t, d)] = [turn(i, n), turn(j, m)].map(|a| (sin(a), cos(a)));
        [(30.0 + 10.0 * d) * c, (30.0 + 10.0 * d) * s, 10.0 * t]
    };
    let number = |i: u32, j: u32| i % n * m + j % m;
    let face = |i, j| vec![number(i, j), number(i + 1, j), number(i + 1, j + 1), number(i, j + 1)];
    Cage {
        points: (0..n).flat_map(|i| (0..m).map(move |j| (i, j))).map(|(i, j)| at(i, j)).collect(),
        faces: (0..n).flat_map(|i| (0..m).map(move |j| (i, j))).map(|(i, j)| face(i, j)).collect(),
        ..Cage::default()
    }
}

/// Pseudorandom numbers, the same on every machine.
struct Random(u64);

impl Random {
    fn unit(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        f64::from(u32::try_from(self.0 >> 32).expect("32 bits")) / f64::from(u32::MAX)
    }

    fn below(&mut self, n: usize) -> usize {
        let at = self.unit();
        (1..n).take_while(|&i| at >= ratio(i, n)).count()
    }
}

/// Returns a point of a surface with one span, by its Bernstein form.
fn at(surface: &BSplineSurface, u: f64, v: f64) -> Vector {
    let row = |points: &[Vector], t: f64| {
        let mut points = points.to_vec();
        while points.len() > 1 {
            points = points
                .windows(2)
                .map(|pair| std::array::from_fn(|k| (1.0 - t) * pair[0][k] + t * pair[1][k]))
                .collect();
        }
        points[0]
    };
    let along: Vec<Vector> = surface.points.iter().map(|points| row(points, v)).collect();
    row(&along, u)
}

fn near(a: Vector, b: Vector, tolerance: f64) -> bool {
    length(minus(a, b)) <= tolerance
}

/// Checks that every edge bounds two faces, once in each direction, or one at the boundary of the cage; that loops run
/// from edge to edge; and that the Euler characteristic is even and at most 2 in each closed shell.
fn check_topology(name: &str, found: &Solid, size: f64) {
    let brep = &found.brep;
    let mut uses: BTreeMap<u32, Vec<bool>> = BTreeMap::new();
    for face in &brep.faces {
        let ends = |&(e, along): &(u32, bool)| {
            let [a, b] = brep.edges[e as usize].ends;
            if along { [a, b] } else { [b, a] }
        };
        for (i, step) in face.edges.iter().enumerate() {
            let next = &face.edges[(i + 1) % face.edges.len()];
            assert_eq!(ends(step)[1], ends(next)[0], "{name}: a loop is broken");
            uses.entry(step.0).or_default().push(step.1);
        }
    }
    let closed = found.certificate.is_closed();
    for uses in uses.values() {
        assert!(matches!(uses[..], [true, false] | [false, true]) || !closed && uses.len() == 1, "{name}: {uses:?}");
    }
    for shell in found.certificate.shells.iter().filter(|shell| shell.is_closed) {
        assert!(shell.euler <= 2 && shell.euler % 2 == 0, "{name}: Euler characteristic {}", shell.euler);
        assert!(shell.volume > 0.0, "{name}: volume {}", shell.volume);
    }
    assert!(found.certificate.gap < 1e-12 * size, "{name}: gap {:e}", found.certificate.gap);
}

#[test]
fn exact_faces_are_the_limit_surface() {
    let sharp = |cage: Cage, sharpness: f64| {
        let creases = [[1, 3], [3, 7], [7, 5], [5, 1]].map(|edge| (edge, sharpness)).into();
        Cage { creases, ..cage }
    };
    let bent = |i: f64, j: f64| [i, j, sin(1.3 * i) * cos(0.9 * j)];
    let cages = [
        ("sheet", sheet(4, 3, bent)),
        ("sheet with round corners", Cage { boundary: Boundary::EdgeOnly, ..sheet(4, 3, bent) }),
        ("torus", torus(6, 5)),
        ("creased", sharp(cube(1.0), 10.0)),
        ("semi-sharp", sharp(cube(1.0), 1.5)),
        ("pentagons", prism(5)),
    ];
    for (name, cage) in cages {
        let found = cage.solid(&SolidRequest { pack: Pack::Nothing, ..COARSE }).expect(name);
        let asked = LimitRequest { positions: true, normals: false };
        let levels = 4;
        let (refined, _) = refine_mesh_to_limit(&cage.mesh(), &cage.plan(), levels, asked, &Watch::new()).expect(name);
        let mut points = Vec::new();
        refined.positions(0..refined.n_vertices(), &mut points);
        let mut exact = 0;
        // faces of the third level have one point inside their sides, which the fourth level contains
        for face in found.brep.faces.iter().filter(|face| face.is_exact) {
            for (u, v) in [(0.0, 0.0), (1.0, 0.0), (0.5, 0.5), (0.5, 1.0), (0.0, 0.5)] {
                let place = at(&face.surface, u, v);
                let apart = points.iter().map(|&p| length(minus(p, place))).fold(f64::INFINITY, f64::min);
                assert!(apart < 1e-13 * cage.size(), "{name}: {apart:e} from the limit surface");
            }
            exact += 1;
        }
        assert!(exact > 3, "{name}: {exact} exact faces");
        check_topology(name, &found, cage.size());
    }
}

/// A face with sharp sides is smooth inside, and the faces beyond those sides do not affect it.
#[test]
fn faces_with_sharp_sides_are_within_the_deviation_of_their_limit() {
    let alone = |n: u32| {
        let cage = prism(n);
        let at = |i: u32| cage.points[i as usize];
        Cage {
            points: (0..n).map(|i| plus(at(i), [0.0, 0.0, f64::from(i % 3)])).collect(),
            faces: vec![(0..n).collect()],
            ..cage
        }
    };
    let rimmed = |n: u32| {
        let rim = (0..n).map(|i| ([i, (i + 1) % n].map(u64::from), 10.0));
        Cage { creases: rim.collect(), ..prism(n) }
    };
    let cages = [3, 5, 6].into_iter().flat_map(|n| [("alone", n, alone(n)), ("rimmed", n, rimmed(n))]);
    for (name, n, cage) in cages.flat_map(|(name, n, cage)| {
        let round = Cage { boundary: Boundary::EdgeOnly, ..cage.clone() };
        [(name, n, cage), (name, n, round)]
    }) {
        let asked = LimitRequest { positions: true, normals: false };
        let (refined, _) = refine_mesh_to_limit(&cage.mesh(), &cage.plan(), 6, asked, &Watch::new()).expect(name);
        let mut points = Vec::new();
        refined.positions(0..refined.n_vertices(), &mut points);
        for continuity in [Continuity::Bicubic, Continuity::Tangent] {
            let found = cage.solid(&SolidRequest { continuity, pack: Pack::Nothing, ..COARSE }).expect(name);
            check_topology(name, &found, cage.size());
            for face in &found.brep.faces {
                // between their corners, caps have parameters of their own
                let places = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0), (0.5, 0.5)];
                for &(u, v) in &places[..if face.is_exact { 5 } else { 4 }] {
                    let place = at(&face.surface, u, v);
                    let apart = points.iter().map(|&p| length(minus(p, place))).fold(f64::INFINITY, f64::min);
                    let bound = found.certificate.deviation + 1e-12 * cage.size();
                    assert!(apart <= bound, "{name} {n}, {continuity:?}: {apart:e} of {bound:e}");
                }
            }
        }
    }
}

/// Returns two tips of `n` quads each, one above the other; for `n = 3` a cube. The edge from the upper tip to the
/// first vertex below it is sharp.
fn tips(n: u32) -> Cage {
    let at = |k: u32| {
        let turn = std::f64::consts::PI * f64::from(k) / f64::from(n);
        [cos(turn), sin(turn), if k.is_multiple_of(2) { 0.4 } else { -0.3 }]
    };
    let between = |k: u32| 2 + k % (2 * n);
    let upper = (0..n).map(|i| vec![0, between(2 * i), between(2 * i + 1), between(2 * i + 2)]);
    let lower = (0..n).map(|i| vec![1, between(2 * i + 3), between(2 * i + 2), between(2 * i + 1)]);
    Cage {
        points: [[0.1, 0.2, 1.7], [0.0, 0.0, -1.5]].into_iter().chain((0..2 * n).map(at)).collect(),
        faces: upper.chain(lower).collect(),
        creases: vec![([0, 2], 10.0)],
        ..Cage::default()
    }
}

/// Ends of sharp edges have no closed-form mask of two rings: their limits converge from level to level, the more
/// slowly the more faces they have.
#[test]
fn ends_of_sharp_edges_are_at_their_limits_whatever_their_valence() {
    for n in 3..13 {
        let cage = tips(n);
        let asked = LimitRequest { positions: true, normals: false };
        let (limits, _) =
            refine_mesh_to_limit(&cage.mesh(), &cage.plan(), 0, asked, &Watch::new()).expect("it has one");
        let mut points = Vec::new();
        limits.positions(0..limits.n_vertices(), &mut points);
        let solid = cage.solid(&COARSE).expect("it is closed");
        for v in [0, 2] {
            let apart = |p: &Vector| length(minus(*p, points[v]));
            let nearest = solid.brep.vertices.iter().map(apart).fold(f64::INFINITY, f64::min);
            assert!(nearest <= 1e-14 * cage.size(), "{n}, {v}: {nearest:e}");
        }
    }
}

#[test]
fn random_cages_become_shells_without_gaps() {
    let mut random = Random(7);
    for round in 0..24 {
        let mut cage = match round % 4 {
            0 => cube(1.0),
            1 => prism(3 + u32::try_from(random.below(4)).expect("small")),
            2 => torus(4, 3),
            _ => sheet(3, 3, |i, j| [i, j, 0.3 * sin(i * j)]),
        };
        let size = cage.size();
        for x in cage.points.as_flattened_mut() {
            *x += 0.03 * size * (random.unit() - 0.5);
        }
        let sides = cage
            .faces
            .iter()
            .flat_map(|face| (0..face.len()).map(|i| [face[i], face[(i + 1) % face.len()]]).filter(|[a, b]| a < b));
        for edge in sides.collect::<Vec<_>>() {
            let sharpness = [10.0, 1.0, 0.6][random.below(3)];
            if random.unit() < 0.15 {
                cage.creases.push((edge.map(u64::from), sharpness));
            }
        }
        if random.unit() < 0.3 {
            cage.holes.push(random.below(cage.faces.len()) as u64);
        }
        if random.unit() < 0.5 {
            cage.boundary = Boundary::EdgeOnly;
        }
        let name = format!("round {round}: {cage:?}");
        let pack = [Pack::Patch, Pack::Face, Pack::Nothing][random.below(3)];
        let continuity = [Continuity::Bicubic, Continuity::Tangent][round / 4 % 2];
        let found =
            cage.solid(&SolidRequest { pack, continuity, ..COARSE }).unwrap_or_else(|error| panic!("{error} {name}"));
        check_topology(&name, &found, cage.size());
        assert!(found.certificate.deviation_of_size() <= 1e-2, "{name}");
    }
}

#[test]
fn volumes_and_counts_are_those_of_the_reference() {
    let ring = torus(12, 8).solid(&COARSE).expect("a torus").certificate;
    assert_eq!(ring.counts, [4, 8, 4]);
    // the integral of (a b' - a' b) over one turn times that of z r r' over the other, where a, b, r and z are the
    // splines of cosines, sines, radii and heights: 43945.01051071307256 with fifty digits
    assert!((ring.volume() / 43_945.010_510_713_07 - 1.0).abs() < 1e-14, "{}", ring.volume());
    assert!(ring.exact_area_share >= 1.0 && ring.worst_edge_angle_deg < 1e-10);
    let edges = [[0, 1], [1, 3], [3, 2], [2, 0], [4, 6], [6, 7], [7, 5], [5, 4], [0, 4], [5, 1], [3, 7], [6, 2]];
    let sharp = Cage { creases: edges.map(|edge| (edge, 10.0)).into(), ..cube(10.0) };
    let block = sharp.solid(&COARSE).expect("a box").certificate;
    assert_eq!(block.counts, [6, 12, 8]);
    assert!((block.volume() - 8_000.0).abs() < 1e-9, "{}", block.volume());
    let round = cube(10.0).solid(&SolidRequest { tolerance: 1e-4, continuity: Continuity::Tangent, ..COARSE });
    let round = round.expect("a cube").certificate;
    assert!((round.volume() / 2_620.419_033 - 1.0).abs() < 2e-5, "{}", round.volume());
    assert!(round.counts[0] <= 24 && round.worst_edge_angle_deg < 1e-8, "{:?}", round.counts);
}

#[test]
fn cubes_take_no_more_faces_than_they_need() {
    for (tolerance, most) in [(1e-4, 24), (1e-5, 32), (1e-6, 80)] {
        let found = cube(10.0).solid(&SolidRequest { tolerance, continuity: Continuity::Tangent, ..COARSE });
        let said = found.expect("a cube").certificate;
        assert!(said.counts[0] <= most, "{tolerance:e}: {:?}", said.counts);
        assert!(said.known == DeviationMethod::Certified && said.deviation_of_size() <= tolerance, "{tolerance:e}");
        // extrapolated from refined meshes
        let off = (said.volume() - 2_620.419_033_38).abs();
        assert!(off <= said.deviation * said.area() && off < 0.1, "{tolerance:e}: {}", said.volume());
    }
}

/// The coordinates are binary fractions, so that moving the cage is exact, and only its solid is rounded.
#[test]
fn bounds_count_the_rounding_of_coordinates_even_where_all_is_exact() {
    let moved = |by: f64| sheet(4, 3, |i, j| [i + by, j + by, 0.25 * i * j + by]);
    let by = 1_048_576.0;
    let [here, there] = [0.0, by].map(|by| moved(by).solid(&COARSE).expect("a sheet"));
    assert!(here.certificate.vertices.is_empty() && here.certificate.known == DeviationMethod::Certified);
    let bounds = [&here, &there].map(|solid| solid.certificate.deviation);
    assert!(bounds[0] >= f64::EPSILON * 4.0 && bounds[0] < 1e-12, "{bounds:?}");
    let mut most = 0.0_f64;
    for (a, b) in here.brep.faces.iter().zip(&there.brep.faces) {
        for (a, b) in a.surface.points.iter().flatten().zip(b.surface.points.iter().flatten()) {
            most = most.max(length(minus(minus(*b, [by; 3]), *a)));
        }
    }
    assert!(bounds[0] < most && most <= bounds[0] + bounds[1], "{most:e}, {bounds:?}");
    let error = moved(by).solid(&SolidRequest { tolerance: 1e-9, ..COARSE }).expect_err("it is rounded by more");
    assert!(error.to_string().contains("move the mesh to the origin"), "{error}");
}

/// Returns a cube after two refinements, with bumps: its corners are four edges apart.
fn bumpy() -> Cage {
    let asked = LimitRequest { positions: false, normals: false };
    let (refined, _) =
        refine_mesh_to_limit(&cube(1.0).mesh(), &cube(1.0).plan(), 2, asked, &Watch::new()).expect("small");
    let (mut points, mut faces) = (Vec::new(), FaceChunk::default());
    refined.positions(0..refined.n_vertices(), &mut points);
    refined.faces(0..refined.n_faces(), &mut faces);
    let bump = |[x, y, z]: Vector| [x + 0.05 * sin(7.0 * y), y + 0.05 * cos(5.0 * z), z + 0.06 * sin(6.0 * x)];
    Cage {
        points: points.into_iter().map(bump).collect(),
        faces: faces.iter().map(<[u32]>::to_vec).collect(),
        ..Cage::default()
    }
}

#[test]
fn caps_beside_holes_are_those_of_the_surface_without_them() {
    let whole = bumpy();
    let around = |v: u32| (0..).zip(&whole.faces).filter(move |(_, face)| face.contains(&v)).map(|(f, _)| f);
    let corner = (0..u32::try_from(whole.points.len()).expect("few"))
        .find(|&v| around(v).count() == 3)
        .expect("a cube has corners");
    let holes: Vec<u64> = around(corner).collect();
    let side = |f: u64| {
        let face = &whole.faces[usize::try_from(f).expect("few")];
        let at = face.iter().position(|&v| v == corner).expect("it is around");
        [corner, face[(at + 1) % 4]].map(u64::from)
    };
    let request = SolidRequest { tolerance: 1e-4, continuity: Continuity::Tangent, pack: Pack::Nothing, ..COARSE };
    for creases in [vec![], vec![(side(holes[0]), 10.0)], vec![(side(holes[1]), 10.0)]] {
        let whole = Cage { creases, ..whole.clone() };
        let all = whole.solid(&request).expect("a cube");
        for n in 1..3 {
            let holed = Cage { holes: holes[..n].into(), ..whole.clone() }.solid(&request).expect("an open cube");
            assert_eq!(holed.certificate.vertices.len(), all.certificate.vertices.len());
            for vertex in &holed.certificate.vertices {
                let is_same = |other: &&Isolated| near(other.at, vertex.at, 1e-14) && other.level == vertex.level;
                let other = all.certificate.vertices.iter().find(is_same).expect("it is a vertex of the whole");
                let share = vertex.deviation / other.deviation;
                assert!((share - 1.0).abs() < 1e-9 && vertex.known == other.known, "{vertex:?} {other:?}");
            }
            let points = |surface: &BSplineSurface| surface.points.concat();
            for face in &holed.brep.faces {
                let own = points(&face.surface);
                let is_same = |other: &Vec<Vector>| {
                    other.len() == own.len() && other.iter().zip(&own).all(|(&a, &b)| near(a, b, 1e-14))
                };
                assert!(all.brep.faces.iter().any(|face| is_same(&points(&face.surface))), "{face:?}");
            }
        }
    }
}

/// The search for closest places, which does not know caps, finds the limit surface.
#[test]
fn points_of_sampled_caps_are_within_their_deviation_of_the_limit_surface() {
    let tip = |n| Cage { creases: vec![], corners: vec![(0, 10.0)], ..tips(n) };
    let cages = [
        ("cone of 3", tip(3)),
        ("cone of 5", tip(5)),
        ("dart", tips(4)),
        ("round", {
            Cage { boundary: Boundary::EdgeOnly, ..sheet(3, 3, |i, j| [i, j, 0.4 * sin(1.3 * i) * cos(0.9 * j)]) }
        }),
    ];
    for (name, cage) in cages {
        let found = cage.solid(&SolidRequest { tolerance: 1e-3, ..COARSE }).expect(name);
        let caps = found.brep.faces.iter().filter(|face| !face.is_exact);
        let places = (0..64).map(|k| [ratio(k / 8, 8) + 0.03, ratio(k % 8, 8) + 0.04]);
        let points: Vec<Vector> = caps.flat_map(|face| places.clone().map(|[u, v]| at(&face.surface, u, v))).collect();
        let nearest = closest(&cage.mesh(), &cage.plan(), &points, &Watch::new()).expect(name);
        let most = nearest.iter().map(|closest| closest.distance).fold(0.0, f64::max);
        let said = found.certificate.deviation;
        assert!(
            found.certificate.known == DeviationMethod::Sampled && most <= 1.1 * said,
            "{name}: {most:e} of {said:e}"
        );
    }
}

#[test]
fn faces_that_are_inside_out_are_turned() {
    let mut cage = cube(10.0);
    cage.faces.iter_mut().for_each(|face| face.reverse());
    let turned = cage.solid(&COARSE).expect("a cube");
    let straight = cube(10.0).solid(&COARSE).expect("a cube");
    assert_eq!([&turned, &straight].map(|found| found.certificate.shells[0].was_inside_out), [true, false]);
    let [a, b] = [&turned, &straight].map(|found| found.certificate.volume());
    assert!((a / b - 1.0).abs() < 1e-12);
    check_topology("turned", &turned, 20.0);
}

#[test]
fn caps_have_the_points_of_the_reference() {
    let first = |request: &SolidRequest| {
        let found = cube(1.0).solid(request).expect("a cube");
        let at_corner = |surface: &&BSplineSurface| near(surface.points[0][0], [0.5; 3], 1e-12);
        let caps = found.brep.faces.iter().filter(|face| !face.is_exact).map(|face| &face.surface);
        caps.filter(at_corner).cloned().collect::<Vec<_>>()
    };
    let approximate = first(&COARSE);
    let [p10, p11] = [
        [0.552_083_333_333, 0.395_833_333_333, 0.552_083_333_333],
        [0.708_333_333_333, 0.395_833_333_333, 0.395_833_333_333],
    ];
    let has =
        |surface: &BSplineSurface| near(surface.points[1][0], p10, 1e-11) && near(surface.points[1][1], p11, 1e-11);
    assert!(approximate.iter().any(has), "{approximate:?}");
    let fitted = first(&SolidRequest { tolerance: 1e-3, continuity: Continuity::Tangent, ..COARSE });
    let spoke = [
        [0.528_036_800_349, 0.443_926_399_301, 0.528_036_800_349],
        [0.609_567_901_235, 0.124_074_074_074, 0.609_567_901_235],
        [0.609_567_901_235, 0.0, 0.609_567_901_235],
    ];
    let inner = [0.701_234_567_901, 0.124_074_074_074, 0.517_901_234_568];
    let has = |surface: &BSplineSurface| {
        let along = [1, 4, 5].iter().zip(spoke).all(|(&a, point)| near(surface.points[a][0], point, 1e-11));
        along && near(surface.points[4][1], inner, 1e-11)
    };
    assert!(fitted.iter().any(has), "{fitted:?}");
}

#[test]
fn nets_at_corners_of_sheets_are_those_of_the_reference() {
    let cage = sheet(2, 2, |i, j| [i, j, i * i - j]);
    let found = cage.solid(&SolidRequest { pack: Pack::Nothing, ..COARSE }).expect("a sheet");
    let net = &found.brep.faces[0].surface.points;
    let third = 1.0 / 3.0;
    let row = [[third, 0.0, third], [third, third, 0.0], [third, 2.0 * third, -third], [third, 1.0, -2.0 * third]];
    assert!(net[1].iter().zip(row).all(|(&a, b)| near(a, b, 1e-14)), "{net:?}");
    assert!(near(net[3][0], [1.0, 0.0, 4.0 * third], 1e-14), "{net:?}");
}

#[test]
fn a_face_of_the_second_level_of_a_cube_is_that_of_the_reference() {
    let request = SolidRequest { tolerance: 1e-5, continuity: Continuity::Tangent, pack: Pack::Nothing, ..COARSE };
    let found = cube(1.0).solid(&request).expect("a cube");
    let (a, b) = (-0.609_567_901_235, -0.595_293_209_877);
    let row = [
        [a, a, 0.0],
        [a, a, -0.103_395_061_728],
        [b, b, -0.206_790_123_457],
        [-0.572_932_741_77, -0.572_932_741_77, -0.296_649_948_56],
    ];
    let sides = |surface: &BSplineSurface| {
        let net = &surface.points;
        let column = |j: usize| net.iter().map(|row| row[j]).collect::<Vec<_>>();
        let mut all = vec![net[0].clone(), net[3].clone(), column(0), column(3)];
        all.extend(all.clone().into_iter().map(|side| side.into_iter().rev().collect()));
        all
    };
    let exact = || found.brep.faces.iter().filter(|face| face.is_exact).flat_map(|face| sides(&face.surface));
    let is_it = |side: &Vec<Vector>| side.len() == 4 && side.iter().zip(row).all(|(&a, b)| near(a, b, 1e-12));
    assert!(exact().any(|side| is_it(&side)), "{:?}", exact().collect::<Vec<_>>());
}

/// Returns a job of a cube with an output.
fn job(output: &serde_json::Value) -> serde_json::Value {
    let Cage { points, faces, .. } = cube(10.0);
    json!({
        "input": { "mesh": { "positions": points, "faces": faces,
            "groups": [{ "name": "top", "faces": [1] }],
            "materials": [{ "name": "red", "faces": [0, 1], "color": [1, 0, 0.5, 1] }] }, "unit": "in" },
        "plan": { "preset": "catmull-clark" },
        "outputs": [output],
    })
}

#[test]
fn step_files_name_what_the_input_names_and_are_the_same_every_time() {
    let asked = job(&json!({ "format": "step", "tolerance": 1e-2, "continuity": "bicubic" }));
    let (bytes, report) = render(&asked).expect("a solid");
    assert_eq!(bytes, render(&asked).expect("a solid").0);
    let text = String::from_utf8(bytes).expect("text");
    for part in [
        "FILE_NAME('','',(''),(''),'planish','planish','');",
        "CONVERSION_BASED_UNIT('INCH'",
        "MANIFOLD_SOLID_BREP",
        "PRESENTATION_LAYER_ASSIGNMENT('top'",
        "COLOUR_RGB('',1.,0.,0.5)",
        "ADVANCED_FACE('f0'",
    ] {
        assert!(text.contains(part), "{part} is missing");
    }
    assert!(report.warnings.iter().any(|warning| warning.contains("of the area exact")), "{:?}", report.warnings);
}

#[test]
fn certificates_say_what_is_known_and_how() {
    let (bytes, _) = render(&job(&json!({ "format": "certificate", "tolerance": 1e-3 }))).expect("a certificate");
    let said: serde_json::Value = serde_json::from_slice(&bytes).expect("JSON");
    assert_eq!(said["bound_method"], "certified");
    assert_eq!(said["euler_characteristic"], 2);
    assert_eq!(said["self_intersections"], "not checked");
    assert_eq!(said["irregular"].as_array().map(Vec::len), Some(8));
    assert!(said["deviation_of_size"].as_f64().expect("a number") <= 1e-3);
    assert!(said["worst_edge_angle_deg"].as_f64().expect("a number") < 1e-9);
}

#[test]
fn statistics_tell_the_certificate_on_request() {
    let (bytes, _) = render(&job(&json!({ "format": "certificate" }))).expect("a certificate");
    let certificate: serde_json::Value = serde_json::from_slice(&bytes).expect("JSON");
    let mut asked = job(&json!({ "format": "stats", "certificate": true }));
    asked["levels"] = 1.into();
    let (bytes, _) = render(&asked).expect("statistics");
    let said: serde_json::Value = serde_json::from_slice(&bytes).expect("JSON");
    assert_eq!(said["certificate"], certificate);
    assert_eq!(said["faces"], 24);
}

/// A change of a job.
type Change<'a> = &'a dyn Fn(&mut serde_json::Value);

#[test]
fn what_gives_no_solid_is_refused_with_a_remedy() {
    let with = |change: Change<'_>| {
        let mut asked = job(&json!({ "format": "step", "continuity": "bicubic", "tolerance": 1e-2 }));
        change(&mut asked);
        render(&asked).expect_err("it is refused").remove(0)
    };
    let cases: [(&str, &str, Change<'_>); 7] = [
        ("/outputs/0/format", "Catmull-Clark", &|asked| {
            asked["plan"] = json!({ "word": "UC" });
            asked["input"]["mesh"] = json!({ "positions": cube(1.0).points, "faces": cube(1.0).faces });
        }),
        ("/outputs/0/format", "Catmull-Clark", &|asked| {
            asked.as_object_mut().expect("an object").remove("plan");
        }),
        ("/outputs/0/solid", "auto", &|asked| {
            asked["input"]["mesh"] = json!({ "positions": cube(1.0).points, "faces": cube(1.0).faces[..5] });
            asked["outputs"][0]["solid"] = "require".into();
        }),
        ("/outputs/0/max_faces", "max_faces", &|asked| asked["outputs"][0]["max_faces"] = 3.into()),
        ("/outputs/0/tolerance", "max_level", &|asked| {
            asked["outputs"][0]["tolerance"] = 1e-7.into();
            asked["outputs"][0]["max_level"] = 2.into();
        }),
        ("/outputs/0", "only two faces meet", &|asked| {
            let square = [[0.0; 3], [1.0, 0.0, 0.0], [1.0, 1.0, 0.3], [0.0, 1.0, 0.0]];
            asked["input"]["mesh"] = json!({ "positions": square, "faces": [[0, 1, 2, 3], [3, 2, 1, 0]] });
        }),
        ("/outputs/0", "one place", &|asked| {
            let flat: Vec<Vector> = cube(1.0).points.iter().map(|_| [1.0; 3]).collect();
            asked["input"]["mesh"] = json!({ "positions": flat, "faces": cube(1.0).faces });
        }),
    ];
    for (place, word, change) in cases {
        let fault = with(change);
        assert_eq!(fault.pointer, place, "{}", fault.detail);
        assert!(fault.detail.contains(word), "{}", fault.detail);
    }
}
