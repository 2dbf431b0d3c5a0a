//! The cost of caps, for booking time and memory.

use super::composed::SHORT_TERMS;
use super::proof::{LeafCell, n_cells, n_rings};
use super::rings::LEAVES;
use super::table::{ESTIMATE_SAMPLES, FIT_SAMPLES, MAX_PROVED_VALENCE, rings_that_matter};
use crate::math::functions::real;

/// Numbers of operations, each about a nanosecond, and bytes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CapCost {
    /// Operations to build the table of a valence, once.
    pub table_operations: f64,
    /// Bytes of that table, which is kept.
    pub table_bytes: usize,
    /// Operations to build the table from which bounds are read, once.
    pub proof_operations: f64,
    /// Bytes of that table, which is kept.
    pub proof_bytes: usize,
    /// Operations of one cap.
    pub cap_operations: f64,
    /// Operations of one estimate.
    pub estimate_operations: f64,
    /// Operations of one bound.
    pub bound_operations: f64,
}

/// Returns the cost of caps of a valence.
pub fn cost(valence: usize) -> CapCost {
    let per_ring = |side: usize| rings_that_matter(valence) * LEAVES.len() * side * side;
    let (n, fitted, estimated) = (real(valence), real(per_ring(FIT_SAMPLES)), real(per_ring(ESTIMATE_SAMPLES)));
    let proved = if valence <= MAX_PROVED_VALENCE { n_rings(valence) } else { 0 };
    let n_cells: usize = (1..=proved).map(|ring| LEAVES.len() * n_cells(valence, ring) * n_cells(valence, ring)).sum();
    let cell_bytes = SHORT_TERMS * SHORT_TERMS * size_of::<f64>() + size_of::<LeafCell>();
    let cap_operations = 4_000.0 * n + 220.0 * n * n;
    let estimate_operations = cap_operations + 300.0 * n * estimated;
    CapCost {
        // frequencies times sectors times samples times columns, and Newton's steps
        table_operations: fitted * (26.0 * n * n + 900.0 * n) + 4_000.0 * (fitted + estimated),
        table_bytes: per_ring(ESTIMATE_SAMPLES) * 12 * size_of::<f64>() + valence * 128 * size_of::<f64>(),
        proof_operations: 2e6 * real(n_cells),
        proof_bytes: n_cells * cell_bytes,
        cap_operations,
        estimate_operations,
        bound_operations: if proved == 0 { estimate_operations } else { cap_operations + 6_000.0 * n * real(n_cells) },
    }
}
