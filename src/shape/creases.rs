//! Sharp edges and corners as a client tags them.

use std::collections::BTreeMap;

use super::indices::MAX_REPORTED;
use super::topology::{Topology, index};
use crate::fault::Fault;

/// The sharpness from which an edge or vertex counts as infinitely sharp.
///
/// Source: OpenSubdiv 3.5, class `Sdc::Crease`.
pub const INFINITE_SHARPNESS: f64 = 10.0;

/// The sharpness of edges or vertices: index and value above 0, ascending by index; infinite sharpness is stored as
/// [`INFINITE_SHARPNESS`].
pub type Sharp = Vec<(u32, f64)>;

/// The sharp edges and vertices of a mesh as a client tags them: ascending, values above 0, at most
/// [`INFINITE_SHARPNESS`].
#[derive(Debug, Clone, Default, PartialEq)]
pub struct CreaseTags {
    /// Ends and sharpness of edges.
    pub creases: Vec<([u32; 2], f64)>,
    /// Sharp vertices.
    pub corners: Sharp,
}

/// The sharpness of each tagged item, with the position of its first tag in the request.
type Tagged<K> = BTreeMap<K, (usize, f64)>;

/// Sharp edges as pairs of vertices; whether the edges exist is not checked yet.
#[derive(Debug, Clone, Default)]
pub(super) struct Pairs(Tagged<(u32, u32)>);

/// Normalizes a sharpness of a request, or returns why it is invalid.
fn sharpness(value: f64) -> Result<f64, String> {
    if value.is_finite() && value >= 0.0 {
        Ok(value.min(INFINITE_SHARPNESS) + 0.0)
    } else {
        Err(format!("{value} is no sharpness; 0 is smooth, {INFINITE_SHARPNESS} or more infinitely sharp"))
    }
}

fn vertex(v: u64, n: usize, place: &str, faults: &mut Vec<Fault>) -> Option<u32> {
    let found = u32::try_from(v).ok().filter(|&v| (v as usize) < n);
    if found.is_none() {
        let detail = format!("there is no vertex {v}; the mesh has {n}, counted from 0");
        faults.push(Fault::new(place, detail));
    }
    found
}

/// Checks the sharpness of vertices or edges in the list at `list`. `known` resolves a tag at a place to its key and
/// name, or adds faults.
fn check<T, K: Ord + Copy>(
    list: &str,
    tags: &[(T, f64)],
    known: impl Fn(&T, &str, &mut Vec<Fault>) -> Option<(K, String)>,
    faults: &mut Vec<Fault>,
) -> Tagged<K> {
    let mut found = Tagged::new();
    let mut wrong = Vec::new();
    for (i, (what, value)) in tags.iter().enumerate() {
        if wrong.len() >= MAX_REPORTED {
            break;
        }
        let place = format!("{list}/{i}");
        let what = known(what, &place, &mut wrong);
        match (what, sharpness(*value)) {
            (_, Err(detail)) => wrong.push(Fault::new(format!("{place}/sharpness"), detail)),
            (None, Ok(_)) => {}
            (Some((key, name)), Ok(value)) => {
                let (first, known) = *found.entry(key).or_insert((i, value));
                if known.to_bits() != value.to_bits() {
                    let before = format!("{name} has sharpness {known} at ");
                    let detail = [&before, &format!("{list}/{first}"), &format!(" and {value} here; give it one")];
                    wrong.push(Fault::with_other(format!("{place}/sharpness"), detail.map(String::as_str)));
                }
            }
        }
    }
    faults.extend(wrong.into_iter().take(MAX_REPORTED));
    found
}

/// Checks the sharpness of vertices.
pub(super) fn check_corners(corners: &[(u64, f64)], n: usize, faults: &mut Vec<Fault>) -> Sharp {
    let known = |&v: &u64, place: &str, faults: &mut Vec<Fault>| {
        let v = vertex(v, n, &format!("{place}/vertex"), faults)?;
        Some((v, format!("vertex {v}")))
    };
    let found = check("/corners", corners, known, faults);
    found.into_iter().map(|(v, (_, value))| (v, value)).filter(|&(_, value)| value > 0.0).collect()
}

impl Pairs {
    /// Checks the sharpness of edges, but not whether the edges exist.
    pub(super) fn check(creases: &[([u64; 2], f64)], n: usize, faults: &mut Vec<Fault>) -> Self {
        let known = |ends: &[u64; 2], place: &str, faults: &mut Vec<Fault>| {
            let [a, b] = [0, 1].map(|j| vertex(ends[j], n, &format!("{place}/edge/{j}"), faults));
            let (a, b) = a.zip(b)?;
            Some(((a.min(b), a.max(b)), format!("edge ({a}, {b})")))
        };
        Self(check("/creases", creases, known, faults))
    }

    /// Returns the sharp edges of a topology. Boundary edges are infinitely sharp whatever their tag, so they are left
    /// out.
    ///
    /// `split_from` holds, for each vertex from `n` on, the vertex that it was split from.
    pub(super) fn edges(&self, topology: &Topology, n: usize, split_from: &[u32]) -> Result<Sharp, Vec<Fault>> {
        if self.0.is_empty() {
            return Ok(Vec::new());
        }
        let given = |v: u32| split_from.get((v as usize).wrapping_sub(n)).copied().unwrap_or(v);
        let mut missing = self.0.clone();
        let mut sharp = Sharp::new();
        for e in 0..topology.n_edges() {
            let [a, b] = topology.ends(e).map(given);
            let ends = (a.min(b), a.max(b));
            let Some(&(_, value)) = self.0.get(&ends) else { continue };
            missing.remove(&ends);
            if value > 0.0 && !topology.is_boundary_edge(e) {
                sharp.push((index(e), value));
            }
        }
        let fault = |(&(a, b), &(i, _)): (&(u32, u32), &(usize, f64))| {
            let detail = format!("there is no edge ({a}, {b}); name the two ends of a side of some face");
            Fault::new(format!("/creases/{i}/edge"), detail)
        };
        let faults: Vec<Fault> = missing.iter().map(fault).take(MAX_REPORTED).collect();
        if faults.is_empty() { Ok(sharp) } else { Err(faults) }
    }
}
