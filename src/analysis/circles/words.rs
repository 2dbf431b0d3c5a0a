//! The effect of plans on tubes: whether their words preserve circles, and how far their stencils reach along the axis.

use crate::scheme::letter::Letter;
use crate::scheme::operator::Role;
use crate::scheme::plan::Scheduled;
use crate::scheme::rules::LatitudeRule;
use crate::scheme::word::Word;

/// How many rings on each side a line depends on: of the rings that are given, and of those at any level at most.
///
/// These steps are followed backwards from the ring of the line alone: an average depends on one finer ring more; a
/// push-back on the displacements of the coarser rings beside, so on the finer rings that these have become; and of the
/// finer rings every other one is a coarser one. Push-backs count where rings are `pushed`.
///
/// The displacement of the last ring that counts does not, where an average comes before each push-back: its
/// displacement would depend on the ring beyond it.
pub(super) fn reach(steps: &[Scheduled], pushed: bool) -> [usize; 2] {
    let (mut rings, mut widest) = (0_usize, 0);
    for step in steps.iter().rev() {
        rings = match step.letter.facts().role {
            Role::Average => rings + 1,
            Role::PushBack if pushed => rings.next_multiple_of(2),
            Role::PushBack | Role::Smooth => rings,
            Role::Upsample => rings.div_ceil(2),
        };
        if step.letter.facts().role == Role::Upsample {
            widest = widest.max(rings);
        }
    }
    [rings, widest]
}

/// A U at the front of each part, and what follows it.
fn blocks(letters: &[Letter]) -> impl Iterator<Item = &[Letter]> {
    letters.chunk_by(|_, next| next.facts().role != Role::Upsample)
}

fn parts(word: &Word) -> impl Iterator<Item = &[Letter]> {
    [&word.prefix, &word.cycle].into_iter().flat_map(|letters| blocks(letters))
}

/// What follows the first average.
fn averaged<T>(block: &[T], role: impl Fn(&T) -> Role) -> &[T] {
    let first = block.iter().position(|step| role(step) == Role::Average);
    first.map_or(&[], |first| &block[first + 1..])
}

/// Whether something is pushed back after an upsampling: before the first average vertices are where they were.
pub(super) fn pushes_back(block: &[Scheduled]) -> bool {
    let role = |step: &Scheduled| step.letter.facts().role;
    averaged(block, role).iter().any(|step| role(step) == Role::PushBack)
}

/// Whether a word pushes anything back.
pub(super) fn pushes(word: &Word) -> bool {
    let role = |letter: &Letter| letter.facts().role;
    parts(word).any(|block| averaged(block, role).iter().any(|letter| role(letter) == Role::PushBack))
}

/// Whether each upsampling halves edges and is followed by averages and push-backs that act on single vertices, of
/// which an average is the first to change anything, and nothing stands before the first upsampling. By places a
/// push-back changes the odd points even where no vertex has moved.
pub(super) fn keeps_circles(word: &Word, rule: LatitudeRule) -> bool {
    let keeps = |block: &[Letter]| {
        let roles: Vec<Role> = block.iter().map(|letter| letter.facts().role).collect();
        let Some((Role::Upsample, after)) = roles.split_first() else { return false };
        let idle = after.iter().take_while(|&&role| role == Role::PushBack).count();
        (idle == 0 || rule != LatitudeRule::Position)
            && after.get(idle) == Some(&Role::Average)
            && block.iter().all(|letter| letter.facts().pointwise && letter.settings.halves())
    };
    !word.cycle.is_empty() && parts(word).all(keeps)
}
