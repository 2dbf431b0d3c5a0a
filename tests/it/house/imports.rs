//! The imports between the files of `src`, read from their text: `use` trees, paths in code, and the targets of
//! re-exports.

use std::collections::{BTreeMap, BTreeSet};

/// Maximum number of names through which one import is followed: `use a::X` with `pub use b::X` in `a`, and so on.
const MAX_STEPS: u32 = 12;

/// A module as its names from the crate's root; the root is empty.
type Module = Vec<String>;

/// The files of a crate by their modules.
pub(super) struct Crate {
    files: BTreeMap<Module, File>,
}

struct File {
    path: String,
    /// The imported paths of `use` declarations, with the local names.
    uses: Vec<(Vec<String>, String)>,
    /// Paths in code.
    inline: Vec<Vec<String>>,
}

impl Crate {
    /// Reads a crate from the paths and texts of its files below `src`.
    pub(super) fn of(files: impl IntoIterator<Item = (String, String)>) -> Self {
        let read = |(path, text): (String, String)| {
            let mut module: Module = path.trim_end_matches(".rs").split('/').map(str::to_owned).collect();
            let last = module.last().cloned().unwrap_or_default();
            if last == "mod" || last == "lib" {
                module.pop();
            }
            (last != "tests" && last != "main").then(|| (module, File::read(path, &text)))
        };
        Self { files: files.into_iter().filter_map(read).collect() }
    }

    /// Returns for each file the files that it imports, by path.
    pub(super) fn imports(&self) -> BTreeMap<&str, BTreeSet<&str>> {
        let of_file = |(module, file): (&Module, &File)| {
            let paths = file.uses.iter().map(|(path, _)| path).chain(&file.inline);
            let found = paths.filter_map(|path| self.defined_in(module, path, 0));
            found
                .filter(|other| other != module)
                .filter_map(|other| Some(self.files.get(&other)?.path.as_str()))
                .collect()
        };
        self.files.iter().map(|entry| (entry.1.path.as_str(), of_file(entry))).collect()
    }

    /// Returns the module that defines the target of a path in `module`; `None` outside the crate.
    fn defined_in(&self, module: &Module, path: &[String], steps: u32) -> Option<Module> {
        let (first, rest) = path.split_first().filter(|_| steps < MAX_STEPS)?;
        let mut here = module.clone();
        let mut rest = rest;
        match first.as_str() {
            "crate" => here.clear(),
            "self" => {}
            "super" => {
                here.pop();
                while rest.first().is_some_and(|name| name == "super") {
                    here.pop();
                    rest = &rest[1..];
                }
            }
            name if self.child(module, name).is_some() => here = self.child(module, name)?,
            name => {
                let (path, _) =
                    self.files.get(module)?.uses.iter().find(|(path, known)| known == name && path[0] != name)?;
                return self.defined_in(module, &[path.as_slice(), rest].concat(), steps + 1);
            }
        }
        while let Some((name, after)) = rest.split_first() {
            if let Some(child) = self.child(&here, name) {
                (here, rest) = (child, after);
                continue;
            }
            let file = self.files.get(&here)?;
            let Some((path, _)) = file.uses.iter().find(|(_, known)| known == name) else { break };
            return self.defined_in(&here, &[path.as_slice(), after].concat(), steps + 1).or(Some(here));
        }
        self.files.contains_key(&here).then_some(here)
    }

    fn child(&self, module: &Module, name: &str) -> Option<Module> {
        let child = [module.as_slice(), &[name.to_owned()]].concat();
        self.files.contains_key(&child).then_some(child)
    }
}

impl File {
    fn read(path: String, text: &str) -> Self {
        let code: String =
            text.lines().map(|line| line.split("//").next().unwrap_or_default().to_owned() + "\n").collect();
        let code = code.split("#[cfg(test)]\nmod tests {").next().unwrap_or_default();
        let (mut uses, mut inline) = (Vec::new(), Vec::new());
        // a declaration ends at its semicolon, a line of code at its end
        let mut declaration: Option<String> = None;
        for line in code.lines() {
            let start = line.trim_start();
            let visible = start.strip_prefix("pub").map_or(start, |rest| match rest.strip_prefix('(') {
                Some(rest) => rest.split_once(')').map_or("", |(_, rest)| rest).trim_start(),
                None => rest.trim_start(),
            });
            match (&mut declaration, visible.strip_prefix("use ")) {
                (Some(text), _) => *text += start,
                (None, Some(tree)) => declaration = Some(tree.to_owned()),
                (None, None) => inline.extend(paths(line)),
            }
            if let Some(tree) = declaration.as_ref().and_then(|text| text.trim_end().strip_suffix(';')) {
                uses.extend(leaves(tree));
                declaration = None;
            }
        }
        Self { path, uses, inline }
    }
}

/// Returns the paths of a `use` tree with their local names; a glob denotes its module.
fn leaves(tree: &str) -> Vec<(Vec<String>, String)> {
    let tree = tree.trim();
    if let Some((prefix, body)) = tree.strip_suffix('}').and_then(|tree| tree.split_once('{')) {
        let mut depth = 0;
        let outer = |c: char| {
            depth += i32::from(c == '{') - i32::from(c == '}');
            c == ',' && depth == 0
        };
        let branches = body.split(outer).map(str::trim).filter(|branch| !branch.is_empty());
        return branches.flat_map(|branch| leaves(&format!("{}{branch}", prefix.trim()))).collect();
    }
    let (path, alias) = tree.split_once(" as ").unwrap_or((tree, ""));
    let mut path: Vec<String> = path.trim().split("::").map(str::to_owned).collect();
    path.pop_if(|last| last == "self" || last == "*");
    let name = if alias.is_empty() { path.last().cloned().unwrap_or_default() } else { alias.trim().to_owned() };
    vec![(path, name)]
}

/// Returns the paths of two and more names in a line of code.
fn paths(line: &str) -> impl Iterator<Item = Vec<String>> + '_ {
    let words = line.split(|c: char| !c.is_ascii_alphanumeric() && c != '_' && c != ':');
    let words = words.map(|word| word.trim_matches(':')).filter(|word| word.contains("::"));
    words.map(|word| word.split("::").map(str::to_owned).collect())
}

/// Returns the groups of files that import each other in a circle, the smallest first.
pub(super) fn circles<'a>(imports: &BTreeMap<&'a str, BTreeSet<&'a str>>) -> Vec<BTreeSet<&'a str>> {
    let reached = |from: &'a str| {
        let (mut seen, mut open) = (BTreeSet::new(), vec![from]);
        while let Some(file) = open.pop() {
            open.extend(imports.get(file).into_iter().flatten().filter(|&&next| seen.insert(next)));
        }
        seen
    };
    let reached: BTreeMap<&str, BTreeSet<&str>> = imports.keys().map(|&file| (file, reached(file))).collect();
    let back = |file: &str, other: &str| reached.get(other).is_some_and(|all| all.contains(file));
    let mut found: BTreeSet<BTreeSet<&str>> = BTreeSet::new();
    for (&file, all) in &reached {
        found.insert(all.iter().copied().filter(|&other| back(file, other)).collect());
    }
    let mut found: Vec<_> = found.into_iter().filter(|circle| !circle.is_empty()).collect();
    found.sort_by_key(BTreeSet::len);
    found
}

#[test]
fn imports_are_followed_through_trees_names_and_re_exports() {
    let files = [
        ("lib.rs", "pub mod a;\npub mod b;"),
        ("a/mod.rs", "mod x;\nmod y;\npub use x::X;\nuse crate::b;\n"),
        ("a/x.rs", "use super::y::{self, Y as Why};\npub struct X;\n// use crate::b::Hidden;\n"),
        ("a/y.rs", "use super::X;\npub struct Y;\nfn f() -> b::B { crate::b::f() }\n"),
        ("b.rs", "use std::fmt;\npub struct B;\npub fn f() {}\n#[cfg(test)]\nmod tests {\n    use crate::a::X;\n}\n"),
    ];
    let read = Crate::of(files.map(|(path, text)| (path.to_owned(), text.to_owned())));
    let imports = read.imports();
    let expected = |path: &str, files: &[&str]| assert_eq!(imports[path], files.iter().copied().collect(), "{path}");
    expected("lib.rs", &[]);
    expected("a/mod.rs", &["a/x.rs", "b.rs"]);
    expected("a/x.rs", &["a/y.rs"]);
    expected("a/y.rs", &["a/x.rs", "b.rs"]);
    expected("b.rs", &[]);
    assert_eq!(circles(&imports), [BTreeSet::from(["a/x.rs", "a/y.rs"])]);
}
