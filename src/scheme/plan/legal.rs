//! Which operators may follow which.

use super::{Plan, Subject};
use crate::math::parameter::Value;
use crate::scheme::extent::Ends;
use crate::scheme::letter::Letter;
use crate::scheme::operator::{Follows, Role};
use crate::scheme::parameters::{ARITY, AVERAGES, MASK};
use crate::scheme::step::StepError;
use crate::shape::tile::Tile;

impl Plan {
    /// Whether every operator can follow those before it, in the prefix and the first two applications of the cycle.
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
            if subject.is_mesh && letter.facts().needs_upsampling {
                return Err(StepError::WrongNet("A averages the points of polygons; meshes take U, D, C and P"));
            }
            let splits_input =
                role == Role::Upsample && letter.settings.tile() == Tile::Triangle && !upsampled && duals == 0;
            if let Some((face, size)) = subject.other_face.filter(|_| splits_input) {
                return Err(StepError::NotTriangles { face, size });
            }
            let dual = letter.shifts();
            if let Some(carried) = subject.carried {
                if let Some(found) = other_than_halves(&letter) {
                    return Err(StepError::NotHalves { what: carried.name(), found });
                }
                // averages that move to the duals are refused for what they cannot carry
                let known = letter.facts().pointwise || role == Role::Average;
                if !known || letter.settings.tile() == Tile::Triangle {
                    return Err(StepError::Useless(carried.name()));
                }
            }
            if let Some(tags) = subject.attached.filter(|_| letter.facts().rebuilds) {
                return Err(StepError::OwnTags(letter.facts().name, tags));
            }
            let follows = letter.facts().follows;
            most = most.max(follows);
            if subject.creased && follows == Follows::Corners && !dual {
                return Err(StepError::Creases);
            }
            match role {
                Role::Upsample if letter.facts().has(&MASK) => {
                    if let Some(tags) = subject.tags {
                        return Err(StepError::MaskTags(tags));
                    }
                    let averaged = natural && letter.settings.whole(&AVERAGES).is_some_and(|averages| averages > 0);
                    (upsampled, duals, lost, arity) =
                        (true, 0, letter.settings.mask().is_some() || averaged, letter.settings.arity());
                }
                Role::Upsample => (upsampled, duals, lost, arity) = (true, 0, false, letter.settings.arity()),
                Role::Average => {
                    if letter.facts().needs_upsampling && !upsampled {
                        return Err(StepError::NoArity);
                    }
                    if let Some(tags) = subject.tags.filter(|_| dual) {
                        return Err(StepError::DualTags(tags));
                    }
                    duals += u32::from(dual);
                    lost |= natural || dual && subject.is_mesh && subject.is_open;
                }
                Role::PushBack if !upsampled => return Err(StepError::NoAnchor),
                // what no other input helps against first
                Role::PushBack if duals % 2 == 1 => return Err(StepError::OddDuals(duals)),
                Role::PushBack if lost => {
                    return Err(StepError::LostPoints(match (natural, subject.is_mesh) {
                        (true, _) => "natural ends: use clamped ones, or a scheme without push-back",
                        (false, true) => "the boundary: close the mesh, or leave the P out",
                        (false, false) => "a scheme of its own mask: leave the P out",
                    }));
                }
                Role::PushBack | Role::Smooth => {}
            }
        }
        match subject.semi_sharp {
            Some(tags) if most < Follows::SemiSharp => Err(StepError::SemiSharp(tags)),
            _ => Ok(()),
        }
    }
}

/// How the U of a word differs from one that halves edges and makes quads, if it does.
pub(super) fn other_than_halves(letter: &Letter) -> Option<String> {
    let is_upsampling = letter.facts().pointwise && letter.facts().role == Role::Upsample;
    let split = || (letter.settings.tile() == Tile::Triangle).then(|| "split triangle".to_owned());
    let arity = || (letter.settings.arity() != 2).then(|| format!("U{}", letter.settings.arity()));
    if is_upsampling { split().or_else(arity) } else { None }
}
