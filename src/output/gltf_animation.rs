//! The animation of glTF that shows the frames of a mesh one after another, by the weights of its morph targets.

use gltf::json::accessor::{ComponentType, Type};
use gltf::json::animation::{Animation, Channel, Interpolation, Property, Sampler, Target};
use gltf::json::validation::Checked::Valid;
use gltf::json::{Accessor, Extras, Index, Root};
use serde_json::json;

use crate::math::parameter::{Default as Otherwise, Parameter};
use crate::output::gltf_views::{CHANNEL_NUMBER_BYTES, Views, accessor};
use crate::output::numbers::rounded;
use crate::shape::topology::index;

/// The option of both containers that requests the animation.
pub(super) const FRAME_RATE: Parameter = Parameter::number(
    "frames_per_second",
    [0.001, 1000.0],
    Otherwise::Absent,
    "Adds an animation that leads through the frames of a mesh, blended linearly; meshes with frames only",
)
.in_unit("frames a second");

/// Returns the time of a frame, seconds after the first one.
fn moment(frame: usize, rate: f64) -> f32 {
    rounded(f64::from(index(frame)) / rate)
}

/// Returns the bytes of the times of all frames, and of the weights of all targets in all frames.
pub(super) fn lengths(targets: u128) -> [u128; 2] {
    [(targets + 1) * CHANNEL_NUMBER_BYTES, (targets + 1) * targets * CHANNEL_NUMBER_BYTES]
}

/// Returns the times of all frames, then frame after frame the weights of all targets: 1 for its own target, 0 for the
/// others.
pub(super) fn numbers(targets: usize, rate: f64) -> Vec<u8> {
    let moments = (0..=targets).map(|frame| moment(frame, rate));
    let weights =
        (0..=targets).flat_map(|frame| (1..=targets).map(move |target| if target == frame { 1.0_f32 } else { 0.0 }));
    moments.chain(weights).flat_map(f32::to_le_bytes).collect()
}

/// Adds to a document the animation of all its nodes with meshes.
pub(super) fn animate(root: &mut Root, targets: usize, rate: f64) {
    let (n, [moments, weights]) = (targets as u128, lengths(targets as u128));
    let scalars = |view, count| accessor(view, 0, count, ComponentType::F32, Type::Scalar);
    let view = Views::of(root).loose(moments);
    let (min, max) = (Some(json!([0.0])), Some(json!([moment(targets, rate)])));
    let input = root.push(Accessor { min, max, ..scalars(view, n + 1) });
    let view = Views::of(root).loose(weights);
    let output = root.push(scalars(view, (n + 1) * n));
    let interpolation = Valid(Interpolation::Linear);
    let sampler = Sampler { extensions: None, extras: Extras::default(), input, interpolation, output };
    let is_shown = |node: &u32| root.nodes[*node as usize].mesh.is_some();
    let channel = |node: u32| {
        let (node, path) = (Index::new(node), Valid(Property::MorphTargetWeights));
        let target = Target { extensions: None, extras: Extras::default(), node, path };
        Channel { sampler: Index::new(0), target, extensions: None, extras: Extras::default() }
    };
    let channels = (0..index(root.nodes.len())).filter(is_shown).map(channel).collect();
    root.animations = vec![Animation {
        extensions: None,
        extras: Extras::default(),
        channels,
        name: Some("frames".into()),
        samplers: vec![sampler],
    }];
}
