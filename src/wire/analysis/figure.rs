//! An analysis as a figure of one page: mask, basic limit function and derivatives, eigenvalues and smoothness, or the
//! results of a scan.

mod plot;

use super::markdown::number;
use super::{AnalysisAnswer, ScanAnswer, SchemeAnswer, SmoothnessAnswer, ValuesAnswer};
use crate::drawing::{Drawing, DrawingItem, FontWeight, HorizontalAlign, Label, Mark, Text, VerticalAlign};
use crate::wire::surface_analysis::{NetAnswer, SurfaceAnswer};
use crate::wire::tube_analysis::TubeAnswer;
use plot::{DISPROVED_COLOR, FUNCTION_COLOR, PROVED_COLOR, Plot, TEXT_INK, band, circle, dots, line, stems};

/// Width of the page in pixels.
const PAGE_WIDTH: u16 = 960;
/// Height of a row of plots with its heading, in pixels.
const PLOT_ROW_HEIGHT: u16 = 320;
/// Height of the text above the plots, in pixels.
const PAGE_HEAD_HEIGHT: u16 = 96;
/// Size of the text in pixels.
const TEXT_SIZE_PX: f32 = 14.0;

/// Returns the figure of an answer.
pub(super) fn figure(answer: &AnalysisAnswer) -> Drawing {
    match answer {
        AnalysisAnswer::Stationary(scheme) => of_scheme(scheme, &format!("Curve scheme of arity {}", scheme.arity)),
        AnalysisAnswer::Changing(changing) => {
            let proved = match changing.conclusion.proved_c {
                -1 => "nothing proved for the plan".to_owned(),
                k => format!("limits of the plan are C{k}"),
            };
            let title =
                format!("Static limit of a curve scheme of arity {} that follows alpha; {proved}", changing.arity);
            of_scheme(&changing.static_limit, &title)
        }
        AnalysisAnswer::Scan(scan) => of_scan(scan),
        AnalysisAnswer::Surface(surface) => of_surface(surface),
        AnalysisAnswer::Tube(tube) => of_tube(tube),
    }
}

/// Returns a page with a heading, lines of text below it, and plots in rows of `columns`.
fn page(title: &str, lines: &[String], plots: Vec<Plot>, columns: u16) -> Drawing {
    let rows = u16::try_from(plots.len()).unwrap_or(1).div_ceil(columns);
    // `PAGE_HEAD_HEIGHT` has room for two lines
    let head = PAGE_HEAD_HEIGHT + 20 * u16::try_from(lines.len().saturating_sub(2)).unwrap_or(0);
    let mut items = vec![text(title, [24.0, 36.0], 1.3 * TEXT_SIZE_PX, FontWeight::Bold)];
    for (k, line) in (0_u8..).zip(lines) {
        items.push(text(line, [24.0, 60.0 + 20.0 * f32::from(k)], TEXT_SIZE_PX, FontWeight::Regular));
    }
    let width = f32::from(PAGE_WIDTH) / f32::from(columns);
    for (k, plot) in (0_u16..).zip(plots) {
        let left = width * f32::from(k % columns);
        let top = f32::from(head) + f32::from(PLOT_ROW_HEIGHT * (k / columns));
        items.push(text(&plot.title, [left + 24.0, top + 24.0], TEXT_SIZE_PX, FontWeight::Bold));
        items.extend(
            plot.items([left + 8.0, top + 36.0, width - 24.0, f32::from(PLOT_ROW_HEIGHT) - 44.0], TEXT_SIZE_PX),
        );
    }
    let size = [u32::from(PAGE_WIDTH), u32::from(head + rows * PLOT_ROW_HEIGHT)];
    Drawing { size, background: [255; 4], title: title.to_owned(), items }
}

fn text(says: &str, at: [f32; 2], size_px: f32, weight: FontWeight) -> DrawingItem {
    // the texts are names and numbers; a text that cannot be set is left empty
    let label = Label::plain(says, weight).or_else(|_| Label::plain("", weight)).expect("an empty text can be set");
    let (anchor, level) = (HorizontalAlign::Start, VerticalAlign::Baseline);
    DrawingItem::new("label", Mark::Text(Text { label, at, size_px, anchor, level, turn_deg: 0.0, color: TEXT_INK }))
}

fn of_scheme(scheme: &SchemeAnswer, title: &str) -> Drawing {
    let [from, to] = scheme.support;
    let facts = format!(
        "sum rules {}, polynomials generated up to degree {}, reproduced up to degree {}, support [{}, {}]",
        scheme.sum_rules,
        scheme.generation_degree,
        scheme.reproduction_degree,
        number(from),
        number(to)
    );
    let mut plots = vec![mask(scheme)];
    if let Some(values) = &scheme.basic_limit_function {
        plots.push(function("Basic limit function", values));
    }
    let names = ["First derivative", "Second derivative", "Third derivative"];
    plots.extend(names.iter().zip(&scheme.derivatives).map(|(name, values)| function(name, values)));
    plots.push(eigenvalues(scheme));
    plots.push(smoothness(&scheme.smoothness, scheme.sum_rules));
    page(title, &[facts, verdict(&scheme.smoothness)], plots, 2)
}

fn verdict(smoothness: &SmoothnessAnswer) -> String {
    let proved = match smoothness.proved_c {
        -1 => "not proved to converge".to_owned(),
        k => format!("limits are C{k}"),
    };
    let disproved = smoothness.disproved_c.map(|k| format!(", not C{k}")).unwrap_or_default();
    let holder =
        smoothness.holder.map(|[from, to]| format!("; Hoelder exponent in [{}, {}]", number(from), number(to)));
    proved + &disproved + &holder.unwrap_or_default()
}

#[expect(clippy::cast_precision_loss, reason = "indices of masks are small")]
fn mask(scheme: &SchemeAnswer) -> Plot {
    let places = (scheme.mask.first..).map(|j| j as f64);
    let points: Vec<[f64; 2]> = places.zip(scheme.mask.values.iter().copied()).map(|(j, a)| [j, a]).collect();
    Plot::around("Mask", "index", "weight", vec![stems(points, FUNCTION_COLOR)])
}

fn function(title: &str, values: &ValuesAnswer) -> Plot {
    let ValuesAnswer { from, step, values } = values;
    let place = |k: usize| {
        #[expect(clippy::cast_precision_loss, reason = "grids are small")]
        let k = k as f64;
        from + k * step
    };
    let points = values.iter().enumerate().map(|(k, y)| [place(k), *y]).collect();
    Plot::around(title, "parameter", "value", vec![line(points, FUNCTION_COLOR)])
}

fn eigenvalues(scheme: &SchemeAnswer) -> Plot {
    let imaginary = scheme.local_eigenvalues_imaginary.as_deref().unwrap_or_default();
    let place = |(k, re): (usize, &f64)| [*re, imaginary.get(k).copied().unwrap_or(0.0)];
    let points: Vec<[f64; 2]> = scheme.local_eigenvalues.iter().enumerate().map(place).collect();
    #[expect(clippy::cast_precision_loss, reason = "arities are small")]
    let d = scheme.arity as f64;
    let mut marks: Vec<_> = [1.0, 1.0 / d, 1.0 / (d * d)].into_iter().map(circle).collect();
    marks.push(dots(points, FUNCTION_COLOR));
    Plot::within(
        "Local eigenvalues; circles of 1, 1/d, 1/d^2",
        ["real", "imaginary"],
        [[-2.0, 2.0], [-1.1, 1.1]],
        marks,
    )
    .in_one_scale()
}

/// Returns a plot along the orders k: proved and disproved orders, and the interval of the Hoelder exponent.
#[expect(clippy::cast_precision_loss, reason = "orders are small")]
fn smoothness(smoothness: &SmoothnessAnswer, order: usize) -> Plot {
    let most = (order as f64).max(1.0) + 0.5;
    let mut marks = Vec::new();
    if smoothness.proved_c >= 0 {
        marks.push(line(vec![[-0.5, 0.5], [smoothness.proved_c as f64, 0.5]], PROVED_COLOR));
        marks.push(dots((0..=smoothness.proved_c).map(|k| [k as f64, 0.5]).collect(), PROVED_COLOR));
    }
    if let Some(k) = smoothness.disproved_c {
        marks.push(line(vec![[k as f64, 0.5], [most, 0.5]], DISPROVED_COLOR));
        let disproved = (k..=i64::try_from(order).unwrap_or(k)).map(|k| [k as f64, 0.5]).collect();
        marks.push(dots(disproved, DISPROVED_COLOR));
    }
    if let Some([from, to]) = smoothness.holder {
        marks.push(band(vec![[from, 0.8], [to, 0.8]], vec![[from, 0.9], [to, 0.9]], FUNCTION_COLOR));
        marks.push(line(vec![[from, 0.75], [from, 0.95]], FUNCTION_COLOR));
        marks.push(line(vec![[to, 0.75], [to, 0.95]], FUNCTION_COLOR));
    }
    let title = "Proved (green), disproved (red), exponent (blue)";
    Plot::within(title, ["k", ""], [[-0.5, most], [0.0, 1.0]], marks)
}

fn of_scan(scan: &ScanAnswer) -> Drawing {
    let (from, to) = (scan.from.value, scan.to.value);
    let known = || scan.values.iter().filter_map(|row| Some((row, row.holder?)));
    let low: Vec<[f64; 2]> = known().map(|(row, [low, _])| [row.value, low]).collect();
    let high: Vec<[f64; 2]> = known().map(|(row, [_, high])| [row.value, high]).collect();
    let title = "Hoelder exponent: between its bounds";
    let mut exponent = Plot::around(
        title,
        "",
        "exponent",
        vec![band(low.clone(), high.clone(), FUNCTION_COLOR), line(low, FUNCTION_COLOR), line(high, FUNCTION_COLOR)],
    );
    exponent.set_x(scan.parameter.clone(), [from, to]);
    let most = scan.intervals.iter().map(|found| found.k).max().unwrap_or(0);
    let mut marks = Vec::new();
    for found in &scan.intervals {
        #[expect(clippy::cast_precision_loss, reason = "orders are small")]
        let k = found.k as f64;
        marks.push(line(vec![[found.from.value, k], [found.to.value, k]], PROVED_COLOR));
        let ends = [&found.disproved_below, &found.disproved_above];
        marks.push(dots(ends.into_iter().flatten().map(|end| [end.value, k]).collect(), DISPROVED_COLOR));
    }
    #[expect(clippy::cast_precision_loss, reason = "orders are small")]
    let range = [[from, to], [-0.5, most as f64 + 0.5]];
    let mut proved = Plot::within("C^k is proved (green); disproved next to it (red)", ["", "k"], range, marks);
    proved.set_x(scan.parameter.clone(), [from, to]);
    let facts = format!("{} from {} to {} in {} steps", scan.parameter, scan.from.exact, scan.to.exact, scan.steps);
    page("What is proved along a parameter", &[facts], vec![exponent, proved], 1)
}

/// Maximum number of characteristic nets on a page, usually those of the valences 3 to 8 without the regular one. Half
/// as many would omit some; twice as many would need a poster.
const MAX_NETS: usize = 6;

/// Maximum number of characteristic nets of boundary vertices on a page, usually those of one to four faces. Half as
/// many would show a corner and the regular one; twice as many would need a poster.
const MAX_HALVES: usize = 4;

fn of_surface(surface: &SurfaceAnswer) -> Drawing {
    let SurfaceAnswer { regular, valences, boundaries, .. } = surface;
    #[expect(clippy::cast_precision_loss, reason = "valences are small")]
    let by_valence = |value: fn(&crate::wire::surface_analysis::ValenceAnswer) -> Option<f64>| -> Vec<[f64; 2]> {
        valences.iter().filter_map(|of| Some([of.valence as f64, value(of)?])).collect()
    };
    let subdominant = by_valence(|of| of.eigenvalues.iter().find(|found| found.fourier == 1).map(|found| found.value));
    let ratio = by_valence(|of| of.subdominant_ratio);
    let mut plots = Vec::new();
    if !valences.is_empty() {
        plots.push(Plot::around(
            "Subdominant eigenvalue",
            "valence",
            "value",
            vec![stems(subdominant, FUNCTION_COLOR)],
        ));
        plots.push(Plot::around("The next eigenvalue over it", "valence", "ratio", vec![stems(ratio, FUNCTION_COLOR)]));
    }
    let nets = valences.iter().filter_map(|of| Some((of.valence, of.characteristic_net.as_ref()?)));
    plots.extend(nets.take(MAX_NETS).map(|(valence, net)| characteristic(&format!("valence {valence}"), net)));
    let facts: Vec<String> = valences.iter().map(|of| format!("{}: {}", of.valence, of.c1)).collect();
    let smooth = match regular.smoothness.proved_c {
        -1 => "not proved to converge".to_owned(),
        k => format!("C{k}"),
    };
    let mut lines = vec![format!("regular regions of {}: {smooth}", regular.faces)];
    if !facts.is_empty() {
        lines.push(format!("C1 by valence: {}", facts.join(", ")));
    }
    let known = boundaries.iter().filter(|of| of.refused.is_none());
    let edges: Vec<String> = known.map(|of| format!("{}: {}", of.faces, of.evidence)).collect();
    if !edges.is_empty() {
        lines.push(format!("C1 by faces on the boundary: {}", edges.join(", ")));
    }
    let nets = boundaries.iter().filter_map(|of| Some((of.faces, of.characteristic_net.as_ref()?)));
    plots.extend(nets.take(MAX_HALVES).map(|(faces, net)| {
        let faces = if faces == 1 { "1 face".to_owned() } else { format!("{faces} faces") };
        characteristic(&format!("{faces} on the boundary"), net)
    }));
    page("Scheme for surfaces", &lines, plots, 2)
}

fn of_tube(tube: &TubeAnswer) -> Drawing {
    let TubeAnswer { vertices, delta, factor, along, across, .. } = tube;
    let facts = format!("delta {}, limit radius over control radius {}", number(*delta), number(*factor));
    let plots = [("along", along), ("across", across)].map(|(name, scheme)| {
        let mut plot = mask(scheme);
        plot.title = format!("{} {name} latitude lines", plot.title);
        plot
    });
    page(&format!("Straight tube with {vertices} vertices around"), &[facts], plots.into(), 2)
}

fn characteristic(of: &str, net: &NetAnswer) -> Plot {
    let NetAnswer { points, faces } = net;
    let closed = |face: &Vec<usize>| face.iter().chain(face.first()).filter_map(|i| points.get(*i)).copied().collect();
    let marks = faces.iter().map(|face| line(closed(face), FUNCTION_COLOR)).collect();
    Plot::around(&format!("Characteristic net of {of}"), "", "", marks).in_one_scale()
}
