//! Lists of indices as a client gives them.

use crate::fault::Fault;
use crate::math::distinct::distinct;

/// Maximum number of faults of a kind that are reported one by one; the others are counted or left out.
pub(super) const MAX_REPORTED: usize = 20;

/// Checks a client's list of indices, given at `place`, against the number of points or faces (`what`) of a shape;
/// returns them ascending and without repetition.
pub(super) fn check_indices(
    place: &str,
    what: &str,
    indices: &[u64],
    (shape, n): (&str, usize),
    faults: &mut Vec<Fault>,
) -> Vec<u32> {
    let mut found = Vec::with_capacity(indices.len());
    let most = faults.len() + MAX_REPORTED;
    for (i, &given) in indices.iter().enumerate() {
        match u32::try_from(given) {
            Ok(index) if (index as usize) < n => found.push(index),
            _ if faults.len() == most => {}
            _ => {
                let detail = format!("there is no {what} {given}; the {shape} has {n}, counted from 0");
                faults.push(Fault::new(format!("{place}/{i}"), detail));
            }
        }
    }
    distinct(found)
}
