//! How far a cycle reaches where nothing is extraordinary.

use super::bounds::MAX_RINGS;
use super::cycle::Cycle;
use super::error::Unlimited;
use super::patch::{Centre, Patch, Rings, is_triangular};
use super::regular::{Regular, Starts};
use super::walk::WholeNet;
use crate::shape::topology::{Topology, index};

/// Rings that are tried one after another before it is asked whether the most are enough: cost grows with their fourth
/// power.
/// Words of up to 7 averages need up to 8 rings. Half of it asks about the most rings from 4 averages on, where one
/// large patch takes longer than all the small ones; twice of it is all of [`MAX_RINGS`], where what fails takes
/// longest.
const TRIED: usize = 8;
/// Steps after which children of places on the boundary, of edges and of faces are like those before.
/// A first step leaves the start, a second gives the children of children, and a third repeats them. One step would not
/// show that they repeat; twice of it takes twice as long.
const STEPS: usize = 3;
impl Regular {
    /// What a cycle makes of a mesh: triangles stay triangles under triangle splits only.
    pub(super) fn of(cycle: &Cycle<'_>, topology: &Topology) -> Result<Self, Unlimited> {
        if !is_triangular(topology) {
            return Ok(Self::Quads);
        }
        let refined = cycle.applied(Self::Triangles.net(4 + 2 * cycle.n_duals(), false), |_, _| Ok(()))?;
        Ok(if is_triangular(&refined.mesh.topology()) { Self::Triangles } else { Self::Quads })
    }

    fn patch(self, rings: Rings, tagged: bool) -> Option<Patch> {
        let (net, middle) = self.grid(rings, tagged);
        let whole = WholeNet::of(&net, &net.mesh.base);
        whole.patch(Centre::Vertex(index(middle)), rings).map(|found| found.patch)
    }

    /// The fewest rings that decide about a limit.
    ///
    /// The support is the least number of rings such that the points of as many rings around the child come of no
    /// others. But for those that say so, the operators' rules reach as many rings at every valence, so that what holds
    /// here holds everywhere. The patch is larger where points of its rim would take their connectivity from beyond it.
    pub(super) fn rings(self, cycle: &Cycle<'_>, tagged: bool, starts: Starts) -> Result<Rings, Unlimited> {
        let mut failed = Unlimited::Reach;
        let mut closed = |support: usize| match self.closed(cycle, support, tagged, starts) {
            // of so few rings nothing may be left
            Err(error @ (Unlimited::Later(_) | Unlimited::Lost | Unlimited::Separated)) => {
                failed = error;
                Ok(false)
            }
            closed => closed,
        };
        let mut support = 1;
        while !closed(support)? {
            support += 1;
            if support > MAX_RINGS || support == TRIED + 1 && !closed(MAX_RINGS)? {
                return Err(failed);
            }
        }
        // where boundary edges are cut in some steps only, rules reach one vertex farther along the boundary than
        // inside, and patches lose faces where their rim meets it
        let spare = usize::from(cycle.patch_rules.boundary_every > 1);
        let support = support + spare + usize::from(cycle.reaches_farther());
        let most = support + 2 + starts.wider(cycle.n_duals());
        for patch in support + spare..most {
            let rings = Rings { support, patch };
            if self.agrees(cycle, rings, tagged)? && self.agrees_elsewhere(cycle, rings, starts)? {
                return Ok(rings);
            }
        }
        Ok(Rings { support, patch: most + spare })
    }

    fn closed(self, cycle: &Cycle<'_>, support: usize, tagged: bool, starts: Starts) -> Result<bool, Unlimited> {
        let rings = Rings { support, patch: support + 2 };
        let patch = self.patch(rings, tagged).ok_or(Unlimited::Size)?;
        // the second child of a dual scheme lies around a face as the first one does
        if !closes(cycle, patch, rings, 2)? {
            return Ok(false);
        }
        let rings = Rings { patch: rings.patch + starts.wider(cycle.n_duals()), ..rings };
        for (net, centre) in self.places(starts, cycle.n_duals(), rings.patch) {
            let patch = WholeNet::of(&net, &net.mesh.base).patch(centre, rings).ok_or(Unlimited::Size)?.patch;
            if !closes(cycle, patch, rings, STEPS)? {
                return Ok(false);
            }
        }
        Ok(true)
    }

    /// Whether a patch of so many rings leads to the same child and the same weights as a larger one.
    fn agrees(self, cycle: &Cycle<'_>, rings: Rings, tagged: bool) -> Result<bool, Unlimited> {
        let larger = Rings { patch: rings.support + 3, ..rings };
        let mut pair = [rings, larger].map(|rings| self.patch(rings, tagged));
        for _ in 0..2 {
            let [Some(small), Some(large)] = pair else { return Err(Unlimited::Size) };
            let large = cycle.step(cycle.settled, &large, larger)?;
            let Ok(small) = cycle.step(cycle.settled, &small, rings) else { return Ok(false) };
            let (few, many) = (begins(&small.patch), begins(&large.patch));
            if !small.has_weights_of(&large) || !many.starts_with(&few) || !self.is_complete(&few, rings) {
                return Ok(false);
            }
            pair = [Some(small.patch), Some(large.patch)];
        }
        Ok(true)
    }

    /// Whether the other places agree, too.
    fn agrees_elsewhere(self, cycle: &Cycle<'_>, rings: Rings, starts: Starts) -> Result<bool, Unlimited> {
        let larger = Rings { patch: rings.patch + 2 + starts.wider(cycle.n_duals()), ..rings };
        for (net, centre) in self.places(starts, cycle.n_duals(), larger.patch) {
            let whole = WholeNet::of(&net, &net.mesh.base);
            let [Some(mut small), Some(mut large)] =
                [rings, larger].map(|rings| whole.patch(centre, rings).map(|found| found.patch))
            else {
                return Err(Unlimited::Size);
            };
            for _ in 0..STEPS {
                let expected = cycle.step(cycle.settled, &large, rings)?;
                let Ok(found) = cycle.step(cycle.settled, &small, rings) else { return Ok(false) };
                if !found.has_weights_of(&expected) || begins(&found.patch) != begins(&expected.patch) {
                    return Ok(false);
                }
                small = found.patch;
                large = cycle.step(cycle.settled, &large, larger)?.patch;
            }
        }
        Ok(true)
    }

    /// Whether there are as many faces as so many rings have in a regular net.
    fn is_complete(self, faces: &[Vec<u32>], rings: Rings) -> bool {
        let k = rings.patch;
        // around a vertex, or around a face
        match self {
            Self::Quads => [4 * k * k, (2 * k + 1) * (2 * k + 1)].contains(&faces.len()),
            Self::Triangles => [6 * k * k, 6 * k * k + 6 * k + 1].contains(&faces.len()),
        }
    }
}

/// Whether what could have a weight in the support of a patch's child, and so on, lies in its support.
fn closes(cycle: &Cycle<'_>, mut patch: Patch, rings: Rings, steps: usize) -> Result<bool, Unlimited> {
    for _ in 0..steps {
        let (closes, child) = cycle.closes(&patch, rings)?;
        if !closes {
            return Ok(false);
        }
        patch = child;
    }
    Ok(true)
}

/// The faces of a patch.
fn begins(patch: &Patch) -> Vec<Vec<u32>> {
    patch.faces().map(<[u32]>::to_vec).collect()
}
