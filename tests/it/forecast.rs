//! The forecast equals the result: counts of every level and bytes of every format, for random plans and nets.

use planish::job::limits::{Limits, Refusal};
use planish::job::{Input, Job};
use planish::output::{FORMATS, Format, ShapeKind, Size};
use planish::refine::{refine_mesh, refine_polygon};
use planish::scheme::forecast::{Count, Forecast};
use planish::watch::Watch;
use proptest::prelude::*;
use serde_json::{Value, json};

use crate::support::nets::{self, Net};
use crate::support::{parsed, render};

mod duals;
mod memory;

/// Upper bound of the number of vertices up to which further levels are tested.
const MAX_VERTICES: u128 = 1500;

/// The letters of the prefix, and of the cycle.
type Word = (String, String);

/// The properties of the input that decide whether a word may contain a P.
#[derive(Debug, Clone, Copy)]
struct Subject {
    /// Whether every average loses end points.
    natural: bool,
    /// Whether D loses the boundary.
    open_mesh: bool,
}

/// Returns random words, without the letters P that are illegal for the subject.
fn words(subject: Subject) -> impl Strategy<Value = Word> {
    let letters = |most| proptest::collection::vec(prop::sample::select(vec!['U', 'U', 'C', 'D', 'P']), 0..most);
    (letters(4), letters(5)).prop_map(move |(prefix, cycle)| {
        let (mut prefix, mut cycle): (String, String) = (prefix.iter().collect(), cycle.iter().collect());
        if cycle.is_empty() {
            cycle.push('U');
        }
        if !is_legal(&format!("{prefix}{cycle}{cycle}"), subject) {
            prefix.retain(|letter| letter != 'P');
            cycle.retain(|letter| letter != 'P');
        }
        if cycle.is_empty() {
            cycle.push('C');
        }
        (prefix, cycle)
    })
}

/// Whether each P has a U before it, an even number of D in between, and all children of the net that entered that U.
fn is_legal(letters: &str, subject: Subject) -> bool {
    let mut since_upsampling: Option<(u32, bool)> = None;
    letters.chars().all(|letter| {
        match (letter, &mut since_upsampling) {
            ('U', state) => *state = Some((0, false)),
            ('P', state) => {
                return *state == Some((0, false)) || state.is_some_and(|(duals, lost)| duals % 2 == 0 && !lost);
            }
            ('D', Some((duals, lost))) => {
                *duals += 1;
                *lost |= subject.natural || subject.open_mesh;
            }
            ('C', Some((_, lost))) => *lost |= subject.natural,
            _ => {}
        }
        true
    })
}

fn text((prefix, cycle): &Word) -> String {
    if prefix.is_empty() { cycle.clone() } else { format!("{prefix}({cycle})") }
}

/// Returns a job; its word is legal by construction, so that the plan must be accepted.
fn job(input: &Value, word: &Word, extra: &Value, levels: u32, output: &Value) -> Result<Job, TestCaseError> {
    let text = job_text(input, word, extra, levels, output).to_string();
    parsed(text.as_bytes()).map_err(|faults| TestCaseError::fail(format!("{faults:?} for {text}")))
}

fn job_text(input: &Value, word: &Word, extra: &Value, levels: u32, output: &Value) -> Value {
    let mut plan = json!({ "word": text(word), "parameters": { "kernel": 0.8, "delta": 0.4 } });
    for (name, value) in extra.as_object().expect("an object") {
        plan[name] = value.clone();
    }
    json!({ "input": input, "plan": plan, "levels": levels, "outputs": [output] })
}

/// Returns the counts of a JSON output, also `corners`; it does not show hidden elements.
fn counted(bytes: &[u8]) -> Count {
    let result: Value = serde_json::from_slice(bytes).expect("the json output is JSON");
    let mut count = Count::default();
    if result["positions"].is_array() {
        let net = Net::of(&result);
        count.vertices = net.positions.len() as u128;
        count.edges = net.edges().len() as u128;
        count.faces = net.faces.len() as u128;
        count.corners = net.faces.iter().map(|face| face.len() as u128).sum();
        count.largest_face = net.faces.iter().map(|face| face.len() as u128).max().unwrap_or(0);
        return count;
    }
    let one = std::slice::from_ref(&result);
    for polygon in result["polygons"].as_array().map_or(one, |many| many) {
        let n = polygon["points"].as_array().expect("points").len() as u128;
        count.vertices += n;
        count.edges += if polygon["closed"] == true { n } else { n - 1 };
    }
    count
}

/// Returns the forecast of a job, or `None` if an operator cannot be applied, which refinement then reports as well.
fn forecast(job: &Job) -> Result<Option<Forecast>, TestCaseError> {
    match Limits::default().estimate(job) {
        Ok(estimate) => Ok(Some(estimate.forecast)),
        Err(Refusal::TooLarge { detail, .. }) => Err(TestCaseError::reject(detail)),
        Err(Refusal::Stopped) => unreachable!("nothing stops it"),
        Err(Refusal::Impossible(faults)) => {
            let steps = job.plan.schedule(job.levels).expect("the functions are constants");
            let watch = Watch::new();
            let refused = match &*job.input {
                Input::Mesh(mesh) => refine_mesh(mesh, &job.plan, &steps, &watch).is_err(),
                Input::Polygons(polygons) => {
                    polygons.iter().any(|polygon| refine_polygon(polygon, &job.plan, &steps, &watch).is_err())
                }
            };
            prop_assert!(refused, "refused only by the forecast: {:?}", faults);
            Ok(None)
        }
    }
}

fn check(input: &Value, word: &Word, extra: &Value) -> Result<(), TestCaseError> {
    let output = json!({ "format": "json" });
    for levels in 0..=3 {
        let Some(forecast) = forecast(&job(input, word, extra, levels, &output)?)? else { break };
        prop_assert_eq!(forecast.levels.len(), levels as usize + 1);
        let last = forecast.levels[levels as usize];
        prop_assert!(forecast.levels.iter().all(|count| count.vertices <= forecast.peak.vertices));
        if forecast.peak.vertices > MAX_VERTICES {
            break;
        }
        let text = job_text(input, word, extra, levels, &output);
        let (bytes, _) = render(&text).map_err(|faults| TestCaseError::fail(format!("{faults:?} for {text}")))?;
        let actual = counted(&bytes);
        prop_assert_eq!(last.vertices, actual.vertices, "vertices of {}", text);
        prop_assert_eq!(last.faces - last.hidden_faces, actual.faces, "faces of {}", text);
        prop_assert_eq!(last.corners - last.hidden_corners, actual.corners, "corners of {}", text);
        if actual.faces > 0 {
            prop_assert_eq!(last.largest_face, actual.largest_face, "the largest face of {}", text);
        }
        if last.hidden_faces == 0 {
            prop_assert_eq!(last.edges, actual.edges, "edges of {}", text);
        }
    }
    Ok(())
}

/// Compares the length of every format that can hold the result with the forecast.
fn check_bytes(input: &Value, word: &Word, extra: &Value, levels: u32) -> Result<usize, TestCaseError> {
    let mut compared = 0;
    for format in FORMATS {
        for options in options(*format) {
            let text = job_text(input, word, extra, levels, &options);
            let Ok(job) = parsed(text.to_string().as_bytes()) else {
                continue; // the format cannot hold this kind of shape
            };
            let Some(forecast) = forecast(&job)? else { return Ok(compared) };
            if forecast.peak.vertices > MAX_VERTICES {
                return Ok(compared);
            }
            let estimate = Limits::default().estimate(&job).expect("it was just made");
            compared += 1;
            let bytes = match render(&text) {
                Ok((bytes, _)) => bytes,
                // hidden faces are known only after refinement
                Err(faults) if faults[0].detail.starts_with("no face is shown") => continue,
                Err(faults) => return Err(TestCaseError::fail(format!("{faults:?} for {text}"))),
            };
            match estimate.outputs[0].1 {
                Size::Exact(n) => prop_assert_eq!(n, bytes.len() as u128, "{}", text),
                Size::AtMost(n) => prop_assert!(bytes.len() as u128 <= n, "{} > {}: {}", bytes.len(), n, text),
            }
        }
    }
    Ok(compared)
}

fn options(format: &dyn Format) -> Vec<Value> {
    let name = format.name();
    match name {
        "json" => vec![
            json!({ "format": name }),
            json!({ "format": name, "sections": planes() }),
            json!({ "format": name, "isolines": true }),
            json!({ "format": name, "cage": true }),
        ],
        "svg" | "pdf" => vec![
            json!({ "format": name, "width": 32, "height": 24 }),
            json!({ "format": name, "width": 32, "height": 24, "sections": planes() }),
            json!({ "format": name, "show": everything(), "fill": "#abc", "title": "\\alpha_0 '\"<>&" }),
            json!({ "format": name, "show": everything(), "styles": [{ "dash": "dash-dot", "label": "x" }] }),
        ],
        "png" => vec![json!({ "format": name, "width": 32, "height": 24 })],
        "apng" => vec![json!({ "format": name, "width": 32, "height": 24, "frames": 3 })],
        "ply" => vec![json!({ "format": name }), json!({ "format": name, "ascii": true })],
        "obj" => vec![json!({ "format": name }), json!({ "format": name, "normals": "area" })],
        _ => vec![json!({ "format": name })],
    }
}

fn everything() -> Value {
    json!(["curve", "control", "points", "vertices", "comb", "tangents", "axes", "grid", "legend"])
}

fn planes() -> Value {
    json!([{ "point": [0.7, 0.5, 0.3], "normal": [0.1, 0, 1] }, { "point": [1, 1, 0], "normal": [1, 1, 1] }])
}

fn polygon() -> impl Strategy<Value = Value> {
    (proptest::collection::vec(proptest::array::uniform2(-9.0..9.0_f64), 3..9), any::<bool>())
        .prop_map(|(points, closed)| json!({ "points": points, "closed": closed }))
}

const CLAMPED: Subject = Subject { natural: false, open_mesh: false };
const NATURAL: Subject = Subject { natural: true, open_mesh: false };
const OPEN_MESH: Subject = Subject { natural: false, open_mesh: true };

fn closed_mesh() -> impl Strategy<Value = Net> {
    prop_oneof![
        Just(nets::cube()),
        Just(nets::tetrahedron()),
        (3..6_usize, 3..5_usize).prop_map(|(n, m)| nets::torus(n, m)),
        (3..8_usize).prop_map(nets::prism),
    ]
}

/// Returns a mesh with some of its faces as holes, and the boundary rule of a plan.
fn tagged_mesh() -> impl Strategy<Value = (Value, Value)> {
    let rule = prop::sample::select(vec!["edge-and-corner", "edge-only", "none"]);
    (nets::manifold(), proptest::collection::vec(any::<prop::sample::Index>(), 0..4), rule).prop_map(
        |(net, holes, rule)| {
            let mut mesh = net.to_json();
            mesh["holes"] = holes.iter().map(|hole| hole.index(net.faces.len())).collect();
            mesh["corners"] = json!([{ "vertex": 0, "sharpness": 10 }]);
            (json!({ "mesh": mesh }), json!({ "boundary": rule }))
        },
    )
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 96, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn counts_of_polygons_are_as_forecast(polygon in polygon(), word in words(CLAMPED)) {
        check(&json!({ "polygon": polygon }), &word, &json!({}))?;
    }

    #[test]
    fn counts_of_polygons_with_natural_ends_are_as_forecast(polygon in polygon(), word in words(NATURAL)) {
        check(&json!({ "polygon": polygon }), &word, &json!({ "ends": "natural" }))?;
    }

    #[test]
    fn counts_of_several_polygons_are_as_forecast(
        polygons in proptest::collection::vec(polygon(), 1..4), word in words(CLAMPED),
    ) {
        check(&json!({ "polygons": polygons }), &word, &json!({}))?;
    }

    #[test]
    fn counts_of_steps_that_are_not_linear_are_as_forecast(
        polygons in proptest::collection::vec(polygon(), 1..4), levels in 0..5_u32,
    ) {
        let text = json!({
            "input": { "polygons": polygons }, "plan": { "preset": "incenter" }, "levels": levels,
            "outputs": [{ "format": "json" }],
        });
        let job = parsed(text.to_string().as_bytes()).expect("a job");
        let estimate = Limits::default().estimate(&job).expect("it is small");
        let (bytes, _) = render(&text).expect("it can be refined");
        let actual = counted(&bytes);
        prop_assert_eq!(*estimate.forecast.levels.last().expect("level 0"), actual);
        prop_assert_eq!(estimate.forecast.peak, actual);
        prop_assert!(estimate.outputs[0].1.bytes() >= bytes.len() as u128);
    }

    #[test]
    fn counts_of_meshes_are_as_forecast(net in nets::manifold(), word in words(OPEN_MESH)) {
        check(&net.input(), &word, &json!({}))?;
    }

    #[test]
    fn counts_of_closed_meshes_are_as_forecast(net in closed_mesh(), word in words(CLAMPED)) {
        check(&net.input(), &word, &json!({}))?;
    }

    #[test]
    fn counts_with_holes_are_as_forecast((input, extra) in tagged_mesh(), mut word in words(CLAMPED)) {
        // D carries no tags
        word.0.retain(|letter| letter != 'D');
        word.1 = word.1.replace('D', "C");
        prop_assume!(is_legal(&format!("{}{}{}", word.0, word.1, word.1), CLAMPED));
        check(&input, &word, &extra)?;
    }
}

/// Returns the word with arities at its letters U.
fn with_arities((prefix, cycle): &Word, arities: &[u32]) -> Word {
    let mut next = arities.iter().cycle();
    let mut write = |word: &str| {
        let letter = |c: char| if c == 'U' { format!("U{}", next.next().expect("endless")) } else { c.to_string() };
        word.chars().map(letter).collect::<String>()
    };
    (write(prefix), write(cycle))
}

fn arities() -> impl Strategy<Value = Vec<u32>> {
    proptest::collection::vec(2..6_u32, 1..4)
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 96, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn counts_of_any_arity_are_as_forecast(
        (input, extra) in tagged_mesh(), word in words(CLAMPED), arities in arities(),
    ) {
        // D carries no tags
        let word = (word.0.replace('D', ""), word.1.replace('D', "C"));
        prop_assume!(is_legal(&format!("{}{}{}", word.0, word.1, word.1), CLAMPED));
        check(&input, &with_arities(&word, &arities), &extra)?;
    }

    #[test]
    fn counts_of_any_arity_with_duals_are_as_forecast(
        net in nets::manifold(), word in words(OPEN_MESH), arities in arities(),
    ) {
        check(&net.input(), &with_arities(&word, &arities), &json!({}))?;
    }

    #[test]
    fn counts_of_triangles_are_as_forecast(
        net in nets::triangle_manifold(), word in words(OPEN_MESH), arities in arities(),
    ) {
        check_triangles(&net.input(), &with_arities(&word, &arities))?;
    }

    #[test]
    fn counts_of_closed_triangles_are_as_forecast(
        net in closed_mesh(), word in words(CLAMPED), arities in arities(),
    ) {
        check_triangles(&nets::triangulated(net).input(), &with_arities(&word, &arities))?;
    }
}

fn check_triangles(input: &Value, word: &Word) -> Result<(), TestCaseError> {
    check(input, word, &json!({ "parameters": { "kernel": 0.8, "delta": 0.4, "split": "triangle" } }))
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 24, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn bytes_of_polygons_are_as_forecast(polygon in polygon(), levels in 0..4_u32) {
        let compared = check_bytes(&json!({ "polygon": polygon }), &(String::new(), "UC".into()), &json!({}), levels)?;
        let holding = FORMATS.iter().filter(|format| format.holds(ShapeKind::Curves { dimension: 2 }).is_ok());
        prop_assert!(compared >= holding.count());
    }

    #[test]
    fn bytes_of_meshes_are_as_forecast((input, extra) in tagged_mesh(), levels in 0..3_u32) {
        let compared = check_bytes(&input, &(String::new(), "UCP".into()), &extra, levels)?;
        let holding = FORMATS.iter().filter(|format| format.holds(ShapeKind::Mesh).is_ok());
        prop_assert!(compared >= holding.count());
    }

    #[test]
    fn bytes_of_triangles_are_as_forecast(net in nets::triangle_manifold(), levels in 0..3_u32) {
        let extra = json!({ "parameters": { "split": "triangle" } });
        let compared = check_bytes(&net.input(), &(String::new(), "UCP".into()), &extra, levels)?;
        let holding = FORMATS.iter().filter(|format| format.holds(ShapeKind::Mesh).is_ok());
        prop_assert!(compared >= holding.count());
    }

    #[test]
    fn bytes_of_duals_are_as_forecast(net in nets::manifold()) {
        check_bytes(&net.input(), &(String::new(), "UD".into()), &json!({}), 1)?;
    }
}

#[test]
fn a_cube_has_the_counts_that_euler_knows() {
    let word = (String::new(), "UC".to_owned());
    let made = job(&nets::cube().input(), &word, &json!({}), 3, &json!({ "format": "json" })).expect("a job");
    let forecast = Limits::default().estimate(&made).expect("it is small").forecast;
    let counts: Vec<_> = forecast.levels.iter().map(|count| (count.vertices, count.edges, count.faces)).collect();
    assert_eq!(counts, [(8, 12, 6), (26, 48, 24), (98, 192, 96), (386, 768, 384)]);
}

/// Sixty-four levels of four U each: the counts remain exact or saturate, and no memory is allocated for them.
#[test]
fn a_level_bomb_is_counted_and_refused() {
    let word = (String::new(), "U".repeat(64));
    for levels in [1, 2, 64] {
        for input in [nets::cube().input(), json!({ "polygon": { "points": [[0], [1], [2]], "closed": true } })] {
            let made = job(&input, &word, &json!({}), levels, &json!({ "format": "json" })).expect("a job");
            let Err(Refusal::TooLarge { detail, faults }) = Limits::default().estimate(&made) else {
                panic!("{levels} levels of 64 U are too large");
            };
            assert_eq!(faults[0].pointer, "/levels");
            assert!(detail.contains("this server allows"), "{detail}");
        }
    }
}
