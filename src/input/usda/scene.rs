//! Combines the visible prims into one mesh.

use std::collections::BTreeMap;

use super::polygons::{self, MeshRanges, below};
use super::primvars::Primvars;
use super::tree::{Layer, Prim, UsdaValue, metadata_value};
use super::{looks, place};
use crate::input::collect::MeshBuilder;
use crate::input::reader::{ReadLimits, ReadMesh};
use crate::input::room::{GROWN, MemoryBudget};
use crate::input::text::quoted;
use crate::input::transform::Transform;
use crate::scheme::tags::Boundary;
use crate::shape::labels::{FaceSet, MAX_LABELS};
use crate::shape::looks::Look;

/// Bytes of memory of a set of faces, and of a face index in it, each kept in lists that grow.
const USDA_SET_BYTES: usize = GROWN * size_of::<FaceSet>() + 128;
const USDA_MEMBER_BYTES: usize = GROWN * 8;
/// Shapes that are not meshes.
const OTHER_SHAPES: [&str; 13] = [
    "BasisCurves",
    "Capsule",
    "Cone",
    "Cube",
    "Cylinder",
    "HermiteCurves",
    "NurbsCurves",
    "NurbsPatch",
    "Plane",
    "PointInstancer",
    "Points",
    "Sphere",
    "TetMesh",
];

/// Reads the meshes of a layer; `scale` is the factor of lengths, if any.
///
/// # Errors
/// The lists of a mesh, named by its path, do not fit together, or the meshes take more than is allowed.
pub(super) fn read(
    layer: &Layer<'_>,
    room: MemoryBudget,
    limits: &ReadLimits,
    scale: Option<f64>,
) -> Result<ReadMesh, String> {
    let mut reading = UsdaReader {
        layer,
        mesh: MeshBuilder::new(limits),
        room,
        primvars: Primvars::default(),
        groups: Vec::new(),
        meshes: Vec::new(),
        materials: Vec::new(),
        numbers: BTreeMap::new(),
        boundary: None,
        notes: BTreeMap::new(),
    };
    reading.note("sets of variants are left out", layer.variants);
    reading.note("other layers are left out", usize::from(has_files(&layer.metadata, &["subLayers"])));
    let mut columns = Transform::IDENTITY;
    if let Some(scale) = scale {
        reading.note("lengths are in metres, as their unit has no name here", 1);
        (0..3).for_each(|k| columns.0[k][k] = scale);
    }
    let mut path = String::new();
    for prim in &layer.prims {
        reading.prim(prim, &mut path, &columns, None)?;
    }
    reading.finish()
}

/// Whether any metadata of these names refer to files or other prims.
fn has_files(metadata: &[(&str, UsdaValue<'_>)], names: &[&str]) -> bool {
    names
        .iter()
        .filter_map(|name| metadata_value(metadata, name))
        .any(|value| value.has_assets || value.word().is_some_and(|word| word != "None"))
}

struct UsdaReader<'t, 'a> {
    layer: &'t Layer<'a>,
    mesh: MeshBuilder,
    room: MemoryBudget,
    primvars: Primvars,
    /// Subsets that bind no material.
    groups: Vec<FaceSet>,
    /// Faces of each mesh that are in none of `groups`.
    meshes: Vec<FaceSet>,
    materials: Vec<Bound<'a>>,
    /// Indices into `materials` by path.
    numbers: BTreeMap<&'a str, usize>,
    boundary: Option<Boundary>,
    notes: BTreeMap<&'static str, usize>,
}

/// A material with its faces.
struct Bound<'a> {
    path: &'a str,
    faces: Vec<u64>,
    /// Whether a mesh with this material is declared single-sided.
    is_one_sided: bool,
}

impl<'a> UsdaReader<'_, 'a> {
    fn note(&mut self, what: &'static str, n: usize) {
        if n > 0 {
            *self.notes.entry(what).or_default() += n;
        }
    }

    /// Reads a prim and its descendants; `bound` is the material of its parent.
    fn prim(
        &mut self,
        prim: &Prim<'a>,
        path: &mut String,
        outer: &Transform,
        bound: Option<&'a str>,
    ) -> Result<(), String> {
        let is_off = metadata_value(&prim.metadata, "active").and_then(UsdaValue::number) == Some(0.0);
        if prim.specifier != "def" || is_off {
            return Ok(());
        }
        let is_helper = matches!(prim.word("purpose"), Some("guide" | "proxy"));
        if is_helper || prim.word("visibility") == Some("invisible") {
            self.note("prims that are not shown are left out", 1);
            return Ok(());
        }
        if OTHER_SHAPES.contains(&prim.kind) {
            self.note("shapes that are no meshes are left out", 1);
            return Ok(());
        }
        let names = ["references", "payload", "inherits", "specializes"];
        self.note("references to other prims are left out", usize::from(has_files(&prim.metadata, &names)));
        let is_skinned = prim.property("skel:skeleton").is_some();
        self.note("skins and blend shapes are not applied", usize::from(is_skinned));
        let is_moved = prim.properties.iter().any(|property| property.value.is_sampled);
        self.note("prims that move are where they begin", usize::from(is_moved));
        let before = path.len();
        path.push('/');
        path.push_str(prim.name);
        let named = |detail: String| format!("<{path}>: {detail}");
        let transform = place::of(prim, outer).map_err(named)?;
        let bound = prim.word("material:binding").or(bound);
        if prim.kind == "Mesh" {
            self.mesh(prim, &transform, bound).map_err(named)?;
        }
        for child in &prim.children {
            self.prim(child, path, &transform, bound)?;
        }
        path.truncate(before);
        Ok(())
    }

    fn mesh(&mut self, prim: &Prim<'a>, transform: &Transform, bound: Option<&'a str>) -> Result<(), String> {
        let part = polygons::faces(prim, transform, &mut self.room, &mut self.mesh)?;
        polygons::tags(prim, &part, &mut self.room, &mut self.mesh)?;
        let boundary = polygons::boundary(prim)?;
        if self.boundary.is_some() && boundary.is_some() && boundary != self.boundary {
            self.note("boundary rules of meshes are left out, as those before have another", 1);
        }
        self.boundary = self.boundary.or(boundary);
        let is_smooth = prim.word("triangleSubdivisionRule") == Some("smooth");
        self.note("the smooth rule of triangles is left to the plan", usize::from(is_smooth));
        self.primvars.take(prim, &part, &mut self.room, &mut self.mesh.mesh)?;
        self.sets(prim, &part, bound)
    }

    /// Adds the groups and materials of the faces of a mesh.
    fn sets(&mut self, prim: &Prim<'a>, part: &MeshRanges, bound: Option<&'a str>) -> Result<(), String> {
        let is_one_sided = prim.value("doubleSided").and_then(UsdaValue::number) == Some(0.0);
        self.room.take(2 * USDA_SET_BYTES + part.n_faces * (2 * USDA_MEMBER_BYTES + 2))?;
        let mut free = [vec![true; part.n_faces], vec![true; part.n_faces]];
        for subset in prim.children.iter().filter(|child| child.kind == "GeomSubset" && child.specifier == "def") {
            if subset.word("elementType").is_some_and(|kind| kind != "face") {
                self.note("subsets of edges and points are left out", 1);
                continue;
            }
            let material = subset.word("material:binding");
            let indices = subset.numbers("indices");
            self.room.take(USDA_SET_BYTES + indices.len() * USDA_MEMBER_BYTES)?;
            let mut faces = Vec::with_capacity(indices.len());
            for &x in indices {
                let face = below(x, part.n_faces, "indices of a subset")? as usize;
                free[usize::from(material.is_some())][face] = false;
                faces.push((part.first_face + face) as u64);
            }
            match material {
                Some(path) => self.bind(path, faces, is_one_sided),
                None => self.groups.push(FaceSet { name: subset.label(), faces }),
            }
        }
        let left = free.map(|free| {
            let faces = free.iter().enumerate().filter(|(_, is_free)| **is_free);
            faces.map(|(f, _)| (part.first_face + f) as u64).collect::<Vec<u64>>()
        });
        let [without_group, without_material] = left;
        if !without_group.is_empty() {
            self.meshes.push(FaceSet { name: prim.label(), faces: without_group });
        }
        if let Some(path) = bound.filter(|_| !without_material.is_empty()) {
            self.bind(path, without_material, is_one_sided);
        }
        Ok(())
    }

    fn bind(&mut self, path: &'a str, faces: Vec<u64>, is_one_sided: bool) {
        let number = *self.numbers.entry(path).or_insert(self.materials.len());
        if number == self.materials.len() {
            self.materials.push(Bound { path, faces: Vec::new(), is_one_sided });
        }
        self.materials[number].faces.extend(faces);
        self.materials[number].is_one_sided |= is_one_sided;
    }

    fn finish(mut self) -> Result<ReadMesh, String> {
        let mut mesh = std::mem::take(&mut self.mesh.mesh);
        mesh.boundary = self.boundary;
        std::mem::take(&mut self.primvars).finish(&mut self.room, &mut mesh)?;
        for (i, Bound { path, faces, is_one_sided }) in std::mem::take(&mut self.materials).into_iter().enumerate() {
            // a mesh holds at most this many
            let found = if i < MAX_LABELS { looks::at(self.layer, path) } else { None };
            let (name, mut look) = if let Some(prim) = found {
                let (look, has_textures) = looks::look(self.layer, prim);
                self.note("textures are left out", usize::from(has_textures));
                (prim.label(), look)
            } else {
                mesh.notes.push(format!("there is no material {} in the file", quoted(path)));
                (path.rsplit('/').next().unwrap_or_default().to_owned(), Look::default())
            };
            if is_one_sided {
                look.double_sided = Some(false);
            }
            mesh.materials.push(FaceSet { name, faces });
            mesh.looks.push(look);
        }
        // a single mesh group distinguishes nothing
        let meshes = if self.meshes.len() > 1 { self.meshes } else { Vec::new() };
        mesh.groups = self.groups.into_iter().chain(meshes).collect();
        mesh.notes.extend(self.notes.into_iter().map(|(what, n)| format!("{what}: {n}")));
        Ok(mesh)
    }
}
