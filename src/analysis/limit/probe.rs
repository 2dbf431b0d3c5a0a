//! Determines how far the stencils of a cycle reach on regular nets.

use super::bounds::MAX_RINGS;
use super::cycle::Cycle;
use super::disc::{Centre, Disc, Rings, is_triangular};
use super::error::Unlimited;
use super::regular::{Regular, Starts};
use super::walk::WholeNet;
use crate::shape::topology::{Topology, index};

/// Rings that are tried one after another before it is asked whether the most are enough: cost grows with their fourth
/// power.
/// Words of up to 7 averages need up to 8 rings. Half of it asks about the most rings from 4 averages on, where one
/// large disc takes longer than all the small ones; twice of it is all of [`MAX_RINGS`], where what fails takes
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

    fn disc(self, rings: Rings, tagged: bool) -> Option<Disc> {
        let (net, middle) = self.grid(rings, tagged);
        let whole = WholeNet::of(&net, &net.mesh.base);
        whole.disc(Centre::Vertex(index(middle)), rings).map(|found| found.disc)
    }

    /// The fewest rings that decide about a limit.
    ///
    /// The support is the least number of rings such that the points of as many rings around the child come of no
    /// others. But for those that say so, the operators' rules reach as many rings at every valence, so that what holds
    /// here holds everywhere. The disc is larger where points of its rim would take their connectivity from beyond it.
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
        // inside, and discs lose faces where their rim meets it
        let spare = usize::from(cycle.disc_rules.boundary_every > 1);
        let support = support + spare + usize::from(cycle.reaches_farther());
        let most = support + 2 + starts.wider(cycle.n_duals());
        for disc in support + spare..most {
            let rings = Rings { support, disc };
            if self.agrees(cycle, rings, tagged)? && self.agrees_elsewhere(cycle, rings, starts)? {
                return Ok(rings);
            }
        }
        Ok(Rings { support, disc: most + spare })
    }

    fn closed(self, cycle: &Cycle<'_>, support: usize, tagged: bool, starts: Starts) -> Result<bool, Unlimited> {
        let rings = Rings { support, disc: support + 2 };
        let disc = self.disc(rings, tagged).ok_or(Unlimited::Size)?;
        // the second child of a dual scheme lies around a face as the first one does
        if !closes(cycle, disc, rings, 2)? {
            return Ok(false);
        }
        let rings = Rings { disc: rings.disc + starts.wider(cycle.n_duals()), ..rings };
        for (net, centre) in self.places(starts, cycle.n_duals(), rings.disc) {
            let disc = WholeNet::of(&net, &net.mesh.base).disc(centre, rings).ok_or(Unlimited::Size)?.disc;
            if !closes(cycle, disc, rings, STEPS)? {
                return Ok(false);
            }
        }
        Ok(true)
    }

    /// Whether a disc of so many rings leads to the same child and the same weights as a larger one.
    fn agrees(self, cycle: &Cycle<'_>, rings: Rings, tagged: bool) -> Result<bool, Unlimited> {
        let larger = Rings { disc: rings.support + 3, ..rings };
        let mut pair = [rings, larger].map(|rings| self.disc(rings, tagged));
        for _ in 0..2 {
            let [Some(small), Some(large)] = pair else { return Err(Unlimited::Size) };
            let large = cycle.step(cycle.settled, &large, larger)?;
            let Ok(small) = cycle.step(cycle.settled, &small, rings) else { return Ok(false) };
            let (few, many) = (begins(&small.disc), begins(&large.disc));
            if !small.has_weights_of(&large) || !many.starts_with(&few) || !self.is_complete(&few, rings) {
                return Ok(false);
            }
            pair = [Some(small.disc), Some(large.disc)];
        }
        Ok(true)
    }

    /// Whether the other places agree, too.
    fn agrees_elsewhere(self, cycle: &Cycle<'_>, rings: Rings, starts: Starts) -> Result<bool, Unlimited> {
        let larger = Rings { disc: rings.disc + 2 + starts.wider(cycle.n_duals()), ..rings };
        for (net, centre) in self.places(starts, cycle.n_duals(), larger.disc) {
            let whole = WholeNet::of(&net, &net.mesh.base);
            let [Some(mut small), Some(mut large)] =
                [rings, larger].map(|rings| whole.disc(centre, rings).map(|found| found.disc))
            else {
                return Err(Unlimited::Size);
            };
            for _ in 0..STEPS {
                let expected = cycle.step(cycle.settled, &large, rings)?;
                let Ok(found) = cycle.step(cycle.settled, &small, rings) else { return Ok(false) };
                if !found.has_weights_of(&expected) || begins(&found.disc) != begins(&expected.disc) {
                    return Ok(false);
                }
                small = found.disc;
                large = cycle.step(cycle.settled, &large, larger)?.disc;
            }
        }
        Ok(true)
    }

    /// Whether there are as many faces as so many rings have in a regular net.
    fn is_complete(self, faces: &[Vec<u32>], rings: Rings) -> bool {
        let k = rings.disc;
        // around a vertex, or around a face
        match self {
            Self::Quads => [4 * k * k, (2 * k + 1) * (2 * k + 1)].contains(&faces.len()),
            Self::Triangles => [6 * k * k, 6 * k * k + 6 * k + 1].contains(&faces.len()),
        }
    }
}

/// Whether what could have a weight in the support of a disc's child, and so on, lies in its support.
fn closes(cycle: &Cycle<'_>, mut disc: Disc, rings: Rings, steps: usize) -> Result<bool, Unlimited> {
    for _ in 0..steps {
        let (closes, child) = cycle.closes(&disc, rings)?;
        if !closes {
            return Ok(false);
        }
        disc = child;
    }
    Ok(true)
}

/// The faces of a disc.
fn begins(disc: &Disc) -> Vec<Vec<u32>> {
    disc.faces().map(<[u32]>::to_vec).collect()
}
