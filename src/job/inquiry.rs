//! What is asked about a plan: as a scheme for curves or for surfaces, or about a tube.

use super::analysis::Analysis;
use super::form::Form;
use super::key::Key;
use super::surface_analysis::SurfaceAnalysis;
use super::tube_analysis::TubeAnalysis;
use crate::math::parameter::Literal;
use crate::scheme::parameters::SPLIT;
use crate::scheme::plan::PlanInput;
use crate::scheme::preset::Refines;
use crate::scheme::presets::PRESETS;

/// A question about a plan.
#[derive(Debug)]
pub enum Inquiry {
    /// As a scheme for curves.
    Curve(Box<Analysis>),
    /// As a scheme for surfaces.
    Surface(Box<SurfaceAnalysis>),
    /// About a straight tube with latitude lines.
    Tube(Box<TubeAnalysis>),
}

/// Whether a plan is one for meshes alone: a preset that refines nothing else, or a word that splits triangles.
pub fn is_for_meshes(plan: &PlanInput) -> bool {
    let preset = PRESETS.iter().find(|preset| Some(preset.name) == plan.preset.as_deref());
    let splits = |(name, value): &(String, Literal)| {
        name == SPLIT.name && matches!(value, Literal::Text(text) if text == "triangle")
    };
    preset.is_some_and(|preset| preset.refines == Refines::Meshes) || plan.parameters.iter().any(splits)
}

impl Inquiry {
    /// The key of the answer in a form.
    pub fn key(&self, form: Form) -> Key {
        let key = match self {
            Self::Curve(analysis) => analysis.key(),
            Self::Surface(analysis) => analysis.key(),
            Self::Tube(analysis) => analysis.key(),
        };
        form.key(key)
    }

    /// Bytes of memory that it takes at most.
    pub fn bytes(&self) -> u64 {
        match self {
            Self::Curve(analysis) => analysis.bytes(),
            Self::Surface(analysis) => analysis.bytes(),
            Self::Tube(analysis) => analysis.bytes(),
        }
    }

    /// Units of work, at most.
    pub fn work(&self) -> u64 {
        match self {
            Self::Curve(analysis) => analysis.work(),
            Self::Surface(analysis) => analysis.work(),
            Self::Tube(analysis) => analysis.work(),
        }
    }

    /// Milliseconds on one core, roughly.
    pub fn milliseconds(&self) -> u64 {
        match self {
            Self::Curve(analysis) => analysis.milliseconds(),
            Self::Surface(analysis) => analysis.milliseconds(),
            Self::Tube(analysis) => analysis.milliseconds(),
        }
    }
}
