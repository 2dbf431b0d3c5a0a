//! Counts the places of attributes with seams.

use super::complete::Job;
use crate::refine::seam_net;
use crate::scheme::forecast::{self, Count, Forecast, ForecastError};
use crate::scheme::mesh_net::MeshNet;
use crate::watch::Watch;

/// Adds to a forecast the numbers of places of attributes with seams, which are vertices of separate meshes; at most
/// `cap` each.
///
/// # Errors
/// [`ForecastError`].
pub(super) fn add_places(job: &Job, forecast: &mut Forecast, cap: u128, watch: &Watch) -> Result<(), ForecastError> {
    let Some(mesh) = job.input.mesh() else { return Ok(()) };
    let Some(unfolded) = &mesh.attachments.unfolded else { return Ok(()) };
    let mut add = |net: &MeshNet, slot: fn(&mut Count) -> &mut u128| {
        let places = forecast::of_mesh(net, job.steps(), cap, watch)?;
        let levels = forecast.levels.iter_mut().zip(&places.levels).chain([(&mut forecast.peak, &places.peak)]);
        levels.for_each(|(count, places)| *slot(count) = slot(count).saturating_add(places.vertices));
        Ok::<_, ForecastError>(places.work)
    };
    let (mut work, mut n) = (0_u128, 0);
    for places in mesh.attachments.places() {
        let is_uvs = n == 0 && mesh.attachments.uvs.is_some();
        let net = seam_net(mesh, places.seams, &job.plan);
        let added = if is_uvs { add(&net, |count| &mut count.uvs) } else { add(&net, |count| &mut count.seamed) };
        work = work.saturating_add(added?);
        n += 1;
    }
    if n > 1 {
        // these meshes are not refined
        add(&MeshNet::new(unfolded.clone(), &[], &[], job.plan.boundary), |count| &mut count.unfolded)?;
    } else {
        let levels = forecast.levels.iter_mut().chain([&mut forecast.peak]);
        levels.for_each(|count| count.unfolded = count.uvs.saturating_add(count.seamed));
    }
    forecast.work = forecast.work.saturating_add(work);
    Ok(())
}
