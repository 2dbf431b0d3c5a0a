//! Nets and plans without a limit, and the messages about them.

use serde_json::{Value, json};

use super::warnings;
use crate::support::nets::{self, Net};
use crate::support::{parsed, render};

fn refusal(net: &Net, plan: &Value, levels: u32) -> String {
    let job = json!({ "input": net.input(), "plan": plan, "levels": levels,
        "outputs": [{ "format": "obj", "positions": "limit" }] });
    match render(&job) {
        Ok(_) => panic!("{job} was accepted"),
        Err(faults) => {
            assert!(faults[0].pointer.starts_with("/outputs/0"), "{faults:?}");
            faults[0].detail.clone()
        }
    }
}

fn assert_says(text: &str, words: &str) {
    assert!(text.contains(words), "\"{text}\" does not say \"{words}\"");
    assert!(text.ends_with("ask for \"positions\": \"refined\""), "\"{text}\" has no remedy");
}

#[test]
fn plans_without_a_limit_are_refused() {
    assert_says(&refusal(&nets::cube(), &json!({ "word": "U(C)" }), 1), "no operator of the plan's cycle refines");
    // nothing remains of narrow meshes: everywhere, at an end, and where faces meet in a vertex only
    assert_says(&refusal(&nets::grid(3, 3), &json!({ "word": "UDDDD" }), 0), "D needs a vertex all of whose faces");
    let mut handle = nets::grid(6, 3);
    handle.faces.retain(|face| face.iter().all(|v| v % 7 < 4 || v / 7 < 2));
    assert_says(&refusal(&handle, &json!({ "word": "DU" }), 0), "D leaves no faces near it");
    let mut waist = nets::grid(5, 6);
    waist.faces.remove(12);
    waist.faces.remove(0);
    assert_says(&refusal(&waist, &json!({ "word": "DU" }), 0), "D parts the faces near it");
    let fine = json!({ "word": "U^30" });
    assert_says(&refusal(&nets::cube(), &fine, 0), "fewer or smaller upsamplings");
    let wild = json!({ "word": "UCP", "parameters": { "compensation": 9 } });
    assert_says(&refusal(&nets::cube(), &wild, 1), "no continuous limit");
    // only at vertices and faces with other than four neighbours, or six
    let uneven = |delta: &str| json!({ "word": "UCP", "parameters": { "delta": delta } });
    assert_says(&refusal(&nets::cube(), &uneven("8*(valence-4)"), 0), "no continuous limit");
    let five = uneven("6*max(0,valence-4)");
    for (net, levels) in [(nets::sectors_of_quads(5, 2).0, 0), (nets::prism(5), 0), (nets::prism(5), 1)] {
        assert_says(&refusal(&net, &five, levels), "no continuous limit");
    }
    let mut seven = uneven("3*max(0,valence-5)");
    seven["parameters"]["split"] = "triangle".into();
    assert_says(&refusal(&nets::triangulated(nets::prism(7)), &seven, 0), "no continuous limit");
    let wide = json!({ "word": "UC^24" });
    assert_says(&refusal(&nets::cube(), &wide, 1), "farther than 16 rings");
    let pole = json!({ "word": "UCP", "parameters": { "alpha": 1, "compensation": "1/(alpha-0.125)" } });
    assert_says(&refusal(&nets::cube(), &pole, 1), "later levels");
}

#[test]
fn what_the_word_tells_is_refused_before_it_is_computed() {
    let job = json!({ "input": nets::grid(2, 2).input(), "plan": { "word": "U(D)" }, "levels": 1,
        "outputs": [{ "format": "obj", "positions": "limit" }] });
    let faults = parsed(job.to_string().as_bytes()).expect_err("it has no limit");
    assert_eq!(faults[0].pointer, "/outputs/0/positions");
}

/// Without limit normals, area normals replace all of them, and a warning says why.
#[test]
fn missing_normals_are_explained() {
    let only = |warnings: Vec<String>| {
        assert_eq!(warnings.len(), 1, "{warnings:?}");
        warnings[0].clone()
    };
    let bilinear = json!({ "preset": "bilinear" });
    assert!(only(warnings(&nets::cube(), &bilinear, 1)).contains("no continuous tangents"));
    let fractal = json!({ "word": "UCP", "parameters": { "kernel": 0.1, "compensation": 1.9 } });
    assert!(only(warnings(&nets::cube(), &fractal, 1)).contains("no continuous tangents"));
    let lost = only(warnings(&nets::grid(3, 3), &json!({ "word": "UDDDD" }), 0));
    assert!(lost.contains("D needs a vertex"), "{lost}");
    let flat = Net { positions: nets::cube().positions.iter().map(|p| [p[0], 0.0, 0.0]).collect(), ..nets::cube() };
    assert!(only(warnings(&flat, &json!({ "preset": "catmull-clark" }), 1)).contains("lie in a line"));
    assert_eq!(warnings(&nets::cube(), &json!({ "preset": "catmull-clark" }), 1), Vec::<String>::new());
    for (plan, levels) in [(bilinear, 2), (fractal, 1)] {
        let normals = |normals: &str| {
            let job = json!({ "input": nets::cube().input(), "plan": plan, "levels": levels,
                "outputs": [{ "format": "obj", "normals": normals }] });
            render(&job).expect("normals are area ones").0
        };
        assert_eq!(normals("limit"), normals("area"));
    }
}
