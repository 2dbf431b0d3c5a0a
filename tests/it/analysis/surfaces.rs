//! Analyses of surface schemes.

use planish::job::Form;
use planish::math::functions::{cos, real, sqrt};
use planish::watch::Watch;
use planish::wire::analysis::AnalysisAnswer;
use serde_json::{Map, Value, json};

use super::{asked, key, question, refused};

fn surface(plan: &Value, valences: &[usize]) -> Value {
    let answer = asked(&json!({ "plan": plan, "valences": valences, "nodes": 1000 }));
    assert_eq!(answer["kind"], "surface");
    answer
}

fn word(word: &str, parameters: &Value) -> Value {
    json!({ "word": word, "parameters": parameters })
}

fn schemes(file: &str) -> Map<String, Value> {
    let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/vectors").join(file);
    let text = std::fs::read_to_string(path).unwrap();
    serde_json::from_str::<Value>(&text).unwrap()["schemes"].as_object().unwrap().clone()
}

/// Returns the result at each valence of a scheme of the vectors, with the reference.
fn rows(plan: &Value, scheme: &Value) -> Vec<(Value, Value)> {
    let scheme = scheme.as_object().unwrap();
    let valences: Vec<usize> = scheme.keys().map(|valence| valence.parse().unwrap()).collect();
    let found = surface(plan, &valences)["valences"].as_array().unwrap().clone();
    assert_eq!(found.len(), 4);
    found.into_iter().map(|row| (scheme[&row["valence"].to_string()].clone(), row)).collect()
}

/// Checks that every leading eigenvalue of the reference is found, with its index.
fn has_eigenvalues(name: &str, wanted: &Value, found: &Value) {
    let mut left: Vec<(f64, u64)> = found["eigenvalues"]
        .as_array()
        .unwrap()
        .iter()
        .map(|value| (value["value"].as_f64().unwrap(), value["fourier"].as_u64().unwrap()))
        .collect();
    for value in wanted["top"].as_array().unwrap() {
        let (re, index) = (value[0].as_f64().unwrap(), value[2].as_u64().unwrap());
        // eigenvalues of Jordan blocks are accurate to the square root of the rounding error
        let place = left.iter().position(|(x, k)| (x - re).abs() < 1e-7 && *k == index);
        let place = place.unwrap_or_else(|| panic!("{name} at {}: no {value} among {left:?}", found["valence"]));
        left.remove(place);
    }
}

fn weight(mask: &Value, names: &[&str]) -> f64 {
    names.iter().find_map(|name| mask[*name].as_f64()).unwrap_or(0.0)
}

#[test]
fn every_quad_scheme_of_the_reference_is_found_again() {
    let plans = [
        ("catmull_clark", json!({ "preset": "catmull-clark" })),
        ("CU (f=1,delta=0)", word("UC", &json!({}))),
        ("table b/d static (1,1,1)", word("UCP", &json!({ "delta": 1 }))),
        ("table c static (1,1,-0.1)", word("UCP", &json!({ "delta": -0.1 }))),
        ("table e static (10,1,0.8)", word("UCP", &json!({ "kernel": 10, "delta": 0.8 }))),
        ("CCU (f=1,delta=0)", word("UCC", &json!({}))),
    ];
    let schemes = schemes("eig_surfaces_quad.json");
    assert_eq!(schemes.len(), plans.len());
    for (name, plan) in plans {
        for (wanted, found) in rows(&plan, &schemes[name]) {
            has_eigenvalues(name, &wanted, &found);
            for (at, value) in wanted["limit"].as_object().unwrap() {
                let names: &[&str] = match at.as_str() {
                    "1,0" => &["1,0", "edge"],
                    "1,1" => &["1,1", "face"],
                    other => &[other],
                };
                let off = weight(&found["limit_mask"], names) - value.as_f64().unwrap();
                assert!(off.abs() < 1e-10, "{name}: {at} {off} {}", found["limit_mask"]);
            }
            let sine = found["characteristic_map_min_sine"].as_f64().unwrap();
            let wanted = wanted["char_min_orient"][1].as_f64().unwrap();
            assert!((sine - wanted).abs() < 1e-9, "{name} at {}: {sine} {wanted}", found["valence"]);
        }
    }
}

#[test]
fn every_triangle_scheme_of_the_reference_is_found_again() {
    let triangles = |text: &str, mut parameters: Value| {
        parameters["split"] = json!("triangle");
        word(text, &parameters)
    };
    let plans = [
        ("loop", json!({ "preset": "loop" })),
        ("mu14", triangles("UC", json!({}))),
        ("centroid", triangles("UC", json!({ "mu": "1/3" }))),
        ("mu14x2", triangles("UCC", json!({}))),
        ("interp", triangles("UCP", json!({ "delta": 1 }))),
    ];
    let schemes = schemes("eig_surfaces_tri.json");
    assert_eq!(schemes.len(), plans.len());
    for (name, plan) in plans {
        for (wanted, found) in rows(&plan, &schemes[name]) {
            has_eigenvalues(name, &wanted, &found);
            let mask = &found["limit_mask"];
            for (names, at) in [(["center", "center"], "limit_center"), (["1,0", "edge"], "limit_1ring")] {
                let off = weight(mask, &names) - wanted[at].as_f64().unwrap();
                assert!(off.abs() < 1e-10, "{name}: {at} {mask}");
            }
        }
    }
}

/// Reference, 10.2, and "every scheme": for each of them, the smoothness of regular limits is proved.
#[test]
fn every_preset_on_meshes_has_proved_smoothness_where_nothing_is_extraordinary() {
    let regular = |plan: &Value| asked(&json!({ "plan": plan, "valences": [4], "boundaries": [] }))["regular"].clone();
    for (preset, smooth, by) in [
        ("catmull-clark", [json!(2), json!(3)], "box spline"),
        ("loop", [json!(2), json!(3)], "box spline"),
        ("bilinear", [json!(0), json!(1)], "box spline"),
        ("doo-sabin", [json!(1), json!(2)], "box spline"),
        ("kobbelt", [json!(1), json!(2)], "product"),
        ("butterfly", [json!(1), json!(2)], "norms"),
        ("sqrt-3", [json!(2), Value::Null], "radius"),
    ] {
        let found = &regular(&json!({ "preset": preset }))["smoothness"];
        assert_eq!([&found["proved_c"], &found["disproved_c"]], [&smooth[0], &smooth[1]], "{preset}: {found}");
        assert_eq!(found["by"], by, "{preset}");
    }
}

/// Jiang and Oswald, Journal of Computational and Applied Mathematics 156 (2003): the exponent of the sqrt 3 scheme is
/// log 18 / log 3; of the butterfly scheme it is 2, as of the four-point scheme along its lines.
#[test]
fn exponents_of_schemes_without_factors_lie_between_their_bounds() {
    for (preset, radius) in [("sqrt-3", 1.0 / 18.0), ("butterfly", 0.25)] {
        let answer = asked(&json!({ "plan": { "preset": preset }, "valences": [], "boundaries": [] }));
        let found = &answer["regular"]["smoothness"];
        let bounds: Vec<f64> =
            found["joint_spectral_radius"].as_array().unwrap().iter().map(|x| x.as_f64().unwrap()).collect();
        assert!(bounds[0] <= radius && radius <= bounds[1], "{preset}: {bounds:?}");
        assert!((bounds[0] - radius).abs() < 1e-12, "{preset}: {bounds:?}");
        assert!(found["holder"][0].as_f64().unwrap() > if preset == "sqrt-3" { 2.0 } else { 1.5 }, "{found}");
    }
}

/// Checks the eigenvalue of Fourier index 1 and whether the verdict is proved, for each valence from 3 on.
fn subdominant(plan: &Value, last: usize, formula: impl Fn(f64) -> f64) {
    let valences: Vec<usize> = (3..=last).collect();
    for (valence, row) in valences.iter().zip(surface(plan, &valences)["valences"].as_array().unwrap()) {
        assert_eq!(row["valence"], json!(valence));
        let first = &row["eigenvalues"][1];
        let off = first["value"].as_f64().unwrap() - formula(real(*valence));
        assert!(off.abs() < 1e-12 && first["fourier"] == 1, "{valence}: {first}");
        assert_eq!(row["eigenvalues"][2]["fourier"], json!(valence - 1));
        assert_eq!(row["c1"], "proved", "{valence}: {}", row["criteria"]);
    }
}

#[test]
fn classical_schemes_are_c1_as_far_as_numbers_and_samples_show() {
    for preset in ["doo-sabin", "kobbelt"] {
        for row in surface(&json!({ "preset": preset }), &[3, 5, 7])["valences"].as_array().unwrap() {
            let evidence = &row["evidence"];
            assert!(evidence == "proved" || evidence == "supported", "{preset} at {}", row["valence"]);
        }
    }
}

#[test]
fn catmull_clark_has_the_eigenvalues_of_the_closed_formula_and_is_c1_at_valences_3_to_50() {
    let pi = std::f64::consts::PI;
    let formula = |n: f64| {
        let c = cos(2.0 * pi / n);
        (5.0 + c + cos(pi / n) * sqrt(2.0 * (9.0 + c))) / 16.0
    };
    subdominant(&json!({ "preset": "catmull-clark" }), 50, formula);
}

#[test]
fn loop_has_the_eigenvalues_of_the_closed_formula_and_is_c1_at_valences_3_to_50() {
    let formula = |n: f64| 0.375 + cos(2.0 * std::f64::consts::PI / n) / 4.0;
    subdominant(&json!({ "preset": "loop" }), 50, formula);
}

#[test]
fn limit_masks_of_catmull_clark_and_loop_are_those_of_the_papers() {
    for row in surface(&json!({ "preset": "catmull-clark" }), &[3, 5, 8])["valences"].as_array().unwrap() {
        let n = row["valence"].as_f64().unwrap();
        for (name, value) in [("center", n * n), ("edge", 4.0), ("face", 1.0)] {
            let off = row["limit_mask"][name].as_f64().unwrap() - value / (n * (n + 5.0));
            assert!(off.abs() < 1e-14, "{name} at {n}");
        }
    }
    for row in surface(&json!({ "preset": "loop" }), &[3, 5, 8])["valences"].as_array().unwrap() {
        let n = row["valence"].as_f64().unwrap();
        let lambda = 0.375 + cos(2.0 * std::f64::consts::PI / n) / 4.0;
        let beta = (0.625 - lambda * lambda) / n;
        let off = row["limit_mask"]["center"].as_f64().unwrap() - 1.0 / (1.0 + 8.0 * n * beta / 3.0);
        assert!(off.abs() < 1e-14, "{n}");
    }
}

/// The tangent masks map the characteristic net to the unit vectors, and constants to 0.
#[test]
fn tangent_masks_are_dual_to_the_characteristic_net() {
    for plan in [json!({ "preset": "catmull-clark" }), json!({ "preset": "loop" }), json!({ "preset": "doo-sabin" })] {
        for row in surface(&plan, &[3, 5])["valences"].as_array().unwrap() {
            let n = usize::try_from(row["valence"].as_u64().unwrap()).unwrap();
            let points = row["characteristic_net"]["points"].as_array().unwrap();
            for (which, mask) in row["tangent_masks"].as_array().unwrap().iter().enumerate() {
                let mask = mask.as_object().unwrap();
                let (mut sum, mut applied) = (0.0, [0.0; 2]);
                for (name, weights) in mask {
                    let coordinates: Vec<usize> = name.split(',').map(|x| x.parse().unwrap()).collect();
                    // the net lists the points of each sector together, the nearest first
                    let (i, j) = (coordinates[0], coordinates[1]);
                    let dual = usize::from(plan["preset"] == "doo-sabin");
                    let per_sector = (points.len() + dual - 1) / n;
                    let place = place(&plan, i, j);
                    for (sector, weight) in weights.as_array().unwrap().iter().enumerate() {
                        let weight = weight.as_f64().unwrap();
                        let point = &points[1 - dual + sector * per_sector + place];
                        sum += weight;
                        (0..2).for_each(|k| applied[k] += weight * point[k].as_f64().unwrap());
                    }
                }
                assert!(sum.abs() < 1e-12, "{plan} at {n}: {sum}");
                let unit = [0, 1].map(|k| f64::from(u8::from(k == which)));
                let near = (0..2).all(|k| (applied[k] - unit[k]).abs() < 1e-9);
                assert!(near, "{plan} at {n}: {applied:?} for {unit:?}");
            }
        }
    }
}

/// Returns the position of a point among the points of its sector: by radius, then by its coordinates.
fn place(plan: &Value, i: usize, j: usize) -> usize {
    let radius = |i: usize, j: usize| if plan["preset"] == "loop" { i + j } else { i.max(j) };
    let from = usize::from(plan["preset"] != "doo-sabin");
    let mut points: Vec<[usize; 3]> =
        (from..9).flat_map(|i| (0..9).map(move |j| (i, j))).map(|(i, j)| [radius(i, j), i, j]).collect();
    points.sort_unstable();
    points.iter().position(|point| *point == [radius(i, j), i, j]).unwrap()
}

#[test]
fn classical_schemes_are_proved_to_be_c1_at_the_valences_that_are_looked_at_by_default() {
    for preset in ["catmull-clark", "repeated-averaging"] {
        let answer = asked(&json!({ "plan": { "preset": preset } }));
        let rows = answer["valences"].as_array().unwrap();
        assert_eq!(rows.len(), 10, "{preset}");
        for row in rows {
            assert_eq!(row["c1"], "proved", "{preset} at {}: {}", row["valence"], row["criteria"]);
        }
    }
}

#[test]
fn what_is_not_smooth_in_regular_nets_is_disproved_everywhere() {
    let answer = surface(&json!({ "preset": "bilinear" }), &[3, 4, 5]);
    assert_eq!(answer["regular"]["smoothness"]["disproved_c"], 1);
    assert!(answer["valences"].as_array().unwrap().iter().all(|row| row["c1"] == "disproved"));
}

/// If the vertex is held back, the eigenvalue of index 0 is the next after 1: surfaces end in a spike.
#[test]
fn a_subdominant_eigenvalue_of_index_0_disproves_c1() {
    let parameters = json!({ "delta": "min(19/20, max(0, valence - 4))", "compensation": 0 });
    let answer = surface(&word("UCP", &parameters), &[4, 6]);
    let rows = answer["valences"].as_array().unwrap();
    assert_eq!((&rows[0]["c1"], &rows[1]["c1"]), (&json!("proved"), &json!("disproved")), "{answer}");
    assert_eq!(rows[1]["eigenvalues"][1]["fourier"], 0);
}

/// Warren's weights have an eigenvalue 1/4 of each index at valence 3: no argument decides C1.
#[test]
fn equal_eigenvalues_leave_a_verdict_open() {
    let answer = surface(&word("UC", &json!({ "split": "triangle" })), &[3, 4]);
    let rows = answer["valences"].as_array().unwrap();
    assert_eq!((&rows[0]["c1"], &rows[1]["c1"]), (&json!("open"), &json!("proved")));
}

/// Zhang and Wang, section 3: only without a push-back the regular region is the product of the curve scheme.
#[test]
fn a_push_back_is_no_tensor_product_and_not_the_scheme_of_kobbelt() {
    let regular = |plan: &Value| surface(plan, &[4])["regular"].clone();
    let [none, half, whole] = [0.0, 0.5, 1.0].map(|delta| regular(&word("UCP", &json!({ "delta": delta }))));
    assert!(none.get("product").is_some() && half.get("product").is_none() && whole.get("product").is_none());
    let kobbelt = regular(&json!({ "preset": "kobbelt" }));
    assert!(kobbelt.get("product").is_some());
    let at = |regular: &Value, x: usize, y: usize| regular["mask"]["values"][y][x].as_f64().unwrap();
    assert_eq!(whole["mask"]["first"], kobbelt["mask"]["first"]);
    assert!((0..7).all(|x| at(&whole, x, 3) - at(&kobbelt, x, 3) == 0.0 || x % 2 == 0 || x == 3), "rules of vertices");
    assert!((at(&whole, 0, 0) - at(&kobbelt, 0, 0)).abs() > 1e-3, "rules of faces differ");
}

/// Zhang and Wang: Catmull-Clark is the push-back with delta = (n - 4)/n wherever all faces are quads.
#[test]
fn catmull_clark_is_a_push_back_on_quads() {
    let parameters = json!({ "delta": "(valence - 4)/valence", "compensation": 0 });
    let [pushed, classical] = [word("UCP", &parameters), json!({ "preset": "catmull-clark" })]
        .map(|plan| surface(&plan, &[3, 5, 7])["valences"].as_array().unwrap().clone());
    for (a, b) in pushed.iter().zip(&classical) {
        let values = |row: &Value| -> Vec<f64> {
            row["eigenvalues"].as_array().unwrap().iter().map(|x| x["value"].as_f64().unwrap()).collect()
        };
        assert!(values(a).iter().zip(values(b)).all(|(x, y)| (x - y).abs() < 1e-9), "{a} {b}");
        assert_eq!((&a["c1"], &b["c1"]), (&json!("proved"), &json!("proved")));
    }
}

/// Zhang and Wang, table 1: the static limits of its rows are C1 at extraordinary vertices.
#[test]
fn rows_of_the_first_paper_are_c1_at_extraordinary_vertices() {
    for parameters in [json!({ "delta": 1 }), json!({ "delta": -0.1 }), json!({ "kernel": 10, "delta": 0.8 })] {
        for row in surface(&word("UCP", &parameters), &[3, 5, 8])["valences"].as_array().unwrap() {
            let known = ["proved", "supported"].map(Value::from);
            assert!(known.contains(&row["evidence"]), "{parameters} at {}: {}", row["valence"], row["criteria"]);
            assert_ne!(row["c1"], "disproved");
        }
    }
}

/// The eigenvalues of index 1 of one D after a U, whose corners weigh f^2, its edges f and its centre 1: arity and turn
/// do not depend on these weights.
#[test]
fn arity_and_turn_follow_from_the_connectivity_at_every_kernel() {
    for (kernel, f) in [("1/2", 0.5), ("1", 1.0), ("2", 2.0), ("10", 10.0)] {
        let answer = surface(&word("UD", &json!({ "kernel": kernel })), &[3, 4, 5, 7]);
        assert_eq!((&answer["arity"], &answer["applications"]), (&json!(2), &json!(1)), "{kernel}");
        let values = [1.0, 2.0 * f + 1.0].map(|x| x / (2.0 * (f + 1.0)));
        for curve in answer["regular"]["product"].as_array().unwrap() {
            let found: Vec<f64> = curve["values"].as_array().unwrap().iter().map(|x| x.as_f64().unwrap()).collect();
            let wanted = [values[0], values[1], values[1], values[0]];
            assert!(found.len() == 4 && found.iter().zip(wanted).all(|(a, b)| (a - b).abs() < 1e-14), "{found:?}");
        }
        let disproved = if kernel == "1" { json!(2) } else { json!(1) };
        assert_eq!(answer["regular"]["smoothness"]["disproved_c"], disproved, "corners are cut in other ratios");
        for row in answer["valences"].as_array().unwrap() {
            let n = row["valence"].as_f64().unwrap();
            let wanted = (f * f + f * (1.0 + cos(2.0 * std::f64::consts::PI / n))) / ((1.0 + f) * (1.0 + f));
            let mut of_index_1 = row["eigenvalues"].as_array().unwrap().iter().filter(|value| value["fourier"] == 1);
            let is_found = of_index_1.any(|value| (value["value"].as_f64().unwrap() - wanted).abs() < 1e-12);
            assert!(is_found, "{kernel} at {n}: {wanted}, {row}");
        }
    }
    for (plan, arity, applications, dual) in [
        (json!({ "preset": "sqrt-3" }), 3, 2, false),
        (json!({ "preset": "kobbelt" }), 2, 1, false),
        (json!({ "preset": "doo-sabin" }), 2, 1, true),
        (word("UDDD", &json!({ "kernel": "1/10" })), 2, 1, true),
        (word("U3C", &json!({ "kernel": 5 })), 3, 1, false),
        (word("UCUDD", &json!({ "kernel": "1/3" })), 4, 1, false),
        (word("UDUD", &json!({ "kernel": 2 })), 4, 1, true),
        (word("DU", &json!({})), 2, 1, false),
        (word("DUD", &json!({})), 2, 1, true),
    ] {
        let answer = surface(&plan, &[3, 5, 6, 8]);
        let found = (&answer["arity"], &answer["applications"], &answer["regular"]["dual"]);
        assert_eq!(found, (&json!(arity), &json!(applications), &json!(dual)), "{plan}");
        for row in answer["valences"].as_array().unwrap() {
            assert!(row.get("refused").is_none(), "{plan}: {row}");
            let next = &row["eigenvalues"][1];
            assert!(next["value"].as_f64().unwrap() > 0.0 && next["fourier"] == 1, "{plan}: {row}");
        }
    }
}

#[test]
fn plans_that_follow_alpha_are_analysed_where_they_lead_to() {
    let follows = json!({ "kernel": "cos(alpha/2)", "compensation": "1/cos(alpha/2)", "alpha": 1, "delta": 1 });
    let (changing, settled) =
        (surface(&word("UCP", &follows), &[5]), surface(&word("UCP", &json!({ "delta": 1 })), &[5]));
    assert_eq!(changing["valences"], settled["valences"]);
    assert_eq!(changing["assumptions"].as_array().unwrap().len(), 1 + settled["assumptions"].as_array().unwrap().len());
}

#[test]
fn a_surface_question_that_cannot_be_answered_is_refused_with_its_place() {
    let place = |question: Value| refused(&question)[0].pointer.clone();
    assert_eq!(place(json!({ "plan": { "preset": "loop" }, "valences": [3, 2] })), "/valences/1");
    assert_eq!(place(json!({ "plan": { "preset": "loop" }, "valences": [51] })), "/valences/0");
    assert_eq!(place(json!({ "plan": { "preset": "loop" }, "grid": 3 })), "/grid");
    assert_eq!(place(json!({ "plan": { "preset": "four-point" }, "valences": [3] })), "/plan/preset");
    assert_eq!(place(json!({ "plan": { "word": "C" }, "valences": [3] })), "/plan/word");
    let perturbed = json!({ "word": "UC", "parameters": { "perturbation": [0.1, 0.4] } });
    assert!(place(json!({ "plan": perturbed, "valences": [3] })).starts_with("/plan"));
}

#[test]
fn surface_questions_with_the_same_answer_have_the_same_key() {
    let ask = |plan: Value, valences: Value| key(&json!({ "plan": plan, "valences": valences }));
    let first = ask(json!({ "word": "UC" }), json!([3, 5]));
    assert_eq!(first, ask(json!({ "word": "UC", "parameters": { "kernel": "2/2" } }), json!([5, 3, 3])));
    assert_ne!(first, ask(json!({ "word": "UC" }), json!([3, 6])));
    assert_ne!(first, ask(json!({ "word": "UC", "parameters": { "kernel": 2 } }), json!([3, 5])));
    assert_ne!(first, key(&json!({ "plan": { "word": "UC" } })), "the curve scheme is another question");
}

#[test]
fn an_analysis_of_surfaces_stops_when_it_is_told_to() {
    let watch = Watch::new();
    let inquiry = question(&json!({ "plan": { "preset": "loop" } })).resolve(Form::Json, &watch).unwrap();
    watch.stop();
    assert!(AnalysisAnswer::of(&inquiry, &watch).is_err());
}

#[test]
fn a_mesh_is_told_its_extraordinary_points_and_how_close_levels_come() {
    let cube = json!({
        "positions": [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]],
        "faces": [[3, 2, 1, 0], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]]
    });
    let ask = |plan: Value| asked(&json!({ "plan": plan, "input": { "mesh": cube }, "nodes": 1000 }));
    let answer = ask(json!({ "preset": "catmull-clark" }));
    let points = answer["input"]["extraordinary"].as_array().unwrap();
    assert_eq!(points.len(), 1);
    assert_eq!((&points[0]["valence"], &points[0]["c1"]), (&json!(3), &json!("proved")));
    assert_eq!((&points[0]["n_vertices"], &points[0]["vertices"]), (&json!(8), &json!([0, 1, 2, 3, 4, 5, 6, 7])));
    assert_eq!(answer["valences"].as_array().unwrap().len(), 1, "those that the mesh has");
    let bounds = answer["input"]["bounds"].as_array().unwrap();
    assert!(bounds.len() >= 2, "{bounds:?}");
    for pair in bounds.windows(2) {
        assert!(pair[0]["level"].as_u64() < pair[1]["level"].as_u64());
        assert!(2.0 * pair[1]["bound"].as_f64().unwrap() <= pair[0]["bound"].as_f64().unwrap());
    }
    assert_eq!(answer["input"]["warnings"], json!([]));
    // 1/(alpha - 1) is not finite where alpha is 1
    let parameters = json!({ "compensation": "1/(alpha - 1)", "alpha": 4, "delta": 1 });
    let warned = ask(json!({ "word": "UCP", "parameters": parameters }));
    let warnings = warned["input"]["warnings"].as_array().unwrap();
    assert!(warnings.iter().any(|text| text.as_str().unwrap().contains("level 3")), "{warnings:?}");
    let points = json!([[0, 0], [1, 0], [0, 1]]);
    let polygon = json!({ "plan": { "word": "UC" }, "input": { "polygon": { "points": points } }, "valences": [3] });
    assert_eq!(refused(&polygon)[0].pointer, "/input");
}

/// Tagged lines have rules of their own, along and across; vertices are analysed without the tags, and an assumption
/// states this.
#[test]
fn what_is_said_of_a_tagged_mesh_is_said_without_its_tags() {
    let plan = word("UCP", &json!({ "delta": "1/2" }));
    let lines: Vec<[usize; 2]> = (0..20).map(|v| [v, v - v % 5 + (v + 1) % 5]).collect();
    let mesh = |tagged: bool| {
        let points: Vec<[f64; 3]> = (0..20_u16)
            .map(|v| {
                let angle = 2.0 * std::f64::consts::PI * f64::from(v % 5) / 5.0;
                [cos(angle), planish::math::functions::sin(angle), f64::from(v / 5)]
            })
            .collect();
        let side =
            |r: usize| (0..5).map(move |i| [5 * r + i, 5 * r + (i + 1) % 5, 5 * r + 5 + (i + 1) % 5, 5 * r + 5 + i]);
        let mut faces: Vec<Vec<usize>> = (0..3).flat_map(side).map(Vec::from).collect();
        faces.push((0..5).rev().collect());
        faces.push((15..20).collect());
        let mut mesh = json!({ "positions": points, "faces": faces });
        if tagged {
            mesh["latitude"] = json!(lines);
        }
        asked(&json!({ "plan": plan, "input": { "mesh": mesh }, "nodes": 1000 }))
    };
    let (tagged, plain) = (mesh(true), mesh(false));
    // with tags, the plan of the lines follows alpha, and the result is the same
    assert_eq!(tagged["valences"], plain["valences"]);
    assert_eq!(tagged["regular"], plain["regular"]);
    let told = |answer: &Value| answer["assumptions"].to_string().contains("latitude");
    assert!(told(&tagged) && !told(&plain), "{}", tagged["assumptions"]);
    assert_eq!(tagged["input"]["extraordinary"], plain["input"]["extraordinary"]);
}
