//! Questions about a plan: as a curve scheme, as a surface scheme, or on a tube.

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
    /// About the plan as a curve scheme.
    Curve(Box<Analysis>),
    /// About the plan as a surface scheme.
    Surface(Box<SurfaceAnalysis>),
    /// About a straight tube with latitude lines.
    Tube(Box<TubeAnalysis>),
}

/// Returns whether a plan is for meshes only: a preset that refines nothing else, or a word that splits triangles.
pub fn is_for_meshes(plan: &PlanInput) -> bool {
    let preset = PRESETS.iter().find(|preset| Some(preset.name) == plan.preset.as_deref());
    let splits = |(name, value): &(String, Literal)| {
        name == SPLIT.name && matches!(value, Literal::Text(text) if text == "triangle")
    };
    preset.is_some_and(|preset| preset.refines == Refines::Meshes) || plan.parameters.iter().any(splits)
}

impl Inquiry {
    /// Returns the key of the answer in a form.
    pub fn key(&self, form: Form) -> Key {
        let key = match self {
            Self::Curve(analysis) => analysis.key(),
            Self::Surface(analysis) => analysis.key(),
            Self::Tube(analysis) => analysis.key(),
        };
        form.key(key)
    }

    /// Returns upper bounds of the memory in bytes and of the work in the units of the watch, and the approximate time
    /// in milliseconds on one core.
    pub fn cost(&self) -> [u64; 3] {
        match self {
            Self::Curve(analysis) => [analysis.bytes(), analysis.work(), analysis.milliseconds()],
            Self::Surface(analysis) => [analysis.bytes(), analysis.work(), analysis.milliseconds()],
            Self::Tube(analysis) => [analysis.bytes(), analysis.work(), analysis.milliseconds()],
        }
    }
}
