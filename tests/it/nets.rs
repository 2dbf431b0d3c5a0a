//! The control nets of `tests/nets` agree with their README.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::PathBuf;

use planish::shape::check::{FaceList, Winding};
use planish::shape::topology::Topology;
use serde_json::Value;

use crate::support::nets::Net;

fn path(inside: &str) -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join(inside)
}

/// Returns the files of a folder: the text of each by its name without `.json`.
fn files(folder: &str) -> BTreeMap<String, String> {
    let entries = fs::read_dir(path(folder)).unwrap_or_else(|error| panic!("{folder}: {error}"));
    let mut found = BTreeMap::new();
    for entry in entries {
        let path = entry.expect("the folder can be read").path();
        if path.extension().is_some_and(|extension| extension == "json") {
            let name = path.file_stem().expect("a file has a name").to_string_lossy().into_owned();
            found.insert(name, fs::read_to_string(&path).expect("the file is text"));
        }
    }
    found
}

/// Returns the rows of the README's table that starts with these columns, by their first cell.
fn table(columns: &str) -> BTreeMap<String, Vec<String>> {
    let text = fs::read_to_string(path("tests/nets/README.md")).expect("the nets have a README");
    let rows = text.lines().skip_while(|line| !line.starts_with(columns)).skip(2);
    let rows = rows.take_while(|line| line.starts_with('|')).map(|line| {
        let mut cells = line.trim_matches('|').split('|').map(|cell| cell.trim().to_owned());
        (cells.next().expect("a row has a name"), cells.collect())
    });
    rows.collect()
}

fn input(text: &str) -> Value {
    serde_json::from_str(text).expect("a net is JSON")
}

/// Returns the counts of all values as `value: count`, in ascending order.
fn tally(values: impl Iterator<Item = usize>) -> String {
    let mut counts: BTreeMap<usize, usize> = BTreeMap::new();
    values.for_each(|value| *counts.entry(value).or_default() += 1);
    counts.iter().map(|(value, n)| format!("{value}: {n}")).collect::<Vec<_>>().join(", ")
}

/// Returns the README's facts about a mesh, counted without the crate.
fn described(net: &Net) -> Vec<String> {
    let sides: BTreeSet<(usize, usize)> =
        net.faces.iter().flat_map(|face| (0..face.len()).map(|j| (face[j], face[(j + 1) % face.len()]))).collect();
    let rim: BTreeMap<usize, usize> = sides.iter().filter(|(a, b)| !sides.contains(&(*b, *a))).copied().collect();
    let mut left: BTreeSet<usize> = rim.keys().copied().collect();
    let mut loops = 0;
    while let Some(start) = left.pop_first() {
        loops += 1;
        let mut at = rim[&start];
        while left.remove(&at) {
            at = rim[&at];
        }
        assert_eq!(at, start, "a boundary loop closes");
    }
    let edges = net.edges();
    let valence = |v: usize| edges.iter().filter(|(a, b)| *a == v || *b == v).count();
    let on_rim = |v: &usize| rim.contains_key(v);
    let [inside, outside] = [false, true]
        .map(|rim_wanted| tally((0..net.positions.len()).filter(|v| on_rim(v) == rim_wanted).map(valence)));
    let boundary = if rim.is_empty() { String::new() } else { format!("; boundary {outside}") };
    let euler = (net.positions.len() + net.faces.len()).cast_signed() - edges.len().cast_signed();
    vec![
        net.positions.len().to_string(),
        edges.len().to_string(),
        net.faces.len().to_string(),
        euler.to_string(),
        loops.to_string(),
        format!("interior {inside}{boundary}"),
        tally(net.faces.iter().map(Vec::len)),
    ]
}

#[test]
fn meshes_are_as_their_readme_says() {
    let rows = table("| name | vertices |");
    assert!(rows.len() > 8, "{rows:?}");
    let files = files("tests/nets");
    for (name, row) in &rows {
        let input = input(files.get(name).unwrap_or_else(|| panic!("there is no net {name}")));
        assert_eq!(&described(&Net::of(&input["mesh"])), row, "{name}");
    }
}

/// The topology of the crate gives the same numbers.
#[test]
fn the_topology_agrees_with_the_readme() {
    let files = files("tests/nets");
    for (name, row) in table("| name | vertices |") {
        let net = Net::of(&input(&files[&name])["mesh"]);
        let mut faces = FaceList::default();
        for face in &net.faces {
            faces.push(face.iter().map(|&v| u32::try_from(v).expect("a small net")));
        }
        let checked = Topology::of_faces(net.positions.len(), faces, Winding::Refuse).expect("it is a manifold");
        assert!(checked.split_from.is_empty() && checked.reversed.is_empty(), "{name}");
        let topology = checked.topology;
        let of = |on_boundary: bool| {
            let all = (0..topology.n_vertices()).filter(|&v| topology.boundary_edges(v).is_some() == on_boundary);
            tally(all.map(|v| topology.valence(v)))
        };
        let boundary = of(true);
        let boundary = if boundary.is_empty() { boundary } else { format!("; boundary {boundary}") };
        assert_eq!(row[1], topology.n_edges().to_string(), "{name}");
        assert_eq!(row[4], topology.boundary_loops().len().to_string(), "{name}");
        assert_eq!(row[5], format!("interior {}{boundary}", of(false)), "{name}");
    }
}

#[test]
fn polygons_are_as_their_readme_says() {
    let rows = table("| name | polygons |");
    assert!(rows.len() > 2, "{rows:?}");
    let files = files("tests/nets");
    for (name, row) in &rows {
        let input = input(&files[name]);
        let one = std::slice::from_ref(&input["polygon"]);
        let polygons = input["polygons"].as_array().map_or(one, |many| many);
        let points = |polygon: &Value| polygon["points"].as_array().expect("points").clone();
        let sizes: Vec<String> = polygons.iter().map(|polygon| points(polygon).len().to_string()).collect();
        let closed = polygons.iter().all(|polygon| polygon["closed"] == true);
        let dimension = points(&polygons[0])[0].as_array().expect("a point").len();
        let yes_or_no = if closed { "yes" } else { "no" };
        let expected =
            [polygons.len().to_string(), sizes.join(", "), yes_or_no.to_owned(), dimension.to_string()].to_vec();
        assert_eq!(&expected, row, "{name}");
    }
}

#[test]
fn every_net_has_a_row_in_the_readme() {
    let rows: BTreeSet<String> = ["| name | vertices |", "| name | polygons |"]
        .into_iter()
        .flat_map(|columns| table(columns).into_keys())
        .collect();
    assert_eq!(rows, files("tests/nets").into_keys().collect());
}
