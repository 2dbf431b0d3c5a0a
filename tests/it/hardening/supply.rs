//! Dependencies: their sources and licences. `deny.toml` lists the allowed ones; `cargo deny check`, run by hand,
//! checks more.

use std::collections::BTreeSet;
use std::path::Path;
use std::process::Command;

use serde_json::Value;

/// Returns the crates of a build for this machine, from cargo.
fn crates() -> Vec<Value> {
    let version = Command::new("rustc").arg("-vV").output().unwrap();
    let version = String::from_utf8(version.stdout).unwrap();
    let host = version.lines().find_map(|line| line.strip_prefix("host: ")).unwrap();
    let told = Command::new(env!("CARGO"))
        .args(["metadata", "--locked", "--offline", "--format-version", "1", "--filter-platform", host])
        .current_dir(env!("CARGO_MANIFEST_DIR"))
        .output()
        .unwrap();
    let told: Value = serde_json::from_slice(&told.stdout).unwrap();
    let built: BTreeSet<_> =
        told["resolve"]["nodes"].as_array().unwrap().iter().map(|node| node["id"].as_str().unwrap()).collect();
    let packages = told["packages"].as_array().unwrap();
    packages.iter().filter(|package| built.contains(package["id"].as_str().unwrap())).cloned().collect()
}

fn rules() -> toml::Table {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("deny.toml");
    std::fs::read_to_string(path).unwrap().parse().unwrap()
}

fn texts(list: &toml::Value) -> BTreeSet<String> {
    list.as_array().unwrap().iter().map(|text| text.as_str().unwrap().to_owned()).collect()
}

/// Whether a licence expression can be met with the allowed licences. `/` is an older notation of OR; AND binds more
/// strongly, and brackets contain alternatives.
fn is_met(expression: &str, allowed: &BTreeSet<String>) -> bool {
    let expression = expression.replace('/', " OR ");
    if let Some((before, rest)) = expression.split_once('(') {
        let (inner, after) = rest.split_once(')').unwrap();
        let known = if is_met(inner, allowed) { "MIT" } else { "none" };
        return is_met(&format!("{before}{known}{after}"), allowed);
    }
    let alternatives = expression.split(" OR ");
    alternatives.into_iter().any(|all| all.split(" AND ").all(|one| allowed.contains(one.trim())))
}

#[test]
fn expressions_of_licences_are_met_by_one_alternative_or_by_none() {
    let allowed = ["MIT", "Zlib"].map(str::to_owned).into();
    for met in
        ["MIT", "GPL-3.0 OR MIT", "MIT/GPL-2.0", "MIT AND Zlib", "(GPL-3.0 OR Zlib) AND MIT", "GPL-3.0 OR MIT AND Zlib"]
    {
        assert!(is_met(met, &allowed), "{met}");
    }
    for unmet in ["GPL-3.0", "MIT AND GPL-3.0", "(MIT OR Zlib) AND GPL-3.0", "MIT-0", "AGPL-3.0 OR GPL-3.0", ""] {
        assert!(!is_met(unmet, &allowed), "{unmet}");
    }
}

#[test]
fn crates_come_from_the_registry_under_licences_that_are_allowed() {
    let rules = rules();
    let allowed = texts(&rules["licenses"]["allow"]);
    let exceptions = rules["licenses"]["exceptions"].as_array().unwrap();
    let denied = rules["bans"]["deny"].as_array().unwrap();
    let crates = crates();
    assert!(crates.len() > 100, "only {} crates", crates.len());
    for package in &crates {
        let name = package["name"].as_str().unwrap();
        let own = exceptions.iter().find(|exception| exception["crate"].as_str() == Some(name));
        let allowed = own.map_or_else(|| allowed.clone(), |own| texts(&own["allow"]));
        let license = package["license"].as_str().unwrap_or_default();
        assert!(is_met(license, &allowed), "{name} is under {license:?}");
        let source = package["source"].as_str();
        assert!(
            name == "planish" || source.is_some_and(|source| source.starts_with("registry+")),
            "{name}: {source:?}"
        );
        assert!(denied.iter().all(|denied| denied["crate"].as_str() != Some(name)), "{name} is denied");
    }
}
