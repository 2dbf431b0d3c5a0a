//! Limit normals on each side of edges that remain sharp, at their ends, at corners and on boundaries.

use std::collections::BTreeSet;

use planish::math::functions::sqrt;
use serde_json::{Value, json};

use crate::support::nets::{self, Net, distance};
use crate::support::render;

/// A mesh with infinitely sharp edges and corners.
#[derive(Clone)]
struct Tagged {
    net: Net,
    edges: Vec<[usize; 2]>,
    corners: Vec<usize>,
}

fn tagged(net: Net, edges: &[[usize; 2]]) -> Tagged {
    Tagged { net, edges: edges.to_vec(), corners: Vec::new() }
}

/// The corners of each face of the result, as vertex and normal; and the warnings.
type Sides = (Vec<Vec<(usize, [f64; 3])>>, Vec<String>);

fn sides(tagged: &Tagged, plan: &Value, levels: u32, normals: &str) -> Sides {
    let mut input = tagged.net.input();
    input["mesh"]["creases"] = tagged.edges.iter().map(|edge| json!({ "edge": edge, "sharpness": 10 })).collect();
    input["mesh"]["corners"] = tagged.corners.iter().map(|v| json!({ "vertex": v, "sharpness": 10 })).collect();
    let job = json!({ "input": input, "plan": plan, "levels": levels,
        "outputs": [{ "format": "obj", "normals": normals }] });
    let (bytes, report) = render(&job).unwrap_or_else(|faults| panic!("{faults:?} for {job}"));
    let text = String::from_utf8(bytes).expect("OBJ is text");
    let row = |line: &str| -> [f64; 3] {
        let row: Vec<f64> = line.split(' ').map(|x| x.parse().expect("a number")).collect();
        row.try_into().expect("three numbers")
    };
    let normals: Vec<[f64; 3]> = text.lines().filter_map(|line| line.strip_prefix("vn ")).map(row).collect();
    let corner = |corner: &str| {
        let (v, n) = corner.split_once("//").expect("a vertex and a normal");
        let [v, n] = [v, n].map(|i| i.parse::<usize>().expect("an index") - 1);
        (v, normals[n])
    };
    let faces = text.lines().filter_map(|line| line.strip_prefix("f "));
    (faces.map(|face| face.split(' ').map(corner).collect()).collect(), report.warnings)
}

/// Returns the angle between limit normals and area normals of a deep level at each corner of the input.
fn differences(tagged: &Tagged, plan: &Value, levels: u32) -> Vec<(usize, usize, f64)> {
    let (claimed, warnings) = sides(tagged, plan, 0, "limit");
    assert!(warnings.is_empty(), "{plan}: {warnings:?}");
    let (deep, _) = sides(tagged, plan, levels, "area");
    let n_corners: usize = tagged.net.faces.iter().map(Vec::len).sum();
    let triangles = tagged.net.faces.iter().all(|face| face.len() == 3) && deep[0].len() == 3;
    let mut found = Vec::new();
    let mut first = 0;
    for (f, face) in claimed.iter().enumerate() {
        let share = if triangles { deep.len() / claimed.len() } else { deep.len() / n_corners * face.len() };
        for &(v, normal) in face {
            let here = deep[first..first + share].iter().flatten().find(|(u, _)| *u == v);
            let (_, area) = here.unwrap_or_else(|| panic!("face {f} has no vertex {v}"));
            let length = sqrt(normal.iter().map(|x| x * x).sum());
            assert!((length - 1.0).abs() < 1e-12, "{normal:?}");
            found.push((f, v, distance(&normal, area)));
        }
        first += share;
    }
    found
}

/// Checks that area normals converge to the limit normals, by a factor of about two per level.
fn assert_approached(tagged: &Tagged, plan: &Value) {
    let [early, late] = [3, 5].map(|levels| differences(tagged, plan, levels));
    for ((f, v, before), (_, _, after)) in early.into_iter().zip(late) {
        let near = after < 0.08 && after < 0.6 * before + 5e-3;
        assert!(near, "{plan}: on the side of face {f} the normal of vertex {v} is off by {before}, then {after}");
    }
}

fn catmull_clark() -> Value {
    json!({ "preset": "catmull-clark" })
}

fn edge_only(plan: &Value) -> Value {
    let mut plan = plan.clone();
    plan["boundary"] = json!("edge-only");
    plan
}

/// Returns plans that support infinitely sharp edges; the last one changes from level to level.
fn plans() -> Vec<Value> {
    let circle = json!({ "alpha": "pi/5", "kernel": "cos(alpha/2)", "compensation": "1/cos(alpha/2)", "delta": 0.5 });
    vec![catmull_clark(), json!({ "word": "UCC" }), json!({ "word": "UCP", "parameters": circle })]
}

const RING: [[usize; 2]; 4] = [[0, 1], [1, 2], [2, 3], [3, 0]];
const ACROSS: [[usize; 2]; 5] = [[0, 4], [4, 8], [8, 12], [12, 16], [16, 0]];

fn octahedron() -> Net {
    let positions = vec![[1., 0., 0.], [-1., 0., 0.25], [0., 1., 0.], [0., -1., 0.], [0.125, 0., 1.], [0., 0., -1.]];
    let faces = [[0, 2, 4], [2, 1, 4], [1, 3, 4], [3, 0, 4], [2, 0, 5], [1, 2, 5], [3, 1, 5], [0, 3, 5]];
    Net { positions, faces: faces.map(Vec::from).to_vec() }
}

/// Creases, crossing creases, and ends of creases.
#[test]
fn each_side_of_a_crease_has_its_limit_normal() {
    for plan in plans() {
        let both: Vec<[usize; 2]> = RING.into_iter().chain(ACROSS).collect();
        for edges in [&RING[..], &both, &RING[..2]] {
            assert_approached(&tagged(nets::torus(4, 5), edges), &plan);
        }
    }
}

/// Three creases that meet in a corner; and a cube with all edges sharp.
#[test]
fn each_side_of_a_corner_has_its_limit_normal() {
    let all: Vec<[usize; 2]> = nets::cube().edges().into_iter().map(|(a, b)| [a, b]).collect();
    for plan in plans() {
        for edges in [&[[4, 5], [5, 7], [5, 1]][..], &all] {
            assert_approached(&tagged(nets::cube(), edges), &plan);
        }
    }
}

#[test]
fn creases_that_reach_the_boundary_have_a_limit_normal_on_each_side() {
    for plan in plans() {
        assert_approached(&tagged(nets::grid(4, 2), &[[2, 7], [7, 12]]), &plan);
        assert_approached(&tagged(nets::grid(4, 2), &[[6, 7], [7, 8]]), &plan);
    }
}

#[test]
fn creases_of_triangles_have_a_limit_normal_on_each_side() {
    let equator = [[0, 2], [2, 1], [1, 3], [3, 0]];
    let word = json!({ "word": "UCP", "parameters": { "split": "triangle", "delta": 0.25 } });
    for plan in [json!({ "preset": "loop" }), word] {
        let both: Vec<[usize; 2]> = equator.into_iter().chain([[0, 4], [4, 1], [1, 5], [5, 0]]).collect();
        for edges in [&equator[..], &both, &equator[..1]] {
            assert_approached(&tagged(octahedron(), edges), &plan);
        }
    }
}

/// For a single face between two edges, its points and those along the crease shrink at the same rate: the surface
/// touches the plane in which the crease curves, and area normals converge as slowly as 1/level.
#[test]
fn alone_between_two_edges_a_face_touches_the_plane_of_the_crease() {
    let (cube, rim) = (nets::cube(), [[4, 5], [5, 7], [7, 6], [6, 4]]);
    for (tagged, plan) in [
        (tagged(cube, &rim), catmull_clark()),
        (tagged(nets::grid(2, 2), &[]), edge_only(&catmull_clark())),
        (tagged(nets::grid(1, 1), &[]), edge_only(&json!({ "word": "UC" }))),
    ] {
        let (claimed, warnings) = sides(&tagged, &plan, 0, "limit");
        assert!(warnings.is_empty(), "{plan}: {warnings:?}");
        let mut alone = 0;
        for (f, face) in claimed.iter().enumerate() {
            for i in 0..face.len() {
                let [before, here, after] = [i + 3, i, i + 1].map(|i| face[i % 4].0);
                let is_sharp = |a: usize, b: usize| {
                    let faces = tagged.net.faces.iter().filter(|face| face.contains(&a) && face.contains(&b)).count();
                    faces == 1 || tagged.edges.contains(&[a, b]) || tagged.edges.contains(&[b, a])
                };
                if is_sharp(before, here) && is_sharp(here, after) {
                    let [p, q, r] = [before, here, after].map(|v| tagged.net.positions[v]);
                    let expected = nets::triangle_normal(q, r, p);
                    let off = distance(&face[i].1, &expected);
                    assert!(off < 1e-9, "{plan}: face {f} at vertex {here}: {:?} is not {expected:?}", face[i].1);
                    alone += 1;
                }
            }
        }
        assert_eq!(alone, 4, "{plan}");
        let [early, late] = [2, 6].map(|levels| differences(&tagged, &plan, levels));
        for ((_, v, before), (_, _, after)) in early.into_iter().zip(late) {
            assert!(after < 0.1 && after < 0.6 * before + 1e-9, "{plan}: vertex {v}: {before}, then {after}");
        }
    }
}

/// Returns the first sectors of a disc: their centre lies on the boundary.
fn part(sectors: usize, of: usize) -> Net {
    let (net, _) = nets::sectors_of_quads(of, 2);
    let faces = &net.faces[..net.faces.len() / of * sectors];
    let used: BTreeSet<usize> = faces.iter().flatten().copied().collect();
    let number = |v: &usize| used.range(..v).count();
    Net {
        positions: used.iter().map(|&v| net.positions[v]).collect(),
        faces: faces.iter().map(|face| face.iter().map(number).collect()).collect(),
    }
}

/// Returns the normal of vertex 0 in the first face at it.
fn of_first(claimed: &[Vec<(usize, [f64; 3])>]) -> [f64; 3] {
    claimed.iter().flatten().find(|(v, _)| *v == 0).expect("a face at the first vertex").1
}

/// Returns the two neighbours of vertex 0 on the boundary.
fn beside_first(net: &Net) -> [usize; 2] {
    let near = net.edges().into_iter().filter(|(a, b)| {
        let both = |face: &&Vec<usize>| face.contains(a) && face.contains(b);
        *a == 0 && net.faces.iter().filter(both).count() == 1
    });
    near.map(|(_, b)| b).collect::<Vec<_>>().try_into().expect("two on the boundary")
}

/// If the eigenvalue 1/2 of the boundary occurs again inside, in a Jordan chain, normals converge to that of the
/// tangent along the boundary and the other tangent inside. At a single face under `UCP` with delta 1, the eigenvalue
/// 1/4 has a chain of three.
#[test]
fn vertices_on_the_boundary_have_limit_normals_where_eigenvalues_have_chains() {
    for (net, plan, reach) in [
        (part(4, 8), edge_only(&catmull_clark()), 1),
        (nets::triangulated(part(3, 6)), edge_only(&json!({ "preset": "loop" })), 1),
        (part(1, 6), edge_only(&json!({ "word": "UCP", "parameters": { "delta": 1 } })), 2),
    ] {
        let tagged = tagged(net.clone(), &[]);
        let (coarse, warnings) = sides(&tagged, &plan, 0, "limit");
        assert!(warnings.is_empty(), "{plan}: {warnings:?}");
        let normal = of_first(&coarse);
        let [p, q] = beside_first(&net).map(|v| net.positions[v]);
        let across: f64 = (0..3).map(|k| normal[k] * (p[k] - q[k])).sum();
        // these two determine the direction of the boundary
        assert!(reach > 1 || across.abs() <= 1e-9, "{plan}: {normal:?} is not upright on the boundary: {across}");
        for levels in [1, 2] {
            let off = distance(&normal, &of_first(&sides(&tagged, &plan, levels, "limit").0));
            assert!(off < 1e-8, "{plan}: the normal turns by {off} at level {levels}");
        }
        let of_faces = |levels| distance(&normal, &of_first(&sides(&tagged, &plan, levels, "area").0));
        let [early, late] = [of_faces(3), of_faces(6)];
        assert!(late < 0.8 * early, "{plan}: area normals are {early}, then {late} away");
    }
}

/// From five faces on, points inside converge more slowly than those along the boundary, which do not determine the
/// faces there: there is no tangent plane, and rounding must not make one.
#[test]
fn vertices_on_the_boundary_with_more_faces_have_none() {
    for plan in [catmull_clark(), json!({ "word": "UCC" }), json!({ "word": "UCP", "parameters": { "delta": 0.5 } })] {
        for n in 5..10 {
            let (_, warnings) = sides(&tagged(part(n, 2 * n), &[]), &edge_only(&plan), 0, "limit");
            let place = format!("no tangent plane at a boundary vertex with {n} faces");
            assert!(warnings.iter().any(|warning| warning.ends_with(&place)), "{plan}: {warnings:?} for {place}");
        }
    }
}

/// The normals of the input's vertices are the same at every level.
#[test]
fn limit_normals_of_sides_do_not_turn_under_more_levels() {
    for plan in plans() {
        let tagged = tagged(nets::cube(), &[[4, 5], [5, 7], [5, 1], [1, 0]]);
        let (coarse, _) = sides(&tagged, &plan, 0, "limit");
        for levels in [1, 2] {
            let (fine, warnings) = sides(&tagged, &plan, levels, "limit");
            assert!(warnings.is_empty(), "{warnings:?}");
            let share = fine.len() / coarse.len();
            for (f, face) in coarse.iter().enumerate() {
                for (v, normal) in face {
                    let here = fine[f * share..(f + 1) * share].iter().flatten().find(|(u, _)| u == v);
                    let off = distance(normal, &here.expect("vertices stay in their faces").1);
                    assert!(off < 1e-8, "{plan}: the normal of vertex {v} in face {f} turns by {off}");
                }
            }
        }
    }
}

/// Edges that are sharp for some levels only are smooth in the limit: one normal per vertex.
#[test]
fn sharpness_that_ends_parts_no_limit_normals() {
    let mut input = nets::torus(4, 5).input();
    input["mesh"]["creases"] = json!(RING.map(|edge| json!({ "edge": edge, "sharpness": 3.5 })));
    let count = |normals: &str| {
        let job = json!({ "input": input, "plan": catmull_clark(), "levels": 2,
            "outputs": [{ "format": "obj", "normals": normals }] });
        let text = String::from_utf8(render(&job).expect("a result").0).expect("OBJ is text");
        text.lines().filter(|line| line.starts_with("vn ")).count()
    };
    assert_eq!([count("limit"), count("area")], [320, 320 + 16]);
}

/// A sector without a tangent plane has an area normal; all others keep theirs, and the warning counts it.
#[test]
fn only_sectors_without_a_tangent_plane_have_area_normals() {
    let mut cone = tagged(nets::torus(4, 5), &RING);
    cone.corners = vec![9];
    let (claimed, warnings) = sides(&cone, &catmull_clark(), 1, "limit");
    assert_eq!(warnings.len(), 1, "{warnings:?}");
    assert!(warnings[0].starts_with("at 1 of 80 vertices"), "{warnings:?}");
    assert!(warnings[0].ends_with("no tangent plane at a corner with 4 faces"), "{warnings:?}");
    let (area, _) = sides(&cone, &catmull_clark(), 1, "area");
    let mut same = 0;
    for ((v, normal), (u, area)) in claimed.iter().flatten().zip(area.iter().flatten()) {
        assert_eq!(v, u);
        let agree = distance(normal, area) <= 0.0;
        assert!(*v != 9 || agree, "the corner has {normal:?}, not {area:?}");
        same += usize::from(agree);
    }
    assert_eq!(same, 4, "only the corner has an area normal, in four faces");
    // a crease across a corner with three faces on either side
    let (net, _) = nets::sectors_of_quads(6, 2);
    let beyond = |a: usize| {
        let after = |face: &&Vec<usize>| (0..4).any(|i| face[i] == 0 && face[(i + 1) % 4] == a);
        let face = net.faces.iter().find(after).expect("a face beside each edge");
        face[(face.iter().position(|&v| v == 0).expect("the vertex") + 3) % 4]
    };
    let first = net.edges().into_iter().find(|edge| edge.0 == 0).expect("an edge").1;
    let mut parted = tagged(net.clone(), &[[0, first], [0, beyond(beyond(beyond(first)))]]);
    parted.corners = vec![0];
    let (_, warnings) = sides(&parted, &catmull_clark(), 0, "limit");
    assert!(warnings[0].contains("one side of the sharp edges at a corner with 6 faces"), "{warnings:?}");
}

/// At corners with two quads or three triangles, an eigenvalue is triple, and points converge to the plane of the two
/// edges that remain.
#[test]
fn corners_of_two_quads_or_three_triangles_touch_the_plane_of_their_edges() {
    let rim = [[1.0, 0.0, 0.0], [1.0, 1.2, 0.3], [-0.2, 1.0, 0.1], [-1.0, 0.4, 0.5]];
    let fan = Net {
        positions: [[0.0; 3]].into_iter().chain(rim).collect(),
        faces: (1..4).map(|i| vec![0, i, i + 1]).collect(),
    };
    let lifted = |mut net: Net| {
        net.positions.iter_mut().enumerate().for_each(|(i, p)| p[2] += [0.0, 0.3, -0.2, 0.4, 0.1][i % 5]);
        net
    };
    for (net, plan) in [
        (lifted(part(2, 5)), catmull_clark()),
        (lifted(part(2, 9)), json!({ "word": "UC" })),
        (fan, json!({ "preset": "loop" })),
    ] {
        let mut corner = tagged(net.clone(), &[]);
        corner.corners = vec![0];
        let (coarse, warnings) = sides(&corner, &edge_only(&plan), 0, "limit");
        assert!(warnings.is_empty(), "{plan}: {warnings:?}");
        let normal = of_first(&coarse);
        for b in beside_first(&net) {
            let across: f64 = (0..3).map(|k| normal[k] * (net.positions[b][k] - net.positions[0][k])).sum();
            assert!(across.abs() <= 1e-9, "{plan}: {normal:?} is not upright on the edge to {b}: {across}");
        }
        let of_faces = |levels| distance(&normal, &of_first(&sides(&corner, &edge_only(&plan), levels, "area").0));
        let [early, late] = [of_faces(2), of_faces(6)];
        assert!(late < 0.85 * early, "{plan}: area normals are {early}, then {late} away");
    }
}

/// The formats split vertices alike, with and without texture coordinates; JSON has one normal per vertex, the mean of
/// its sides.
#[test]
fn formats_agree_on_limit_normals_of_sides() {
    let net = nets::torus(4, 5);
    let both: Vec<[usize; 2]> = RING.into_iter().chain(ACROSS).collect();
    let (claimed, _) = sides(&tagged(net.clone(), &both), &catmull_clark(), 1, "limit");
    let mut input = net.input();
    input["mesh"]["creases"] = both.iter().map(|edge| json!({ "edge": edge, "sharpness": 10 })).collect();
    let values: Vec<[f64; 2]> = net.positions.iter().map(|p| [p[0] / 8.0, p[1] / 8.0]).collect();
    // one seam, along a part of a crease
    let mut places = net.faces.clone();
    let cut = places.iter_mut().find(|face| face.contains(&0) && face.contains(&1)).expect("a face at the edge");
    cut.iter_mut().filter(|v| **v < 2).for_each(|v| *v += net.positions.len());
    let values = [values.clone(), vec![[0.5, 0.5], [0.75, 0.5]]].concat();
    let with = |uvs: bool, output: Value| {
        let mut input = input.clone();
        if uvs {
            input["mesh"]["uvs"] = json!({ "values": values, "faces": places });
        }
        let job = json!({ "input": input, "plan": catmull_clark(), "levels": 1, "outputs": [output] });
        String::from_utf8(render(&job).unwrap_or_else(|faults| panic!("{faults:?}")).0).expect("the format is text")
    };
    for uvs in [false, true] {
        let ply = with(uvs, json!({ "format": "ply", "ascii": true, "normals": "limit" }));
        let head: Vec<&str> = ply.lines().take_while(|line| *line != "end_header").collect();
        let count = head.iter().find_map(|line| line.strip_prefix("element vertex ")).expect("a count");
        let n: usize = count.parse().expect("a number");
        let rows: Vec<Vec<f64>> = ply
            .lines()
            .skip(head.len() + 1)
            .map(|line| line.split(' ').map(|x| x.parse().expect("a number")).collect())
            .collect();
        for (face, row) in claimed.iter().zip(&rows[n..]) {
            for ((v, normal), &at) in face.iter().zip(&row[1..=4]) {
                #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "an index of a small mesh")]
                let found = &rows[at as usize][3..6];
                assert_eq!(found, normal, "uvs {uvs}: vertex {v}");
            }
        }
    }
    let json: Value =
        serde_json::from_str(&with(false, json!({ "format": "json", "normals": "limit" }))).expect("JSON");
    let means: Vec<[f64; 3]> = serde_json::from_value(json["normals"].clone()).expect("normals");
    for v in [0, 1, 4] {
        let mut all: Vec<[f64; 3]> =
            claimed.iter().flatten().filter(|(u, _)| *u == v).map(|(_, normal)| *normal).collect();
        all.sort_by(|a, b| a.partial_cmp(b).expect("numbers"));
        all.dedup();
        assert_eq!(all.len(), if v == 0 { 4 } else { 2 });
        let sum = all.iter().fold([0.0; 3], |sum: [f64; 3], normal| [0, 1, 2].map(|k| sum[k] + normal[k]));
        let length = sqrt(sum.iter().map(|x| x * x).sum());
        assert!(distance(&means[v], &sum.map(|x| x / length)) < 1e-14, "vertex {v}");
    }
}
