//! The reference vectors of `tests/vectors`, reproduced through the public API: each becomes one job per level, whose
//! JSON output must agree within the file's own tolerance.
//!
//! For a new scheme, add its pattern to one of the tables below; for a new kind of file, add a function.

mod masks;
mod opensubdiv;
mod uvs;

use std::fs;
use std::path::PathBuf;

use planish::math::functions::{cos, sin, sqrt};
use serde_json::{Value, json};

use crate::support::nets::{Net, distance, same_surface};
use crate::support::{json, render};

const CURVES: &[(&str, usize)] = &[
    ("curve_chaikin", 1),
    ("curve_cubic_bspline", 1),
    ("curve_four_point", 1),
    ("curve_pushback_static_*", 4),
    ("curve_semi_*", 8),
    ("curve_word_*", 5),
    ("curve_open_clamped_*", 3),
    ("curve_dary_*", 3),
    ("curve_dd_*", 3),
    ("ternary_*", 8),
    ("curve_per_vertex", 1),
    ("curve_random_perturbation", 1),
    ("curve_incenter_mu*", 3),
];
const CIRCLES: &[(&str, usize)] = &[("circle_theorem1", 1), ("circle_cbspline_word", 1), ("circle_dary", 1)];
const SURFACES: &[(&str, usize)] =
    &[("surf_pushback_*", 13), ("surf_table1_*", 4), ("surf_cc_identity_*", 2), ("surf_latlong_*", 9)];
const OPENSUBDIV: &[(&str, usize)] = &[
    ("osd_cc_corner_vertex", 1),
    ("osd_cc_cube*", 6),
    ("osd_cc_dart*", 2),
    ("osd_cc_grid_*", 4),
    ("osd_cc_mixed_ngon_open*", 2),
    ("osd_cc_pentprism*", 2),
    ("osd_cc_tet*", 2),
    ("osd_cc_three_creases", 1),
];

const LOOP: &[(&str, usize)] = &[("osd_loop_*", 9)];
const TRIANGLES: &[(&str, usize)] = &[("tri_*", 4)];

#[test]
fn curves_agree_with_the_vectors() {
    assert_eq!(reproduced(CURVES, curve), 114, "levels compared");
}

#[test]
fn circles_have_the_predicted_radius() {
    assert_eq!(reproduced(CIRCLES, circle), 58, "circles compared");
}

#[test]
fn points_on_a_circle_stay_on_it() {
    assert_eq!(reproduced(&[("circle_incenter", 1)], points_on_circle), 192, "points compared");
}

#[test]
fn surfaces_agree_with_the_vectors() {
    assert_eq!(reproduced(SURFACES, surface), 60, "levels compared");
}

#[test]
fn catmull_clark_agrees_with_opensubdiv() {
    assert_eq!(reproduced(OPENSUBDIV, opensubdiv::levels), 58, "levels compared");
}

#[test]
fn loop_agrees_with_opensubdiv() {
    assert_eq!(reproduced(LOOP, opensubdiv::levels), 28, "levels compared");
}

#[test]
fn texture_coordinates_agree_with_opensubdiv() {
    assert_eq!(reproduced(&[("osd_uvs", 1)], uvs::cases), 30, "cases compared");
}

#[test]
fn limit_surfaces_agree_with_opensubdiv() {
    assert_eq!(reproduced(OPENSUBDIV, opensubdiv::limits), 18, "limit surfaces compared");
    assert_eq!(reproduced(LOOP, opensubdiv::limits), 9, "limit surfaces compared");
}

#[test]
fn limit_masks_agree_with_the_analysis() {
    assert_eq!(reproduced(&[("eig_surfaces_quad", 1)], masks::limits), 24, "masks compared");
}

#[test]
fn words_on_triangles_agree_with_the_vectors() {
    assert_eq!(reproduced(TRIANGLES, triangle_word), 8, "levels compared");
}

#[test]
fn the_copy_of_the_vectors_is_complete() {
    let files = matching("*");
    assert_eq!(files.len(), 112);
    for (id, vector) in files {
        assert_eq!(vector["id"], id);
        assert!(vector["tol"].as_f64().is_some_and(|tol| tol > 0.0), "{id} has a tolerance");
    }
}

/// Checks every file that matches a pattern; returns the number of comparisons.
///
/// # Panics
/// If a pattern does not match as many files as the table states, since a vector that did not run proves nothing.
fn reproduced(table: &[(&str, usize)], check: fn(&Value) -> usize) -> usize {
    let mut compared = 0;
    for (pattern, expected) in table {
        let files = matching(pattern);
        assert_eq!(files.len(), *expected, "files named {pattern}");
        compared += files.iter().map(|(_, vector)| check(vector)).sum::<usize>();
    }
    compared
}

/// Returns the vectors whose name is `pattern`, or starts with the part before its `*`.
fn matching(pattern: &str) -> Vec<(String, Value)> {
    let folder = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("tests/vectors");
    let mut files = Vec::new();
    for entry in fs::read_dir(folder).expect("the vectors are there") {
        let path = entry.expect("the folder can be read").path();
        let Some(name) = path.file_name().and_then(|name| name.to_str()).and_then(|name| name.strip_suffix(".json"))
        else {
            continue;
        };
        if pattern.strip_suffix('*').map_or(name == pattern, |start| name.starts_with(start)) {
            let text = fs::read_to_string(&path).expect("a vector can be read");
            files.push((name.to_owned(), serde_json::from_str(&text).expect("a vector is JSON")));
        }
    }
    files.sort_by(|a, b| a.0.cmp(&b.0));
    files
}

/// Converts a function of alpha to an expression.
fn expression(function: &Value) -> Value {
    match function["type"].as_str() {
        Some("const") => function["value"].clone(),
        Some("cos_half") => match function["scale"].as_str() {
            Some(scale) => json!(format!("{scale}*cos(alpha/2)")),
            None => json!("cos(alpha/2)"),
        },
        Some("sec_half") => json!("1/cos(alpha/2)"),
        // words have bare constants
        _ => {
            if function.is_null() {
                json!(1)
            } else {
                function.clone()
            }
        }
    }
}

fn push_back(params: &Value) -> Value {
    let delta = params["delta"].as_str().expect("delta is a fraction").replace('N', "valence");
    json!({ "preset": "push-back", "parameters": {
        "alpha": if params["alpha0"].is_null() { json!(0) } else { params["alpha0"].clone() },
        "kernel": expression(&params["f"]), "compensation": expression(&params["omega"]),
        "delta": delta, "k": params["k"],
    } })
}

fn curve_plan(vector: &Value) -> Value {
    let params = &vector["params"];
    match vector["scheme"].as_str().expect("a vector names its scheme") {
        "chaikin" => json!({ "preset": "chaikin" }),
        "cubic_bspline" => json!({ "preset": "cubic-b-spline" }),
        "four_point" => {
            let w = format!("({})/2", params["alpha"].as_str().expect("alpha is a fraction"));
            json!({ "preset": "four-point", "parameters": { "w": w } })
        }
        "pushback" => push_back(params),
        "word" => {
            let delta = if params["delta"].is_null() { json!(1) } else { params["delta"].clone() };
            json!({ "word": params["word"], "parameters": {
                "kernel": expression(&params["f"]), "compensation": expression(&params["omega"]), "delta": delta,
            } })
        }
        "d_ary" => {
            json!({ "preset": "d-ary-b-spline", "parameters": { "arity": params["d"], "degree": params["degree"] } })
        }
        "incenter" => json!({ "preset": "incenter", "parameters": { "mu": params["mu"] } }),
        "dd_2n_point" => json!({ "preset": "two-n-point", "parameters": { "n": params["n"] } }),
        "ternary" => json!({ "preset": "ternary-blending", "parameters": params }),
        "pushback_per_vertex" => json!({ "preset": "push-back", "parameters": { "k": params["k"] } }),
        "pushback_perturbed" => json!({ "preset": "push-back", "seed": params["seed"], "parameters": {
            "kernel": params["f"], "compensation": params["omega"], "delta": params["delta"], "k": params["k"],
            "perturbation": { "amplitude": params["c"], "decay": params["gamma"] },
        } }),
        scheme => panic!("no plan is known for {scheme}"),
    }
}

fn curve(vector: &Value) -> usize {
    let mut polygon = json!({
        "points": vector["input"].get("points").unwrap_or(&vector["input"]), "closed": vector["closed"],
        "corners": vector["params"].get("corners").cloned().unwrap_or_else(|| json!([])),
    });
    if vector["input"].get("points").is_some() {
        let fraction = |text: &Value| {
            let text = text.as_str().expect("parameters of points are fractions");
            let (p, q) = text.split_once('/').unwrap_or((text, "1"));
            let number = |text: &str| text.parse::<f64>().expect("parts of a fraction are numbers");
            number(p) / number(q)
        };
        let list = |name: &str| {
            vector["input"][name].as_array().expect("parameters are lists").iter().map(fraction).collect::<Vec<_>>()
        };
        polygon["parameters"] = json!({ "kernel": list("f"), "compensation": list("omega"), "delta": list("delta") });
    }
    let convention = vector["index_convention"].as_str().unwrap_or_default();
    let cyclic = vector["compare"] == "cyclic" || convention.contains("cyclic");
    let levels = vector["levels"].as_array().expect("levels are a list");
    for level in levels {
        let with_tangents = level["tangent_unit"].is_array();
        let job = json!({
            "input": { "polygon": polygon }, "plan": curve_plan(vector), "levels": level["level"],
            "outputs": [{ "format": "json", "tangents": with_tangents }],
        });
        let result: Value = serde_json::from_slice(&render(&job).expect("it can be refined").0).expect("JSON");
        if with_tangents {
            let (found, expected): (Vec<Vec<f64>>, Vec<Vec<f64>>) =
                (points(&result["tangents"]), points(&level["tangent_unit"]));
            assert_eq!(found.len(), expected.len());
            for (found, expected) in found.iter().zip(&expected) {
                let off = distance(found, expected);
                assert!(off <= tolerance(vector), "a tangent of {} is off by {off}", vector["id"]);
            }
        }
        let (found, expected): (Vec<Vec<f64>>, Vec<Vec<f64>>) = (points(&result["points"]), points(&level["points"]));
        assert_eq!(found.len(), expected.len(), "points of {} at level {}", vector["id"], level["level"]);
        let shifts = if cyclic { expected.len() } else { 1 };
        let deviation = |shift: usize| {
            let pairs = (0..expected.len()).map(|i| distance(&found[(i + shift) % found.len()], &expected[i]));
            pairs.fold(0.0, f64::max)
        };
        let least = (0..shifts).map(deviation).fold(f64::INFINITY, f64::min);
        assert!(least <= tolerance(vector), "{} level {}: off by {least}", vector["id"], level["level"]);
    }
    levels.len()
}

fn circle(vector: &Value) -> usize {
    let rows = vector["rows"].as_array().expect("rows are a list");
    for row in rows {
        let (k, winding) = (number(&row["K"]), row["winding"].as_f64().unwrap_or(1.0));
        let alpha = format!("2*pi*{winding}/{k}");
        let plan = match vector["scheme"].as_str() {
            Some("pushback") => json!({ "preset": "push-back", "parameters": {
                "alpha": alpha, "kernel": "cos(alpha/2)", "compensation": "1/cos(alpha/2)",
                "delta": row["delta"], "k": row["k"],
            } }),
            Some("word") => json!({ "word": format!("UD^{}", row["m"]), "parameters": {
                "alpha": alpha, "kernel": "cos(alpha/2)",
            } }),
            Some("d_ary_trig") => json!({ "preset": "d-ary-circle", "parameters": {
                "alpha": alpha, "arity": row["d"], "averages": row["m"],
            } }),
            scheme => panic!("no plan is known for {scheme:?}"),
        };
        let (arity, levels) = (row["d"].as_u64().unwrap_or(2), row["levels"].as_u64().unwrap_or(5));
        let corners = row["K"].as_u64().expect("K is whole");
        let corner = |i: u64| 2.0 * std::f64::consts::PI * winding * f64::from(u32::try_from(i).expect("small")) / k;
        let polygon: Vec<_> = (0..corners).map(|i| [cos(corner(i)), sin(corner(i))]).collect();
        let job =
            json!({ "input": { "polygon": { "points": polygon, "closed": true } }, "plan": plan, "levels": levels });
        let radius = number(row.get("radius_level5").unwrap_or(&row["radius"]));
        let found: Vec<[f64; 2]> = points(&json(job)["points"]);
        assert_eq!(found.len() as u64, (0..levels).fold(corners, |n, _| n * arity));
        for point in found {
            let off = (sqrt(point[0] * point[0] + point[1] * point[1]) - radius).abs();
            assert!(off <= tolerance(vector), "{} {row}: off by {off}", vector["id"]);
        }
    }
    rows.len()
}

fn points_on_circle(vector: &Value) -> usize {
    let circle = &vector["circle"];
    let job = json!({
        "input": { "polygon": { "points": vector["input"], "closed": true } },
        "plan": { "preset": vector["scheme"], "parameters": vector["params"] }, "levels": circle["levels"],
    });
    let [center, found] = [points::<[f64; 2]>(&json!([circle["center"]])), points(&json(job)["points"])];
    for point in &found {
        let [x, y] = [0, 1].map(|i| point[i] - center[0][i]);
        let off = (sqrt(x * x + y * y) - number(&circle["radius"])).abs();
        assert!(off <= tolerance(vector), "{}: {point:?} is off by {off}", vector["id"]);
    }
    found.len()
}

fn surface(vector: &Value) -> usize {
    let (params, input) = (&vector["params"], &vector["input"]);
    let tagged = vector["corners"].as_array().into_iter().flatten();
    let corners: Vec<_> = tagged.map(|v| json!({ "vertex": v, "sharpness": 10 })).collect();
    let mut mesh = json!({ "positions": input["points"], "faces": input["faces"], "corners": corners });
    let along = |direction: &str| -> Vec<Value> {
        let tags = input["edge_tags"].as_array().into_iter().flatten().filter(|tag| tag[2] == direction);
        tags.map(|tag| json!([tag[0], tag[1]])).collect()
    };
    (mesh["latitude"], mesh["longitude"]) = (json!(along("lat")), json!(along("lon")));
    let mut push_back = push_back(&if params["f"].is_number() {
        let constant = |x: &Value| json!({ "type": "const", "value": x });
        json!({
            "f": constant(&params["f"]), "omega": constant(&params["omega"]), "delta": params["delta"], "k": params["k"]
        })
    } else {
        params.clone()
    });
    push_back["boundary"] = json!("edge-only");
    let rule = [("lat_diff", "difference"), ("lat_pos", "position"), ("iso", "isotropic")];
    if let Some((_, rule)) = rule.into_iter().find(|(mode, _)| params["mode"] == *mode) {
        push_back["parameters"]["latitude_rule"] = json!(rule);
    }
    let catmull_clark = json!({ "preset": "catmull-clark", "boundary": "edge-only" });
    let mut compared = 0;
    for level in vector["levels"].as_array().expect("levels are a list") {
        for (plan, points) in
            [(&push_back, "points"), (&push_back, "points_pushback"), (&catmull_clark, "points_catmull_clark")]
        {
            if level[points].is_array() {
                check_mesh(vector, &mesh, plan, level, points);
                compared += 1;
            }
        }
    }
    compared
}

/// Checks a word `U C^repeats`, with a push-back if the vector has a delta: then it is Loop's scheme.
fn triangle_word(vector: &Value) -> usize {
    let (params, input) = (&vector["params"], &vector["input"]);
    let repeats = usize::try_from(params["repeats"].as_u64().expect("repeats are whole")).expect("few");
    let averages = "C".repeat(repeats);
    let mut plan = json!({ "word": format!("U{averages}"), "boundary": "edge-only", "parameters": {
        "split": "triangle", "mu": params["mu"],
    } });
    if params["delta"].is_string() {
        plan["word"] = json!(format!("U{averages}P"));
        plan["parameters"]["compensation"] = json!(0);
        plan["parameters"]["delta"] = json!("1 - 8/3*(5/8 - (3/8 + cos(2*pi/valence)/4)^2)");
    }
    let mesh = json!({ "positions": input["points"], "faces": input["faces"] });
    let levels = vector["levels"].as_array().expect("levels are a list");
    levels.iter().for_each(|level| check_mesh(vector, &mesh, &plan, level, "points"));
    levels.len()
}

/// Compares one level: points are matched one to one by nearest neighbour, faces as a set of cycles of matched points.
fn check_mesh(vector: &Value, mesh: &Value, plan: &Value, level: &Value, key: &str) {
    let what = format!("{} level {} ({key})", vector["id"], level["level"]);
    let result = json(json!({ "input": { "mesh": mesh }, "plan": plan, "levels": level["level"] }));
    let mut expected = Net { positions: points(&level[key]), faces: Vec::new() };
    expected.faces = serde_json::from_value(level["faces"].clone()).expect("faces are lists of indices");
    if let Err(difference) = same_surface(&Net::of(&result), &expected, tolerance(vector)) {
        panic!("{what}: {difference}");
    }
}

/// Reads points of any dimension.
fn points<T: serde::de::DeserializeOwned>(list: &Value) -> Vec<T> {
    serde_json::from_value(list.clone()).expect("points are lists of numbers")
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("{value} is no number"))
}

fn tolerance(vector: &Value) -> f64 {
    number(&vector["tol"])
}
