//! Groups and materials of faces.

use std::collections::BTreeSet;

use super::topology::{NONE, index};
use crate::fault::Fault;
use crate::fault::shortened;

/// Maximum number of groups, and of materials, of a mesh.
pub const MAX_LABELS: usize = 256;

/// Maximum length of a name, in bytes.
pub const MAX_LABEL_NAME: usize = 64;

/// A named set of faces, as a client gives it.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct FaceSet {
    /// The name.
    pub name: String,
    /// The faces, counted from 0.
    pub faces: Vec<u64>,
}

/// Named sets of faces; each face has at most one name.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Labels {
    /// The names, in the order in which they were given.
    pub names: Vec<String>,
    /// For each input face the index of its name, or [`NONE`]. Empty if there are no names, or if all faces have the
    /// only name; then so do all faces of any refinement.
    pub of_faces: Vec<u32>,
}

impl Labels {
    /// No names.
    pub const NONE: Self = Self { names: Vec::new(), of_faces: Vec::new() };

    /// Whether there are no names.
    pub fn is_empty(&self) -> bool {
        self.names.is_empty()
    }

    /// Returns whether faces differ in their names.
    pub fn differ(&self) -> bool {
        !self.of_faces.is_empty()
    }

    /// Returns the index of the name of input face `f`, if it has one.
    pub fn number(&self, f: u32) -> Option<usize> {
        if !self.differ() {
            return (!self.is_empty()).then_some(0);
        }
        let label = *self.of_faces.get(f as usize)?;
        (label != NONE).then_some(label as usize)
    }

    /// Returns the name of input face `f`, if it has one.
    pub fn name(&self, f: u32) -> Option<&str> {
        self.number(f).map(|label| self.names[label].as_str())
    }

    /// Returns the total length of all names, in bytes.
    pub fn name_bytes(&self) -> usize {
        self.names.iter().map(String::len).sum()
    }

    /// Checks the sets of a mesh with `n_faces` faces.
    ///
    /// # Errors
    /// Names that are empty, too long, given twice or hold blanks, faces that do not exist or are in two sets; with
    /// pointers below the sets.
    pub fn new(sets: Vec<FaceSet>, n_faces: usize) -> Result<Self, Vec<Fault>> {
        if sets.is_empty() {
            return Ok(Self::NONE);
        }
        if sets.len() > MAX_LABELS {
            return Err(vec![Fault::new("", format!("{} names; at most {MAX_LABELS} are allowed", sets.len()))]);
        }
        let mut faults = Vec::new();
        let mut of_faces = vec![NONE; n_faces];
        let mut known = BTreeSet::new();
        for (i, set) in sets.iter().enumerate() {
            let again = !known.insert(set.name.as_str());
            faults.extend(check_name(&set.name, again).map(|detail| Fault::new(format!("/{i}/name"), detail)));
            for (j, &face) in set.faces.iter().enumerate() {
                let slot = usize::try_from(face).ok().and_then(|f| of_faces.get_mut(f));
                let detail = match slot {
                    None => format!("there is no face {face}; the mesh has {n_faces}, counted from 0"),
                    Some(&mut label) if label != NONE && label != index(i) => {
                        let other = shortened(&sets[label as usize].name);
                        format!("face {face} is in \"{other}\" already; a face has one name of a kind")
                    }
                    Some(label) => {
                        *label = index(i);
                        continue;
                    }
                };
                if faults.len() < 20 {
                    faults.push(Fault::new(format!("/{i}/faces/{j}"), detail));
                }
            }
        }
        let names: Vec<String> = sets.into_iter().map(|set| set.name).collect();
        if names.len() == 1 && of_faces.iter().all(|&label| label == 0) {
            of_faces = Vec::new();
        }
        if faults.is_empty() { Ok(Self { names, of_faces }) } else { Err(faults) }
    }
}

fn check_name(name: &str, again: bool) -> Option<String> {
    let alien = |c: char| c.is_whitespace() || c.is_control() || c == '#';
    if name.is_empty() || name.len() > MAX_LABEL_NAME {
        return Some(format!("a name of {} bytes; it has 1 to {MAX_LABEL_NAME}", name.len()));
    }
    if let Some(c) = name.chars().find(|&c| alien(c)) {
        return Some(format!("{c:?} has no place in a name; leave out blanks, control characters and #"));
    }
    again.then(|| format!("the name \"{}\" is taken; list all its faces in one place", shortened(name)))
}

/// The input faces of one group and one material.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct LabelledFaces {
    /// Number of the group, if any.
    pub group: Option<usize>,
    /// Number of the material, if any.
    pub material: Option<usize>,
    /// Runs of consecutive input faces, ascending.
    pub runs: Vec<std::ops::Range<u32>>,
}

/// Divides a mesh with `n_faces` input faces by group and material, in order of first appearance; without names there
/// is one part with all faces.
pub fn by_labels(groups: &Labels, materials: &Labels, n_faces: usize) -> Vec<LabelledFaces> {
    let mut parts: Vec<LabelledFaces> = Vec::new();
    let mut numbers = std::collections::BTreeMap::new();
    for f in 0..index(n_faces) {
        let kind = (groups.number(f), materials.number(f));
        let number = *numbers.entry(kind).or_insert(parts.len());
        if number == parts.len() {
            parts.push(LabelledFaces { group: kind.0, material: kind.1, runs: Vec::new() });
        }
        match parts[number].runs.last_mut() {
            Some(run) if run.end == f => run.end += 1,
            _ => parts[number].runs.push(f..f + 1),
        }
    }
    parts
}
