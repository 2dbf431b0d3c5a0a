//! The report on changed figures: Markdown with its pictures in folders beside it, and a self-contained HTML file.

use std::fmt::Write;
use std::path::Path;

use base64::Engine;
use quick_xml::escape::escape;
use serde_json::Value;

use super::compare::FigureDifference;
use super::manifest::put;
use crate::cli::error::CliError;

/// Maximum number of changed numbers listed per figure. Half of it would hide changes that belong together; twice of it
/// would bury the pictures.
const MAX_REPORTED_NUMBERS: usize = 40;

const REPORT_CSS: &str = "body{font:16px/1.5 system-ui,sans-serif;margin:2rem auto;max-width:80rem;padding:0 1rem;\
    color:#16263f}figure{margin:0;flex:1 1 20rem}img{max-width:100%;border:1px solid #d5dbe3}\
    .row{display:flex;flex-wrap:wrap;gap:1rem}table{border-collapse:collapse;margin:1rem 0}\
    td,th{border-bottom:1px solid #d5dbe3;padding:.2rem .8rem;text-align:left;font-variant-numeric:tabular-nums;\
    overflow-wrap:anywhere}";

/// Returns the pictures of a difference: caption, file name, bytes.
fn pictures(of: &FigureDifference) -> Vec<(&'static str, String, &[u8])> {
    let stem = &of.name;
    let all = [
        ("before", stem.clone(), &of.before),
        ("after", stem.clone(), &of.after),
        ("difference", format!("{stem}.png"), &of.where_),
        ("both from one camera, before and after", format!("{stem}.png"), &of.together),
    ];
    all.into_iter().filter_map(|(what, name, bytes)| Some((what, name, bytes.as_deref()?))).collect()
}

/// Writes the report into a folder: `report.md` with its pictures, and `report.html`.
pub(super) fn write(folder: &Path, head: &str, differences: &[FigureDifference]) -> Result<(), CliError> {
    let mut markdown = format!("# Figures\n\n{head}\n");
    let mut html = format!(
        "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><title>Figures</title>\n\
         <style>{REPORT_CSS}</style></head><body>\n<h1>Figures</h1>\n<p>{}</p>\n",
        escape(head)
    );
    for difference in differences {
        of_one(folder, difference, &mut markdown, &mut html)?;
    }
    html.push_str("</body></html>\n");
    put(&folder.join("report.md"), markdown.as_bytes())?;
    put(&folder.join("report.html"), html.as_bytes())
}

fn of_one(folder: &Path, of: &FigureDifference, markdown: &mut String, html: &mut String) -> Result<(), CliError> {
    let (name, description) = (&of.name, of.describe());
    let _ = write!(markdown, "\n## {name}\n\n{description}\n");
    let _ = write!(html, "<h2>{}</h2>\n<p>{}</p>\n<div class=\"row\">\n", escape(name), escape(&description));
    let shown = pictures(of);
    if !shown.is_empty() {
        let heads: Vec<&str> = shown.iter().map(|(what, ..)| *what).collect();
        let _ = write!(markdown, "\n| {} |\n|{}\n|", heads.join(" | "), "---|".repeat(shown.len()));
    }
    for (what, file, bytes) in shown {
        let folder_name = what.split([',', ' ']).next().unwrap_or(what);
        put(&folder.join(folder_name).join(&file), bytes)?;
        let data = base64::engine::general_purpose::STANDARD.encode(bytes);
        let media_type = media_type(&file);
        let source = format!("data:{media_type};base64,{data}");
        let mark = if media_type.starts_with("image/") { "!" } else { "" };
        let _ = write!(markdown, " {mark}[{what}]({folder_name}/{}) |", file.replace(' ', "%20"));
        let shown = if media_type.starts_with("image/") {
            format!("<img alt=\"{}\" src=\"{source}\">", escape(what))
        } else {
            format!("<a download=\"{}\" href=\"{source}\">{}</a>", escape(&file), escape(&file))
        };
        let _ = writeln!(html, "<figure>{shown}<figcaption>{}</figcaption></figure>", escape(what));
    }
    html.push_str("</div>\n");
    markdown.push('\n');
    numbers(of, markdown, html);
    Ok(())
}

/// Writes the table of the changed numbers.
fn numbers(of: &FigureDifference, markdown: &mut String, html: &mut String) {
    if of.before.is_none() || of.after.is_none() || of.numbers.is_empty() {
        return;
    }
    markdown.push_str("\n| number | before | after |\n|---|---|---|\n");
    html.push_str("<table><tr><th>number</th><th>before</th><th>after</th></tr>\n");
    let text = |value: &Option<Value>| value.as_ref().map_or_else(|| "-".to_owned(), ToString::to_string);
    for (name, before, after) in of.numbers.iter().take(MAX_REPORTED_NUMBERS) {
        let (before, after) = (text(before), text(after));
        let _ = writeln!(markdown, "| {name} | {before} | {after} |");
        let (name, before, after) = (escape(name), escape(&before), escape(&after));
        let _ = writeln!(html, "<tr><td>{name}</td><td>{before}</td><td>{after}</td></tr>");
    }
    html.push_str("</table>\n");
    if let Some(more) = of.numbers.len().checked_sub(MAX_REPORTED_NUMBERS).filter(|more| *more > 0) {
        let _ = writeln!(markdown, "\nand {more} more");
        let _ = writeln!(html, "<p>and {more} more</p>");
    }
}

fn media_type(file: &str) -> &'static str {
    let extension = file.rsplit('.').next().unwrap_or_default();
    let format = crate::output::FORMATS.iter().find(|format| format.extension() == extension);
    format.map_or("application/octet-stream", |format| format.media_type())
}
