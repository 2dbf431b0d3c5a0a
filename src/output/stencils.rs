//! Stencils: the weights that make the points of a result from those of the input, for pages that move points
//! themselves.

use crate::fault::Fault;
use crate::math::parameter::{Parameter, Values};
use crate::output::counts::{Counts, ShapeKind};
use crate::output::error::FormatError;
use crate::output::format::{Content, Costs, Format, FormatFacts, MadeOf, Requirements};
use crate::output::numbers::{REAL_BYTES, digits, real, total, whole};
use crate::output::options::{LIMIT, POSITIONS};
use crate::output::scene::Scene;
use crate::output::size::Size;
use crate::output::stream::Stream;
use crate::shape::attachments::Attachments;
use crate::shape::mesh::Mesh;
use crate::shape::weights::{NormalProduct, Weights};

/// The weights of all points, as JSON text or as arrays behind a line of JSON.
///
/// Values are the points of the input, followed by those of the rows, one after another; the entries
/// `starts[r] .. starts[r + 1]` of row `r` weigh values before it. The last rows are the results: `vertices` points,
/// followed by two tangents for each normal.
///
/// A row is the sum of its terms, added to 0 in their order. A term has one entry, `weight x value`, or several as
/// given in `terms`: `k > 0` entries have one weight, which multiplies the symmetric sum of their values; `-k` have
/// several, and the term is the symmetric sum of `weight x value`. The symmetric sum of 2 is `a + b`, of 4
/// `(a + c) + (b + d)`, of 6 the sum of `a + d`, `b + e`, `c + f` from the least to the greatest, of others the sum in
/// their order. Without `terms` all terms have one entry.
#[derive(Debug)]
pub(super) struct StencilsFormat {
    facts: &'static FormatFacts,
    is_text: bool,
}

/// The format that writes JSON text.
pub(super) const STENCILS_TEXT: StencilsFormat = StencilsFormat {
    facts: &FormatFacts {
        name: "stencils",
        extension: "stencils",
        media_type: "application/vnd.planish.stencils+json",
        content: Content::Json,
        doc: "The weights that make the points of the result of those of the input, with which a page moves points \
              itself and gets the bits of json",
        ..FACTS
    },
    is_text: true,
};

/// The format that writes arrays behind a line of JSON.
pub(super) const STENCILS_BINARY: StencilsFormat = StencilsFormat {
    facts: &FormatFacts {
        name: "stencils-bin",
        extension: "stencils-bin",
        media_type: "application/vnd.planish.stencils",
        content: Content::Binary,
        doc: "The arrays of stencils, little endian, behind one line of JSON that tells their order, types and lengths",
        ..FACTS
    },
    is_text: false,
};

/// The facts that both formats share.
const FACTS: FormatFacts = FormatFacts {
    parameters: &[POSITIONS, STENCIL_NORMALS],
    made_of: MadeOf::Weights,
    // all frames have the same weights
    holds_frames: true,
    ..FormatFacts::USUAL
};

/// The option of normals.
const STENCIL_NORMALS: Parameter = Parameter::choice(
    "normals",
    &["none", LIMIT],
    "Whether rows follow for two tangents of the limit surface at each vertex of a mesh, whose vector product \
     has the direction of the normal.",
);

/// The order in which rows are summed, in a sentence.
const SUM_ORDER: &str = "values are the input points, then the rows; a row sums its terms from 0 in order, a term of \
                     several entries its symmetric sum; the last rows are the results";

/// Maximum number of bytes of the head without its numbers of vertices: names, counts and the sentence.
const STENCIL_HEAD_BYTES: u128 = 1024;

/// Bytes of memory of an entry while all rows are held, twice as lists grow: index and weight, and half of a group.
const STENCIL_ENTRY_BYTES: u128 = 2 * (4 + 8 + 12);
/// Bytes of memory of a row: its start, and the number of its point.
const STENCIL_ROW_BYTES: u128 = 2 * (8 + 4);
/// Number of entries that are made in the time of a row of refinement. Half or twice of it predicts twice or half the
/// time.
const ENTRIES_A_ROW: u128 = 4;

impl Format for StencilsFormat {
    fn facts(&self) -> &'static FormatFacts {
        self.facts
    }

    fn encode(&self, scene: &Scene<'_>, _: &Values, stream: &mut Stream<'_>) -> Result<(), FormatError> {
        let Some(weights) = scene.weights else {
            return Err(FormatError::Unfit("there are no weights without a plan that makes points".into()));
        };
        if self.is_text { write_text(weights, stream) } else { write_arrays(weights, stream) }
    }
}

impl Requirements for StencilsFormat {
    fn suits(&self, kind: ShapeKind, _: &Attachments, options: &Values) -> Result<(), Fault> {
        let is_curve = matches!(kind, ShapeKind::Curves { .. });
        if is_curve && options.choice(STENCIL_NORMALS.name) == Some(LIMIT) {
            return Err(Fault::new("/normals", "curves have no normals; leave it out"));
        }
        Ok(())
    }

    fn fits(&self, counts: &Counts, _: &Values) -> Result<(), Fault> {
        let values = counts.weights[0].saturating_add(counts.control).max(counts.weights[1]);
        if values <= u32::MAX.into() {
            return Ok(());
        }
        Err(Fault::new("/format", "there may be more weights than 32 bits number; ask for fewer levels"))
    }
}

impl Costs for StencilsFormat {
    fn size(&self, counts: &Counts, _: &Values) -> Size {
        let [rows, entries] = counts.weights;
        let number = if self.is_text { digits(rows.saturating_add(counts.control)) + 2 } else { 4 };
        let weight = if self.is_text { REAL_BYTES + 1 } else { 8 };
        let ends = rows.saturating_add(1);
        // an entry has an index, a weight, and outside groups a term; every further sector a number
        let (of_entry, of_row) = (2 * number + weight, (number + if self.is_text { REAL_BYTES } else { 0 }) + number);
        Size::AtMost(total(&[(1, STENCIL_HEAD_BYTES), (ends, of_row), (entries, of_entry), (counts.vertices, number)]))
    }

    fn memory(&self, counts: &Counts, _: &Values) -> u128 {
        let [rows, entries] = counts.weights;
        total(&[(rows, STENCIL_ROW_BYTES), (entries, STENCIL_ENTRY_BYTES)])
    }

    fn work(&self, _: Option<&Mesh>, counts: &Counts, _: &Values) -> u128 {
        counts.weights[1] / ENTRIES_A_ROW
    }
}

/// Returns the counts, as the start of a JSON object.
fn head(weights: &Weights) -> String {
    let Weights { columns, rows, vertices, normals, rational } = weights;
    let rational = if *rational { r#","rational":true"# } else { "" };
    let normals = normals.as_ref().map_or_else(String::new, |normals| {
        let product = match normals.product {
            NormalProduct::OfDirections => "of directions",
            NormalProduct::OfTangents => "of tangents",
        };
        let sectors: Vec<String> = normals.sectors.iter().map(u32::to_string).collect();
        let (pairs, sectors) = (vertices + sectors.len(), sectors.join(","));
        format!(r#","normals":{{"pairs":{pairs},"product":"{product}","sectors":[{sectors}]}}"#)
    });
    format!(r#"{{"rows":{},"columns":{columns},"vertices":{vertices}{rational}{normals}"#, rows.len())
}

fn write_text(weights: &Weights, stream: &mut Stream<'_>) -> Result<(), FormatError> {
    let rows = &weights.rows;
    stream.bytes(head(weights).as_bytes())?;
    let comma = |i: usize, out: &mut Vec<u8>| out.extend_from_slice(if i > 0 { b"," } else { b"" });
    stream.bytes(br#","starts":["#)?;
    stream.each(0..rows.starts().len(), |i, out| {
        comma(i, out);
        whole(out, rows.starts()[i] as u64);
    })?;
    stream.bytes(br#"],"indices":["#)?;
    stream.each(0..rows.indices().len(), |i, out| {
        comma(i, out);
        whole(out, rows.indices()[i].into());
    })?;
    stream.bytes(br#"],"weights":["#)?;
    stream.each(0..rows.weights().len(), |i, out| {
        comma(i, out);
        real(out, rows.weights()[i]);
    })?;
    if rows.has_groups() {
        stream.bytes(br#"],"terms":["#)?;
        stream.each(0..rows.len(), |r, out| {
            let mut at = rows.starts()[r];
            for term in rows.terms(r) {
                comma(at, out);
                at += term.indices.len();
                if !term.alike {
                    out.push(b'-');
                }
                whole(out, term.indices.len() as u64);
            }
        })?;
    }
    stream.bytes(format!(r#"],"order":"{SUM_ORDER}"}}"#).as_bytes())
}

/// Converts a number that fits into 32 bits, as was checked before the job was admitted.
fn narrow(n: usize) -> u32 {
    u32::try_from(n).unwrap_or(u32::MAX)
}

fn write_arrays(weights: &Weights, stream: &mut Stream<'_>) -> Result<(), FormatError> {
    let rows = &weights.rows;
    let mut n_terms = 0;
    if rows.has_groups() {
        n_terms = (0..rows.len()).map(|r| rows.terms(r).count()).sum();
    }
    let entries = rows.indices().len();
    let arrays = format!(
        r#"[["weights","f64",{entries}],["starts","u32",{}],["indices","u32",{entries}],["terms","i32",{n_terms}]]"#,
        rows.starts().len()
    );
    let mut head = format!(r#"{},"order":"{SUM_ORDER}","arrays":{arrays}}}"#, head(weights));
    // the arrays begin at a multiple of 8 bytes
    let room = (head.len() + 1).next_multiple_of(8) - 1 - head.len();
    head.push_str(&" ".repeat(room));
    head.push('\n');
    stream.bytes(head.as_bytes())?;
    stream.each(0..entries, |i, out| out.extend_from_slice(&rows.weights()[i].to_le_bytes()))?;
    stream.each(0..rows.starts().len(), |i, out| out.extend_from_slice(&narrow(rows.starts()[i]).to_le_bytes()))?;
    stream.each(0..entries, |i, out| out.extend_from_slice(&rows.indices()[i].to_le_bytes()))?;
    let terms = if n_terms > 0 { rows.len() } else { 0 };
    stream.each(0..terms, |r, out| {
        for term in rows.terms(r) {
            let n = narrow(term.indices.len()).cast_signed();
            out.extend_from_slice(&(if term.alike { n } else { -n }).to_le_bytes());
        }
    })
}
