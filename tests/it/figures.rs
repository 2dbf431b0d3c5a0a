//! The pictures of `docs/curves` are the results of their jobs, and `docs/presets.md` has a section for each preset of
//! curves with the facts of the catalogue.
//!
//! The pictures of `docs/creases.md`, `docs/data.md`, `docs/pictures.md` and `docs/surfaces.md` are the results of the
//! example jobs of their names.
//!
//! `BLESS=1 cargo test --test it figures::` writes the pictures and the sections anew.

use std::collections::BTreeSet;
use std::fs;
use std::path::PathBuf;

use planish::wire::catalogue::{ParameterEntry, PresetEntry, presets};
use serde_json::Value;

use crate::support::render;

/// The line of the page after which the text is generated from the catalogue.
const MARK: &str = "<!-- From here on the sections follow the catalogue. -->\n";
const MAX_BYTES: usize = 80 << 10;
const ENDS: [&str; 5] =
    ["ends-clamped-primal", "ends-clamped-dual", "ends-clamped-wide", "ends-incenter", "ends-natural"];

fn path(inside: &str) -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join(inside)
}

fn blessing() -> bool {
    std::env::var_os("BLESS").is_some()
}

fn curves() -> Vec<&'static str> {
    presets().iter().filter(|preset| preset.refines.contains(&"polygons")).map(|preset| preset.name).collect()
}

fn job(name: &str) -> Value {
    let path = path(&format!("api/examples/jobs/figure-{name}-png.json"));
    let text = fs::read_to_string(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    serde_json::from_str(&text).expect("a job is JSON")
}

#[test]
fn pictures_are_what_their_jobs_render() {
    for name in curves().into_iter().chain(ENDS) {
        let job = job(name);
        assert!(ENDS.contains(&name) || job["plan"]["preset"] == name, "the figure of {name} shows another preset");
        let (bytes, _) = render(&job).unwrap_or_else(|faults| panic!("{name}: {faults:?}"));
        assert!(bytes.len() <= MAX_BYTES, "the picture of {name} has {} bytes", bytes.len());
        let picture = path(&format!("docs/curves/{name}.png"));
        if blessing() {
            fs::write(&picture, &bytes).expect("the picture can be written");
        }
        let committed = fs::read(&picture).unwrap_or_else(|error| panic!("{}: {error}", picture.display()));
        assert!(committed == bytes, "docs/curves/{name}.png is not what its job renders");
    }
}

#[test]
fn drawings_are_what_their_jobs_draw() {
    let page = fs::read_to_string(path("docs/drawings.md")).expect("the page is there");
    let names: Vec<&str> =
        page.split("src=\"drawings/").skip(1).filter_map(|rest| rest.split(".svg\"").next()).collect();
    assert!(names.len() > 4, "{names:?}");
    for name in names {
        let text = fs::read_to_string(path(&format!("api/examples/jobs/drawing-{name}-svg.json"))).expect("a job");
        let job = serde_json::from_str(&text).expect("a job is JSON");
        let (bytes, _) = render(&job).unwrap_or_else(|faults| panic!("{name}: {faults:?}"));
        let file = path(&format!("docs/drawings/{name}.svg"));
        if blessing() {
            fs::write(&file, &bytes).expect("the drawing can be written");
        }
        assert!(
            fs::read(&file).is_ok_and(|known| known == bytes),
            "docs/drawings/{name}.svg is not what its job draws"
        );
    }
}

/// The results of the example jobs are identified by their hashes.
#[test]
fn pictures_of_surfaces_are_the_results_of_their_jobs() {
    let hashes = fs::read_to_string(path("tests/golden/hashes.txt")).expect("the table is there");
    let mut n = 0;
    for page in ["docs/creases.md", "docs/data.md", "docs/pictures.md", "docs/surfaces.md"] {
        let text = fs::read_to_string(path(page)).expect("the page is there");
        let files = text.split("src=\"surfaces/").skip(1).filter_map(|rest| rest.split('"').next());
        for name in files.filter_map(|file| file.strip_suffix(".png")) {
            let bytes = fs::read(path(&format!("docs/surfaces/{name}.png"))).expect("the picture is there");
            let line = format!("{name}-png png {}", planish::job::key::content(&bytes));
            assert!(hashes.lines().any(|known| known == line), "{page}: {name}.png is not what its job renders");
            n += 1;
        }
    }
    assert!(n > 50, "{n} pictures");
}

/// The figures of the papers are the results of their jobs, too; the page shows a picture of each, and their total size
/// is bounded.
#[test]
fn the_figures_of_the_papers_are_the_results_of_their_jobs() {
    const MAX_TOTAL_BYTES: u64 = 5 << 20;
    let hashes = fs::read_to_string(path("tests/golden/hashes.txt")).expect("the table is there");
    let page = fs::read_to_string(path("docs/papers-figures.md")).expect("the page is there");
    let mut bytes_of_all = 0;
    for entry in fs::read_dir(path("api/examples/figures")).expect("the jobs are there") {
        let file = entry.expect("an entry").path();
        let name = file.file_stem().expect("a name").to_string_lossy().into_owned();
        let picture = format!("figures/{name}.png");
        if blessing() {
            let text = fs::read_to_string(&file).expect("the job can be read");
            let job = serde_json::from_str(&text).expect("a job is JSON");
            let (bytes, _) = render(&job).unwrap_or_else(|faults| panic!("{name}: {faults:?}"));
            fs::create_dir_all(path("docs/figures")).expect("the folder can be made");
            fs::write(path(&format!("docs/{picture}")), bytes).expect("the picture can be written");
        }
        let bytes = fs::read(path(&format!("docs/{picture}"))).expect("the picture is there");
        bytes_of_all += bytes.len() as u64;
        let line = format!("figures/{name} png {}", planish::job::key::content(&bytes));
        assert!(hashes.lines().any(|known| known == line), "docs/{picture} is not what its job renders");
        let (width, _) = image::image_dimensions(path(&format!("docs/{picture}"))).expect("a picture has a size");
        let shown = format!("src=\"{picture}\" width=\"{}\"", width / 2);
        assert!(page.contains(&shown), "{name} is not shown at half its size, for screens with two pixels in one");
        assert!(page.contains(&format!("(../api/examples/figures/{name}.json)")), "the job of {name} is not named");
    }
    assert!((1..=MAX_TOTAL_BYTES).contains(&bytes_of_all), "{bytes_of_all} bytes");
}

#[test]
fn every_picture_is_shown() {
    if blessing() {
        return; // the page is being written
    }
    let page = fs::read_to_string(path("docs/presets.md")).expect("the page is there");
    let shown: BTreeSet<&str> =
        page.split("src=\"curves/").skip(1).filter_map(|rest| rest.split(".png\"").next()).collect();
    let files = fs::read_dir(path("docs/curves")).expect("the pictures are there");
    let names = files.map(|file| file.expect("an entry").file_name().to_string_lossy().into_owned());
    let pictures: BTreeSet<String> = names.filter_map(|name| Some(name.strip_suffix(".png")?.to_owned())).collect();
    assert_eq!(shown.into_iter().map(str::to_owned).collect::<BTreeSet<_>>(), pictures);
}

#[test]
fn the_page_says_what_the_catalogue_says() {
    let file = path("docs/presets.md");
    let page = fs::read_to_string(&file).expect("the page is there");
    let (head, sections) = page.split_once(MARK).expect("the page has the mark");
    let expected = sections_of_presets();
    if blessing() {
        fs::write(&file, format!("{head}{MARK}{expected}")).expect("the page can be written");
    } else {
        assert_eq!(sections, expected);
    }
}

fn sections_of_presets() -> String {
    presets().iter().filter(|preset| preset.refines.contains(&"polygons")).map(section).collect()
}

fn section(preset: &PresetEntry) -> String {
    let PresetEntry { name, doc, source, .. } = preset;
    let plan = serde_json::to_string(&job(name)["plan"]).expect("a plan is JSON");
    let picture = format!("<img src=\"curves/{name}.png\" width=\"400\" alt=\"A curve by {name}\">");
    let job = format!("[The job](../api/examples/jobs/figure-{name}-png.json) has the plan `{plan}`.");
    let head = format!("\n## {name}\n\n{doc}\n\nSource: {source}.\n\n{picture}\n\n{job}\n");
    let table =
        if preset.parameters.is_empty() { "" } else { "\n| Parameter | Is | Default | Does |\n|---|---|---|---|\n" };
    head + table + &preset.parameters.iter().map(row).collect::<String>()
}

fn row(parameter: &ParameterEntry) -> String {
    let unit = if parameter.unit.is_empty() { String::new() } else { format!(", {}", parameter.unit) };
    let default = match &parameter.default {
        Value::Null if parameter.required => "required".to_owned(),
        Value::Null => "none".to_owned(),
        value => value.to_string(),
    };
    format!("| `{}` | {}{unit} | {default} | {} |\n", parameter.name, parameter.expects, parameter.doc)
}
