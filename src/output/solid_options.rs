//! The options of formats that hold solids, and the solids that they describe.

use crate::fault::Fault;
use crate::math::parameter::{Default, Parameter, Values};
use crate::output::counts::Counts;
use crate::output::error::FormatError;
use crate::output::scene::Scene;
use crate::scheme::plan::Plan;
use crate::shape::coordinate_system::Unit;
use crate::shape::labels::by_labels;
use crate::shape::mesh::Mesh;
use crate::solid::{Continuity, Pack, Solid, SolidError, SolidForecast, SolidRequest, check, operations, solid};
use crate::watch::Watch;

const TOLERANCE: Parameter = Parameter::number(
    "tolerance",
    [1e-9, 1e-2],
    Default::Number(1e-5),
    "Largest distance from the limit surface, in shares of the largest side of the box around the cage.",
);

const CONTINUITY: Parameter = Parameter::choice(
    "continuity",
    &["g1", "bicubic"],
    "What the last faces around smooth vertices of a valence other than 4 are: of bidegree 5, with tangent planes that \
     agree, or bicubic, with an angle between them that the certificate tells.",
);

const PACK: Parameter = Parameter::choice(
    "pack",
    &["patch", "face", "none"],
    "Which bicubic faces become one B-spline face: all that form a rectangle, those of one input face, or none.",
);

const MAX_FACES: Parameter =
    Parameter::integer("max_faces", [1, 1_000_000], 20_000.0, "Most faces of the result; more are refused.");

const MAX_LEVEL: Parameter = Parameter::integer(
    "max_level",
    [1, 20],
    14.0,
    "Most levels of refinement around vertices where the surface is not bicubic.",
);

const SOLID: Parameter = Parameter::choice(
    "solid",
    &["auto", "require"],
    "What happens to an open mesh: it becomes an open shell, or it is refused.",
);

/// The options of formats that hold solids.
pub(super) const SOLID_OPTIONS: &[Parameter] = &[TOLERANCE, CONTINUITY, PACK, MAX_FACES, MAX_LEVEL, SOLID];

/// Shortest length that readers distinguish from zero, metres: a hundred times the distance at which they merge points.
const SHORTEST: f64 = 1e-8;

/// Returns the request for a solid with lengths in this unit; formats without these options use the defaults.
pub(super) fn request(options: &Values, unit: Unit) -> SolidRequest {
    let number = |parameter: &Parameter| {
        let usual = if let Default::Number(usual) = parameter.default { usual } else { 0.0 };
        options.number(parameter.name).unwrap_or(usual)
    };
    #[expect(clippy::cast_possible_truncation, reason = "the defaults are small whole numbers")]
    let whole = |parameter: &Parameter| {
        let given = options.integer(parameter.name);
        given.unwrap_or_else(|| number(parameter) as i64)
    };
    SolidRequest {
        tolerance: number(&TOLERANCE),
        continuity: match options.choice(CONTINUITY.name) {
            Some("bicubic") => Continuity::Bicubic,
            _ => Continuity::Tangent,
        },
        pack: match options.choice(PACK.name) {
            Some("none") => Pack::Nothing,
            Some("face") => Pack::Face,
            _ => Pack::Patch,
        },
        max_faces: usize::try_from(whole(&MAX_FACES)).unwrap_or(1),
        max_level: u32::try_from(whole(&MAX_LEVEL)).unwrap_or(1),
        shortest: SHORTEST / unit.metres(),
        closed: options.choice(SOLID.name) == Some("require"),
    }
}

/// Returns upper bounds of the solid of a cage under these options.
pub(super) fn forecast(counts: &Counts, options: &Values) -> SolidForecast {
    counts.cage.forecast(&request(options, counts.coordinate_system.unit))
}

/// Returns the work of building the solid of a mesh, in rows of a table, 100 ns each.
pub(super) fn work(mesh: Option<&Mesh>, options: &Values) -> u128 {
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a forecast above 0")]
    mesh.map_or(0, |mesh| (operations(mesh, &request(options, Unit::default())) / 100.0) as u128)
}

/// Refuses meshes that give no solid under a plan, as far as that is known without refining them.
pub(super) fn admits(mesh: &Mesh, plan: &Plan, options: &Values) -> Result<(), Fault> {
    check(mesh, plan, &request(options, Unit::default())).map_err(|error| match error {
        SolidError::Unfit(fault) => fault,
        SolidError::Stopped(stopped) => Fault::new("", stopped.to_string()),
    })
}

/// Builds the solid of a scene; faces of different groups or materials stay apart.
pub(super) fn solid_of(scene: &Scene<'_>, options: &Values, watch: &Watch) -> Result<Solid, FormatError> {
    let (Some(mesh), Some(plan)) = (scene.control.mesh(), scene.control.plan()) else {
        return Err(FormatError::Unfit("only meshes become solids; ask for json or svg".into()));
    };
    let carried = &mesh.attachments;
    let n_faces = mesh.topology.n_faces();
    let mut labels = vec![0; n_faces];
    for (label, part) in (0..).zip(by_labels(&carried.groups, &carried.materials, n_faces)) {
        part.runs.into_iter().flatten().for_each(|f| labels[f as usize] = label);
    }
    solid(mesh, plan, &request(options, scene.coordinate_system.unit), &labels, watch).map_err(|error| match error {
        SolidError::Stopped(stopped) => FormatError::Stopped(stopped),
        SolidError::Unfit(fault) => FormatError::Impossible(fault),
    })
}
