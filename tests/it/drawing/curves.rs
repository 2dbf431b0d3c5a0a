//! Figures of curves: their content, and the refused ones with pointers.

use planish::math::functions::{cos, real, sin, sqrt};
use serde_json::{Value, json};

use crate::support::render;

fn polygons(n: usize, dimension: usize) -> Value {
    let polygon = |i: usize| {
        let point = |j: usize| -> Vec<f64> {
            let (i, j) = (real(i), real(j));
            [cos(1.5 * j) + 2.0 * i, sin(1.5 * j), 0.2 * j][..dimension].to_vec()
        };
        json!({ "points": (0..5).map(point).collect::<Vec<_>>(), "closed": true })
    };
    json!({ "polygons": (0..n).map(polygon).collect::<Vec<_>>() })
}

fn job(input: &Value, output: &Value) -> Value {
    json!({ "input": input, "plan": { "preset": "cubic-b-spline" }, "levels": 4, "outputs": [output] })
}

fn svg(input: &Value, options: &Value) -> String {
    let mut output = options.clone();
    output["format"] = json!("svg");
    let job = job(input, &output);
    let (bytes, _) = render(&job).unwrap_or_else(|faults| panic!("{faults:?} for {job}"));
    String::from_utf8(bytes).expect("SVG is text")
}

#[test]
fn curves_take_their_styles_in_turn_and_the_legend_names_each_once() {
    let styles = json!([{ "label": "\\alpha_0", "color": "#123456" }, { "label": "second", "dash": "dashed" }]);
    let text = svg(&polygons(3, 2), &json!({ "styles": styles, "show": ["curve", "legend"] }));
    assert_eq!(text.matches("class=\"curve\"").count(), 3);
    assert_eq!(text.matches("stroke=\"#123456\"").count(), 3, "two curves and the legend");
    assert_eq!(text.matches("stroke-dasharray").count(), 2, "a curve and the legend");
    assert_eq!(text.matches(">α</tspan>").count(), 1);
    assert_eq!(text.matches(">second</tspan>").count(), 1);
}

/// The axes of a function are numbered by the points of its control polygon.
#[test]
fn axes_of_functions_count_control_points() {
    let input = json!({ "polygon": { "points": [[0], [0], [0], [1], [0], [0], [0]] } });
    let text = svg(&input, &json!({ "show": ["curve", "axes", "grid"], "x_label": "i", "y_label": "\\phi" }));
    for number in ["0", "1", "2", "3", "4", "5", "6", "φ", "i"] {
        assert!(text.contains(&format!(">{number}</tspan>")), "{number} in {text}");
    }
    assert!(text.contains("class=\"grid\"") && text.contains("clip-path"), "{text}");
}

/// The comb of a circle has constant length: its teeth end on a circle.
#[test]
fn the_comb_of_a_circle_is_a_circle() {
    let points: Vec<[f64; 2]> = (0..72).map(|i| (5.0 * f64::from(i)).to_radians()).map(|t| [cos(t), sin(t)]).collect();
    let input = json!({ "polygon": { "points": points, "closed": true } });
    let output = json!({ "format": "svg", "width": 500, "height": 500, "show": ["comb"] });
    let (bytes, _) = render(&json!({ "input": input, "outputs": [output] })).expect("it is drawn");
    let text = String::from_utf8(bytes).expect("SVG is text");
    let last = text.rsplit("d=\"M").next().expect("a line").split('"').next().expect("its places");
    let numbers: Vec<f64> = last.replace('L', " ").split(' ').map(|x| x.parse().expect("a number")).collect();
    let places = numbers.chunks(2).map(|p| [p[0] - 250.0, p[1] - 250.0]);
    let radii: Vec<f64> = places.map(|[x, y]| sqrt(x * x + y * y)).collect();
    let [low, high] = [f64::min, f64::max].map(|f| radii.iter().copied().fold(radii[0], f));
    assert!(radii.len() > 70 && high - low < 0.05 && low > 200.0, "{low} to {high}");
}

/// Rounding bends no line: neither a slanted one, nor one far from the origin.
#[test]
fn the_comb_of_a_straight_line_is_empty() {
    for far in [0.0, 1e6] {
        let points: Vec<[f64; 2]> = (0..5).map(|i| [far + 0.37 * f64::from(i), 0.1 + 0.73 * f64::from(i)]).collect();
        let text = svg(&json!({ "polygon": { "points": points } }), &json!({ "show": ["curve", "comb"] }));
        let teeth = text.split("class=\"comb\"").nth(1).map(|rest| rest.split("</g>").next().expect("an end"));
        assert!(teeth.is_none_or(|teeth| !teeth.contains("d=\"M")), "{far}: {text}");
    }
}

/// What is read out in place of a picture has no markup.
#[test]
fn titles_of_curves_and_figures_are_text() {
    let styles = json!([{ "label": "\\kappa_{max}" }]);
    let text = svg(&polygons(1, 2), &json!({ "styles": styles, "show": ["curve", "legend"] }));
    assert!(text.contains("<title>κmax</title>") && !text.contains("kappa"), "{text}");
    let panel = json!({ "job": job(&polygons(1, 2), &json!({ "format": "svg" })) });
    let figure = json!({ "title": "C^{4} and \\eta_1", "panels": [panel] });
    let (bytes, _) = render(&json!({ "figure": figure, "outputs": [{ "format": "svg" }] })).expect("it is drawn");
    let text = String::from_utf8(bytes).expect("SVG is text");
    assert!(text.contains("<title>C4 and η1</title>"), "{text}");
}

#[test]
fn texts_of_requests_stay_text() {
    let attack = "</text><script>alert(1)</script>";
    let options = json!({ "title": attack, "x_label": attack, "styles": [{ "label": attack }], "show": ["curve", "axes",
        "legend"] });
    let text = svg(&polygons(1, 2), &options);
    assert!(!text.contains("<script") && text.matches("&lt;script&gt;").count() >= 4, "{text}");
    assert_eq!(text.matches("<text").count(), text.matches("</text>").count());
}

#[test]
fn faults_are_told_at_their_places() {
    let found = |dimension: usize, output: Value| {
        let fault = render(&job(&polygons(1, dimension), &output)).expect_err("it is refused").remove(0);
        (fault.pointer, fault.detail)
    };
    for (dimension, output, place, part) in [
        (2, json!({ "format": "svg", "title": "漢" }), "/outputs/0/title", "U+6F22"),
        (2, json!({ "format": "png", "x_label": "\\foo" }), "/outputs/0/x_label", "foo"),
        (
            2,
            json!({ "format": "pdf", "styles": [{}, { "label": "a_" }] }),
            "/outputs/0/styles/1/label",
            "nothing follows",
        ),
        (3, json!({ "format": "svg", "show": ["axes"] }), "/outputs/0/show", "axes"),
        (1, json!({ "format": "svg", "show": ["comb"] }), "/outputs/0/show", "comb"),
        (2, json!({ "format": "svg", "show": ["silhouettes"] }), "/outputs/0/show", "silhouettes"),
    ] {
        let (pointer, detail) = found(dimension, output.clone());
        assert_eq!(pointer, place, "{output}: {detail}");
        assert!(detail.contains(part), "{output}: {detail}");
    }
}
