//! Builds the solid of a control mesh.

use super::brep::Brep;
use super::certificate::Certificate;
use super::error::SolidError;
use super::forecast::CageCounts;
use super::isolate::{SurfacePieces, isolate};
use super::level::{Level, Refiner};
use super::pack::rectangles;
use super::patch::FacePatch;
use super::request::SolidRequest;
use super::rounding::Rounding;
use crate::math::amounts::thousands;
use crate::math::vector::{Vector, plus, times};
use crate::scheme::operator::BICUBIC;
use crate::scheme::plan::Plan;
use crate::shape::mesh::Mesh;
use crate::watch::Watch;

/// The boundary of a solid, with its certificate.
#[derive(Debug, Clone)]
pub struct Solid {
    /// Its faces, edges and vertices.
    pub brep: Brep,
    /// The deviation from the limit surface, and how the faces meet.
    pub certificate: Certificate,
}

/// Builds the solid of a control mesh under a plan whose regular pieces are bicubic. `labels` has a number for each
/// face of the mesh: faces with different labels are not merged.
///
/// # Errors
/// [`SolidError`], in particular if the mesh gives no solid of the requested kind.
pub fn solid(
    mesh: &Mesh,
    plan: &Plan,
    request: &SolidRequest,
    labels: &[u32],
    watch: &Watch,
) -> Result<Solid, SolidError> {
    check(mesh, plan, request)?;
    let (size, middle) = extent(mesh);
    let refiner = Refiner::new(plan, watch)?;
    // at most as many leaves as the memory was booked for
    let most = usize::try_from(CageCounts::of(mesh).forecast(request).leaves).unwrap_or(usize::MAX);
    let rounding = Rounding::of(mesh);
    let pieces = isolate(Level::of(mesh, plan), request, (request.tolerance * size, rounding, most), &refiner)?;
    let SurfacePieces { leaves, caps, vertices, edges, depth } = pieces;
    let rectangles = rectangles(&leaves, &edges, request.pack, labels);
    let n_faces = rectangles.len() + caps.len();
    if n_faces > request.max_faces {
        let detail = format!(
            "the solid has {} faces, at most {} are asked for; raise max_faces, ask for a coarser tolerance, or pack \
             \"patch\"",
            thousands(n_faces as u128),
            thousands(request.max_faces as u128)
        );
        return Err(SolidError::at("max_faces", detail));
    }
    let mut patches = Vec::with_capacity(n_faces);
    for rectangle in &rectangles {
        watch.check()?;
        patches.push(FacePatch::of_rectangle(rectangle, &leaves, &edges));
    }
    drop(leaves);
    patches.extend(caps.into_iter().map(|cap| FacePatch::of_cap(cap, &edges)));
    if patches.is_empty() {
        return Err(SolidError::empty());
    }
    let mut brep = Brep::of(patches, &edges, request.shortest)?;
    let certificate = Certificate::of(&mut brep, vertices, (size, middle), rounding.after(depth));
    if request.closed && !certificate.is_closed() {
        let n = certificate.shells.iter().filter(|shell| !shell.is_closed).count();
        let detail = format!("{n} components of the mesh are open; close them, or ask for solid \"auto\"");
        return Err(SolidError::at("solid", detail));
    }
    Ok(Solid { brep, certificate })
}

/// Refuses before any refinement what is known not to give a solid.
///
/// # Errors
/// [`SolidError::Unfit`].
pub fn check(mesh: &Mesh, plan: &Plan, request: &SolidRequest) -> Result<(), SolidError> {
    if !plan.is_bicubic() {
        let detail = format!(
            "solids are made of {BICUBIC} alone, whose regular pieces are bicubic; choose it, or ask for stl or glb of \
             some levels"
        );
        return Err(SolidError::at("format", detail));
    }
    if let Some(&v) = mesh.split_from.first() {
        let detail = format!(
            "the mesh touches itself at vertex {v}, where several fans of faces meet, which no solid can; part them"
        );
        return Err(SolidError::at("", detail));
    }
    if extent(mesh).0 <= 0.0 {
        return Err(SolidError::at("", "all vertices of the mesh are at one place; send one that encloses something"));
    }
    if request.closed && mesh.topology.n_boundary() > 0 {
        let n = mesh.topology.n_boundary();
        let detail = format!("the mesh is open, it has {n} boundary edges; close it, or ask for solid \"auto\"");
        return Err(SolidError::at("solid", detail));
    }
    Ok(())
}

/// Returns the largest side of the bounding box of a control mesh, and its centre.
fn extent(mesh: &Mesh) -> (f64, Vector) {
    let points: &[Vector] = mesh.positions.as_chunks().0;
    let bound = |start: f64, pick: fn(f64, f64) -> f64| {
        points.iter().fold([start; 3], |sum, p| std::array::from_fn(|k| pick(sum[k], p[k])))
    };
    let (low, high): (Vector, Vector) = (bound(f64::INFINITY, f64::min), bound(f64::NEG_INFINITY, f64::max));
    let size = (0..3).map(|k| high[k] - low[k]).fold(0.0, f64::max);
    (size, times(0.5, plus(low, high)))
}
