//! The list of all operators.

use super::super::operator::Operator;
use super::{
    average, box_average, butterfly, catmull_clark, circle, doo_sabin, dual, incenter, kobbelt_edges, kobbelt_faces,
    loop_smoothing, masked, push_back, root_three, upsample,
};

/// Every operator, in the order of the documentation.
pub const OPERATORS: &[&dyn Operator] = &[
    &upsample::Upsample,
    &dual::Dual,
    &average::Average,
    &box_average::BoxAverage,
    &push_back::WORD_PUSH_BACK,
    &masked::Masked,
    &circle::Circle,
    &push_back::CIRCULAR_PUSH_BACK,
    &incenter::Incenter,
    &catmull_clark::CatmullClark,
    &loop_smoothing::LoopSmoothing,
    &doo_sabin::DooSabin,
    &kobbelt_edges::KobbeltEdges,
    &kobbelt_faces::KobbeltFaces,
    &butterfly::ButterflyEdges,
    &root_three::RootThree,
];
