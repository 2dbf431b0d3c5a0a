//! Control meshes as clients write them.

use serde::Deserialize;
use utoipa::ToSchema;

use super::channels::{self, ChannelsRequest};
use super::corners::{UvsRequest, face_list};
use super::material::{MaterialRequest, materials};
use super::polygon::PointParameters;
use super::result_entries::PassedOver;
use super::{fixed, object, schema, whole};
use crate::fault::Fault;
use crate::shape::attachments::AttachmentsInput;
use crate::shape::check::Winding;
use crate::shape::labels::FaceSet;
use crate::shape::mesh::MeshInput;

/// A control mesh.
#[derive(Debug, Clone, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct MeshRequest {
    /// Vertex positions, `n x 3`, model units.
    #[serde(deserialize_with = "fixed::list")]
    #[schema(schema_with = schema::positions)]
    pub positions: Vec<[f64; 3]>,
    /// Other positions of the same vertices, frame after frame: frame 0 is `positions`, frame k entry k - 1 of these.
    /// `glb` and `gltf` hold all frames, as morph targets; an output with a `frame` shows that one.
    #[serde(default, deserialize_with = "fixed::lists")]
    #[schema(schema_with = schema::frames)]
    pub frames: Vec<Vec<[f64; 3]>>,
    /// Faces as lists of vertex indices, counted from 0, counter-clockwise seen from outside.
    #[serde(deserialize_with = "whole::lists")]
    #[schema(schema_with = schema::faces)]
    pub faces: Vec<Vec<u64>>,
    /// Sharp vertices: infinitely sharp ones keep their place.
    #[serde(default, deserialize_with = "object::list")]
    pub corners: Vec<CornerRequest>,
    /// Sharp edges.
    #[serde(default, deserialize_with = "object::list")]
    pub creases: Vec<CreaseRequest>,
    /// Faces that are refined but not shown.
    #[serde(default, deserialize_with = "whole::list")]
    pub holes: Vec<u64>,
    /// Parameters that vertices carry: each a list of one number a vertex.
    #[serde(default, deserialize_with = "object::optional")]
    pub parameters: Option<PointParameters>,
    /// Edges along latitude lines, as pairs of vertices.
    #[serde(default, deserialize_with = "whole::pairs")]
    #[schema(schema_with = schema::edges)]
    pub latitude: Vec<[u64; 2]>,
    /// Edges along longitude lines, as pairs of vertices.
    #[serde(default, deserialize_with = "whole::pairs")]
    #[schema(schema_with = schema::edges)]
    pub longitude: Vec<[u64; 2]>,
    /// Numbers that vertices carry, by name: `n` numbers, or `n` lists of 1 to 4 numbers; refined like positions. With
    /// `values` and `faces`, as `uvs` have them, corners of faces carry them, and seams stay seams. `color` (red,
    /// green, blue and perhaps alpha, sRGB from 0 to 1) is the colour of the vertices.
    #[serde(default)]
    #[schema(schema_with = channels::described)]
    pub channels: ChannelsRequest,
    /// Groups of faces; a face is in one of them at most.
    #[serde(default, deserialize_with = "object::list")]
    #[schema(max_items = 256)]
    pub groups: Vec<FaceSetRequest>,
    /// Materials of faces, and how they look; a face has one of them at most.
    #[serde(default, deserialize_with = "object::list")]
    #[schema(max_items = 256)]
    pub materials: Vec<MaterialRequest>,
    /// Texture coordinates of face corners.
    #[serde(default, deserialize_with = "object::optional")]
    pub uvs: Option<UvsRequest>,
    /// What a `json` result says of normals, passed over where the result is an input.
    #[serde(default)]
    #[schema(value_type = serde_json::Value)]
    pub normals: PassedOver,
    /// What a `json` result says of the cells of its input, passed over where the result is an input.
    #[serde(default)]
    #[schema(value_type = serde_json::Value)]
    pub ids: PassedOver,
    /// What a `json` result says of the edges of its input, passed over where the result is an input.
    #[serde(default)]
    #[schema(value_type = serde_json::Value)]
    pub isolines: PassedOver,
    /// What a `json` result says of sections, passed over where the result is an input.
    #[serde(default)]
    #[schema(value_type = serde_json::Value)]
    pub sections: PassedOver,
    /// Warnings of a `json` result, passed over where the result is an input.
    #[serde(default)]
    #[schema(value_type = serde_json::Value)]
    pub warnings: PassedOver,
}

/// Some faces under one name.
#[derive(Debug, Clone, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct FaceSetRequest {
    /// The name: 1 to 64 bytes without blanks, control characters and `#`.
    pub name: String,
    /// Faces, counted from 0.
    #[serde(deserialize_with = "whole::list")]
    pub faces: Vec<u64>,
}

fn face_sets(requests: Vec<FaceSetRequest>) -> Vec<FaceSet> {
    requests.into_iter().map(|FaceSetRequest { name, faces }| FaceSet { name, faces }).collect()
}

/// A corner of a mesh.
#[derive(Debug, Clone, Copy, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct CornerRequest {
    /// The vertex.
    #[serde(deserialize_with = "whole::one")]
    pub vertex: u64,
    /// 0 is smooth, 10 or more infinitely sharp; what lies between belongs to `catmull-clark` and `loop`.
    #[schema(minimum = 0)]
    pub sharpness: f64,
}

/// A sharp edge of a mesh.
#[derive(Debug, Clone, Copy, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct CreaseRequest {
    /// The two ends of the edge, in any order.
    #[serde(deserialize_with = "whole::pair")]
    #[schema(schema_with = schema::ends)]
    pub edge: [u64; 2],
    /// 0 is smooth, 10 or more infinitely sharp; what lies between belongs to `catmull-clark` and `loop`, which
    /// make it less from level to level.
    #[schema(minimum = 0)]
    pub sharpness: f64,
}

impl MeshRequest {
    /// Converts the request; only indices that no mesh can have are checked.
    ///
    /// # Errors
    /// Indices that are out of range, with pointers below the mesh.
    pub fn input(self, winding: Winding) -> Result<MeshInput, Vec<Fault>> {
        let beyond = |(f, face): (usize, &Vec<u64>)| {
            let j = face.iter().position(|&v| v >= u64::from(u32::MAX))?;
            let detail =
                format!("there is no vertex {}; the mesh has {}, counted from 0", face[j], self.positions.len());
            Some(Fault::new(format!("/faces/{f}/{j}"), detail))
        };
        let beyond: Vec<Fault> = self.faces.iter().enumerate().filter_map(beyond).take(20).collect();
        if !beyond.is_empty() {
            return Err(beyond);
        }
        let corners = self.corners.iter().map(|corner| (corner.vertex, corner.sharpness)).collect();
        let creases = self.creases.iter().map(|crease| (crease.edge, crease.sharpness)).collect();
        let (materials, looks) = materials(self.materials)?;
        let entries =
            [("normals", self.normals), ("ids", self.ids), ("isolines", self.isolines), ("sections", self.sections)];
        let given: Vec<&str> = entries.into_iter().filter(|(_, entry)| entry.is_given).map(|(name, _)| name).collect();
        let left_out = || format!("what a result says beside its mesh is left out: {}", given.join(", "));
        let notes = (!given.is_empty()).then(left_out).into_iter().collect();
        let attachments = AttachmentsInput {
            channels: self.channels.0,
            groups: face_sets(self.groups),
            materials,
            looks,
            uvs: self.uvs.map(UvsRequest::resolve),
        };
        Ok(MeshInput {
            positions: self.positions,
            frames: self.frames,
            faces: face_list(&self.faces),
            corners,
            creases,
            holes: self.holes,
            attributes: self.parameters.map(PointParameters::attributes),
            latitude: self.latitude,
            longitude: self.longitude,
            winding,
            attachments,
            notes,
            ..MeshInput::default()
        })
    }
}
