//! Lists of indices as a client gives them.

use crate::fault::Fault;

/// Most faults of a kind reported one by one; the rest are counted, or left out.
pub(super) const MAX_REPORTED: usize = 20;

/// Indices of points or faces, as `what` says, that a shape has so many of, ascending and each once. The list is at
/// `place`.
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
    found.sort_unstable();
    found.dedup();
    found
}
