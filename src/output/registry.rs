//! The list of all formats.

use super::format::Format;
use super::{
    apng, certificate, glb, gltf, gltf_bin, json, mtl, obj, ply, png, stats, stencils, step, stl, threemf, usda, vector,
};

/// Every format, in the order of the documentation.
pub const FORMATS: &[&dyn Format] = &[
    &json::Json,
    &stats::Stats,
    &obj::Obj,
    &mtl::Mtl,
    &glb::Glb,
    &gltf::Gltf,
    &gltf_bin::GltfBin,
    &ply::Ply,
    &stl::Stl,
    &usda::Usda,
    &threemf::ThreeMf,
    &step::StepFormat,
    &certificate::CertificateFormat,
    &png::Png,
    &apng::Apng,
    &vector::SVG,
    &vector::PDF,
    &stencils::STENCILS_TEXT,
    &stencils::STENCILS_BINARY,
];
