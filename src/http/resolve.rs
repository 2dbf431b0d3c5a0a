//! Requests become jobs.

use super::problem::Problem;
use super::{App, body};
use crate::job::{Job, Levels};
use crate::output::ShapeKind;
use crate::service::pool::Lane;
use crate::wire::JobRequest;
use crate::wire::levels::LevelsRequest;

/// What the search for the level of a tolerance on a mesh takes at most, bytes.
const SEARCH_BYTES: u128 = 256 << 20;

/// The job of a request whose body has so many bytes.
///
/// The level of a tolerance on a mesh is found by refining it: such a request stands in line as long computations do.
pub(super) async fn resolve(app: &App, request: JobRequest, bytes: usize) -> Result<Job, Problem> {
    let limits = app.desk.limits.reading();
    let is_search =
        matches!(request.levels, Some(LevelsRequest(Levels::Tolerance(_)))) && request.shape_kind() == ShapeKind::Mesh;
    let resolve = move || request.resolve_within(&limits).map_err(Problem::invalid);
    if !is_search {
        return body::off_loop(bytes, resolve).await;
    }
    let pool = &app.desk.pool;
    let waiting = pool.line_up(Lane::Long)?;
    let turn = pool.turn(Lane::Long, SEARCH_BYTES).await;
    drop(waiting);
    body::off_loop(usize::MAX, move || turn.run(resolve)).await
}
