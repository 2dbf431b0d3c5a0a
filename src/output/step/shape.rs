//! Faces, edges and vertices as entities.

use std::fmt::Write as _;

use super::entities::{Entities, Id, List, Real, StepText};
use super::product::StepProduct;
use crate::math::vector::Vector;
use crate::output::error::FormatError;
use crate::solid::{BSplineCurve, BSplineSurface, Brep, Face, Shell};
use crate::watch::Watch;

/// Writes all faces, and returns their entities.
pub(super) fn faces(out: &mut Entities<'_>, brep: &Brep, watch: &Watch) -> Result<Vec<Id>, FormatError> {
    let mut vertices = vec![None; brep.vertices.len()];
    let mut edges = vec![None; brep.edges.len()];
    let mut found = Vec::with_capacity(brep.faces.len());
    for face in &brep.faces {
        watch.check()?;
        let mut around = Vec::with_capacity(face.edges.len());
        for &(e, along) in &face.edges {
            let edge = match edges[e as usize] {
                Some(edge) => edge,
                None => *edges[e as usize].insert(edge(out, brep, e as usize, &mut vertices)?),
            };
            let sense = if along { ".T." } else { ".F." };
            around.push(out.add(format_args!("ORIENTED_EDGE('',*,*,{edge},{sense})"))?);
        }
        let around = out.add(format_args!("EDGE_LOOP('',{})", List(&around)))?;
        let bound = out.add(format_args!("FACE_OUTER_BOUND('',{around},.T.)"))?;
        let surface = surface(out, &face.surface)?;
        let name = name(face);
        found.push(out.add(format_args!("ADVANCED_FACE({},({bound}),{surface},.T.)", StepText(&name)))?);
    }
    Ok(found)
}

/// Maximum number of runs of input faces in the name of a face; some readers cut names at 256 bytes.
const MAX_NAMED_RUNS: usize = 12;

/// Returns the name of a face, which lists its input faces: `f3`, or `f3-f5,f8`.
fn name(face: &Face) -> String {
    let mut name = String::new();
    let runs: Vec<&[u32]> = face.inputs.chunk_by(|a, b| a + 1 == *b).collect();
    for (i, run) in runs.iter().take(MAX_NAMED_RUNS).enumerate() {
        let comma = if i > 0 { "," } else { "" };
        let (first, last) = (run[0], run[run.len() - 1]);
        let written =
            if first == last { write!(name, "{comma}f{first}") } else { write!(name, "{comma}f{first}-f{last}") };
        written.expect("text takes what is written");
    }
    if runs.len() > MAX_NAMED_RUNS {
        name.push_str(",...");
    }
    name
}

fn edge(out: &mut Entities<'_>, brep: &Brep, e: usize, vertices: &mut [Option<Id>]) -> Result<Id, FormatError> {
    let edge = &brep.edges[e];
    let mut ends = [None; 2];
    for (end, v) in ends.iter_mut().zip(edge.ends.map(|v| v as usize)) {
        if vertices[v].is_none() {
            let point = out.point(brep.vertices[v])?;
            vertices[v] = Some(out.add(format_args!("VERTEX_POINT('',{point})"))?);
        }
        *end = vertices[v];
    }
    let curve = curve(out, &edge.curve)?;
    let [Some(from), Some(to)] = ends else { unreachable!("both were written just now") };
    out.add(format_args!("EDGE_CURVE('',{from},{to},{curve},.T.)"))
}

fn points(out: &mut Entities<'_>, points: &[Vector]) -> Result<Vec<Id>, FormatError> {
    points.iter().map(|&point| out.point(point)).collect()
}

/// Returns the multiplicity of each knot.
fn multiplicities(n_knots: usize, degree: usize) -> Vec<usize> {
    (0..n_knots).map(|i| if i == 0 || i + 1 == n_knots { degree + 1 } else { 1 }).collect()
}

fn curve(out: &mut Entities<'_>, curve: &BSplineCurve) -> Result<Id, FormatError> {
    let points = points(out, &curve.points)?;
    let knots: Vec<Real> = curve.knots.iter().copied().map(Real).collect();
    out.add(format_args!(
        "B_SPLINE_CURVE_WITH_KNOTS('',{},{},.UNSPECIFIED.,.F.,.F.,{},{},.UNSPECIFIED.)",
        curve.degree,
        List(&points),
        List(&multiplicities(knots.len(), curve.degree)),
        List(&knots)
    ))
}

fn surface(out: &mut Entities<'_>, surface: &BSplineSurface) -> Result<Id, FormatError> {
    let rows = surface.points.iter().map(|row| points(out, row)).collect::<Result<Vec<_>, _>>()?;
    let rows: Vec<List<'_, Id>> = rows.iter().map(|row| List(row)).collect();
    let knots: [Vec<Real>; 2] = [0, 1].map(|d| surface.knots(d).into_iter().map(Real).collect());
    let [along_u, along_v] = [&knots[0], &knots[1]].map(|knots| multiplicities(knots.len(), surface.degree));
    out.add(format_args!(
        "B_SPLINE_SURFACE_WITH_KNOTS('',{0},{0},{1},.UNSPECIFIED.,.F.,.F.,.F.,{2},{3},{4},{5},.UNSPECIFIED.)",
        surface.degree,
        List(&rows),
        List(&along_u),
        List(&along_v),
        List(&knots[0]),
        List(&knots[1])
    ))
}

/// Writes shells of faces, and the representations that hold them: a solid for each closed shell.
pub(super) fn shells(
    out: &mut Entities<'_>,
    shells: &[Shell],
    faces: &[Id],
    product: StepProduct,
) -> Result<(), FormatError> {
    let mut items = [vec![product.axes], vec![product.axes]];
    let mut open = Vec::new();
    for shell in shells {
        let faces: Vec<Id> = shell.faces.iter().map(|&f| faces[f as usize]).collect();
        if shell.is_closed {
            let shell = out.add(format_args!("CLOSED_SHELL('',{})", List(&faces)))?;
            items[0].push(out.add(format_args!("MANIFOLD_SOLID_BREP('',{shell})"))?);
        } else {
            open.push(out.add(format_args!("OPEN_SHELL('',{})", List(&faces)))?);
        }
    }
    if !open.is_empty() {
        items[1].push(out.add(format_args!("SHELL_BASED_SURFACE_MODEL('',{})", List(&open)))?);
    }
    let kinds = ["ADVANCED_BREP_SHAPE_REPRESENTATION", "MANIFOLD_SURFACE_SHAPE_REPRESENTATION"];
    let mut first = None;
    for (items, kind) in items.iter().zip(kinds).filter(|(items, _)| items.len() > 1) {
        let representation = out.add(format_args!("{kind}('',{},{})", List(items), product.context))?;
        match first {
            None => {
                out.add(format_args!("SHAPE_DEFINITION_REPRESENTATION({},{representation})", product.shape))?;
                first = Some(representation);
            }
            Some(first) => {
                out.add(format_args!("SHAPE_REPRESENTATION_RELATIONSHIP('','',{first},{representation})"))?;
            }
        }
    }
    Ok(())
}
