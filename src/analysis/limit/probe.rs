//! Determines on regular nets how many rings of faces influence a limit.

use super::bounds::MAX_INFLUENCE_RINGS;
use super::cycle::Cycle;
use super::disc::{Centre, Disc, RingCount, is_triangular};
use super::error::Unlimited;
use super::regular::{Regular, Starts};
use super::walk::WholeNet;
use crate::shape::topology::{Topology, index};

/// Number of supports that are tried in ascending order before checking that [`MAX_INFLUENCE_RINGS`] are enough; the
/// cost of a trial grows with the fourth power of the rings. Words of up to 7 averages need up to 8 rings. Half of it
/// would check [`MAX_INFLUENCE_RINGS`] from 4 averages on, where one large disc takes longer than all the small ones;
/// twice of it would try every support up to [`MAX_INFLUENCE_RINGS`], so that refusals take longest.
const TRIED_SUPPORTS: usize = 8;
/// Number of levels for which boundary vertices, edges and faces are followed. The first level leaves the start, the
/// second gives the children of children, and the third repeats them. A single level would not show that they repeat;
/// twice of it takes twice as long.
const FOLLOWED_LEVELS: usize = 3;

impl Regular {
    /// Returns the kind of regular net to which a cycle refines a mesh: triangles if all faces are triangles and remain
    /// so, else quads.
    pub(super) fn of(cycle: &Cycle<'_>, topology: &Topology) -> Result<Self, Unlimited> {
        if !is_triangular(topology) {
            return Ok(Self::Quads);
        }
        let refined = cycle.applied(Self::Triangles.net(4 + 2 * cycle.n_duals(), false), |_, _| Ok(()))?;
        Ok(if is_triangular(&refined.mesh.topology()) { Self::Triangles } else { Self::Quads })
    }

    /// Returns the disc around an inner vertex of a regular net; `None` if it is too large.
    fn disc(self, rings: RingCount, tagged: bool) -> Option<Disc> {
        let (net, middle) = self.grid(rings, tagged);
        let whole = WholeNet::of(&net, &net.mesh.base);
        whole.disc(Centre::Vertex(index(middle)), rings).map(|found| found.disc)
    }

    /// Returns the smallest numbers of rings that determine a limit.
    ///
    /// The support is the least number of rings such that the points within as many rings of the child depend on no
    /// points outside it. Rules reach equally far at every valence, apart from operators that declare
    /// `reaches_farther`, so the support of a regular net is enough everywhere. The disc has more rings than the
    /// support if the rules at its rim need connectivity beyond it.
    ///
    /// # Errors
    /// [`Unlimited`], in particular [`Unlimited::Reach`] if more than [`MAX_INFLUENCE_RINGS`] rings are needed.
    pub(super) fn rings(self, cycle: &Cycle<'_>, tagged: bool, starts: Starts) -> Result<RingCount, Unlimited> {
        let mut failed = Unlimited::Reach;
        let mut closed = |support: usize| match self.closed(cycle, support, tagged, starts) {
            // a disc of so few rings may have no child
            Err(error @ (Unlimited::Later(_) | Unlimited::Lost | Unlimited::Separated)) => {
                failed = error;
                Ok(false)
            }
            closed => closed,
        };
        let mut support = 1;
        while !closed(support)? {
            support += 1;
            if support > MAX_INFLUENCE_RINGS || support == TRIED_SUPPORTS + 1 && !closed(MAX_INFLUENCE_RINGS)? {
                return Err(failed);
            }
        }
        // if boundary edges are cut in some steps only, rules reach one vertex farther along the boundary than inside,
        // and discs lose faces where their rim meets the boundary
        let spare = usize::from(cycle.disc_rules.boundary_every > 1);
        let support = support + spare + usize::from(cycle.reaches_farther());
        let most = support + 2 + starts.wider(cycle.n_duals());
        for disc in support + spare..most {
            let rings = RingCount { support, disc };
            if self.agrees(cycle, rings, tagged)? && self.agrees_elsewhere(cycle, rings, starts)? {
                return Ok(rings);
            }
        }
        Ok(RingCount { support, disc: most + spare })
    }

    /// Returns whether a support is closed: whether the points within `support` rings of a child depend only on points
    /// within `support` rings of its parent.
    fn closed(self, cycle: &Cycle<'_>, support: usize, tagged: bool, starts: Starts) -> Result<bool, Unlimited> {
        let rings = RingCount { support, disc: support + 2 };
        let disc = self.disc(rings, tagged).ok_or(Unlimited::Size)?;
        // two levels, since under a dual scheme the first child is a face, whose child is a face again
        if !closes(cycle, disc, rings, 2)? {
            return Ok(false);
        }
        let rings = RingCount { disc: rings.disc + starts.wider(cycle.n_duals()), ..rings };
        for (net, centre) in self.places(starts, cycle.n_duals(), rings.disc) {
            let disc = WholeNet::of(&net, &net.mesh.base).disc(centre, rings).ok_or(Unlimited::Size)?.disc;
            if !closes(cycle, disc, rings, FOLLOWED_LEVELS)? {
                return Ok(false);
            }
        }
        Ok(true)
    }

    /// Returns whether the disc of an inner vertex with these rings has the same weights as a larger one, and a
    /// complete child that agrees with the larger one's; for two levels.
    fn agrees(self, cycle: &Cycle<'_>, rings: RingCount, tagged: bool) -> Result<bool, Unlimited> {
        let larger = RingCount { disc: rings.support + 3, ..rings };
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

    /// Returns whether, for [`FOLLOWED_LEVELS`] levels, the discs at all other places have the same weights and
    /// children as larger ones.
    fn agrees_elsewhere(self, cycle: &Cycle<'_>, rings: RingCount, starts: Starts) -> Result<bool, Unlimited> {
        let larger = RingCount { disc: rings.disc + 2 + starts.wider(cycle.n_duals()), ..rings };
        for (net, centre) in self.places(starts, cycle.n_duals(), larger.disc) {
            let whole = WholeNet::of(&net, &net.mesh.base);
            let [Some(mut small), Some(mut large)] =
                [rings, larger].map(|rings| whole.disc(centre, rings).map(|found| found.disc))
            else {
                return Err(Unlimited::Size);
            };
            for _ in 0..FOLLOWED_LEVELS {
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

    /// Returns whether a disc has as many faces as its rings have in a regular net.
    fn is_complete(self, faces: &[Vec<u32>], rings: RingCount) -> bool {
        let k = rings.disc;
        // the numbers around a vertex and around a face
        match self {
            Self::Quads => [4 * k * k, (2 * k + 1) * (2 * k + 1)].contains(&faces.len()),
            Self::Triangles => [6 * k * k, 6 * k * k + 6 * k + 1].contains(&faces.len()),
        }
    }
}

/// Returns whether, for `steps` levels in turn, every point that could have a weight in the support of the child lies
/// in the support of its parent.
fn closes(cycle: &Cycle<'_>, mut disc: Disc, rings: RingCount, steps: usize) -> Result<bool, Unlimited> {
    for _ in 0..steps {
        let (closes, child) = cycle.closes(&disc, rings)?;
        if !closes {
            return Ok(false);
        }
        disc = child;
    }
    Ok(true)
}

/// Returns the faces of a disc, each as its vertices.
fn begins(disc: &Disc) -> Vec<Vec<u32>> {
    disc.faces().map(<[u32]>::to_vec).collect()
}
