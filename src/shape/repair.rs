//! Repairs a mesh before it is checked by merging vertices and pairing triangles into quads; each repair is recorded.

use std::collections::BTreeSet;

use super::attachments::{AttachmentsInput, ChannelInput};
use super::attributes::Attributes;
use super::check::{FaceList, NonManifold, groups, oriented, sides};
use super::mesh::MeshInput;
use super::pair::{Diagonal, pair};
use super::repairs::{AffectedFaces, Repair};
use super::seams::SeamsInput;
use super::topology::{NONE, index};
use super::weld::{Welded, weld, weld_faces};
use crate::fault::Fault;

impl MeshInput {
    /// Merges vertices that are at most `distance` (model units) apart, and removes faces that collapse.
    ///
    /// A mesh with unrelated faults is returned unchanged, so that [`super::mesh::Mesh::new`] refuses it.
    ///
    /// # Errors
    /// A distance that cannot be used or that leaves no face, at `/weld`; a face that would meet a vertex twice.
    pub fn welded(mut self, distance: f64) -> Result<Self, Fault> {
        let n = self.positions.len();
        let is_whole = (0..self.faces.len()).all(|f| self.faces.face(f).iter().all(|&v| (v as usize) < n));
        if !is_whole || self.positions.iter().flatten().any(|x| !x.is_finite()) {
            return Ok(self);
        }
        let welded = weld(&self.positions, distance).map_err(|detail| Fault::new("/weld", detail))?;
        let result = weld_faces(&self.faces, &welded).map_err(|(f, v)| {
            let detail = format!(
                "merging vertices within {distance} makes face {f} meet vertex {v} twice; choose a smaller distance"
            );
            Fault::new("/weld", detail)
        })?;
        if result.faces.is_empty() && !self.faces.is_empty() && distance > 0.0 {
            let detail = format!(
                "merging vertices within {distance} leaves none of {} faces; choose a smaller distance",
                self.faces.len()
            );
            return Err(Fault::new("/weld", detail));
        }
        if welded.merged() > 0 {
            self.repairs.push(Repair::Welded { merged: welded.merged(), pairs: welded.pairs.clone() });
            let lost = self.attributes.as_ref().and_then(|attributes| lost_parameters(attributes, &welded));
            self.repairs.extend(lost);
            if let Some(uvs) = &mut self.attachments.uvs {
                uvs.seams.join(2, uvs.values.as_flattened(), &self.faces, &welded);
            }
        }
        self.repairs.extend(AffectedFaces::some(result.gone.iter().copied()).map(Repair::LeftOut));
        self.positions = welded.kept.iter().map(|&v| self.positions[v as usize]).collect();
        let image =
            |vertex: u64| usize::try_from(vertex).ok().and_then(|v| welded.image.get(v)).map_or(vertex, |&v| v.into());
        self.corners.iter_mut().for_each(|(vertex, _)| *vertex = image(*vertex));
        self.creases.iter_mut().for_each(|(edge, _)| *edge = edge.map(image));
        self.creases.retain(|([a, b], _)| a != b);
        for edges in [&mut self.latitude, &mut self.longitude] {
            edges.iter_mut().for_each(|edge| *edge = edge.map(image));
            edges.retain(|[a, b]| a != b);
        }
        let kept = |array: &[f64]| {
            let is_whole = array.len() == n;
            if is_whole { welded.kept.iter().map(|&v| array[v as usize]).collect() } else { array.to_vec() }
        };
        self.attributes = self.attributes.map(|attributes| attributes.changed(kept));
        self.attachments.channels.iter_mut().for_each(|channel| weld_channel(channel, &self.faces, &welded));
        self.refaced(result.faces, &result.kept, &result.corners);
        Ok(self)
    }

    /// Merges vertices at equal positions, the default for some file formats. If only the merging gives edges more than
    /// two faces, as where bodies touch, the mesh is cut at these edges.
    ///
    /// # Errors
    /// As [`Self::welded`].
    pub fn joined(self) -> Result<Self, Fault> {
        let before = self.faces.clone();
        let n = self.positions.len();
        let welded = self.welded(0.0)?;
        let is_joined = welded.positions.len() < n && crowded(n, &before) == 0;
        Ok(if is_joined { welded.split_where_crowded() } else { welded })
    }

    /// Requests a cut at edges with more than two faces, which welding has made.
    #[must_use]
    pub fn split_where_crowded(mut self) -> Self {
        let n = crowded(self.positions.len(), &self.faces);
        if n > 0 {
            self.non_manifold = NonManifold::SplitCrowded;
            let edges = if n == 1 { "edge" } else { "edges" };
            self.notes.push(format!(
                "welding gives {n} {edges} more than two faces, as where bodies touch, so that the mesh is cut there; \
                 \"weld\": false welds nothing"
            ));
        }
        self
    }

    /// Gives each face corner a vertex of its own; only for meshes without data on vertices.
    #[must_use]
    pub fn with_split_corners(mut self) -> Self {
        self.positions = self.faces.vertices().iter().map(|&v| self.positions[v as usize]).collect();
        self.faces = self.faces.with_vertices((0..index(self.positions.len())).collect());
        self
    }

    /// Joins pairs of triangles into quads where the pairing is unambiguous; faces are first reversed according to
    /// `winding`.
    ///
    /// A mesh with faults is returned unchanged, so that [`super::mesh::Mesh::new`] refuses it.
    #[must_use]
    pub fn paired(mut self) -> Self {
        let mut faces = self.faces.clone();
        let (n, winding) = (self.positions.len(), self.winding);
        let Ok(changed) = oriented(n, &mut faces, winding, self.non_manifold) else { return self };
        if self.positions.iter().flatten().any(|x| !x.is_finite()) {
            return self;
        }
        self.repairs.extend(AffectedFaces::some(changed.iter().copied()).map(Repair::Turned));
        seams(&mut self.attachments).for_each(|seams| seams.reverse(&faces, &changed));
        self.faces = faces;
        let mut is_hole = vec![false; self.faces.len()];
        for &hole in &self.holes {
            usize::try_from(hole).ok().and_then(|f| is_hole.get_mut(f)).into_iter().for_each(|flag| *flag = true);
        }
        let names = self.names();
        let sharp = self.creases.iter().filter(|(_, sharpness)| *sharpness > 0.0);
        let sharp: BTreeSet<[u64; 2]> = sharp.map(|&([a, b], _)| [a.min(b), a.max(b)]).collect();
        let uvs = self.attachments.uvs.iter().map(|uvs| &uvs.seams);
        let seams = uvs.chain(self.attachments.channels.iter().filter_map(|channel| channel.seams.as_ref()));
        let seams: Vec<&SeamsInput> = seams.filter(|seams| seams.fits(&self.faces)).collect();
        let may_join = |diagonal: Diagonal| {
            let [f, g] = diagonal.faces.map(|f| is_hole[f as usize]);
            let [a, b] = diagonal.ends.map(u64::from);
            let [name, other] = diagonal.faces.map(|f| names[f as usize]);
            let smooth = seams.iter().all(|seams| seams.joins(diagonal));
            f == g && name == other && smooth && !sharp.contains(&[a.min(b), a.max(b)])
        };
        let paired = pair(&self.positions, &self.faces, may_join);
        let left = (0..paired.faces.len()).filter(|&f| paired.faces.face(f).len() == 3).count();
        self.repairs.push(Repair::Paired { pairs: paired.made, left });
        self.refaced(paired.faces, &paired.kept, &paired.corners);
        self
    }

    /// Returns, for each face, the indices of its group and its material, counted from 1; 0 for none.
    fn names(&self) -> Vec<[usize; 2]> {
        let mut names = vec![[0; 2]; self.faces.len()];
        for (kind, sets) in [&self.attachments.groups, &self.attachments.materials].into_iter().enumerate() {
            for (i, set) in sets.iter().enumerate() {
                for &f in &set.faces {
                    let slot = usize::try_from(f).ok().and_then(|f| names.get_mut(f));
                    slot.into_iter().for_each(|names| names[kind] = i + 1);
                }
            }
        }
        names
    }

    /// Replaces the faces; `kept` names the old face of each new one, ascending, and `corners` the old corner of each
    /// new one. Holes, groups, materials and face-corner values are adapted.
    fn refaced(&mut self, faces: FaceList, kept: &[u32], corners: &[u32]) {
        seams(&mut self.attachments).for_each(|seams| seams.follow(&self.faces, &faces, corners));
        let mut image = vec![NONE; self.faces.len()];
        kept.iter().zip(0..).for_each(|(&old, new)| image[old as usize] = new);
        let moved = |face: u64| match usize::try_from(face).ok().and_then(|f| image.get(f)) {
            Some(&NONE) => None,
            Some(&new) => Some(u64::from(new)),
            // there is no such face, neither before nor after; the check reports it
            None => Some(face),
        };
        let sets = self.attachments.groups.iter_mut().chain(&mut self.attachments.materials);
        for faces in sets.map(|set| &mut set.faces).chain([&mut self.holes]) {
            *faces = faces.iter().filter_map(|&face| moved(face)).collect();
        }
        self.faces = faces;
    }
}

/// Returns the number of edges with more than two faces, or 0 if some face has vertices that do not exist.
fn crowded(n_vertices: usize, faces: &FaceList) -> usize {
    if faces.vertices().iter().any(|&v| v as usize >= n_vertices) {
        return 0;
    }
    groups(&sides(n_vertices, faces)).filter(|group| group.len() > 2).count()
}

/// Returns the seams of all attributes that have any.
fn seams(attachments: &mut AttachmentsInput) -> impl Iterator<Item = &mut SeamsInput> {
    let uvs = attachments.uvs.iter_mut().map(|uvs| &mut uvs.seams);
    uvs.chain(attachments.channels.iter_mut().filter_map(|channel| channel.seams.as_mut()))
}

/// Reduces a channel to the vertices that were kept. If merged vertices have different values, all values stay at the
/// corners of `faces`, which still have the old vertices, and the channel gets seams.
fn weld_channel(ChannelInput { width, values, seams, .. }: &mut ChannelInput, faces: &FaceList, welded: &Welded) {
    if let Some(seams) = seams {
        return seams.join(*width, values, faces, welded);
    }
    let rows: Vec<&[f64]> = values.chunks_exact((*width).max(1)).collect();
    if rows.len() != welded.image.len() {
        return;
    }
    let kept = |new: u32| rows[welded.kept[new as usize] as usize];
    if welded.image.iter().zip(&rows).all(|(&new, &row)| kept(new) == row) {
        *values = (0..index(welded.kept.len())).flat_map(kept).copied().collect();
    } else {
        seams.insert(SeamsInput::of_vertices(faces)).join(*width, values, faces, welded);
    }
}

/// Returns the parameters in which merged vertices differ from those that were kept, each with the first such pair.
fn lost_parameters(attributes: &Attributes, welded: &Welded) -> Option<Repair> {
    let image = welded.image.iter().enumerate();
    let merged = image.map(|(v, &new)| (v, welded.kept[new as usize] as usize));
    // zeros of both signs are equal
    let differ =
        |array: &[f64], from: usize, into: usize| (array[from] + 0.0).to_bits() != (array[into] + 0.0).to_bits();
    let first = |(name, array): (&'static str, Option<&[f64]>)| {
        let array = array.filter(|array| array.len() == welded.image.len())?;
        let (from, into) = merged.clone().find(|&(from, into)| differ(array, from, into))?;
        Some((name, [from, into]))
    };
    let lost: Vec<_> = attributes.arrays().into_iter().filter_map(first).collect();
    (!lost.is_empty()).then_some(Repair::LostParameters(lost))
}
