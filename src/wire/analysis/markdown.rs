//! An analysis as a report in Markdown.

use std::fmt::Write;

use super::{
    AnalysisAnswer, ChangingAnswer, LevelBoundAnswer, MaskAnswer, MatricesAnswer, MatrixAnswer, ScanAnswer,
    SchemeAnswer, SmoothnessAnswer,
};
use crate::wire::surface_analysis::{BoundaryAnswer, InputSurveyAnswer, SurfaceAnswer};
use crate::wire::tube_analysis::TubeAnswer;

/// Maximum number of columns of matrices that are written out. Wider ones do not fit on a page; the JSON has them.
const MAX_MATRIX_COLUMNS: usize = 16;

/// Returns the report of an answer.
pub(super) fn report(answer: &AnalysisAnswer) -> String {
    let mut text = String::new();
    // writing to a `String` cannot fail
    let _ = match answer {
        AnalysisAnswer::Stationary(scheme) => {
            write!(text, "# A curve scheme of arity {}\n\n", scheme.arity).and_then(|()| of_scheme(&mut text, scheme))
        }
        AnalysisAnswer::Changing(changing) => of_changing(&mut text, changing),
        AnalysisAnswer::Scan(scan) => of_scan(&mut text, scan),
        AnalysisAnswer::Surface(surface) => of_surface(&mut text, surface),
        AnalysisAnswer::Tube(tube) => of_tube(&mut text, tube),
    };
    text
}

type FmtResult = std::fmt::Result;

fn of_scheme(text: &mut String, scheme: &SchemeAnswer) -> FmtResult {
    writeln!(text, "| Quantity | Value |\n|---|---|")?;
    writeln!(text, "| limits | {} |", verdict(scheme.smoothness.proved_c, scheme.smoothness.disproved_c))?;
    if let Some(holder) = scheme.smoothness.holder {
        writeln!(text, "| Hoelder exponent | {} |", interval(holder))?;
    }
    writeln!(text, "| sum rules | {} |", scheme.sum_rules)?;
    writeln!(text, "| polynomials generated up to degree | {} |", scheme.generation_degree)?;
    writeln!(text, "| polynomials reproduced up to degree | {} |", scheme.reproduction_degree)?;
    let shift = scheme.shift.exact.clone().unwrap_or_else(|| number(scheme.shift.value));
    writeln!(text, "| parameter shift | {shift} |")?;
    let [from, to] = scheme.support;
    writeln!(text, "| support | [{}, {}], width {} |", number(from), number(to), number(to - from))?;
    writeln!(text, "| control points with a say in a limit point | {} |", scheme.influence)?;
    text.push_str("\n## Mask\n\n");
    weights(text, "mask", &scheme.mask)?;
    for (r, mask) in scheme.sub_masks.iter().enumerate() {
        weights(text, &format!("new points {r} modulo {}", scheme.arity), mask)?;
    }
    weights(text, "residual of the symbol", &scheme.residual)?;
    of_smoothness(text, &scheme.smoothness)?;
    text.push_str("\n## Around a point\n\n");
    if let Some(mask) = &scheme.limit_mask {
        weights(text, "limit point", mask)?;
    }
    if let Some(mask) = &scheme.tangent_mask {
        weights(text, "tangent", mask)?;
    }
    writeln!(text, "- eigenvalues of the local matrix: {}", eigenvalues(scheme))?;
    if let Some(matrices) = &scheme.matrices {
        of_matrices(text, matrices)?;
    }
    let Some(input) = &scheme.input else { return Ok(()) };
    of_levels(text, &input.bounds, input.bounds_refused.as_deref(), &input.warnings)
}

/// Writes how close the levels of an input are to its limit, and the warnings about it.
fn of_levels(text: &mut String, bounds: &[LevelBoundAnswer], refused: Option<&str>, warnings: &[String]) -> FmtResult {
    text.push_str("\n## The input\n\n");
    if let Some(reason) = refused {
        writeln!(text, "- distances of its levels from the limit are not known: {reason}")?;
    } else {
        text.push_str("| Level | At most so far from the limit, model units |\n|---|---|\n");
        bounds.iter().try_for_each(|of| writeln!(text, "| {} | {} |", of.level, number(of.bound)))?;
        text.push('\n');
    }
    warnings.iter().try_for_each(|warning| writeln!(text, "- warning: {warning}"))
}

fn verdict(proved_c: i64, disproved_c: Option<i64>) -> String {
    let proved = match proved_c {
        -1 => "not proved to converge".to_owned(),
        k => format!("C{k} (proved)"),
    };
    let disproved = disproved_c.map(|k| format!(", not C{k} (proved)"));
    proved + &disproved.unwrap_or_else(|| ", nothing disproved".to_owned())
}

fn of_smoothness(text: &mut String, smoothness: &SmoothnessAnswer) -> FmtResult {
    text.push_str("\n## Smoothness\n\n");
    if !smoothness.certificates.is_empty() {
        text.push_str("| C^k | steps l | norm of l steps of the difference scheme |\n|---|---|---|\n");
        for certificate in &smoothness.certificates {
            writeln!(text, "| {} | {} | {} |", certificate.k, certificate.l, certificate.norm)?;
        }
        text.push('\n');
    }
    if let Some(radius) = smoothness.joint_spectral_radius {
        write!(text, "- joint spectral radius: {}, from below ", interval(radius))?;
        match smoothness.extremal_word.as_slice() {
            [] => write!(text, "by the mean of the matrices")?,
            word => write!(text, "by the product {word:?}")?,
        }
        let norm = smoothness.norm.unwrap_or("row sums");
        writeln!(text, ", from above by {} products in {norm}", smoothness.nodes)?;
    }
    let stable = if smoothness.stable { "stable" } else { "not proved to be stable" };
    writeln!(text, "- integer shifts of the basic limit function: {stable}")?;
    if let Some(reduction) = &smoothness.reduction {
        text.push_str("- the basic limit function is a combination of shifts of that of another scheme, as smooth:\n");
        weights(text, "weights of the shifts", &reduction.combination)?;
        weights(text, "mask of the other scheme", &reduction.mask)?;
    }
    smoothness.assumptions.iter().try_for_each(|assumption| writeln!(text, "- assumption: {assumption}"))
}

fn of_changing(text: &mut String, changing: &ChangingAnswer) -> FmtResult {
    let ChangingAnswer { arity, levels, rate, exponentials, static_limit, conclusion, input, .. } = changing;
    write!(text, "# A curve scheme of arity {arity} whose mask follows alpha\n\n")?;
    match conclusion.proved_c {
        -1 => writeln!(text, "Nothing is concluded for its limits.")?,
        k => writeln!(text, "Limits are C{k} (proved).")?,
    }
    writeln!(text, "\n- {}", conclusion.theorem)?;
    conclusion.assumptions.iter().try_for_each(|assumption| writeln!(text, "- assumption: {assumption}"))?;
    let keeps = if *exponentials { "reproduced by every level" } else { "not reproduced by every level" };
    writeln!(text, "- cos and sin with the spacing alpha: {keeps}")?;
    writeln!(text, "- sum rules that every level has: {}", conclusion.sum_rules)?;
    if let Some(rate) = rate {
        writeln!(text, "- distances from the static limit shrink by {} a level", number(*rate))?;
    }
    text.push_str("\n## Theorems\n\n| Theorem | Applies | Found | Proves |\n|---|---|---|---|\n");
    for theorem in &conclusion.theorems {
        let applies = if theorem.applies { "yes" } else { "no" };
        // an unescaped bar would end the cell
        let because = theorem.because.replace('|', "\\|");
        writeln!(text, "| {} | {applies} | {because} | {} |", theorem.name, theorem.proves)?;
    }
    text.push_str("\n## Levels\n\n| Level | alpha | Sum rules | Distance from the static limit |\n|---|---|---|---|\n");
    for (h, level) in levels.iter().enumerate() {
        writeln!(text, "| {h} | {} | {} | {:.3e} |", number(level.alpha), level.sum_rules, level.distance)?;
    }
    if let Some(input) = input {
        of_levels(text, &input.bounds, input.bounds_refused.as_deref(), &input.warnings)?;
    }
    text.push_str("\n# The static limit\n\n");
    of_scheme(text, static_limit)
}

fn of_surface(text: &mut String, surface: &SurfaceAnswer) -> FmtResult {
    let SurfaceAnswer { arity, regular, valences, boundaries, assumptions, .. } = surface;
    write!(text, "# A scheme for surfaces of {}, edges divided by {arity}\n\n", regular.faces)?;
    let limits = verdict(regular.smoothness.proved_c, regular.smoothness.disproved_c);
    writeln!(text, "Where nothing is extraordinary limits are {limits}, by {}.", regular.smoothness.by)?;
    text.push_str("\n## Valences\n\n| Valence | C1 | Evidence | Subdominant eigenvalue | Next over it |");
    text.push_str(" Least sine of the characteristic net |\n|---|---|---|---|---|---|\n");
    for of in valences {
        let or_none = |x: Option<f64>| x.map_or_else(|| "-".to_owned(), number);
        let subdominant = of.eigenvalues.iter().find(|found| found.fourier == 1).map(|found| found.value);
        let cells = [subdominant, of.subdominant_ratio, of.characteristic_map_min_sine].map(or_none).join(" | ");
        writeln!(text, "| {} | {} | {} | {cells} |", of.valence, of.c1, of.evidence)?;
    }
    of_boundaries(text, boundaries)?;
    text.push_str("\n## Limit masks\n\n");
    for of in valences {
        let weights: Vec<String> = of.limit_mask.iter().map(|(name, w)| format!("{name} {}", number(*w))).collect();
        writeln!(text, "- valence {}: {}", of.valence, weights.join(", "))?;
    }
    assumptions.iter().try_for_each(|assumption| writeln!(text, "- assumption: {assumption}"))?;
    surface.input.as_ref().map_or(Ok(()), |input| of_mesh(text, input))
}

/// Writes the results for a mesh: its levels, and its extraordinary and boundary vertices.
fn of_mesh(text: &mut String, input: &InputSurveyAnswer) -> FmtResult {
    of_levels(text, &input.bounds, input.bounds_refused.as_deref(), &input.warnings)?;
    let not_looked_at = "not looked at";
    if !input.extraordinary.is_empty() {
        text.push_str("\n| Extraordinary, of valence | Vertices | Faces | C1 |\n|---|---|---|---|\n");
    }
    for of in &input.extraordinary {
        let c1 = of.c1.unwrap_or(not_looked_at);
        writeln!(text, "| {} | {} | {} | {c1} |", of.valence, of.n_vertices, of.n_faces)?;
    }
    if !input.boundary.is_empty() {
        text.push_str("\n| On the boundary, with faces | Vertices | C1 |\n|---|---|---|\n");
    }
    for of in &input.boundary {
        writeln!(text, "| {} | {} | {} |", of.faces, of.n_vertices, of.c1.unwrap_or(not_looked_at))?;
    }
    Ok(())
}

fn of_boundaries(text: &mut String, boundaries: &[BoundaryAnswer]) -> FmtResult {
    text.push_str("\n## Boundary vertices\n\n| Faces | Side of a crease | Evidence | Along | Across |");
    text.push_str(" Least sine of the characteristic net |\n|---|---|---|---|---|---|\n");
    for of in boundaries {
        if let Some(reason) = &of.refused {
            writeln!(text, "| {} | - | {reason} | - | - | - |", of.faces)?;
            continue;
        }
        let next = |odd: bool| {
            let found = of.eigenvalues.iter().filter(|found| found.odd == odd).nth(usize::from(!odd));
            found.map_or_else(|| "-".to_owned(), |found| number(found.value))
        };
        let sine = of.characteristic_map_min_sine.map_or_else(|| "-".to_owned(), number);
        let crease = if of.crease { "yes" } else { "no" };
        writeln!(text, "| {} | {crease} | {} | {} | {} | {sine} |", of.faces, of.evidence, next(true), next(false))?;
    }
    Ok(())
}

fn of_tube(text: &mut String, tube: &TubeAnswer) -> FmtResult {
    let TubeAnswer { vertices, alpha, delta, factor, control_radius, limit_radius, along, across, .. } = tube;
    write!(text, "# A straight tube with {vertices} vertices around\n\n| Quantity | Value |\n|---|---|\n")?;
    let or_none = |x: &Option<f64>| x.map_or_else(|| "-".to_owned(), number);
    writeln!(text, "| alpha | {} |\n| delta | {} |", number(*alpha), number(*delta))?;
    writeln!(text, "| limit radius over control radius | {} |", number(*factor))?;
    writeln!(text, "| control radius | {} |\n| limit radius | {} |", or_none(control_radius), or_none(limit_radius))?;
    text.push_str("\n## Along latitude lines\n\n");
    of_scheme(text, along)?;
    text.push_str("\n## Across latitude lines\n\n");
    of_scheme(text, across)
}

fn of_scan(text: &mut String, scan: &ScanAnswer) -> FmtResult {
    let ScanAnswer { parameter, from, to, steps, values, intervals, .. } = scan;
    write!(text, "# {parameter} from {} to {} in {steps} steps\n\n", from.exact, to.exact)?;
    text.push_str(
        "## Where C^k is proved\n\n| k | from | to | disproved below | disproved above |\n|---|---|---|---|---|\n",
    );
    for found in intervals {
        let end = |end: &Option<super::ExactAnswer>| end.as_ref().map_or_else(|| "-".to_owned(), |x| decimal(x.value));
        let [below, above] = [&found.disproved_below, &found.disproved_above].map(end);
        writeln!(
            text,
            "| {} | {} | {} | {below} | {above} |",
            found.k,
            decimal(found.from.value),
            decimal(found.to.value)
        )?;
    }
    write!(
        text,
        "\n## Values\n\n| {parameter} | sum rules | proved | disproved | Hoelder exponent |\n|---|---|---|---|---|\n"
    )?;
    for row in values {
        let Some(proved) = row.proved_c else {
            writeln!(text, "| {} | - | - | - | {} |", row.exact, row.refused.as_deref().unwrap_or("-"))?;
            continue;
        };
        let or_none = |n: Option<String>| n.unwrap_or_else(|| "-".to_owned());
        let proved = if proved < 0 { "-".to_owned() } else { format!("C{proved}") };
        let disproved = or_none(row.disproved_c.map(|k| format!("C{k}")));
        let sum_rules = or_none(row.sum_rules.map(|n| n.to_string()));
        let holder = or_none(row.holder.map(interval));
        writeln!(text, "| {} | {sum_rules} | {proved} | {disproved} | {holder} |", row.exact)?;
    }
    Ok(())
}

fn of_matrices(text: &mut String, matrices: &MatricesAnswer) -> FmtResult {
    let ends = if matrices.closed { "a closed" } else { "an open" };
    write!(text, "\n## One step on {ends} polygon of {} points\n", matrices.points)?;
    for step in &matrices.steps {
        matrix(text, &format!("{} ({})", step.name, step.role), &step.matrix)?;
        if let Some(coarse) = &step.coarse {
            matrix(text, &format!("{}: of the points before the splitting", step.name), coarse)?;
        }
    }
    matrix(text, "product", &matrices.product)?;
    for (k, power) in matrices.local.powers.iter().enumerate() {
        matrix(text, &format!("local matrix to the power {}", k + 1), power)?;
    }
    matrices.local.limit.as_ref().map_or(Ok(()), |limit| matrix(text, "limit of the powers", limit))
}

fn matrix(text: &mut String, name: &str, matrix: &MatrixAnswer) -> FmtResult {
    write!(text, "\n### {name}\n\n")?;
    let columns = matrix.rows.first().map_or(0, Vec::len);
    if columns > MAX_MATRIX_COLUMNS {
        return writeln!(text, "{} x {columns} numbers, which the JSON has.", matrix.rows.len());
    }
    writeln!(text, "|{}\n|{}", " |".repeat(columns), "---|".repeat(columns))?;
    for (r, row) in matrix.rows.iter().enumerate() {
        let cells: Vec<String> = match &matrix.exact {
            Some(exact) => exact[r].clone(),
            None => row.iter().copied().map(number).collect(),
        };
        writeln!(text, "| {} |", cells.join(" | "))?;
    }
    Ok(())
}

fn weights(text: &mut String, name: &str, mask: &MaskAnswer) -> FmtResult {
    let values = match &mask.exact {
        Some(exact) => exact.clone(),
        None => mask.values.iter().copied().map(number).collect(),
    };
    let last = mask.first + i64::try_from(values.len()).unwrap_or(1) - 1;
    writeln!(text, "- {name}, indices {} to {last}: {}", mask.first, values.join(", "))
}

fn eigenvalues(scheme: &SchemeAnswer) -> String {
    let imaginary = scheme.local_eigenvalues_imaginary.as_deref().unwrap_or_default();
    let one = |(k, re): (usize, &f64)| match imaginary.get(k).copied().unwrap_or(0.0) {
        0.0 => number(*re),
        im if im < 0.0 => format!("{} - {}i", number(*re), number(-im)),
        im => format!("{} + {}i", number(*re), number(im)),
    };
    scheme.local_eigenvalues.iter().enumerate().map(one).collect::<Vec<_>>().join(", ")
}

fn interval([from, to]: [f64; 2]) -> String {
    if from.to_bits() == to.to_bits() { number(from) } else { format!("[{}, {}]", number(from), number(to)) }
}

/// Formats a number with up to six decimals; smaller ones than 1e-4 in scientific notation.
pub(super) fn number(x: f64) -> String {
    if x != 0.0 && x.abs() < 1e-4 {
        return format!("{x:.3e}");
    }
    trimmed(&format!("{x:.6}"))
}

/// Formats a number with up to nine decimals, the precision of the bisection.
fn decimal(x: f64) -> String {
    trimmed(&format!("{x:.9}"))
}

fn trimmed(text: &str) -> String {
    let text = if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.') } else { text };
    if text == "-0" { "0".to_owned() } else { text.to_owned() }
}
