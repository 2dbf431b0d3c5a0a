//! JSON in the notation of requests: every format's fallback, holding everything at full precision.

use std::io::Write;

use serde_json::Value;

use crate::math::parameter::{Parameter, Values};
use crate::output::numbers::{REAL, digits, reals, total, whole};
use crate::output::scene::{Curve, MeshSource, Scene, Shape};
use crate::output::stream::{Positions, Stream, unfit};
use crate::output::{Counts, Format, FormatError, ShapeKind, Size};
use crate::watch::Watch;

/// Most bytes of the entry of the warnings, and of what stands in it beside them.
const WARNINGS: usize = 8_192;
const WARNINGS_FRAME: usize = 64;

/// `{"positions":[...],"faces":[...]}` for meshes, `{"points":[...],"closed":...}` for one polygon,
/// `{"polygons":[...]}` with such objects for any other number of them.
///
/// With warnings, an entry `"warnings":[...]` follows. Numbers are the shortest decimals that read back as the same f64; whole ones have no point, -0 is 0.
#[derive(Debug)]
pub(super) struct Json;

impl Format for Json {
    fn name(&self) -> &'static str {
        "json"
    }

    fn media_type(&self) -> &'static str {
        "application/json"
    }

    fn doc(&self) -> &'static str {
        "JSON as in requests: all coordinates at full precision, polygons as they are"
    }

    fn parameters(&self) -> &'static [Parameter] {
        &[]
    }

    fn holds(&self, _kind: ShapeKind) -> Result<(), String> {
        Ok(())
    }

    fn size(&self, counts: &Counts, _options: &Values) -> Size {
        let row = |dimension: u128| 2 + dimension * (REAL + 1);
        let content = match counts.kind {
            ShapeKind::Curves { dimension } => {
                let braces = br#"{"polygons":[]}"#.len() as u128;
                let polygon = br#"{"points":[],"closed":false},"#.len() as u128;
                total(&[(1, braces), (counts.polygons, polygon), (counts.vertices, row(dimension as u128))])
            }
            ShapeKind::Mesh => {
                let braces = br#"{"positions":[],"faces":[]}"#.len() as u128;
                let corner = digits(counts.vertices) + 1;
                total(&[(1, braces), (counts.vertices, row(3)), (counts.faces, 2), (counts.corners, corner)])
            }
        };
        Size::AtMost(content.saturating_add(WARNINGS as u128))
    }

    fn write(
        &self,
        scene: &Scene<'_>,
        _options: &Values,
        out: &mut dyn Write,
        watch: &Watch,
    ) -> Result<(), FormatError> {
        let mut stream = Stream::new(out, watch);
        stream.bytes(b"{")?;
        match scene.shape {
            Shape::Mesh(mesh) => write_mesh(mesh, &mut stream)?,
            Shape::Curves([curve]) => write_curve(curve, &mut stream)?,
            Shape::Curves(curves) => write_curves(curves, &mut stream)?,
        }
        stream.bytes(&warnings(scene.warnings))?;
        stream.bytes(b"}")
    }
}

/// The entry of the warnings, nothing when there are none; those that find no room are only counted.
fn warnings(warnings: &[String]) -> Vec<u8> {
    if warnings.is_empty() {
        return Vec::new();
    }
    let mut texts = Vec::new();
    let mut room = WARNINGS - WARNINGS_FRAME;
    for (i, warning) in warnings.iter().enumerate() {
        let text = Value::from(warning.as_str()).to_string();
        if text.len() >= room {
            texts.push(format!(r#""and {} more""#, warnings.len() - i));
            break;
        }
        room -= text.len() + 1;
        texts.push(text);
    }
    format!(r#","warnings":[{}]"#, texts.join(",")).into_bytes()
}

fn write_mesh(mesh: &dyn MeshSource, stream: &mut Stream<'_>) -> Result<(), FormatError> {
    stream.bytes(br#""positions":["#)?;
    stream.positions(&Positions::of_mesh(mesh), |start, rows, out| {
        for (i, position) in rows.iter().enumerate() {
            row(start + i, out, |out| reals(out, position, b','));
        }
    })?;
    stream.bytes(br#"],"faces":["#)?;
    stream.faces(mesh, |index, face, out| {
        row(index, out, |out| {
            for (i, &vertex) in face.iter().enumerate() {
                if i > 0 {
                    out.push(b',');
                }
                whole(out, u64::from(vertex));
            }
        });
    })?;
    stream.bytes(b"]")
}

fn write_curves(curves: &[Curve], stream: &mut Stream<'_>) -> Result<(), FormatError> {
    stream.bytes(br#""polygons":["#)?;
    for (i, curve) in curves.iter().enumerate() {
        stream.bytes(if i > 0 { b",{" } else { b"{" })?;
        write_curve(curve, stream)?;
        stream.bytes(b"}")?;
    }
    stream.bytes(b"]")
}

fn write_curve(curve: &Curve, stream: &mut Stream<'_>) -> Result<(), FormatError> {
    if let Some(i) = curve.points.iter().position(|x| !x.is_finite()) {
        return Err(unfit(i / curve.dimension, curve.points[i]));
    }
    stream.bytes(br#""points":["#)?;
    let points: Vec<&[f64]> = curve.points.chunks_exact(curve.dimension).collect();
    stream.rows(0, &points, |start, rows, out| {
        for (i, point) in rows.iter().enumerate() {
            row(start + i, out, |out| reals(out, point, b','));
        }
    })?;
    stream.bytes(format!(r#"],"closed":{}"#, curve.closed).as_bytes())
}

/// One list in a list of lists, with a comma before all but the first.
fn row(index: usize, out: &mut Vec<u8>, items: impl FnOnce(&mut Vec<u8>)) {
    if index > 0 {
        out.push(b',');
    }
    out.push(b'[');
    items(out);
    out.push(b']');
}
