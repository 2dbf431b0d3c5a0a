//! Records limits as rows of weights: those that [`refine_mesh_to_limit`](super::refine_mesh_to_limit) applies.

use super::error::{LimitError, Unlimited};
use super::field::{Functional, VertexMasks};
use super::limits::{Looked, before, look};
use super::mesh::scheduled;
use super::request::LimitRequest;
use super::swept::trace_swept;
use crate::math::rows::{RowSource, Rows};
use crate::refine::{Recorder, RefineError, TracedRows, documented, weigh_mesh, weigh_net};
use crate::scheme::mesh_net::MeshNet;
use crate::scheme::plan::{Plan, Scheduled};
use crate::shape::mesh::Mesh;
use crate::shape::topology::index;
use crate::shape::weights::{NormalProduct, NormalWeights};
use crate::watch::Watch;

/// The reason for which limits have no weights.
#[derive(Debug, thiserror::Error)]
pub enum NoWeights {
    /// There is no limit, or it cannot be computed.
    #[error(transparent)]
    Limit(#[from] LimitError),
    /// Some normal does not exist.
    #[error("{0}, so that no tangents make them; leave \"normals\" out")]
    Normals(String),
}

impl From<Unlimited> for NoWeights {
    fn from(error: Unlimited) -> Self {
        Self::Limit(error.into())
    }
}

impl From<RefineError> for NoWeights {
    fn from(error: RefineError) -> Self {
        Self::Limit(error.into())
    }
}

/// Records the rows by which a mesh is refined by `levels` levels and by which the requested parts of its limit are
/// computed, so that the results have the same bits as those of
/// [`refine_mesh_to_limit`](super::refine_mesh_to_limit). The results are the points in the documented order; then, if
/// normals are requested, two tangents for each point, and two for each further sector. Returns how tangents yield
/// normals, or `None` if no normals are requested.
///
/// # Errors
/// [`NoWeights`], also if a vertex with faces has no limit normal.
pub fn weigh_mesh_to_limit(
    recorder: &mut Recorder,
    mesh: &Mesh,
    plan: &Plan,
    levels: u32,
    request: LimitRequest,
    watch: &Watch,
) -> Result<Option<NormalWeights>, NoWeights> {
    let (steps, at) = scheduled(plan, levels)?;
    let (steps, ahead) = steps.split_at(at);
    let found = trace_swept(mesh, plan, (steps, ahead), request, watch)?;
    let net = weigh_mesh(recorder, mesh, plan, steps, watch)?;
    let Some([limits, normals]) = found else { return by_rows(recorder, &net, (plan, ahead), request, watch) };
    recorder.arrange(documented(&net, recorder.points().len()).into_iter());
    let points = recorder.points().to_vec();
    match &limits {
        Some(traced) => {
            for (v, &point) in points.iter().enumerate() {
                add_traced(recorder, traced, v, 0, 1, Some(point));
            }
        }
        None => add_points(recorder, &points),
    }
    let Some(traced) = &normals else { return Ok(None) };
    let n_sectors = |v: usize| traced.of_points[v].map_or(1, |(_, sectors)| sectors);
    (0..points.len()).for_each(|v| add_traced(recorder, traced, v, 0, 2, None));
    let mut sectors = Vec::new();
    for (v, sector) in (0..points.len()).flat_map(|v| (1..n_sectors(v)).map(move |sector| (v, sector))) {
        add_traced(recorder, traced, v, sector, 2, None);
        sectors.push(index(v));
    }
    Ok(Some(NormalWeights { sectors, product: NormalProduct::OfTangents }))
}

/// Adds the `n` rows of one sector of a point as results. A point without faces has the value `instead`, or empty rows.
fn add_traced(recorder: &mut Recorder, traced: &TracedRows, v: usize, sector: usize, n: usize, instead: Option<u32>) {
    let mut empty = Rows::default();
    empty.end_row();
    for k in 0..n {
        match traced.of_points[v] {
            Some((first, _)) => recorder.add(&traced.rows, first + n * sector + k, None),
            None => recorder.add(&empty, 0, instead),
        }
    }
}

/// Adds values as results.
fn add_points(recorder: &mut Recorder, points: &[u32]) {
    let mut empty = Rows::default();
    empty.end_row();
    points.iter().for_each(|&point| recorder.add(&empty, 0, Some(point)));
}

/// Records the requested parts of the limit of a net by the masks of all its vertices.
fn by_rows(
    recorder: &mut Recorder,
    net: &MeshNet,
    (plan, ahead): (&Plan, &[Scheduled]),
    request: LimitRequest,
    watch: &Watch,
) -> Result<Option<NormalWeights>, NoWeights> {
    let given = recorder.points().to_vec();
    let order = documented(net, given.len());
    weigh_net(recorder, net.clone(), plan, &ahead[..before(ahead)], watch)?;
    let found = look((plan, ahead), (net, &[]), request, watch, |looked| {
        let Looked { field, sectors, warning, .. } = looked;
        let (Some(field), None) = (field, warning.clone().filter(|_| request.normals)) else {
            return Ok(Err(warning.unwrap_or_default()));
        };
        if request.positions {
            add_rows(recorder, &field.rows(&sectors[..field.n_vertices()], Functional::Position), &order, Some(&given));
        } else {
            add_points(recorder, &order.iter().map(|&v| given[v]).collect::<Vec<_>>());
        }
        watch.check().map_err(Unlimited::Stopped)?;
        if !request.normals {
            return Ok(Ok(None));
        }
        if let Some(why) = missing(field, sectors) {
            return Ok(Err(why));
        }
        let tangents = [0, 1].map(|i| field.rows(sectors, Functional::Tangent(i)));
        let beside = order.len()..sectors.len();
        for i in order.iter().copied().chain(beside.clone()) {
            tangents.iter().for_each(|tangent| add_rows(recorder, tangent, &[i], None));
        }
        let mut numbers = vec![0; order.len()];
        order.iter().enumerate().for_each(|(number, &v)| numbers[v] = index(number));
        let sectors = sectors[beside].iter().map(|&(v, _)| numbers[v as usize]).collect();
        Ok(Ok(Some(NormalWeights { sectors, product: NormalProduct::OfDirections })))
    })?;
    found.map_err(NoWeights::Normals)
}

/// Adds the rows `which` of a source as results. An empty row `r` is replaced by the value `instead[r]`, if given.
fn add_rows(recorder: &mut Recorder, source: &dyn RowSource, which: &[usize], instead: Option<&[u32]>) {
    let mut rows = Rows::default();
    for &r in which {
        rows.clear();
        source.make(r..r + 1, &mut rows);
        recorder.add(&rows, 0, instead.map(|values| values[r]));
    }
}

/// Returns why some vertex with faces has no limit normal, if there is such a vertex.
fn missing(field: &VertexMasks<'_>, sectors: &[(u32, usize)]) -> Option<String> {
    let why = |&(v, sector): &(u32, usize)| {
        let why = field.no_tangents(v as usize, sector)?;
        Some(format!("a vertex has no limit normal: {}", why.at(&field.describe(v as usize))))
    };
    sectors.iter().find_map(why)
}
