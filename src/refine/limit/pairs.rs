//! Pairs of D as C, where both make the same points.
//!
//! On a closed mesh each of whose vertices has three faces or more, D twice is C but for the order of the points: the mean
//! of the faces around a vertex is the vertex of the dual's dual. As C there is D D, a C between the two is one more: D C D
//! is D D D D, or C C. In a patch D loses the boundary, with points that P needs; C loses nothing.
//!
//! Source: Y. Zhang, G. Wang, 2002, formula (5): C is D D, centred again.

use crate::scheme::mesh_net::MeshNet;
use crate::scheme::ops::{Role, lettered};
use crate::scheme::plan::Scheduled;
use crate::scheme::word::Letter;
use crate::shape::tile::Tile;

/// Levels of `length` steps each with two D, one after the other or with C between them, as one C, and the steps of one of
/// these; `None` where a net does not allow it, or no P asks for it. Each level starts with an upsampling.
pub(super) fn paired(steps: &[Scheduled], length: usize, net: &MeshNet) -> Option<(Vec<Scheduled>, usize)> {
    let (first, topology) = (steps.get(..length)?, &net.base);
    let pushes = first.iter().any(|step| step.letter.operator.role() == Role::PushBack);
    let quads = first.iter().all(|step| step.letter.tile == Tile::Quad);
    let keeps_all =
        || topology.n_boundary() == 0 && (0..topology.n_vertices()).all(|v| topology.ring(v).nth(2).is_some());
    if !(pushes && quads && first.iter().any(is_dual) && keeps_all()) {
        return None;
    }
    let all: Vec<Scheduled> = steps.chunks_exact(length).flat_map(of_level).collect();
    let length = of_level(first).len();
    Some((all, length))
}

fn is_dual(step: &Scheduled) -> bool {
    step.letter.operator.letter() == Some('D')
}

fn of_level(steps: &[Scheduled]) -> Vec<Scheduled> {
    let average = lettered('C').expect("C is registered");
    let mut level: Vec<Scheduled> = Vec::with_capacity(steps.len());
    // whether points still are vertices, points of edges and of faces, on which the kernel acts
    let mut labelled = false;
    // whether the other D of a pair is still to come
    let mut open = false;
    for (at, step) in steps.iter().enumerate() {
        let kernel = if labelled { step.kernel } else { 1.0 };
        labelled = step.letter.operator.role() == Role::Upsample || labelled && !is_dual(step);
        let paired = is_dual(step) && (open || is_dual_next(&steps[at + 1..]));
        let letter = if paired { Letter { operator: average, ..step.letter.clone() } } else { step.letter.clone() };
        if !(paired && open) {
            level.push(Scheduled { letter, kernel, ..step.clone() });
        }
        open ^= paired;
    }
    level
}

/// Whether a D comes after nothing but C.
fn is_dual_next(after: &[Scheduled]) -> bool {
    let next = after.iter().find(|step| step.letter.operator.letter() != Some('C'));
    next.is_some_and(is_dual)
}
