//! The distance between a net's surface and the limit, by what some more levels measure and second differences bound.

use rayon::prelude::*;

use super::budget::Budget;
use super::cut::twist;
use super::level::Level;
use super::nearest::{Faces, Surface, farthest};
use super::remainder::Remainders;
use super::spline::Spline;
use crate::analysis::no_level::NoLevel;
use crate::math::vector::{Vector, length, minus};

/// Faces of a net up to which it is refined further.
/// Half and twice of it halve and double the time, and shift by half a level where the whole net is followed.
pub(super) const FOLLOWED_FACES: usize = 1 << 16;
/// Faces of a part of a net up to which it is refined further.
/// Half and twice of it halve and double the memory of the part, and shift bounds of the faces left out.
const PART_FACES: usize = 1 << 17;
/// Levels that are measured at all faces, where they are not too many: what is bounded after them is a 16th of the
/// whole.
/// With one level a 4th is left, and more faces are followed; with four a 256th, for 16 times as many faces.
const WHOLE: usize = 2;
/// Most levels that are measured around vertices where the net is not regular.
/// Where distances fall by a half at each level, 40 levels leave 1e-12 of them, 20 leave 1e-6 and 80 less than
/// rounding; where they fall to 0.8, 40 leave 1e-4.
const AHEAD: usize = 40;
/// What is bounded after the levels that are measured, over the greatest distance measured, at most, unless that takes
/// too many faces.
/// With half of it bounds are up to 0.1 closer and more faces are followed; with twice of it bounds may be up to 0.4
/// above what was measured, so that a level more may be asked for.
const SLACK: f64 = 0.2;
/// Of the faces that are farthest from their limit, half as many are followed until they are not too many, or this few.
/// Half of it tries one halving more before all others are bounded as they are, twice of it one less; bounds hold with
/// either.
const FEW: usize = 64;
/// Faces whose distances are measured at a time, those first that may be farthest.
/// Half of it looks at the greatest distance twice as often, where threads wait for each other; with twice of it up to
/// 256 faces more are measured than needed.
const CHUNK: usize = 256;
/// How often a piece of a surface is cut into quarters at first, until all of a part is near one face.
/// Half and twice of it only shift where cutting begins.
const FIRST_CUTS: usize = 1 << 4;
/// How often one piece is cut at most.
/// Half of it gives up sooner, and the bound is larger there; twice of it may take twice as long for a piece.
const CUTS: usize = 1 << 12;
/// How often all pieces together are cut at most.
/// Half and twice of it halve and double the time of bounds that stay open.
const ALL_CUTS: usize = 1 << 16;

/// What is known of a level.
struct Seen {
    /// For each of its live faces how far its limit is from the net, and the face from the limit, at most.
    remainders: Vec<(u32, f64)>,
    /// How far they and those around them are from the output, at most.
    there: f64,
}

/// The surface of an output and what is known of its limit.
struct Comparison<'a> {
    spline: &'a Spline,
    output: Surface,
    /// The first level that was looked at, whole, and how far the pieces of the output are from the limit as it tells.
    first: Option<(Vec<Piece>, Vec<f64>)>,
    /// Faces of the levels that are followed no longer, all together near the whole limit.
    limit: Vec<Faces>,
    /// The greatest distance that was measured.
    greatest: f64,
    /// What rounding makes of distances, at most.
    rounding: f64,
    /// How often pieces may still be cut.
    cuts: usize,
    budget: &'a Budget,
}

impl Comparison<'_> {
    /// What is known of a level; `None` as soon as a distance above `most` is measured.
    fn seen(&mut self, level: &Level, most: f64) -> Result<Option<Seen>, NoLevel> {
        let output = self.output.first();
        let belongs = |f: usize| output.slot(level.home[f]).is_some();
        let looked_at =
            level.surroundings(&level.live, self.spline.rings()).into_iter().filter(|&f| belongs(f as usize));
        let looked_at: Vec<u32> = looked_at.collect();
        let pieces: Vec<Piece> = looked_at.iter().map(|&face| Piece::of(level, output, face)).collect();
        let displaced = self.first.is_none().then(|| Displaced::of(output, &pieces, self.rounding));
        let moved = |piece: &Piece| displaced.as_ref().map_or(piece.moved, |all| all.moved(piece).min(piece.moved));
        self.greatest = match &displaced {
            Some(_) => {
                let whole = Self::near(level, &looked_at, vec![0.0; looked_at.len()]);
                let whole = Surface::of(vec![whole], self.budget);
                let distance = |i, piece: &Piece| self.there(piece).max(Self::back(&whole, piece, i));
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
            // at first all faces that are shown are live
            let plain = |(piece, &face): (&Piece, &u32)| piece.moved + remainders.plain(face);
            let known = pieces.par_iter().zip(&level.live).with_min_len(64);
            let known = known.map(|of| plain(of).min(displaced.back(output, of.0, &found))).collect();
            self.first = Some((pieces, known));
        }
        Ok(Some(Seen { remainders: level.live.iter().copied().zip(found).collect(), there }))
    }

    /// Some faces of a level, in the limit's place.
    fn near(level: &Level, faces: &[u32], remainders: Vec<f64>) -> Faces {
        Faces::of(&level.topology, level.points.now.as_chunks().0, faces, remainders, false)
    }

    /// Leaves the faces of a level that are followed no longer; returns how far their limit is from the output at most.
    fn leave(&mut self, level: &Level, seen: &Seen, left: impl Fn(f64) -> bool) -> f64 {
        let left = seen.remainders.iter().copied().filter(|&(_, remainder)| left(remainder));
        let (faces, remainders): (Vec<u32>, Vec<f64>) = left.unzip();
        let most = remainders.iter().fold(0.0, |most: f64, &remainder| most.max(seen.there + remainder));
        self.limit.push(Self::near(level, &faces, remainders));
        most
    }

    /// What distances may come to without being worth more work.
    fn enough(&self) -> f64 {
        ((1.0 + SLACK) * self.greatest).max(self.rounding)
    }

    /// What is not worth to be followed.
    fn little(&self) -> f64 {
        (SLACK * self.greatest).max(self.rounding)
    }

    /// The greatest distance of pieces, but for a part that does not matter, looked for where `moved` is great, which
    /// it is at most; with `briefly` only as long as it grows, and never beyond `most`.
    fn measured(
        &self,
        pieces: &[Piece],
        moved: impl Fn(&Piece) -> f64,
        briefly: bool,
        most: f64,
        distance: impl Fn(usize, &Piece) -> f64 + Sync,
    ) -> Result<f64, NoLevel> {
        let mut order: Vec<(f64, usize)> = pieces.iter().map(moved).zip(0..).collect();
        order.sort_by(|a, b| b.0.total_cmp(&a.0));
        let mut greatest = self.greatest;
        for chunk in order.chunks(CHUNK) {
            if chunk[0].0 <= (1.0 + SLACK) * greatest || greatest > most {
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

    /// How far the corners of a piece are from the output.
    fn there(&self, piece: &Piece) -> f64 {
        piece.points().iter().map(|&p| self.output.from(p, piece.home)).fold(0.0, f64::max)
    }

    /// How far the corners of a piece of the output are from a whole level.
    fn back(level: &Surface, piece: &Piece, slot: usize) -> f64 {
        piece.flat().iter().map(|&p| level.from(p, Some(slot))).fold(0.0, f64::max) + piece.cut
    }

    /// How far pieces are from the output, at most, and the cuts made; none is farther than it was moved.
    fn there_at_most(&self, pieces: &[Piece], moved: impl Fn(&Piece) -> f64) -> Result<(f64, usize), NoLevel> {
        let known: Vec<f64> = pieces.iter().map(moved).collect();
        let cut = |piece: &Piece, cuts, enough| {
            farthest(piece.points(), cuts, enough, &|corners: &[Vector]| self.output.over(corners, piece.home))
        };
        self.cut(pieces, known, self.enough(), cut)
    }

    /// How far the output is from the limit, at most.
    fn back_at_most(&mut self) -> Result<f64, NoLevel> {
        let Some((pieces, known)) = self.first.take() else { return Ok(0.0) };
        let limit = Surface::of(std::mem::take(&mut self.limit), self.budget);
        let cut = |piece: &Piece, cuts, enough: f64| {
            let away = |corners: &[Vector]| limit.over(corners, None);
            let (most, used) = farthest(piece.flat(), cuts, enough - piece.cut, &away);
            (most + piece.cut, used)
        };
        Ok(self.cut(&pieces, known, self.enough() + self.little(), cut)?.0)
    }

    /// The greatest distance of pieces, at most, and how many cuts that took. They are cut where more than `enough` is
    /// known; those for which some cuts do not suffice have more of them, as long as there are some left.
    fn cut(
        &self,
        pieces: &[Piece],
        mut known: Vec<f64>,
        enough: f64,
        cut: impl Fn(&Piece, usize, f64) -> (f64, usize) + Sync,
    ) -> Result<(f64, usize), NoLevel> {
        let mut far: Vec<usize> = (0..pieces.len()).filter(|&i| known[i] > enough).collect();
        let mut left = self.cuts;
        let mut cuts = FIRST_CUTS.min(left / far.len().max(1));
        while !far.is_empty() && cuts * far.len() <= left && (1..=CUTS).contains(&cuts) {
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

/// How far the faces of an output are displaced by a later level.
struct Displaced {
    /// For each face of the output its pieces.
    pieces: Vec<Vec<usize>>,
    /// How far the pieces of a face are from the output, and the face from the level, however it is cut; infinite where
    /// that is not known.
    moved: Vec<f64>,
}

impl Displaced {
    /// Distances up to `little` are not looked into.
    fn of(output: &Faces, all: &[Piece], little: f64) -> Self {
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

    fn moved(&self, piece: &Piece) -> f64 {
        piece.home.map_or(f64::INFINITY, |slot| self.moved[slot])
    }

    /// How far the face of the output that a piece is part of is from the limit; `remainders` are those of the pieces.
    fn back(&self, output: &Faces, piece: &Piece, remainders: &[f64]) -> f64 {
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

/// A face of a later level, and the piece of the output that it was before.
struct Piece {
    sides: usize,
    points: [Vector; 4],
    flat: [Vector; 4],
    /// The slot of the face of the output that it is part of.
    home: Option<usize>,
    /// How far the output is from its face when that is cut.
    cut: f64,
    /// How far the two are apart at most, point by point, however the output is cut.
    moved: f64,
}

impl Piece {
    fn of(level: &Level, output: &Faces, face: u32) -> Self {
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

    /// How far its corners are displaced.
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

/// The distance between the limit of the live faces of a net and the surface that the net is compared with, which has
/// the same faces, at most; either from the other. Infinite where it is soon seen to be above the tolerance.
///
/// # Errors
/// [`NoLevel`], when a level cannot be computed.
pub(super) fn bound(
    base: &Level,
    spline: &Spline,
    tolerance: f64,
    rounding: f64,
    budget: &Budget,
) -> Result<f64, NoLevel> {
    if base.live.len() > FOLLOWED_FACES {
        return plain(base, spline, budget);
    }
    let flat = base.flat.now.as_chunks().0;
    let faces = Faces::of(&base.topology, flat, &base.live, vec![0.0; base.live.len()], !spline.halved);
    let output = Surface::of(vec![faces], budget);
    let (first, limit, cuts) = (None, Vec::new(), ALL_CUTS);
    let mut comparison = Comparison { spline, output, first, limit, greatest: 0.0, rounding, cuts, budget };
    let (mut level, mut bound) = (base.clone(), 0.0_f64);
    for ahead in 0..=AHEAD {
        let next = if spline.halved { Level::next_halved } else { Level::next };
        let next = |level: &Level| next(level, &spline.plan, spline.round(ahead), &budget.watch);
        if ahead < WHOLE && level.faces_after(1) <= FOLLOWED_FACES {
            level = next(&level)?;
            continue;
        }
        let Some(seen) = comparison.seen(&level, (1.0 + SLACK) * tolerance)? else { return Ok(f64::INFINITY) };
        let little = comparison.little();
        let part = |least: f64| {
            let kept = seen.remainders.iter().filter(|&&(_, remainder)| remainder > least);
            let kept: Vec<u32> = kept.map(|&(face, _)| face).collect();
            let few = ahead < AHEAD && (1..=PART_FACES / 4).contains(&kept.len());
            let part = few.then(|| level.focused(&kept, spline.margin()))?;
            (part.faces_after(1) <= PART_FACES).then_some((part, least))
        };
        // where too many faces are farther from their limit than what is little, those that are farthest are followed,
        // as long as that makes a difference
        let remainders = seen.remainders.iter().map(|&(_, remainder)| remainder);
        let mut far: Vec<f64> = remainders.filter(|&remainder| remainder > little).collect();
        far.sort_by(|a, b| b.total_cmp(a));
        let least = |n: usize| far.get(n).copied().unwrap_or(little);
        let fewer = std::iter::successors(Some(far.len()), |&n| (n > FEW).then_some(n / 2)).map(least);
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

/// Bounds the distance of nets of too many faces to be measured.
fn plain(base: &Level, spline: &Spline, budget: &Budget) -> Result<f64, NoLevel> {
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
    // point by point, or from the faces around, which may have moved farther
    let each = base.live.iter().zip(moved).zip(distances);
    Ok(each
        .map(|((&face, moved), remainder)| (moved + remainders.plain(face)).min(most + remainder))
        .fold(0.0, f64::max))
}
