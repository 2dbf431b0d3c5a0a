//! The product, its units and the context of its shape.

use super::entities::{Entities, Id, Real};
use crate::output::error::FormatError;
use crate::shape::coordinate_system::Unit;

/// The schema: application protocol 242, edition 1.
pub(super) const SCHEMA: &str = "AP242_MANAGED_MODEL_BASED_3D_ENGINEERING_MIM_LF { 1 0 10303 442 1 1 4 }";

/// The entities to which shapes refer.
#[derive(Debug, Clone, Copy)]
pub(super) struct StepProduct {
    /// The shape of the product as a property.
    pub(super) shape: Id,
    /// Units and accuracy.
    pub(super) context: Id,
    /// The coordinate system.
    pub(super) axes: Id,
}

/// Writes a product with lengths in this unit that are accurate to `accuracy` units.
pub(super) fn product(out: &mut Entities<'_>, unit: Unit, accuracy: f64) -> Result<StepProduct, FormatError> {
    let application = out.add(format_args!("APPLICATION_CONTEXT('managed model based 3d engineering')"))?;
    out.add(format_args!(
        "APPLICATION_PROTOCOL_DEFINITION('international standard','ap242_managed_model_based_3d_engineering',2014,\
         {application})"
    ))?;
    let context = out.add(format_args!("PRODUCT_CONTEXT('',{application},'mechanical')"))?;
    let product = out.add(format_args!("PRODUCT('solid','solid','',({context}))"))?;
    out.add(format_args!("PRODUCT_RELATED_PRODUCT_CATEGORY('part',$,({product}))"))?;
    let formation = out.add(format_args!("PRODUCT_DEFINITION_FORMATION('','',{product})"))?;
    let context = out.add(format_args!("PRODUCT_DEFINITION_CONTEXT('part definition',{application},'design')"))?;
    let definition = out.add(format_args!("PRODUCT_DEFINITION('design','',{formation},{context})"))?;
    let shape = out.add(format_args!("PRODUCT_DEFINITION_SHAPE('','',{definition})"))?;
    let length = length_unit(out, unit)?;
    let angle = out.add(format_args!("(NAMED_UNIT(*)PLANE_ANGLE_UNIT()SI_UNIT($,.RADIAN.))"))?;
    let solid_angle = out.add(format_args!("(NAMED_UNIT(*)SI_UNIT($,.STERADIAN.)SOLID_ANGLE_UNIT())"))?;
    let accuracy = out.add(format_args!(
        "UNCERTAINTY_MEASURE_WITH_UNIT(LENGTH_MEASURE({}),{length},'distance_accuracy_value','confusion accuracy')",
        Real(accuracy)
    ))?;
    let context = out.add(format_args!(
        "(GEOMETRIC_REPRESENTATION_CONTEXT(3)GLOBAL_UNCERTAINTY_ASSIGNED_CONTEXT(({accuracy}))\
         GLOBAL_UNIT_ASSIGNED_CONTEXT(({length},{angle},{solid_angle}))REPRESENTATION_CONTEXT('',''))"
    ))?;
    let origin = out.point([0.0; 3])?;
    let [axis, reference] =
        [out.add(format_args!("DIRECTION('',(0.,0.,1.))"))?, out.add(format_args!("DIRECTION('',(1.,0.,0.))"))?];
    let axes = out.add(format_args!("AXIS2_PLACEMENT_3D('',{origin},{axis},{reference})"))?;
    Ok(StepProduct { shape, context, axes })
}

fn length_unit(out: &mut Entities<'_>, unit: Unit) -> Result<Id, FormatError> {
    let prefix = match unit {
        Unit::Metre => "$",
        Unit::Centimetre => ".CENTI.",
        Unit::Millimetre | Unit::Inch => ".MILLI.",
    };
    let metric = out.add(format_args!("(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT({prefix},.METRE.))"))?;
    if unit != Unit::Inch {
        return Ok(metric);
    }
    let inch = out.add(format_args!("LENGTH_MEASURE_WITH_UNIT(LENGTH_MEASURE(25.4),{metric})"))?;
    let exponents = out.add(format_args!("DIMENSIONAL_EXPONENTS(1.,0.,0.,0.,0.,0.,0.)"))?;
    out.add(format_args!("(CONVERSION_BASED_UNIT('INCH',{inch})LENGTH_UNIT()NAMED_UNIT({exponents}))"))
}
