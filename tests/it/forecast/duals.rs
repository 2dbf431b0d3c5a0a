//! C1: estimates count, and do not build. Forecasts of words with D equal the nets that the operators make, on any
//! mesh.

use planish::job::Input;
use planish::job::limits::{Limits, Refusal};
use planish::refine::mesh_net;
use planish::scheme::extent::Ends;
use planish::scheme::forecast::{Count, ForecastError, MAX_FORECAST_BYTES, of_mesh};
use planish::scheme::mesh_net::MeshNet;
use planish::scheme::operator::Role;
use planish::scheme::plan::{Plan, Scheduled};
use planish::scheme::step_error::StepError;
use planish::scheme::stepper::Stepper;
use planish::scheme::tags::Boundary;
use planish::watch::{Stopped, Watch};
use proptest::prelude::*;
use serde_json::json;

use crate::support::nets::{self, Net};
use crate::support::{parsed, peak};

/// Maximum number of corners up to which nets are built.
const MAX_CORNERS: usize = 12_000;
const CAP: u128 = 1 << 40;

/// Returns the counts of a net from its topology.
fn counted(net: &MeshNet) -> Count {
    let topology = net.mesh.topology();
    let fan = |v: usize| topology.ring(v).count() + if topology.boundary_edges(v).is_some() { 2 } else { 0 };
    Count {
        vertices: topology.n_vertices() as u128,
        edges: topology.n_edges() as u128,
        faces: topology.n_faces() as u128,
        corners: topology.n_half_edges() as u128,
        largest_face: (0..topology.n_faces()).map(|f| topology.face(f).len()).max().unwrap_or(0) as u128,
        largest_fan: (0..topology.n_vertices()).map(fan).max().unwrap_or(0) as u128,
        ..Count::default()
    }
}

/// Returns the counts of the net after each step of the operators, and the steps that were small enough.
fn built<'a>(net: &MeshNet, steps: &'a [Scheduled]) -> (Vec<Count>, &'a [Scheduled], Option<(u32, StepError)>) {
    let (mut net, mut counts) = (net.clone(), vec![counted(net)]);
    let plan = Plan::none(Boundary::default(), Ends::default());
    for (i, step) in steps.iter().enumerate() {
        let role = step.letter.facts().role;
        let growth = if role == Role::Upsample {
            step.letter.settings.pieces(net.mesh.topology().is_quads()).pow(2) as usize
        } else {
            1
        };
        if net.mesh.topology().n_half_edges() * growth > MAX_CORNERS {
            return (counts, &steps[..i], None);
        }
        match Stepper::new(&plan).next_from(&net, step, None) {
            Ok(next) => net = next.net,
            Err(error) => return (counts, &steps[..=i], Some((step.level, error))),
        }
        counts.push(counted(&net));
    }
    (counts, steps, None)
}

/// Compares the forecast with the built net after every step; each step is the last one once.
fn check(net: &Net, word: &str, split: &str, levels: u32) -> Result<(), TestCaseError> {
    let plan = json!({ "word": word, "parameters": { "kernel": 0.8, "delta": 0.4, "split": split } });
    let text = json!({ "input": net.input(), "plan": plan, "levels": levels, "outputs": [{ "format": "json" }] });
    let Ok(job) = parsed(text.to_string().as_bytes()) else { return Ok(()) };
    let Input::Mesh(mesh) = &*job.input else { unreachable!("the input is a mesh") };
    let (start, steps) = (mesh_net(mesh, &job.plan), job.plan.schedule(levels).expect("the functions are constants"));
    let (counts, steps, error) = built(&start, &steps);
    for n in 0..=steps.len() {
        let found = of_mesh(&start, &steps[..n], CAP, &Watch::new());
        if n == counts.len() {
            let (level, error) = error.clone().expect("a step without a count failed");
            prop_assert_eq!(found, Err(ForecastError::Step { level, error }), "{} {}", word, text);
            continue;
        }
        let found = found.map_err(|error| TestCaseError::fail(format!("{error} after {n} steps of {word}: {text}")))?;
        let last = *found.levels.last().expect("level 0");
        prop_assert_eq!(last, counts[n], "after {} steps of {}: {}", n, word, text);
        prop_assert_eq!(found.work, counts[1..=n].iter().map(|count| count.vertices).sum::<u128>());
        prop_assert_eq!(found.peak.vertices, counts[..=n].iter().map(|c| c.vertices).max().expect("level 0"));
    }
    Ok(())
}

/// Joins meshes side by side.
fn together(nets: Vec<Net>) -> Net {
    let mut all = Net::default();
    for net in nets {
        let first = all.positions.len();
        all.positions.extend(net.positions);
        all.faces.extend(net.faces.into_iter().map(|face| face.into_iter().map(|v| v + first).collect()));
    }
    all
}

/// Returns a grid without some of its faces: holes, narrow strips, corners that meet.
fn perforated() -> impl Strategy<Value = Net> {
    (1..7_usize, 1..7_usize, proptest::collection::vec(any::<prop::sample::Index>(), 0..8)).prop_map(|(n, m, holes)| {
        let mut net = nets::grid(n, m);
        for hole in holes.into_iter().take(net.faces.len() - 1) {
            let hole = hole.index(net.faces.len());
            net.faces.remove(hole);
        }
        net
    })
}

/// Returns fans of triangles or quads around one vertex, which may be pinched there.
fn pinched() -> impl Strategy<Value = Net> {
    (3..8_usize, 1..3_usize, any::<u8>()).prop_map(|(n, rings, missing)| {
        let (mut net, _) = nets::sectors_of_quads(n, rings);
        let sector = rings * rings;
        let keep = |f: usize| f < sector || missing >> (f / sector % 8) & 1 == 0;
        net.faces = net.faces.into_iter().enumerate().filter(|(f, _)| keep(*f)).map(|(_, face)| face).collect();
        net
    })
}

/// Returns polygons glued back to back along some of their edges, so that vertices have two faces only.
fn pillow() -> impl Strategy<Value = Net> {
    (3..7_usize, 0..3_usize).prop_map(|(n, more)| {
        let mut positions = nets::prism(n).positions[..n].to_vec();
        let mut back: Vec<usize> = (0..n).rev().collect();
        for i in 0..more {
            positions.push([0.5, 0.5, 2.0 + f64::from(u8::try_from(i).expect("small"))]);
            back.insert(1, n + i);
        }
        Net { positions, faces: vec![(0..n).collect(), back] }
    })
}

fn any_net() -> impl Strategy<Value = Net> {
    let one = prop_oneof![
        3 => nets::manifold(),
        3 => perforated(),
        1 => pinched(),
        1 => pillow(),
        1 => nets::triangle_manifold(),
        1 => (1..9_usize).prop_map(|n| nets::grid(n, 1)),
        1 => (3..6_usize, 2..4_usize).prop_map(|(n, m)| nets::cylinder(n, m)),
        1 => Just(nets::mixed()),
    ];
    prop_oneof![3 => one.clone(), 1 => proptest::collection::vec(one, 1..4).prop_map(together)]
}

fn triangles() -> impl Strategy<Value = Net> {
    prop_oneof![
        nets::triangle_manifold(),
        perforated().prop_map(nets::triangulated),
        Just(nets::octahedron()),
        proptest::collection::vec(nets::triangle_manifold(), 1..3).prop_map(together),
    ]
}

/// Returns words with at least one D.
fn words() -> impl Strategy<Value = String> {
    let letters = prop::sample::select(vec!["U", "U", "U", "U3", "U4", "D", "D", "D", "C", "P"]);
    let common =
        prop::sample::select(vec!["UD", "UDD", "UDDD", "UCD", "DU", "U3D", "DDU(UD)", "UUD(UDD)", "UDDP", "D"]);
    let random = (proptest::collection::vec(letters.clone(), 0..4), proptest::collection::vec(letters, 1..6));
    let random = random.prop_map(|(prefix, cycle)| {
        let (prefix, cycle) = (prefix.concat(), cycle.concat());
        if prefix.is_empty() { cycle } else { format!("{prefix}({cycle})") }
    });
    prop_oneof![2 => common.prop_map(str::to_owned), 3 => random].prop_filter("it has a D", |word| word.contains('D'))
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 256, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn c1_counts_after_each_d_are_as_built(net in any_net(), word in words(), levels in 1..6_u32) {
        check(&net, &word, "quad", levels)?;
    }

    #[test]
    fn c1_counts_of_triangles_after_each_d_are_as_built(net in triangles(), word in words(), levels in 1..5_u32) {
        check(&net, &word, "triangle", levels)?;
    }
}

fn open_grid(word: &str, levels: u32) -> (MeshNet, Vec<Scheduled>) {
    let text = json!({
        "input": nets::grid(3, 3).input(), "plan": { "word": word }, "levels": levels,
        "outputs": [{ "format": "json" }],
    });
    let job = parsed(text.to_string().as_bytes()).expect("a job");
    let Input::Mesh(mesh) = &*job.input else { unreachable!("the input is a mesh") };
    (mesh_net(mesh, &job.plan), job.plan.schedule(levels).expect("no functions"))
}

/// A grid of n x n quads becomes one of 2 n - k under U and k times D: too large to be built for a forecast.
#[test]
fn c1_estimates_count_and_do_not_build() {
    for (word, lost, levels, kept) in [("UD", 1, 20, 1 << 20), ("UDD", 2, 12, 32 << 20), ("UD", 1, 40, 1 << 20)] {
        let (net, steps) = open_grid(word, levels);
        let (found, taken) = peak(|| of_mesh(&net, &steps, CAP << 60, &Watch::new()));
        let last = *found.expect("it can be counted").levels.last().expect("level 0");
        let side = (0..levels).fold(3_u128, |n, _| 2 * n - lost);
        assert_eq!([last.vertices, last.faces], [(side + 1) * (side + 1), side * side], "{word}");
        assert!(taken < kept, "{word} {levels}: {taken} bytes");
    }
}

#[test]
fn c1_what_cannot_be_counted_within_the_bound_is_refused_without_being_made() {
    let (net, steps) = open_grid("UDD", 18);
    let (found, taken) = peak(|| of_mesh(&net, &steps, CAP, &Watch::new()));
    let Err(error) = found else { panic!("18 levels of UDD have a long boundary: {found:?}") };
    let ForecastError::Bytes { bytes, bound, .. } = error else { panic!("{error}") };
    assert!(bytes > bound && bound == MAX_FORECAST_BYTES);
    assert!(u128::from(taken) <= bound, "{taken} bytes");
}

#[test]
fn c1_a_forecast_that_nobody_waits_for_stops() {
    for word in ["UD", "UDD", "D"] {
        let (net, steps) = open_grid(word, 9);
        let watch = Watch::new();
        watch.stop();
        assert_eq!(of_mesh(&net, &steps, CAP, &watch), Err(ForecastError::Stopped(Stopped)), "{word}");
    }
}

#[test]
fn c1_a_refusal_names_the_level_the_bytes_the_bound_and_the_remedy() {
    let text = json!({
        "input": nets::grid(3, 3).input(), "plan": { "word": "UDD" }, "levels": 18, "outputs": [{ "format": "json" }],
    });
    let job = parsed(text.to_string().as_bytes()).expect("a job");
    let limits = Limits { max_vertices: u64::MAX >> 8, ..Limits::default() };
    let Err(Refusal::TooLarge { detail, faults }) = limits.estimate(&job) else { panic!("its boundary is too long") };
    assert!(
        detail.starts_with("level ") && detail.contains("a forecast may take 64.0 MiB; ask for at most"),
        "{detail}"
    );
    assert_eq!(faults[0].pointer, "/levels");
    let watch = Watch::new();
    watch.stop();
    assert_eq!(limits.estimate_under(&job, &watch), Err(Refusal::Stopped));
}
