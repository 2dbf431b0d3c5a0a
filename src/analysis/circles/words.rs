//! The effect of plans on tubes: whether their words preserve circles, and how far their stencils reach along the axis.

use crate::scheme::letter::Letter;
use crate::scheme::operator::Role;
use crate::scheme::plan::Scheduled;
use crate::scheme::rules::LatitudeRule;
use crate::scheme::word::Word;

/// Returns how many rings on each side influence a line: of the given rings, and of the rings of any level at most.
///
/// The steps are followed backwards from the ring of the line. An average needs one more fine ring. A push-back needs
/// the displacements of the neighbouring coarse rings, hence the fine rings that these have become. Every other fine
/// ring is a coarse one. Push-backs matter only if rings are `pushed`.
///
/// If an average precedes each push-back, the displacement of the outermost ring has no influence, because it would
/// depend on the ring beyond it.
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

/// Splits letters into blocks that each begin with an upsampling, except perhaps the first.
fn blocks(letters: &[Letter]) -> impl Iterator<Item = &[Letter]> {
    letters.chunk_by(|_, next| next.facts().role != Role::Upsample)
}

fn parts(word: &Word) -> impl Iterator<Item = &[Letter]> {
    [&word.prefix, &word.cycle].into_iter().flat_map(|letters| blocks(letters))
}

/// Returns the steps after the first average.
fn averaged<T>(block: &[T], role: impl Fn(&T) -> Role) -> &[T] {
    let first = block.iter().position(|step| role(step) == Role::Average);
    first.map_or(&[], |first| &block[first + 1..])
}

/// Returns whether a step after an upsampling pushes back; a push-back before the first average moves nothing, because
/// vertices are still in place.
pub(super) fn pushes_back(block: &[Scheduled]) -> bool {
    let role = |step: &Scheduled| step.letter.facts().role;
    averaged(block, role).iter().any(|step| role(step) == Role::PushBack)
}

/// Returns whether any letter of a word pushes back.
pub(super) fn pushes(word: &Word) -> bool {
    let role = |letter: &Letter| letter.facts().role;
    parts(word).any(|block| averaged(block, role).iter().any(|letter| role(letter) == Role::PushBack))
}

/// Returns whether a word preserves circles: it begins with an upsampling, and each upsampling halves edges and is
/// followed by averages and push-backs that act on single vertices, the first effective one being an average. Under the
/// rule by position a push-back moves the odd points even if no vertex has moved.
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
