//! Options that formats of meshes share.

use crate::math::parameter::{Parameter, Values};
use crate::output::options::{LIMIT, POSITIONS};

/// Normals of vertices, for formats that have none by default.
pub(super) const NORMALS: Parameter = Parameter::choice(
    "normals",
    &["none", "area", "limit"],
    "Vertex normals of a mesh: none, weighted by the area of the faces around the vertex, or those of the limit \
     surface.",
);

/// Returns whether normals are requested.
pub fn with_normals(options: &Values) -> bool {
    matches!(options.choice("normals"), Some("area" | "limit"))
}

/// Returns whether positions and whether normals of the limit surface are requested.
pub fn limit(options: &Values) -> [bool; 2] {
    [POSITIONS.name, NORMALS.name].map(|name| options.choice(name) == Some(LIMIT))
}
