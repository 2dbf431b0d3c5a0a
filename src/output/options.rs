//! Options that several formats declare.

use crate::math::parameter::Parameter;

/// The option of mesh formats that writes the origin of each face and vertex in the input.
pub(super) const IDS: Parameter = Parameter::flag(
    "ids",
    "For each face of a mesh the input face it came of, for each vertex the input vertex, edge or face",
);

/// The option that writes the control mesh in place of its refinement.
pub const CAGE: &str = "cage";

/// The edges of the input on a refined mesh: an option of formats that write them, and an item of pictures.
pub(super) const ISOLINES: &str = "isolines";

/// Edges along latitude and longitude lines of the input, as items of pictures.
pub const DIRECTION_ITEMS: [&str; 2] = ["latitude", "longitude"];

/// The choice that moves points to the limit.
pub const LIMIT: &str = "limit";

/// The option for the positions of the points of the last level.
pub const POSITIONS: Parameter = Parameter::choice(
    "positions",
    &["refined", LIMIT],
    "Whether the points of the last level stay where refinement put them, or move to their limit.",
);

/// The option of unit tangents.
pub const TANGENTS: Parameter = Parameter::flag(
    "tangents",
    "Whether the unit tangents of the limit curve at the points are written; null where there is none. Curves \
     only.",
);

/// Returns the entries of two lists, one behind the other.
pub(super) const fn joined<T: Copy, const N: usize>(first: &[T], second: &[T]) -> [T; N] {
    assert!(first.len() + second.len() == N, "the length of both lists");
    let mut all = [first[0]; N];
    let mut i = 0;
    while i < N {
        all[i] = if i < first.len() { first[i] } else { second[i - first.len()] };
        i += 1;
    }
    all
}
