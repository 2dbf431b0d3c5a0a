//! Schemes: words over operators, presets that spell them, and their effect on connectivity and weights. Only steps
//! that are not linear see coordinates.

pub mod anchor;
pub mod annotations;
pub mod claim;
pub mod creases;
pub mod curve_rule;
pub mod extent;
pub mod forecast;
pub mod letter;
pub mod local;
pub mod local_mesh;
pub mod mask_range;
pub mod mesh_net;
pub mod operator;
pub mod ops;
pub mod parameters;
pub mod phase;
pub mod plan;
pub mod polygon_anchor;
pub mod polygon_net;
mod preimage;
pub mod preset;
pub mod presets;
pub mod ranges;
pub mod rules;
pub mod settings;
pub mod sharpness;
pub mod split_mesh;
pub mod stencil;
pub mod step;
pub mod step_error;
pub mod stepper;
pub mod surroundings;
pub mod tags;
pub mod word;
