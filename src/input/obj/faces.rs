//! Faces of an OBJ file with the data of their corners, and the sets that contain them.

use std::collections::BTreeMap;
use std::ops::Range;

use super::corner::{self, ObjCorner};
use crate::input::collect::MeshBuilder;
use crate::input::reader::{CornerUvs, ReadMesh};
use crate::input::text::{at_line, quoted};
use crate::shape::check::FaceList;
use crate::shape::labels::FaceSet;
use crate::shape::topology::{NONE, index};

/// Maximum number of groups that contain a face at once.
const MAX_AT_ONCE: usize = 16;
/// Maximum number of faults that are reported individually.
pub(super) const MAX_FACE_FAULTS: usize = 20;
/// The name that stands for no group and for no material.
const NO_NAME: &str = "default";

/// The data of faces other than their vertices.
#[derive(Debug, Default)]
pub(super) struct ObjFaces {
    /// Line of each face.
    lines: Vec<u32>,
    /// Texture coordinate of each corner.
    uvs: Vec<u32>,
    /// The largest normal index, and its line.
    normal: Option<(u32, usize)>,
    pub(super) objects: Sets,
    pub(super) groups: Sets,
    pub(super) materials: Sets,
    face: Vec<u32>,
}

impl ObjFaces {
    /// Adds a face; `counts` are the numbers of positions, texture coordinates and normals before it.
    pub(super) fn push<'a>(
        &mut self,
        line: usize,
        words: impl Iterator<Item = &'a str>,
        counts: [usize; 3],
        mesh: &mut MeshBuilder,
    ) -> Result<(), String> {
        self.face.clear();
        let first = self.uvs.len();
        let mut shape: Option<[bool; 2]> = None;
        for word in words {
            let [vertex, uv, normal]: ObjCorner = corner::read(word, counts)?;
            let given = [uv != NONE, normal != NONE];
            if *shape.get_or_insert(given) != given {
                self.uvs.truncate(first);
                return Err(format!("corner {} has other parts than the corners before it", quoted(word)));
            }
            self.face.push(vertex);
            self.uvs.push(uv);
            if normal != NONE && self.normal.is_none_or(|(largest, _)| normal > largest) {
                self.normal = Some((normal, line));
            }
        }
        if let Err(detail) = mesh.face(&self.face) {
            self.uvs.truncate(first);
            return Err(detail);
        }
        let face = index(self.lines.len());
        self.lines.push(index(line));
        [&mut self.objects, &mut self.groups, &mut self.materials].into_iter().for_each(|sets| sets.take(face));
        Ok(())
    }

    /// Lists the faces whose indices are beyond what the file has.
    pub(super) fn beyond(&self, counts: [usize; 3], faces: &FaceList) -> Vec<String> {
        let mut faults = Vec::new();
        let mut corner = 0;
        for (f, &line) in self.lines.iter().enumerate() {
            let face = faces.face(f);
            let uvs = &self.uvs[corner..corner + face.len()];
            corner += face.len();
            let vertex = face.iter().find(|&&v| v as usize >= counts[0]).map(|&v| corner::beyond(0, v, counts[0]));
            let uv = uvs.iter().find(|&&uv| uv != NONE && uv as usize >= counts[1]);
            let uv = uv.map(|&uv| corner::beyond(1, uv, counts[1]));
            faults.extend(vertex.or(uv).map(|detail| at_line(line as usize, detail)));
            if faults.len() == MAX_FACE_FAULTS {
                return faults;
            }
        }
        if let Some((normal, line)) = self.normal.filter(|&(normal, _)| normal as usize >= counts[2]) {
            faults.push(at_line(line, corner::beyond(2, normal, counts[2])));
        }
        faults
    }

    /// Moves lines, texture coordinates and sets into the mesh.
    pub(super) fn finish(self, uvs: Vec<[f64; 2]>, mesh: &mut ReadMesh) {
        let without = self.uvs.iter().filter(|&&uv| uv == NONE).count();
        if !self.uvs.is_empty() && without == 0 {
            mesh.uvs = Some(CornerUvs::new(uvs, self.uvs));
        } else if without < self.uvs.len() {
            mesh.notes
                .push(format!("texture coordinates are left out: {without} of {} corners have none", self.uvs.len()));
        }
        mesh.lines = self.lines;
        // groups come before objects because they are more specific
        mesh.groups = self.groups.finish().chain(self.objects.finish()).collect();
        mesh.materials = self.materials.finish().collect();
    }
}

/// A named set of faces as ranges in ascending order; a face may be in many sets.
#[derive(Debug)]
struct Set {
    name: String,
    faces: Vec<Range<u32>>,
}

/// Named sets, and the current sets, which the next face joins.
#[derive(Debug, Default)]
pub(super) struct Sets {
    found: Vec<Set>,
    by_name: BTreeMap<String, usize>,
    current: Vec<usize>,
}

impl Sets {
    /// Makes the sets of these names the current ones; [`NO_NAME`] is ignored.
    pub(super) fn enter<'a>(&mut self, names: impl Iterator<Item = &'a str>) -> Result<(), String> {
        self.current.clear();
        for name in names.filter(|name| !name.is_empty() && *name != NO_NAME) {
            if self.current.len() == MAX_AT_ONCE {
                return Err(format!("more than {MAX_AT_ONCE} groups at once; a face may be in {MAX_AT_ONCE}"));
            }
            let at = if let Some(&at) = self.by_name.get(name) {
                at
            } else {
                self.by_name.insert(name.to_owned(), self.found.len());
                self.found.push(Set { name: name.to_owned(), faces: Vec::new() });
                self.found.len() - 1
            };
            if !self.current.contains(&at) {
                self.current.push(at);
            }
        }
        Ok(())
    }

    fn take(&mut self, face: u32) {
        for &at in &self.current {
            match self.found[at].faces.last_mut().filter(|range| range.end == face) {
                Some(range) => range.end = face + 1,
                None => self.found[at].faces.push(face..face + 1),
            }
        }
    }

    /// Returns the sets that have faces, in the order in which their names first appeared.
    fn finish(self) -> impl Iterator<Item = FaceSet> {
        self.found.into_iter().filter(|set| !set.faces.is_empty()).map(|Set { name, faces: ranges }| {
            let mut faces = Vec::with_capacity(ranges.iter().map(ExactSizeIterator::len).sum());
            ranges.into_iter().for_each(|range| faces.extend(range.map(u64::from)));
            FaceSet { name, faces }
        })
    }
}
