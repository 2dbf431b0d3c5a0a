//! `planish presets`, `operators` and `formats`: lists of presets, operators and formats, and their entries by name.

use std::fmt::Write;

use super::error::CliError;
use super::say::answer;
use crate::fault::{did_you_mean, shortened};
use crate::wire::catalogue::{
    ClaimEntry, FormatEntry, OperatorEntry, ParameterEntry, PresetEntry, formats, operators, presets, readers,
};

/// Prints a list of all presets, or the entry of one.
pub(super) fn list_presets(name: Option<&str>) -> Result<(), CliError> {
    let all = presets();
    let row = |preset: &PresetEntry| (preset.name.to_owned(), preset.refines.join(", "), brief(preset.doc).to_owned());
    let one = |PresetEntry { name, refines, parameters, doc, source, claims }: &PresetEntry| {
        let claims: String = claims.iter().map(claim).collect();
        page(&format!("{name} ({})\n{doc}\nSource: {source}{claims}", refines.join(", ")), parameters)
    };
    print(("preset", name), &all, |preset| preset.name.to_owned(), row, one)
}

/// Formats the claim of a preset as one line.
fn claim(claim: &ClaimEntry) -> String {
    let ClaimEntry { range, at: _, smoothness, support, reproduction_degree, of: _, c1_valences } = claim;
    let range = if range.is_empty() { "Claims" } else { range };
    let around = c1_valences.map(|[from, to]| format!(", C1 at valences {from} to {to}")).unwrap_or_default();
    format!(
        "\n{range}: limits C^k with k = {smoothness}, support of width {support}, reproduction of degree \
         {reproduction_degree}{around}"
    )
}

/// Prints a list of all operators, or the entry of one.
pub(super) fn list_operators(letter: Option<&str>) -> Result<(), CliError> {
    let all = operators();
    let row = |operator: &OperatorEntry| {
        (operator.letter.to_string(), operator.name.to_owned(), brief(operator.doc).to_owned())
    };
    let one = |OperatorEntry { letter, name, parameters, doc, source }: &OperatorEntry| {
        page(&format!("{letter} ({name})\n{doc}\nSource: {source}"), parameters)
    };
    print(("operator", letter), &all, |operator| operator.letter.to_string(), row, one)
}

/// Prints all output formats and all kinds of input files, or the entry of one format.
pub(super) fn list_formats(name: Option<&str>) -> Result<(), CliError> {
    let all = formats();
    let row = |format: &FormatEntry| (format.name.to_owned(), format.holds.join(", "), format.doc.to_owned());
    let one = |FormatEntry { name, media_type, extension, holds, options, doc }: &FormatEntry| {
        page(&format!("{name} ({media_type}, .{extension}; holds {})\n{doc}", holds.join(", ")), options)
    };
    print(("format", name), &all, |format| format.name.to_owned(), row, one)?;
    if name.is_none() {
        let rows: Vec<(String, String, String)> =
            readers().iter().map(|reader| (reader.name.to_owned(), String::new(), reader.doc.to_owned())).collect();
        answer(format!("\nInputs, besides jobs:\n{}", table(&rows)).as_bytes())?;
    }
    Ok(())
}

/// Prints the entry with this name, or one row for each entry.
fn print<T>(
    (what, name): (&str, Option<&str>),
    all: &[T],
    named: impl Fn(&T) -> String,
    row: impl Fn(&T) -> (String, String, String),
    one: impl Fn(&T) -> String,
) -> Result<(), CliError> {
    let Some(name) = name else {
        return answer(table(&all.iter().map(row).collect::<Vec<_>>()).as_bytes());
    };
    if let Some(found) = all.iter().find(|entry| named(entry) == name) {
        return answer(one(found).as_bytes());
    }
    let names: Vec<String> = all.iter().map(named).collect();
    let near = did_you_mean(name, names.iter().map(String::as_str));
    let name = shortened(name);
    Err(CliError::usage(format!("there is no {what} \"{name}\"; {near}`planish {what}s` lists them")))
}

/// Formats rows of three columns.
fn table(rows: &[(String, String, String)]) -> String {
    let width = |column: fn(&(String, String, String)) -> &String| rows.iter().map(|row| column(row).len()).max();
    let (first, second) = (width(|row| &row.0).unwrap_or(0), width(|row| &row.1).unwrap_or(0));
    rows.iter().fold(String::new(), |mut text, (a, b, c)| {
        let line = format!("{a:first$}  {b:second$}  {c}");
        let _ = writeln!(text, "{}", line.trim_end());
        text
    })
}

/// Formats a text followed by one line for each parameter.
fn page(text: &str, parameters: &[ParameterEntry]) -> String {
    parameters.iter().fold(format!("{text}\n"), |mut page, parameter| {
        let default = if parameter.required { "required".to_owned() } else { format!("default {}", parameter.default) };
        let unit = if parameter.unit.is_empty() { String::new() } else { format!(", {}", parameter.unit) };
        let _ = writeln!(page, "  {:14} {}{unit} ({default}). {}", parameter.name, parameter.expects, parameter.doc);
        page
    })
}

/// Returns the first sentence or clause of a text.
fn brief(doc: &str) -> &str {
    doc.split([':', ';', '.']).next().unwrap_or(doc)
}
