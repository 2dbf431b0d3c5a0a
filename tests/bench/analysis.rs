//! Analyses of schemes: what a question takes from the plan to the answer.

use std::hint::black_box;

use planish::job::{AnalysedVertices, Analysis, Inquiry, RequestedFindings, RequestedScan, SurfaceAnalysis};
use planish::math::parameter::Literal;
use planish::scheme::plan::PlanInput;
use planish::watch::Watch;
use planish::wire::analysis::AnalysisAnswer;

use crate::table::{Aim, Table, best, ms};

/// A preset, its parameters, and what stands in the table.
type Scheme = (&'static str, &'static [(&'static str, &'static str)]);

/// Milliseconds that an answer about a typical preset may take.
const TYPICAL_MS: f64 = 50.0;
/// Milliseconds that the answer about the 16-point scheme may take.
const SIXTEEN_POINT_MS: f64 = 2000.0;

/// Schemes for surfaces, each at the valences and boundaries that are looked at when nothing is said.
const SURFACES: &[Scheme] = &[
    ("catmull-clark", &[]),
    ("loop", &[]),
    ("doo-sabin", &[]),
    ("kobbelt", &[]),
    ("butterfly", &[]),
    ("sqrt-3", &[]),
    ("repeated-averaging", &[("degree", "7")]),
];

/// The usual ones, and those that take longest.
const SCHEMES: &[Scheme] = &[
    ("cubic-b-spline", &[]),
    ("four-point", &[("w", "1/16")]),
    ("four-point", &[("w", "1/10")]),
    ("four-point", &[("w", "0.1926")]),
    ("ternary-c4", &[("eta", "1/100")]),
    ("ternary-four-point", &[("mu", "1/11")]),
    ("push-back", &[("kernel", "10"), ("delta", "4/5")]),
    ("c-b-spline", &[("degree", "5"), ("alpha", "pi/3")]),
    ("two-n-point", &[("n", "4")]),
    ("two-n-point", &[("n", "8")]),
    ("two-n-point", &[("n", "16")]),
];

pub(crate) fn measure(table: &mut Table) {
    let mut first = None;
    for (name, parameters) in SCHEMES {
        let time = ms(best(|| answered(name, parameters, &RequestedFindings::default())));
        let ratio = format!("{:.1} times cubic-b-spline", time / *first.get_or_insert(time));
        let values: Vec<_> = parameters.iter().flat_map(|(name, value)| [*name, *value]).collect();
        let products = nodes(name, parameters);
        let detail = format!("{products} products, {:.0} a ms", f64::from(u32::try_from(products).unwrap_or(0)) / time);
        let label = format!("analysis {name} {}", values.join(" "));
        let aim = match (*name, *parameters) {
            ("two-n-point", [("n", "8")]) => Aim::Below(SIXTEEN_POINT_MS),
            ("two-n-point", [("n", "16")]) => Aim::None,
            _ => Aim::Below(TYPICAL_MS),
        };
        table.add(label.trim_end(), (time, "ms"), &ratio, aim, &detail);
    }
    let [from, to] = ["0", "1/60"].map(|text| Literal::Text(text.into()));
    let scan = RequestedScan { parameter: "eta".into(), from, to, steps: 200 };
    let time = ms(best(|| {
        answered("ternary-c4", &[], &RequestedFindings { scan: Some(scan.clone()), ..RequestedFindings::default() });
    }));
    let ratio = format!("{:.1} times cubic-b-spline", time / first.unwrap_or(time));
    table.add("analysis ternary-c4, 200 steps of eta", (time, "ms"), &ratio, Aim::None, "201 values and bisection");
    for (name, parameters) in SURFACES {
        let time = ms(best(|| on_surfaces(name, parameters)));
        let ratio = format!("{:.1} times cubic-b-spline", time / first.unwrap_or(time));
        let detail = "valences 3 to 12, 1 to 6 faces on the boundary";
        table.add(&format!("analysis {name}"), (time, "ms"), &ratio, Aim::None, detail);
    }
}

fn plan(name: &str, parameters: &[(&str, &str)]) -> PlanInput {
    let literal = |text: &str| text.parse().map_or_else(|_| Literal::Text(text.into()), Literal::Number);
    let parameters = parameters.iter().map(|(name, text)| ((*name).to_owned(), literal(text))).collect();
    PlanInput { preset: Some(name.to_owned()), parameters, ..PlanInput::default() }
}

fn on_surfaces(name: &str, parameters: &[(&str, &str)]) {
    let watch = Watch::new();
    let plan = plan(name, parameters);
    let surface =
        SurfaceAnalysis::new(&plan, AnalysedVertices::default(), None, None, &watch).expect("a scheme for surfaces");
    black_box(AnalysisAnswer::of(&Inquiry::Surface(Box::new(surface)), &watch).expect("nobody stops it"));
}

fn analysis(name: &str, parameters: &[(&str, &str)], requested: &RequestedFindings) -> Analysis {
    Analysis::new(&plan(name, parameters), requested, &Watch::new()).expect("a scheme for curves")
}

fn answered(name: &str, parameters: &[(&str, &str)], requested: &RequestedFindings) {
    let watch = Watch::new();
    let inquiry = Inquiry::Curve(Box::new(analysis(name, parameters, requested)));
    black_box(AnalysisAnswer::of(&inquiry, &watch).expect("nobody stops it"));
}

/// The products of matrices that were looked at.
fn nodes(name: &str, parameters: &[(&str, &str)]) -> u64 {
    let watch = Watch::new();
    analysis(name, parameters, &RequestedFindings::default()).run(&watch).expect("nobody stops it");
    watch.done()
}
