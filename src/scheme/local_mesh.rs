//! Values of single vertices of a mesh at an upsampling: vertex parameters, perturbations, latitude lines.

use std::sync::Arc;

use super::annotations::{Annotations, mean};
use super::local::{Sources, finite, has_average, no_average};
use super::step_error::StepError;
use crate::shape::topology::Topology;

/// Values of the vertices that entered the last upsampling, and of the points that it made on edges and in faces.
#[derive(Debug, Clone, PartialEq)]
pub struct MeshLocal {
    /// Kernel of each vertex.
    pub kernel: Vec<f64>,
    /// Kernel of each vertex along longitude lines, if it differs.
    pub kernel_longitude: Option<Vec<f64>>,
    /// Push-back factor of each vertex, if vertices have their own.
    pub delta: Option<Vec<f64>>,
    /// Compensation of the edge points, then of the face points.
    pub compensation: Vec<f64>,
    /// Weight `omega / (8 (1 + f))` of the curve rule along latitude lines at the same points; empty without such
    /// lines.
    pub curve_weight: Vec<f64>,
}

impl MeshLocal {
    /// Returns the kernel if all vertices have the same one along all edges.
    pub(super) fn common_kernel(&self) -> Option<f64> {
        let first = *self.kernel.first()?;
        let mut all = self.kernel.iter().chain(self.kernel_longitude.iter().flatten());
        all.all(|kernel| kernel.to_bits() == first.to_bits()).then_some(first)
    }

    /// Returns the local values at an upsampling of `parent`, whose cells have `annotations`; `None` if all vertices
    /// have the values of the plan.
    pub(super) fn of(
        annotations: &Annotations,
        parent: &Topology,
        sources: &Sources<'_>,
    ) -> Result<Option<Arc<Self>>, StepError> {
        let has_lines = annotations.directions.is_some();
        if annotations.attributes.is_none() && sources.noise.is_none() && !has_lines {
            return Ok(None);
        }
        let (n_v, n_e, n_f) = (parent.n_vertices(), parent.n_edges(), parent.n_faces());
        let attributes = annotations.attributes.as_deref().cloned().unwrap_or_default();
        let noise = |operation, i: usize| {
            let number = || match (&annotations.numbering, operation) {
                (None, _) => i as u64,
                (Some(numbering), 0) => numbering.vertex(i),
                (Some(numbering), 1) => numbering.edge(parent, i),
                (Some(numbering), _) => numbering.face(i),
            };
            sources.noise.map_or(0.0, |noise| noise.at(operation, number()))
        };
        let alpha = |own: Option<f64>, plan: f64| own.map_or(plan, |alpha| alpha * sources.scale);
        let at = |array: &Option<Vec<f64>>, v: usize| array.as_ref().map(|array| array[v]);
        let mut kernel = Vec::with_capacity(n_v);
        let mut kernel_longitude = sources.kernel_longitude.map(|_| Vec::with_capacity(n_v));
        for v in 0..n_v {
            let alpha = alpha(at(&attributes.alpha, v), sources.alpha);
            let own = at(&attributes.kernel, v);
            let value = own.map_or_else(|| sources.kernel.value(alpha), Ok);
            kernel.push(weight("kernel", v, value.map(|value| value + noise(0, v)))?);
            if let (Some(expression), Some(values)) = (sources.kernel_longitude, &mut kernel_longitude) {
                let value = own.map_or_else(|| expression.value(alpha), Ok);
                values.push(weight("kernel_longitude", v, value.map(|value| value + noise(0, v)))?);
            }
        }
        let mut compensation = Vec::with_capacity(n_e + n_f);
        let mut curve_weight = Vec::with_capacity(if has_lines { n_e + n_f } else { 0 });
        for i in 0..n_e + n_f {
            let (operation, number) = if i < n_e { (1, i) } else { (2, i - n_e) };
            let own = |array: &Option<Vec<f64>>| array.as_ref().map(|array| mean(array, parent, i));
            let own_alpha = own(&attributes.alpha);
            let seen = alpha(own_alpha.filter(|_| !sources.compensates_apart), sources.compensation_alpha);
            let carried = own(&attributes.compensation);
            let omega = carried.map_or_else(|| sources.compensation.value(seen), Ok);
            let omega = finite("compensation", number, omega.map(|value| value + noise(operation, number)))?;
            let omega = sources.bounded(n_v + i, omega, carried.is_none().then_some(seen))?;
            compensation.push(omega);
            if has_lines {
                let f =
                    own(&attributes.kernel).map_or_else(|| sources.kernel.value(alpha(own_alpha, sources.alpha)), Ok);
                curve_weight.push(omega / (8.0 * (1.0 + weight("kernel", n_v + i, f)?)));
            }
        }
        Ok(Some(Arc::new(Self { kernel, kernel_longitude, delta: attributes.delta, compensation, curve_weight })))
    }
}

fn weight<E: std::fmt::Display>(name: &'static str, i: usize, value: Result<f64, E>) -> Result<f64, StepError> {
    let value = finite(name, i, value)?;
    if has_average(value) { Ok(value) } else { Err(no_average(name, i, value)) }
}
