//! Valid shapes, the messages about faults, and the order of refined shapes.

mod dual_order;
mod faults;
mod non_manifold;
mod numbering;
mod order;
mod own_connectivity;
mod ranges;
mod repairs;
mod small;
mod triangle_order;
