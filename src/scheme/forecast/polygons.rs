//! The forecast of polygons, which follows from the ranges of the masks of the operators.

use super::count::Count;
use super::tally::{Forecast, ForecastError};
use crate::scheme::extent::Extent;
use crate::scheme::operator::Role;
use crate::scheme::plan::Scheduled;
use crate::scheme::polygon_net::{PolygonNet, too_few_points};

/// Returns the forecast of several polygons that are refined alike.
///
/// # Errors
/// When an operator cannot be applied to one of them.
pub fn of_polygons(nets: &[PolygonNet], steps: &[Scheduled]) -> Result<Forecast, ForecastError> {
    let mut sum: Option<Forecast> = None;
    for net in nets {
        let one = of_polygon(net, steps)?;
        sum = Some(match sum {
            None => one,
            Some(sum) => Forecast {
                levels: sum.levels.iter().zip(&one.levels).map(|(a, b)| a.plus(*b)).collect(),
                peak: sum.peak.plus(one.peak),
                work: sum.work.saturating_add(one.work),
                topology_bytes: 0,
            },
        });
    }
    Ok(sum.unwrap_or_else(|| Forecast::new(Count::default())))
}

fn of_polygon(net: &PolygonNet, steps: &[Scheduled]) -> Result<Forecast, ForecastError> {
    let mut extent = net.extent;
    let mut n = net.n as u128;
    let count = |n: u128, extent: Extent| {
        let edges = if extent == Extent::Closed { n } else { n.saturating_sub(1) };
        Count { vertices: n, edges, ..Count::default() }
    };
    let mut tally = Forecast::new(count(n, extent));
    let mut duals = 0;
    for step in steps {
        if step.letter.facts().role == Role::Upsample {
            duals = 0;
        }
        if let Some(range) = step.letter.operator.mask_range(&step.letter.settings, duals) {
            let landing = range.land(n, extent);
            (n, extent) = (landing.n, landing.extent);
        }
        duals += u32::from(step.letter.shifts());
        if n < 2 {
            let error = too_few_points(usize::try_from(n).unwrap_or(0));
            return Err(ForecastError::Step { level: step.level, error });
        }
        tally.step(step, count(n, extent));
    }
    Ok(tally)
}
