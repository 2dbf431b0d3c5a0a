//! Checks which operators may follow each other.

use super::{Plan, Subject};
use crate::math::parameter::Value;
use crate::scheme::extent::Ends;
use crate::scheme::letter::Letter;
use crate::scheme::operator::{Follows, Role};
use crate::scheme::ops::around::cannot_follow;
use crate::scheme::ops::{cannot_carry, lost_points, no_anchor, not_triangles, odd_duals};
use crate::scheme::parameters::{ARITY, AVERAGES, MASK};
use crate::scheme::step_error::{About, StepError};
use crate::shape::creases::INFINITE_SHARPNESS;
use crate::shape::tile::Tile;

impl Plan {
    /// Checks that every operator may follow those before it, in the prefix and the first two applications of the
    /// cycle.
    pub(super) fn check_legal(&self, subject: Subject) -> Result<(), StepError> {
        let (mut upsampled, mut duals, mut lost) = (false, 0, false);
        let natural = !subject.is_mesh && subject.is_open && self.ends == Ends::Natural;
        let mut arity = 2;
        let mut most = Follows::Corners;
        for mut letter in self.word.letters(2) {
            let role = letter.facts().role;
            if role == Role::Average {
                letter.settings.set(&ARITY, Value::Integer(arity.into()));
            }
            if let Some(why) = letter.facts().nets.not_meshes().filter(|_| subject.is_mesh) {
                return Err(StepError::new(why));
            }
            let splits_input =
                role == Role::Upsample && letter.settings.tile() == Tile::Triangle && !upsampled && duals == 0;
            if let Some((face, size)) = subject.other_face.filter(|_| splits_input) {
                return Err(not_triangles(face, size));
            }
            let dual = letter.shifts();
            if let Some(carried) = subject.carried {
                if let Some(found) = other_than_halves(&letter) {
                    return Err(not_halves(carried.name(), &found));
                }
                // averages that move to the dual net are refused below for the tags that they cannot carry
                let known = letter.facts().pointwise || role == Role::Average;
                if !known || letter.settings.tile() == Tile::Triangle {
                    return Err(useless(carried.name()));
                }
            }
            if let Some(tags) = subject.attached.filter(|_| letter.facts().rebuilds) {
                return Err(cannot_follow(letter.facts().name, tags));
            }
            let follows = letter.facts().follows;
            most = most.max(follows);
            if subject.creased && follows == Follows::Corners && !dual {
                let rule = "this scheme knows no creases; leave them out";
                return Err(StepError::new(format!(
                    "{rule}, or use catmull-clark, push-back or a word over U, C and P"
                )));
            }
            match role {
                Role::Upsample if letter.facts().has(&MASK) => {
                    if let Some(tags) = subject.tags {
                        return Err(StepError::new(format!(
                            "this scheme is a mask, which knows no {tags}; leave them out or use a word over U, C and P"
                        )));
                    }
                    let averaged = natural && letter.settings.whole(&AVERAGES).is_some_and(|averages| averages > 0);
                    (upsampled, duals, lost, arity) =
                        (true, 0, letter.settings.mask().is_some() || averaged, letter.settings.arity());
                }
                Role::Upsample => (upsampled, duals, lost, arity) = (true, 0, false, letter.settings.arity()),
                Role::Average => {
                    if let Some(why) = letter.facts().needs_upsampling.filter(|_| !upsampled) {
                        return Err(StepError::new(why));
                    }
                    if let Some(tags) = subject.tags.filter(|_| dual) {
                        return Err(cannot_carry(tags));
                    }
                    duals += u32::from(dual);
                    lost |= natural || dual && subject.is_mesh && subject.is_open;
                }
                Role::PushBack if !upsampled => return Err(no_anchor()),
                // first the faults that no other input could avoid
                Role::PushBack if duals % 2 == 1 => return Err(odd_duals(duals)),
                Role::PushBack if lost => {
                    return Err(lost_points(match (natural, subject.is_mesh) {
                        (true, _) => "natural ends: use clamped ones, or a scheme without push-back",
                        (false, true) => "the boundary: close the mesh, or leave the P out",
                        (false, false) => "a scheme of its own mask: leave the P out",
                    }));
                }
                Role::PushBack | Role::Smooth => {}
            }
        }
        match subject.semi_sharp {
            Some(tags) if most < Follows::SemiSharp => Err(semi_sharp(tags)),
            _ => Ok(()),
        }
    }
}

/// Returns how the U of a word differs from one that halves edges and makes quads, if it does.
pub(super) fn other_than_halves(letter: &Letter) -> Option<String> {
    let is_upsampling = letter.facts().pointwise && letter.facts().role == Role::Upsample;
    let split = || (letter.settings.tile() == Tile::Triangle).then(|| "split triangle".to_owned());
    let arity = || (letter.settings.arity() != 2).then(|| format!("U{}", letter.settings.arity()));
    if is_upsampling { split().or_else(arity) } else { None }
}

/// Returns the error for tags that a scheme does not use.
pub(super) fn useless(tags: &str) -> StepError {
    StepError::new(format!("this scheme knows no {tags}; leave them out or use a word over U, C and P"))
}

/// Returns the error for data that only upsamplings that halve edges and make quads can use.
fn not_halves(what: &str, found: &str) -> StepError {
    let rule = format!("{what} act in words over U, C and P with arity 2 and split quad");
    StepError::about(About::Halves, format!("{rule}; here stands {found}: change it or leave them out"))
}

/// Returns the error for a sharpness between smooth and infinitely sharp under a scheme that does not support it.
fn semi_sharp(tags: &str) -> StepError {
    let most = INFINITE_SHARPNESS;
    let rule = format!("{tags} of a sharpness between 0 and {most} belong to catmull-clark and loop");
    StepError::new(format!("{rule}; here an edge or vertex is smooth (0) or infinitely sharp ({most} or more)"))
}
