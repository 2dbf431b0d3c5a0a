//! D: the dual average.

use std::sync::Arc;

use rayon::prelude::*;

use super::average::Average;
use crate::fault::Fault;
use crate::math::functions::ratio;
use crate::math::rows::{Rows, RowsBy};
use crate::scheme::anchor::Anchor;
use crate::scheme::curve_rule::{CurveRule, pair};
use crate::scheme::mask_range::MaskRange;
use crate::scheme::mesh_net::MeshNet;
use crate::scheme::operator::{Children, Facts, Operator, Role, SplineStep};
use crate::scheme::parameters::SPLIT;
use crate::scheme::polygon_net::PolygonNet;
use crate::scheme::settings::LetterSettings;
use crate::scheme::step::{Action, Step, StepValues};
use crate::scheme::step_error::StepError;
use crate::shape::check::{FaceList, Winding};
use crate::shape::connect::CheckedTopology;
use crate::shape::tile::Tile;
use crate::shape::topology::{Topology, index};

/// Number of vertices whose rings one thread walks at a time. Half as many leave twice as many parts to join; twice as
/// many leave threads idle on small meshes. Results do not depend on it.
const RINGS_PER_TASK: usize = 4096;

/// D, the dual average: one new point for each edge of a curve, for each face of a mesh.
#[derive(Debug)]
pub(super) struct Dual;

static FACTS: Facts = Facts {
    letter: Some('D'),
    name: "dual",
    doc: "The dual average. Curves: q[j] = (w[j] p[j] + w[j+1] p[j+1]) / (w[j] + w[j+1]), with the kernel f as weight \
     of vertices and 1 of edge points for the first average after a U, all 1 else. Meshes: one vertex for each face, \
     at the mean of its vertices (weights f^2 for V, f for E, 1 for F in the first average after a U); one face for \
     each interior vertex.",
    source: "Lane and Riesenfeld, IEEE PAMI 2 (1980), 35-46; Zhang and Wang 2002, formula (2)",
    curve: Some(CurveRule::Pair),
    role: Role::Average,
    uses: &["kernel"],
    parameters: &[SPLIT],
    children: Children::Dual,
    twice: Some(&Average),
    ..Facts::USUAL
};

impl Operator for Dual {
    fn facts(&self) -> &'static Facts {
        &FACTS
    }

    fn spline(&self, settings: &LetterSettings, _: f64) -> Result<SplineStep, &'static str> {
        match settings.tile() {
            Tile::Quad => Ok(SplineStep::HalfMean),
            Tile::Triangle => Err("its D makes other faces of triangles"),
        }
    }

    fn mask_range(&self, _: &LetterSettings, duals: u32) -> Option<MaskRange> {
        // the first D looks forward and the second one back, so that two of them are centred again
        Some(MaskRange::mean(2, duals % 2 == 1))
    }

    fn on_polygon(&self, net: &PolygonNet, values: &StepValues<'_>) -> Result<Step<PolygonNet>, StepError> {
        if !net.corners.is_empty() {
            return Err(cannot_carry("corners"));
        }
        let back = isize::from(net.duals % 2 == 1);
        let (landed, preimages) = net.land(MaskRange::mean(2, back == 1))?;
        let (old, f, first) = (net.clone(), values.kernel, values.first);
        let rows = preimages.rows(net.n, move |j, out: &mut Rows| {
            let (left, right) = (j - back, j - back + 1);
            let [a, b] = pair(&old.weight(left, f, first), &old.weight(right, f, first));
            old.add(left, a, out);
            old.add(right, b, out);
        });
        let rows = if net.is_uniform(values.first) { rows.repeating(net.period(), 4 * net.period()) } else { rows };
        Ok(Step { net: landed.shifted(1), action: Action::Blend(Box::new(rows)) })
    }

    fn on_mesh(&self, net: &MeshNet, values: &StepValues<'_>) -> Result<Step<MeshNet>, StepError> {
        if let Some(tags) = net.tags.lost_by_dual {
            return Err(cannot_carry(tags));
        }
        let ordered = Ordered::of(net);
        let (faces, kept) = dual_faces(&ordered)?;
        if faces.is_empty() {
            return Err(no_interior());
        }
        let n_old = net.mesh.n_vertices();
        let lost = kept.len() < n_old && !net.tags.cut;
        let checked = manifold(ordered.faces.len(), faces)?;
        let split_from = checked.split_from;
        let labels = net.since.anchor.clone().filter(|_| net.mesh.parent.is_some());
        let (n_new, f) = (checked.topology.n_vertices(), values.kernel);
        let Ordered { faces, order, .. } = ordered;
        let anchor = net.since.anchor.clone().map(|anchor| {
            let known = anchor.order.as_ref().or(order.as_ref());
            let order = known.map(|known| order_after(net, known, &kept, &split_from));
            Anchor { lost: lost || anchor.lost, order, ..anchor }
        });
        let n_faces = faces.len();
        let rows = RowsBy::new(n_new, n_old, move |row, out: &mut Rows| {
            let face = if row < n_faces { row } else { split_from[row - n_faces] as usize };
            mean_of_face(faces.face(face), order.as_deref(), labels.as_ref(), f, out);
        });
        Ok(Step { net: net.after_dual(checked.topology, anchor), action: Action::Blend(Box::new(rows)) })
    }
}

/// Adds the weighted mean of the vertices of one face, with weights f^2, f, 1 for V, E, F of the last U (on triangles f
/// for V, else 1); all are equal if f is 1.
fn mean_of_face(face: &[u32], order: Option<&[u32]>, labels: Option<&Anchor>, f: f64, out: &mut Rows) {
    let constructed = |v: u32| order.map_or(v, |order| order[v as usize]);
    let Some(labels) = labels else {
        face.iter().for_each(|&v| out.add(v, ratio(1, face.len())));
        return;
    };
    let weight = |v: u32| labels.weight(constructed(v) as usize, f);
    let sum: f64 = face.iter().map(|&v| weight(v)).sum();
    face.iter().for_each(|&v| out.add(constructed(v), weight(v) / sum));
}

/// The faces of a net in the documented order, with the index of each vertex in the order of construction.
struct Ordered {
    faces: FaceList,
    order: Option<Arc<[u32]>>,
    topology: Arc<Topology>,
}

impl Ordered {
    fn of(net: &MeshNet) -> Self {
        let topology = net.mesh.topology();
        let mut faces = FaceList::default();
        let Some(order) = net.mesh.order() else {
            (0..topology.n_faces()).for_each(|f| faces.push(topology.face(f).iter().copied()));
            return Self { faces, order: None, topology };
        };
        let mut face = vec![0; order.face_size()];
        for f in 0..order.n_faces() {
            order.face(f, &mut face);
            faces.push(face.iter().copied());
        }
        let order = (0..order.n_vertices()).map(|v| order.constructed(v)).collect();
        Self { faces, order: Some(order), topology }
    }
}

/// Returns the indices, as of the last U, of the vertices after a D, or of the vertices that become faces. `known`
/// holds the indices of the vertices or faces before it; the dual has faces for the vertices `kept`, and `split_from`
/// lists the faces that have an additional vertex.
fn order_after(net: &MeshNet, known: &Arc<[u32]>, kept: &[u32], split_from: &[u32]) -> Arc<[u32]> {
    if net.since.duals.is_multiple_of(2) {
        if kept.len() == known.len() {
            return known.clone();
        }
        kept.iter().map(|&v| known[v as usize]).collect()
    } else {
        if split_from.is_empty() {
            return known.clone();
        }
        known.iter().copied().chain(split_from.iter().map(|&face| known[face as usize])).collect()
    }
}

/// Returns the faces of the dual in the documented order, and the vertices from which they arise.
fn dual_faces(ordered: &Ordered) -> Result<(FaceList, Vec<u32>), StepError> {
    Ok(match ordered.order {
        None => cycles(&ordered.topology),
        Some(_) => cycles(&manifold(ordered.topology.n_vertices(), ordered.faces.clone())?.topology),
    })
}

/// Returns the connectivity of the dual, with one vertex per face, and more for faces that join several fans; it may
/// have no faces.
///
/// # Errors
/// If the dual is not a manifold.
pub(in crate::scheme) fn dual(topology: &Topology) -> Result<CheckedTopology, StepError> {
    manifold(topology.n_faces(), cycles(topology).0)
}

/// Returns for each interior vertex, in order, the cycle of its faces, counter-clockwise from the lowest; and these
/// vertices.
fn cycles(explicit: &Topology) -> (FaceList, Vec<u32>) {
    let dual = |v: usize, (faces, kept): &mut (FaceList, Vec<u32>)| {
        if explicit.is_isolated(v) || explicit.boundary_edges(v).is_some() {
            return;
        }
        let mut cycle: Vec<u32> = explicit.ring(v).map(|half_edge| index(explicit.face_of(half_edge))).collect();
        if cycle.len() >= 3 {
            let lowest = (0..cycle.len()).min_by_key(|&i| cycle[i]).unwrap_or(0);
            cycle.rotate_left(lowest);
            faces.push(cycle);
            kept.push(index(v));
        }
    };
    let n = explicit.n_vertices();
    let parts = (0..n.div_ceil(RINGS_PER_TASK)).into_par_iter().map(|part| {
        let mut found = (FaceList::default(), Vec::new());
        (part * RINGS_PER_TASK..n.min((part + 1) * RINGS_PER_TASK)).for_each(|v| dual(v, &mut found));
        found
    });
    let (mut faces, mut kept) = (FaceList::default(), Vec::new());
    for (some, vertices) in parts.collect::<Vec<_>>() {
        faces.append(&some);
        kept.extend(vertices);
    }
    (faces, kept)
}

fn manifold(n_vertices: usize, faces: FaceList) -> Result<CheckedTopology, StepError> {
    Topology::of_faces(n_vertices, faces, Winding::Refuse).map_err(|faults| no_manifold(&faults))
}

/// Returns the error for tags that D cannot carry.
pub(in crate::scheme) fn cannot_carry(tags: &str) -> StepError {
    let both = format!("D cannot carry {tags}, nor can A of an even arity");
    StepError::new(format!("{both}: leave them out or use C, which is two D at once"))
}

/// Returns the error for a mesh without interior vertices.
pub(in crate::scheme) fn no_interior() -> StepError {
    StepError::new("D needs a vertex all of whose faces meet in a full ring; this mesh has none")
}

/// Returns the error for a mesh whose dual is not a manifold, for example because two faces share several edges.
pub(in crate::scheme) fn no_manifold(faults: &[Fault]) -> StepError {
    let first = faults.first().map_or(String::new(), ToString::to_string);
    StepError::new(format!("D is not possible here, as the dual is no manifold ({first}); apply a U first"))
}
