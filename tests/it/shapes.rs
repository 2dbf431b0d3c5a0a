//! What a shape may be, what each fault is told, and in which order a refined one comes out.

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
