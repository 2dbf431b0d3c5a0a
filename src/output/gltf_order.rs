//! Orders triangles so that graphics processors meet vertices again soon, and vertices in the order in which triangles
//! meet them.
//!
//! Source: T. Forsyth, Linear-speed vertex cache optimisation (2006), as implemented by meshoptimizer.

use meshoptimizer_rs::{Error, Limits, Workspace, optimize_vertex_cache, optimize_vertex_cache_strip};

use crate::output::error::FormatError;
use crate::output::gltf_codec::broken;
use crate::shape::topology::{NONE, index};
use crate::watch::Watch;

/// Returns memory for the algorithms of meshoptimizer; the forecast of the job bounds it.
pub(super) fn workspace() -> Workspace {
    Workspace::new(Limits { max_bytes: usize::MAX, max_work: u64::MAX })
}

/// The aim of an order of triangles.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Aim {
    /// Few vertices that are computed twice.
    Cache,
    /// Few bytes when encoded: 1.03 instead of 1.40 a triangle of an animal.
    Bytes,
}

impl Aim {
    fn ordered(self, corners: &[u32], n_vertices: usize, workspace: &mut Workspace) -> Result<Vec<u32>, Error> {
        match self {
            Self::Cache => optimize_vertex_cache(corners, n_vertices, workspace),
            Self::Bytes => optimize_vertex_cache_strip(corners, n_vertices, workspace),
        }
    }
}

/// The order of the triangles and vertices of a model.
#[derive(Debug)]
pub(super) struct TriangleOrder {
    /// The triangles, by the new numbers of vertices.
    pub(super) triangles: Vec<[u32; 3]>,
    /// The former index of each triangle.
    pub(super) former: Vec<u32>,
    /// The former number of each vertex; vertices without triangles come last.
    pub(super) vertices: Vec<u32>,
}

impl TriangleOrder {
    /// Orders triangles for an aim within consecutive parts of these lengths, and `n_vertices` vertices by the
    /// triangles.
    ///
    /// # Errors
    /// A stopped watch.
    pub(super) fn of(
        triangles: &[[u32; 3]],
        parts: &[usize],
        n_vertices: usize,
        aim: Aim,
        watch: &Watch,
    ) -> Result<Self, FormatError> {
        let (mut workspace, mut local) = (workspace(), vec![NONE; n_vertices]);
        let mut ordered = Vec::with_capacity(triangles.len());
        let mut former = Vec::with_capacity(triangles.len());
        let mut rest = triangles;
        for &part in parts {
            watch.check()?;
            let start = triangles.len() - rest.len();
            let (mut vertices, part) = (Vec::new(), rest.split_off(..part).unwrap_or_default());
            let mut corners = Vec::with_capacity(3 * part.len());
            // only the vertices of the part, so that many small parts take no longer than few large ones
            for &v in part.as_flattened() {
                if local[v as usize] == NONE {
                    local[v as usize] = index(vertices.len());
                    vertices.push(v);
                }
                corners.push(local[v as usize]);
            }
            let cached = aim.ordered(&corners, vertices.len(), &mut workspace).map_err(broken)?;
            let first = ordered.len();
            ordered.extend(cached.as_chunks().0.iter().map(|triangle| triangle.map(|v: u32| vertices[v as usize])));
            former.extend(places(part, &ordered[first..]).map(|place| index(start) + place));
            vertices.iter().for_each(|&v| local[v as usize] = NONE);
        }
        let vertices = renumber(&mut ordered, local);
        Ok(Self { triangles: ordered, former, vertices })
    }
}

/// Returns the index that each triangle had before the ordering; triangles with the same corners keep their order.
fn places(before: &[[u32; 3]], after: &[[u32; 3]]) -> impl Iterator<Item = u32> + use<> {
    let sorted = |triangles: &[[u32; 3]]| {
        let least_first = |&[a, b, c]: &[u32; 3]| [[a, b, c], [b, c, a], [c, a, b]].into_iter().min();
        let mut places: Vec<u32> = (0..index(triangles.len())).collect();
        places.sort_by_cached_key(|&place| least_first(&triangles[place as usize]));
        places
    };
    let mut found = vec![0; after.len()];
    sorted(before).into_iter().zip(sorted(after)).for_each(|(before, after)| found[after as usize] = before);
    found.into_iter()
}

/// Numbers vertices in the order in which triangles meet them, and returns the former number of each. `numbers` must
/// have one entry per vertex, all [`NONE`].
fn renumber(triangles: &mut [[u32; 3]], mut numbers: Vec<u32>) -> Vec<u32> {
    let mut vertices = Vec::with_capacity(numbers.len());
    for v in triangles.as_flattened_mut() {
        let number = &mut numbers[*v as usize];
        if *number == NONE {
            *number = index(vertices.len());
            vertices.push(*v);
        }
        *v = *number;
    }
    vertices.extend((0..index(numbers.len())).filter(|&v| numbers[v as usize] == NONE));
    vertices
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_triangle_stays_in_its_part_and_keeps_its_corners() {
        // two parts of a strip, whose second half comes back to the vertices of the first; vertex 12 is in no triangle
        let strip = |first: u32| (first..first + 10).map(|i| [i % 12, (i + 1) % 12, (i + 2) % 12]);
        let triangles: Vec<[u32; 3]> = strip(0).chain(strip(4)).chain([[0, 1, 2]]).collect();
        for aim in [Aim::Cache, Aim::Bytes] {
            check(
                &triangles,
                &TriangleOrder::of(&triangles, &[10, 11], 13, aim, &Watch::new()).expect("nothing stops it"),
            );
        }
    }

    fn check(triangles: &[[u32; 3]], order: &TriangleOrder) {
        let same = |[a, b, c]: [u32; 3], other| [[a, b, c], [b, c, a], [c, a, b]].contains(&other);
        for (i, (triangle, &former)) in order.triangles.iter().zip(&order.former).enumerate() {
            let as_before = triangle.map(|v| order.vertices[v as usize]);
            assert!(same(as_before, triangles[former as usize]), "triangle {i}");
            assert_eq!(i < 10, former < 10, "triangle {i} was {former}");
        }
        let mut former = order.former.clone();
        former.sort_unstable();
        assert_eq!(former, (0..21).collect::<Vec<_>>());
        assert_eq!(order.vertices.last(), Some(&12));
        let met: Vec<u32> = order.triangles.as_flattened().to_vec();
        let is_new = |i: &usize| !met[..*i].contains(&met[*i]);
        let new: Vec<u32> = (0..met.len()).filter(is_new).map(|i| met[i]).collect();
        assert_eq!(new, (0..12).collect::<Vec<_>>());
    }
}
