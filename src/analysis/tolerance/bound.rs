//! Bounds the distance between a net's surface and its limit by measuring finer levels and bounding their remainders.

use rayon::prelude::*;

use super::budget::Budget;
use super::cut::twist;
use super::level::ComparedNet;
use super::nearest::{FaceTree, NetFaces, farthest};
use super::remainder::Remainders;
use super::spline::Spline;
use crate::analysis::no_level::NoLevel;
use crate::math::vector::{Vector, length, minus};

/// Maximum number of faces of a whole net that is measured.
/// Half and twice of it halve and double the time, and shift by half a level up to where the whole net is followed.
pub(super) const FOLLOWED_FACES: usize = 1 << 16;
/// Maximum number of faces of a part of a net that is refined further.
/// Half and twice of it halve and double the memory of the part, and shift the bounds of the faces that are left out.
const PART_FACES: usize = 1 << 17;
/// Number of levels by which the whole net is refined before it is measured, unless it has too many faces: remainders
/// are then a 16th of those of the net.
/// With one level they are a 4th, and more faces have to be followed; with four a 256th, for 16 times as many faces.
const WHOLE_NET_LEVELS: usize = 2;
/// Maximum number of levels that are measured around vertices where the net is not regular.
/// Where remainders halve at each level, 40 levels leave 1e-12 of them, 20 leave 1e-6 and 80 less than rounding; where
/// each level leaves 0.8 of them, 40 leave 1e-4.
const MAX_EXTRAORDINARY_LEVELS: usize = 40;
/// The remainder that need not be reduced further, relative to the greatest distance measured; larger ones remain only
/// where reducing them takes too many faces.
/// With half of it bounds are up to 0.1 closer and more faces are followed; with twice of it bounds may be up to 0.4
/// above what was measured, so that one level more may be used than needed.
const TOLERATED_REMAINDER: f64 = 0.2;
/// Where following all faces takes too many, the half, quarter, ... of them with the greatest remainders is tried, down
/// to this number of faces.
/// Half of it tries one more halving before all faces keep their remainders, twice of it one less; both are valid.
const FEWEST_FOLLOWED: usize = 64;
/// Number of pieces that are measured at a time, in descending order of their bounds.
/// Half of it looks at the greatest distance twice as often, and threads wait for each other there; twice of it
/// measures up to 256 more pieces than needed.
const PIECES_PER_CHUNK: usize = 256;
/// Maximum number of cuts into quarters of each piece at the first attempt; later ones allow four times as many each.
/// Half and twice of it only shift where cutting begins.
const FIRST_CUTS: usize = 1 << 4;
/// Maximum number of cuts of one piece.
/// Half of it gives up sooner, and the bound is larger there; twice of it may take twice as long for a piece.
const MAX_CUTS: usize = 1 << 12;
/// Maximum number of cuts of all pieces together.
/// Half and twice of it halve and double the time of bounds that do not get close.
const ALL_CUTS: usize = 1 << 16;

/// The distances that are known of a level.
struct KnownDistances {
    /// For each live face an upper bound of the distance of its limit from the net, and of the face from the limit.
    remainders: Vec<(u32, f64)>,
    /// An upper bound of the distance of the live faces and those around them from the output.
    there: f64,
}

/// The comparison of an output with its limit surface.
struct LimitComparison<'a> {
    spline: &'a Spline,
    output: FaceTree,
    /// The pieces of the output at the first measured level, and upper bounds of their distances from the limit.
    first: Option<(Vec<MovedFace>, Vec<f64>)>,
    /// Faces of several levels that are not followed further; in the end, together they approximate the whole limit.
    limit: Vec<NetFaces>,
    /// The greatest distance that was measured.
    greatest: f64,
    /// An upper bound of the rounding errors of distances.
    rounding: f64,
    /// Number of cuts that pieces may still take.
    cuts: usize,
    budget: &'a Budget,
}

impl LimitComparison<'_> {
    /// Measures the distances of a level from the output, of the first level both ways, and bounds the others. `None`
    /// as soon as a distance above `most` is measured.
    fn seen(&mut self, level: &ComparedNet, most: f64) -> Result<Option<KnownDistances>, NoLevel> {
        let output = self.output.first();
        let belongs = |f: usize| output.slot(level.home[f]).is_some();
        let looked_at =
            level.surroundings(&level.live, self.spline.rings()).into_iter().filter(|&f| belongs(f as usize));
        let looked_at: Vec<u32> = looked_at.collect();
        let pieces: Vec<MovedFace> = looked_at.iter().map(|&face| MovedFace::of(level, output, face)).collect();
        let displaced = self.first.is_none().then(|| Displaced::of(output, &pieces, self.rounding));
        let moved = |piece: &MovedFace| displaced.as_ref().map_or(piece.moved, |all| all.moved(piece).min(piece.moved));
        self.greatest = match &displaced {
            Some(_) => {
                let whole = Self::near(level, &looked_at, vec![0.0; looked_at.len()]);
                let whole = FaceTree::of(vec![whole], self.budget);
                let distance = |i, piece: &MovedFace| self.there(piece).max(Self::back(&whole, piece, i));
                self.measured(&pieces, moved, false, most, distance)?
            }
            None => self.measured(&pieces, moved, true, most, |_, piece| self.there(piece))?,
        };
        if self.greatest > most {
            return Ok(None);
        }
        let remainders = Remainders::of(level, self.spline, self.budget)?;
        let (there, cuts) = self.there_at_most(&pieces, moved)?;
        self.cuts -= cuts;
        let little = self.little();
        let found = remainders.distances(&level.live, little, belongs)?;
        if let Some(displaced) = displaced {
            // one piece per live face: at the first level, the live faces are those that belong to the output
            let plain = |(piece, &face): (&MovedFace, &u32)| piece.moved + remainders.plain(face);
            let known = pieces.par_iter().zip(&level.live).with_min_len(64);
            let known = known.map(|of| plain(of).min(displaced.back(output, of.0, &found))).collect();
            self.first = Some((pieces, known));
        }
        Ok(Some(KnownDistances { remainders: level.live.iter().copied().zip(found).collect(), there }))
    }

    /// Returns some faces of a level as an approximation of their limit, with their remainders.
    fn near(level: &ComparedNet, faces: &[u32], remainders: Vec<f64>) -> NetFaces {
        NetFaces::of(&level.topology, level.points.now.as_chunks().0, faces, remainders, false)
    }

    /// Stops following the live faces whose remainders satisfy `left`, and adds them to the approximation of the limit.
    /// Returns an upper bound of the distance of their limit from the output.
    fn leave(&mut self, level: &ComparedNet, seen: &KnownDistances, left: impl Fn(f64) -> bool) -> f64 {
        let left = seen.remainders.iter().copied().filter(|&(_, remainder)| left(remainder));
        let (faces, remainders): (Vec<u32>, Vec<f64>) = left.unzip();
        let most = remainders.iter().fold(0.0, |most: f64, &remainder| most.max(seen.there + remainder));
        self.limit.push(Self::near(level, &faces, remainders));
        most
    }

    /// Returns the distance up to which bounds need not be improved.
    fn enough(&self) -> f64 {
        ((1.0 + TOLERATED_REMAINDER) * self.greatest).max(self.rounding)
    }

    /// Returns the remainder up to which faces need not be followed.
    fn little(&self) -> f64 {
        (TOLERATED_REMAINDER * self.greatest).max(self.rounding)
    }

    /// Returns the greatest of `self.greatest` and the measured distances of pieces. These are measured in descending
    /// order of their upper bounds `moved`, until none can exceed the greatest by more than the share
    /// [`TOLERATED_REMAINDER`], the greatest is above `most` or, if `briefly` is set, a chunk does not increase it.
    fn measured(
        &self,
        pieces: &[MovedFace],
        moved: impl Fn(&MovedFace) -> f64,
        briefly: bool,
        most: f64,
        distance: impl Fn(usize, &MovedFace) -> f64 + Sync,
    ) -> Result<f64, NoLevel> {
        let mut order: Vec<(f64, usize)> = pieces.iter().map(moved).zip(0..).collect();
        order.sort_by(|a, b| b.0.total_cmp(&a.0));
        let mut greatest = self.greatest;
        for chunk in order.chunks(PIECES_PER_CHUNK) {
            if chunk[0].0 <= (1.0 + TOLERATED_REMAINDER) * greatest || greatest > most {
                break;
            }
            let all: Vec<f64> = chunk.par_iter().map(|&(_, i)| distance(i, &pieces[i])).collect();
            self.budget.check()?;
            let farthest = all.into_iter().fold(0.0, f64::max);
            if farthest <= greatest && briefly {
                break;
            }
            greatest = greatest.max(farthest);
        }
        Ok(greatest)
    }

    /// Returns the greatest distance of the corners of a piece from the output.
    fn there(&self, piece: &MovedFace) -> f64 {
        piece.points().iter().map(|&p| self.output.from(p, piece.home)).fold(0.0, f64::max)
    }

    /// Returns the greatest distance of the corners of a piece of the output from a whole level, in which `slot` is its
    /// face, and adds what cutting the output may add.
    fn back(level: &FaceTree, piece: &MovedFace, slot: usize) -> f64 {
        piece.flat().iter().map(|&p| level.from(p, Some(slot))).fold(0.0, f64::max) + piece.cut
    }

    /// Returns an upper bound of the distance of the pieces from the output, `moved` or less, and the number of cuts.
    fn there_at_most(&self, pieces: &[MovedFace], moved: impl Fn(&MovedFace) -> f64) -> Result<(f64, usize), NoLevel> {
        let known: Vec<f64> = pieces.iter().map(moved).collect();
        let cut = |piece: &MovedFace, cuts, enough| {
            farthest(piece.points(), cuts, enough, &|corners: &[Vector]| self.output.over(corners, piece.home))
        };
        self.cut(pieces, known, self.enough(), cut)
    }

    /// Returns an upper bound of the distance of the output from the limit; 0 if no level was measured.
    fn back_at_most(&mut self) -> Result<f64, NoLevel> {
        let Some((pieces, known)) = self.first.take() else { return Ok(0.0) };
        let limit = FaceTree::of(std::mem::take(&mut self.limit), self.budget);
        let cut = |piece: &MovedFace, cuts, enough: f64| {
            let away = |corners: &[Vector]| limit.over(corners, None);
            let (most, used) = farthest(piece.flat(), cuts, enough - piece.cut, &away);
            (most + piece.cut, used)
        };
        Ok(self.cut(&pieces, known, self.enough() + self.little(), cut)?.0)
    }

    /// Returns an upper bound of the distance of all pieces, and the number of cuts made. `known` are upper bounds for
    /// each piece; where they are above `enough`, `cut` improves them with a given number of cuts. Pieces that use up
    /// their cuts get four times as many in the next attempt, as long as there are enough left.
    fn cut(
        &self,
        pieces: &[MovedFace],
        mut known: Vec<f64>,
        enough: f64,
        cut: impl Fn(&MovedFace, usize, f64) -> (f64, usize) + Sync,
    ) -> Result<(f64, usize), NoLevel> {
        let mut far: Vec<usize> = (0..pieces.len()).filter(|&i| known[i] > enough).collect();
        let mut left = self.cuts;
        let mut cuts = FIRST_CUTS.min(left / far.len().max(1));
        while !far.is_empty() && cuts * far.len() <= left && (1..=MAX_CUTS).contains(&cuts) {
            let found: Vec<(f64, usize)> =
                far.par_iter().with_min_len(4).map(|&i| cut(&pieces[i], cuts, enough)).collect();
            self.budget.check()?;
            far.iter().zip(&found).for_each(|(&i, &(most, _))| known[i] = known[i].min(most));
            left -= found.iter().map(|&(_, used)| used).sum::<usize>();
            far = far.iter().zip(&found).filter(|(_, (_, used))| *used == cuts).map(|(&i, _)| i).collect();
            cuts *= 4;
        }
        Ok((known.into_iter().fold(0.0, f64::max), self.cuts - left))
    }
}

/// The displacement of the faces of an output at a later level.
struct Displaced {
    /// For each face of the output the indices of its pieces.
    pieces: Vec<Vec<usize>>,
    /// For each face of the output an upper bound of the distance of its pieces from the output and of the face from
    /// the level, however the output is cut; infinite if unknown.
    moved: Vec<f64>,
}

impl Displaced {
    /// Bounds the displacement by the pieces `all`, unless no piece of a face moved by more than `cut + little`.
    fn of(output: &NetFaces, all: &[MovedFace], little: f64) -> Self {
        let mut pieces: Vec<Vec<usize>> = vec![Vec::new(); output.len()];
        for (i, slot) in all.iter().enumerate().filter_map(|(i, piece)| Some((i, piece.home?))) {
            pieces[slot].push(i);
        }
        let of_face = |slot: usize| {
            let still = |&i: &usize| all[i].moved <= all[i].cut + little;
            if pieces[slot].iter().all(still) {
                return None;
            }
            let around = output.around(slot)?;
            let displacements = around.iter().flat_map(|&slot| &pieces[slot]).flat_map(|&i| all[i].displacements());
            let cut = around.iter().map(|&slot| output.cut(slot)).fold(0.0, f64::max);
            Some(output.sheet(slot)?.displaced(displacements)? + cut)
        };
        let faces = (0..pieces.len()).into_par_iter().with_min_len(64);
        let moved = faces.map(|slot| of_face(slot).unwrap_or(f64::INFINITY)).collect();
        Self { pieces, moved }
    }

    /// Returns the bound of the face of which a piece is a part.
    fn moved(&self, piece: &MovedFace) -> f64 {
        piece.home.map_or(f64::INFINITY, |slot| self.moved[slot])
    }

    /// Returns an upper bound of the distance from the limit of the output's face of which a piece is a part;
    /// `remainders` are those of the pieces.
    fn back(&self, output: &NetFaces, piece: &MovedFace, remainders: &[f64]) -> f64 {
        if self.moved(piece).is_infinite() {
            return f64::INFINITY;
        }
        let remainder = |slot| {
            let around = output.around(slot)?.into_iter().flat_map(|slot| &self.pieces[slot]);
            Some(around.map(|&i| remainders[i]).fold(0.0, f64::max))
        };
        self.moved(piece) + piece.home.and_then(remainder).unwrap_or(f64::INFINITY)
    }
}

/// A face of a later level, with the piece of the output that it is the displacement of.
struct MovedFace {
    sides: usize,
    /// The corners of the face.
    points: [Vector; 4],
    /// The corners of the piece.
    flat: [Vector; 4],
    /// The slot of the output's face of which it is a part.
    home: Option<usize>,
    /// An upper bound of the distance between the output's face and the same face cut.
    cut: f64,
    /// An upper bound of the distance between face and piece, point by point, however the output is cut.
    moved: f64,
}

impl MovedFace {
    fn of(level: &ComparedNet, output: &NetFaces, face: u32) -> Self {
        let (points, flat) = (level.points.now.as_chunks::<3>().0, level.flat.now.as_chunks::<3>().0);
        let corners = level.topology.face(face as usize);
        let home = output.slot(level.home[face as usize]);
        let cut = home.map_or(0.0, |slot| output.cut(slot));
        let sides = corners.len().min(4);
        let of = |all: &[Vector]| {
            let mut four = [[0.0; 3]; 4];
            four.iter_mut().zip(corners).for_each(|(p, &v)| *p = all[v as usize]);
            four
        };
        let (points, flat) = (of(points), of(flat));
        let apart = (0..sides).map(|j| length(minus(points[j], flat[j]))).fold(0.0, f64::max);
        Self { sides, points, flat, home, cut, moved: apart + cut }
    }

    /// Returns the displacements of the corners.
    fn displacements(&self) -> impl Iterator<Item = Vector> {
        (0..self.sides).map(|j| minus(self.points[j], self.flat[j]))
    }

    fn points(&self) -> &[Vector] {
        &self.points[..self.sides]
    }

    fn flat(&self) -> &[Vector] {
        &self.flat[..self.sides]
    }
}

/// Returns an upper bound of the distance, either from the other, between the limit of the live faces of a net and the
/// surface that the net is compared with, which has the same faces. Infinite as soon as a distance clearly above the
/// tolerance is measured. `rounding` is an upper bound of rounding errors.
///
/// # Errors
/// [`NoLevel`] when a level cannot be computed or the budget is over.
pub(super) fn bound(
    base: &ComparedNet,
    spline: &Spline,
    tolerance: f64,
    rounding: f64,
    budget: &Budget,
) -> Result<f64, NoLevel> {
    if base.live.len() > FOLLOWED_FACES {
        return plain(base, spline, budget);
    }
    let flat = base.flat.now.as_chunks().0;
    let faces = NetFaces::of(&base.topology, flat, &base.live, vec![0.0; base.live.len()], !spline.halved);
    let output = FaceTree::of(vec![faces], budget);
    let (first, limit, cuts) = (None, Vec::new(), ALL_CUTS);
    let mut comparison = LimitComparison { spline, output, first, limit, greatest: 0.0, rounding, cuts, budget };
    let (mut level, mut bound) = (base.clone(), 0.0_f64);
    for ahead in 0..=MAX_EXTRAORDINARY_LEVELS {
        let next = if spline.halved { ComparedNet::next_halved } else { ComparedNet::next };
        let next = |level: &ComparedNet| next(level, &spline.plan, spline.round(ahead), &budget.watch);
        if ahead < WHOLE_NET_LEVELS && level.faces_after(1) <= FOLLOWED_FACES {
            level = next(&level)?;
            continue;
        }
        let Some(seen) = comparison.seen(&level, (1.0 + TOLERATED_REMAINDER) * tolerance)? else {
            return Ok(f64::INFINITY);
        };
        let little = comparison.little();
        let part = |least: f64| {
            let kept = seen.remainders.iter().filter(|&&(_, remainder)| remainder > least);
            let kept: Vec<u32> = kept.map(|&(face, _)| face).collect();
            let few = ahead < MAX_EXTRAORDINARY_LEVELS && (1..=PART_FACES / 4).contains(&kept.len());
            let part = few.then(|| level.focused(&kept, spline.margin()))?;
            (part.faces_after(1) <= PART_FACES).then_some((part, least))
        };
        // if too many faces have a remainder above `little`, the greatest half, quarter, ... of them is followed, as
        // long as those left out have at most half of the greatest remainder
        let remainders = seen.remainders.iter().map(|&(_, remainder)| remainder);
        let mut far: Vec<f64> = remainders.filter(|&remainder| remainder > little).collect();
        far.sort_by(|a, b| b.total_cmp(a));
        let least = |n: usize| far.get(n).copied().unwrap_or(little);
        let fewer = std::iter::successors(Some(far.len()), |&n| (n > FEWEST_FOLLOWED).then_some(n / 2)).map(least);
        let matters = |least: &f64| far.first().is_some_and(|most| *least <= most / 2.0);
        let Some((part, least)) = fewer.take_while(matters).find_map(part) else {
            bound = comparison.leave(&level, &seen, |_| true).max(bound);
            break;
        };
        bound = comparison.leave(&level, &seen, |remainder| remainder <= least).max(bound);
        level = next(&part)?;
    }
    Ok(bound.max(comparison.back_at_most()?))
}

/// Returns the upper bound of [`bound`] for nets that have too many faces to be measured.
fn plain(base: &ComparedNet, spline: &Spline, budget: &Budget) -> Result<f64, NoLevel> {
    let (points, flat) = (base.points.now.as_chunks::<3>().0, base.flat.now.as_chunks::<3>().0);
    let remainders = Remainders::of(base, spline, budget)?;
    let live: Vec<usize> = base.live.iter().map(|&f| f as usize).collect();
    let of_face = |&face: &u32| {
        let corners = base.topology.face(face as usize);
        let moved = corners.iter().map(|&v| length(minus(points[v as usize], flat[v as usize])));
        let cut = if spline.halved { 0.0 } else { twist(&base.topology, face as usize, flat) };
        moved.fold(0.0, f64::max) + cut
    };
    let moved: Vec<f64> = base.live.iter().map(of_face).collect();
    let most = moved.iter().copied().fold(0.0, f64::max);
    let distances = remainders.distances(&base.live, 0.0, |f| live.binary_search(&f).is_ok())?;
    // a face from its own limit point by point, or its limit from the faces around, which may have moved farther
    let each = base.live.iter().zip(moved).zip(distances);
    Ok(each
        .map(|((&face, moved), remainder)| (moved + remainders.plain(face)).min(most + remainder))
        .fold(0.0, f64::max))
}
