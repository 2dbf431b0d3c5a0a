//! The layering of the modules: each folder imports from lower floors only, and some words must not occur on some
//! floors.
//!
//! The tests read the text of `src` without comments.

mod imports;

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

use imports::{Crate, circles};
use planish::scheme::presets::PRESETS;

/// Every root module of the crate with its floor; all modules may use leaves, which are on no floor.
const FLOORS: &[(&str, u32)] = &[
    ("math", 1),
    ("drawing", 2),
    ("raster", 2),
    ("shape", 2),
    ("scheme", 3),
    ("refine", 4),
    ("solid", 4),
    ("output", 5),
    ("analysis", 5),
    ("input", 5),
    ("job", 6),
    ("service", 7),
    ("config", 7),
    ("wire", 8),
    ("http", 9),
    ("cli", 9),
];
const LEAVES: &[&str] = &["fault", "kept", "watch"];
/// The one import between neighbours: the command `serve` starts the server.
const NEIGHBOURS: &[(&str, &str)] = &[("cli", "http")];
const MAX_LINES: usize = 400;

/// A source file: its root module, its path, its text, and its lines without comments.
struct Source {
    module: String,
    path: PathBuf,
    text: String,
    lines: Vec<String>,
    n_lines: usize,
}

impl Source {
    fn floor(&self) -> Option<u32> {
        floor(&self.module)
    }

    /// Fails at the first line that contains one of the words.
    fn never_says(&self, words: &[&str]) {
        for (i, line) in self.lines.iter().enumerate() {
            for word in words {
                assert!(
                    !line.contains(word),
                    "{}:{}: \"{word}\" has no place here: {line}",
                    self.path.display(),
                    i + 1
                );
            }
        }
    }
}

fn floor(module: &str) -> Option<u32> {
    FLOORS.iter().find(|(name, _)| *name == module).map(|(_, floor)| *floor)
}

fn sources() -> Vec<Source> {
    let root = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("src");
    let mut found = Vec::new();
    read(&root, &root, &mut found);
    assert!(found.len() > 50, "the sources were not found");
    found
}

fn read(folder: &Path, root: &Path, found: &mut Vec<Source>) {
    let mut entries: Vec<PathBuf> =
        fs::read_dir(folder).expect("a folder can be read").map(|entry| entry.expect("an entry").path()).collect();
    entries.sort();
    for path in entries {
        if path.is_dir() {
            read(&path, root, found);
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            let text = fs::read_to_string(&path).expect("a source can be read");
            let inside = path.strip_prefix(root).expect("below the root");
            let first = inside.components().next().expect("a name").as_os_str().to_string_lossy();
            let code = |line: &str| line.split("//").next().unwrap_or_default().to_owned();
            found.push(Source {
                module: first.trim_end_matches(".rs").to_owned(),
                path: inside.to_owned(),
                lines: text.lines().map(code).collect(),
                n_lines: text.lines().count(),
                text,
            });
        }
    }
}

/// Returns the names that follow `crate::` in a line.
fn imports(line: &str) -> impl Iterator<Item = &str> {
    line.match_indices("crate::").map(|(at, found)| {
        let rest = &line[at + found.len()..];
        rest.split(|c: char| !c.is_ascii_alphanumeric() && c != '_').next().unwrap_or_default()
    })
}

#[test]
fn each_folder_imports_from_lower_floors_only() {
    let mut read = 0;
    for source in sources() {
        if ["lib", "main"].contains(&source.module.as_str()) {
            continue;
        }
        let own = source.floor();
        assert!(own.is_some() || LEAVES.contains(&source.module.as_str()), "{} is on no floor", source.module);
        for (i, line) in source.lines.iter().enumerate() {
            for import in imports(line) {
                read += 1;
                let place = format!("{}:{}", source.path.display(), i + 1);
                assert!(!import.is_empty(), "{place}: name one module after crate::, so that this can be read");
                let known = floor(import).is_some() || LEAVES.contains(&import);
                assert!(known, "{place}: {import} is on no floor");
                let neighbours = NEIGHBOURS.contains(&(source.module.as_str(), import));
                let allowed = import == source.module
                    || LEAVES.contains(&import) && own.is_some()
                    || floor(import) < own && own.is_some()
                    || neighbours;
                assert!(allowed, "{place}: {} may not import {import}, which is not on a lower floor", source.module);
            }
        }
        // in a file directly in a folder of `src`, this would be the crate's root
        if source.path.components().count() == 2 {
            source.never_says(&["super::super"]);
        }
    }
    assert!(read > 200, "only {read} imports were read");
}

#[test]
fn the_root_lists_the_floors_from_below() {
    let root = sources().into_iter().find(|source| source.module == "lib").expect("there is a root");
    let mut last = 0;
    for line in root.lines.iter().filter(|line| !line.trim().is_empty()) {
        let module = line.strip_prefix("pub mod ").and_then(|rest| rest.strip_suffix(';'));
        let module = module.unwrap_or_else(|| panic!("the root holds modules only, not {line}"));
        let floor = floor(module).unwrap_or(0);
        assert!(floor > 0 || LEAVES.contains(&module), "{module} is on no floor");
        assert!(floor >= last, "{module} stands above what it is built on");
        last = floor;
    }
    assert_eq!(last, 9);
}

#[test]
fn below_the_service_nothing_waits() {
    for source in sources().iter().filter(|source| source.floor() < floor("service")) {
        if source.module != "lib" && source.module != "main" {
            source.never_says(&["tokio", "async ", ".await", "futures"]);
        }
    }
}

#[test]
fn below_the_wire_nothing_knows_requests() {
    for source in
        sources().iter().filter(|source| source.floor().is_some_and(|own| own < 8) && source.module != "config")
    {
        source.never_says(&["Serialize", "Deserialize", "serde::", "StatusCode", "axum", "hyper", "utoipa"]);
    }
}

#[test]
fn jobs_are_pure() {
    for source in sources().iter().filter(|source| source.floor().is_some_and(|own| own <= 6)) {
        source.never_says(&[
            "std::fs",
            "std::net",
            "std::env",
            "std::time",
            "std::process",
            "SystemTime",
            "Instant",
            "rand::",
            "println!",
        ]);
    }
}

#[test]
fn schemes_see_no_coordinates() {
    for source in sources().iter().filter(|source| source.module == "scheme") {
        source.never_says(&["shape::mesh", "shape::polygon", "shape::source", "positions"]);
    }
}

#[test]
fn no_file_leads_back_to_itself() {
    let files = sources().into_iter().map(|source| {
        let path = source.path.to_string_lossy().replace('\\', "/");
        (path, source.text)
    });
    let files = Crate::of(files);
    let imports = files.imports();
    let n_imports: usize = imports.values().map(std::collections::BTreeSet::len).sum();
    assert!(n_imports > 500, "only {n_imports} imports were read");
    let found = circles(&imports);
    assert!(found.is_empty(), "files that import each other in circles: {found:#?}");
}

/// Words that name schemes, without their separators.
const SCHEMES: &[&str] = &[
    "catmull",
    "loopsmoothing",
    "doosabin",
    "kobbelt",
    "butterfly",
    "sqrt3",
    "rootthree",
    "chaikin",
    "incenter",
    "fourpoint",
    "repeatedaveraging",
];
/// The files outside `scheme/` that may name a scheme: example jobs, the descriptions of these in the OpenAPI document,
/// formats with their own words for schemes, and tests of suggestions.
const NAMED: &[(&str, &[&str])] = &[
    ("fault.rs", &["butterfly", "catmull"]),
    ("http/canary.rs", &["catmull"]),
    ("http/document_examples.rs", &["catmull", "fourpoint"]),
    ("output/usda.rs", &["catmull"]),
    ("output/usda/cage.rs", &["catmull"]),
    ("wire/schema.rs", &["incenter"]),
];
/// The files outside `scheme/` that have the name of a preset between quotes: example jobs, tests of suggestions, a
/// role, a parameter, and words of STL, USD and glTF.
const QUOTED: &[(&str, &[&str])] = &[
    ("cli/analyse.rs", &["mask"]),
    ("fault.rs", &["catmull-clark", "loop", "butterfly"]),
    ("http/canary.rs", &["catmull-clark"]),
    ("http/document_examples.rs", &["push-back", "four-point", "catmull-clark"]),
    ("input/stl.rs", &["loop"]),
    ("output/usda/cage.rs", &["loop", "bilinear"]),
    ("shape/looks.rs", &["mask"]),
    ("wire/analysis/markdown.rs", &["mask"]),
    ("wire/analysis/matrices.rs", &["push-back"]),
    ("wire/look.rs", &["mask"]),
];

#[test]
fn schemes_are_named_in_their_own_folder_only() {
    for source in sources().iter().filter(|source| source.module != "scheme") {
        let path = source.path.to_string_lossy().replace('\\', "/");
        let allowed = NAMED.iter().find(|(file, _)| *file == path).map_or(&[][..], |(_, names)| names);
        for (i, line) in source.lines.iter().enumerate() {
            let plain: String = line.to_lowercase().chars().filter(|c| !matches!(c, '-' | '_' | ' ')).collect();
            let named = SCHEMES.iter().find(|name| plain.contains(**name) && !allowed.contains(name));
            assert!(named.is_none(), "{path}:{}: schemes are named in scheme/ only: {line}", i + 1);
            let allowed = QUOTED.iter().find(|(file, _)| *file == path).map_or(&[][..], |(_, names)| names);
            let mut presets = PRESETS.iter().map(|preset| preset.name).filter(|name| !allowed.contains(name));
            let quoted = presets.find(|name| line.contains(&format!("\"{name}\"")));
            assert!(quoted.is_none(), "{path}:{}: presets are named in scheme/ only: {line}", i + 1);
        }
    }
}

#[test]
fn only_keys_are_hashed_and_stores_know_no_jobs() {
    for source in sources() {
        if source.path != Path::new("job/key.rs")
            && source.floor().is_some_and(|own| own < 7)
            && source.module != "output"
        {
            source.never_says(&["blake3"]);
        }
        if source.path.starts_with("service/store") {
            source.never_says(&["job::Job", "job::run", "Admitted", "crate::wire"]);
        }
    }
}

#[test]
fn nothing_is_unsafe_and_nothing_is_unwrapped() {
    for source in sources() {
        source.never_says(&["unsafe {", "unsafe fn", "unsafe impl", ".unwrap()", "todo!(", "dbg!("]);
    }
}

#[test]
fn files_stay_short() {
    let long: Vec<String> = sources()
        .iter()
        .filter(|source| source.n_lines > MAX_LINES)
        .map(|source| format!("{} has {} lines", source.path.display(), source.n_lines))
        .collect();
    assert!(long.is_empty(), "at most {MAX_LINES} lines a file: {long:?}");
}

const MAX_COLUMNS: usize = 120;
/// The beginnings of lines that may be longer: documentation of operations, whose first line and line breaks are part
/// of the OpenAPI document, which clients compare.
const LONG_LINES: &[(&str, &str)] = &[
    ("http/estimate.rs", "/// Refused as the job would be, but for what only its coordinates show,"),
    ("http/health.rs", "/// A small real job was computed lately,"),
    ("http/render.rs", "/// Without `outputs`, `Accept` chooses the format."),
    ("http/validate.rs", "/// The plan that latitude lines are judged by,"),
];

#[test]
fn lines_fit_120_columns() {
    let tests = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("tests");
    let mut all = sources();
    read(&tests, &tests, &mut all);
    for source in all {
        let path = source.path.to_string_lossy().replace('\\', "/");
        for (i, line) in source.text.lines().enumerate() {
            let excepted = LONG_LINES.iter().any(|(file, start)| *file == path && line.trim_start().starts_with(start));
            let n_columns = line.chars().count();
            assert!(n_columns <= MAX_COLUMNS || excepted, "{path}:{}: {n_columns} columns", i + 1);
        }
    }
}

/// If two schemas had the same name, the OpenAPI document would contain only one, and clients would read answers by the
/// wrong one.
#[test]
fn schemas_have_names_of_their_own() {
    let derives = |line: &&String| line.starts_with("#[derive(") && line.contains("ToSchema");
    let mut names = Vec::new();
    for source in sources() {
        for (i, _) in source.lines.iter().enumerate().filter(|(_, line)| derives(line)) {
            let declared = source.lines[i..].iter().find_map(|line| {
                let (_, rest) = line.split_once("struct ").or_else(|| line.split_once("enum "))?;
                line.starts_with("pub").then(|| rest.split([' ', '<', '(', ';']).next().map(str::to_owned))?
            });
            names.extend(declared);
        }
    }
    let n = names.len();
    names.sort_unstable();
    names.dedup();
    assert!(n > 30 && names.len() == n, "{n} schemas have {} names: {names:?}", names.len());
}

/// Returns the keyword and the name of the type or trait that a line defines, if it defines one.
fn defined_type(line: &str) -> Option<(&str, &str)> {
    let line = line.trim_start();
    let item = match line.strip_prefix("pub") {
        Some(rest) if rest.starts_with('(') => rest.split_once(") ")?.1,
        Some(rest) => rest.strip_prefix(' ')?,
        None => line,
    };
    let (keyword, rest) = item.split_once(' ')?;
    let name = rest.split(|c: char| !c.is_ascii_alphanumeric() && c != '_').next()?;
    let is_type = ["struct", "enum", "union", "trait", "type"].contains(&keyword);
    (is_type && name.starts_with(|c: char| c.is_ascii_uppercase())).then_some((keyword, name))
}

/// Returns the name and the line of each type and trait that a source defines, but for associated types, whose names
/// are those of their traits.
fn defined_types(source: &Source) -> Vec<(&str, usize)> {
    let mut found = Vec::new();
    // the indentation of the open `impl` and `trait` blocks
    let mut blocks: Vec<usize> = Vec::new();
    for (i, line) in source.lines.iter().enumerate() {
        let code = line.trim();
        let indentation = line.len() - line.trim_start().len();
        if code.starts_with('}') {
            blocks.retain(|block| *block < indentation);
        }
        let defined = defined_type(line);
        let is_inside = blocks.last().is_some_and(|block| indentation == block + 4);
        found.extend(defined.filter(|(keyword, _)| *keyword != "type" || !is_inside).map(|(_, name)| (name, i + 1)));
        let is_impl = code.starts_with("impl ") || code.starts_with("impl<");
        if (is_impl || defined.is_some_and(|(keyword, _)| keyword == "trait")) && !code.ends_with('}') {
            blocks.push(indentation);
        }
    }
    found
}

#[test]
fn type_names_have_one_meaning() {
    let all = sources();
    let mut places: BTreeMap<&str, Vec<String>> = BTreeMap::new();
    for source in &all {
        for (name, line) in defined_types(source) {
            places.entry(name).or_default().push(format!("{}:{line}", source.path.display()));
        }
    }
    assert!(places.len() > 1000, "only {} types were found", places.len());
    places.retain(|_, found| found.len() > 1);
    assert!(places.is_empty(), "types of the same name; give each its own: {places:#?}");
}
