//! Requests for batches: lists of jobs, or a template with a grid of values.

use std::collections::HashMap;
use std::ops::Range;

use bytes::Bytes;
use serde::Deserialize;
use serde::de::IgnoredAny;
use serde_json::value::RawValue;
use utoipa::ToSchema;

use super::object;
use super::posted::PostedJob;
use super::read::{ReadError, read};
use crate::fault::{Fault, shortened, token};
use crate::service::batches::{BatchLayout, GridAxis, TemplatePiece};

/// Maximum number of axes of a grid. Half as many are what a figure shows at once; twice as many, with two values each,
/// give more jobs than any server accepts.
const MAX_AXES: usize = 8;

/// A batch: a list of jobs, or a template and a grid.
#[derive(Debug, Clone, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct BatchRequest {
    /// The jobs, each as POST /v1/jobs takes it.
    #[schema(value_type = Option<Vec<PostedJob>>, min_items = 1)]
    pub jobs: Option<Vec<IgnoredAny>>,
    /// A job of which some places are filled from the axes of the grid.
    #[schema(value_type = Option<PostedJob>)]
    pub template: Option<IgnoredAny>,
    /// The axes: every combination of their values is a job, row by row, the last axis fastest.
    #[serde(default, deserialize_with = "object::optional_list")]
    #[schema(min_items = 1, max_items = 8)]
    pub grid: Option<Vec<AxisRequest>>,
}

/// An axis of a grid.
#[derive(Debug, Clone, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct AxisRequest {
    /// JSON pointer (RFC 6901) to the place in the template that the values fill; what stands there is replaced.
    #[schema(example = "/plan/parameters/delta")]
    pub pointer: String,
    /// The values, of any kind that the place may have.
    #[schema(value_type = Vec<serde_json::Value>, min_items = 1)]
    pub values: Vec<IgnoredAny>,
}

/// A batch request with all values as JSON text.
#[derive(Deserialize)]
struct Texts<'a> {
    #[serde(borrow)]
    jobs: Option<Vec<&'a RawValue>>,
    #[serde(borrow)]
    template: Option<&'a RawValue>,
    #[serde(borrow)]
    grid: Option<Vec<AxisTexts<'a>>>,
}

#[derive(Deserialize)]
struct AxisTexts<'a> {
    #[serde(borrow)]
    values: Vec<&'a RawValue>,
}

/// Finds the jobs in the text of a batch.
///
/// # Errors
/// [`ReadError`] if the text is not a batch, with a pointer to the fault.
pub fn layout(text: &Bytes) -> Result<BatchLayout, ReadError> {
    let request: BatchRequest = read(text)?;
    let texts: Texts<'_> = serde_json::from_slice(text).map_err(|error| ReadError::NotJson(error.to_string()))?;
    let range = |value: &RawValue| range(text, value.get());
    let unfit = |pointer: &str, detail: &str| ReadError::Unfit(vec![Fault::new(pointer, detail)]);
    match (texts.jobs, texts.template, request.grid.as_deref()) {
        (Some(jobs), None, None) if jobs.is_empty() => Err(unfit("/jobs", "there is no job in it; give one at least")),
        (Some(jobs), None, None) => Ok(BatchLayout::List(jobs.into_iter().map(range).collect())),
        (None, Some(_), Some([])) => Err(unfit("/grid", "there is no axis in it; give one at least")),
        (None, Some(_), Some(grid)) if grid.len() > MAX_AXES => {
            let detail = format!("{} axes; a grid has at most {MAX_AXES}; join some into values of one", grid.len());
            Err(unfit("/grid", &detail))
        }
        (None, Some(template), Some(grid)) => {
            let values = texts.grid.into_iter().flatten().map(|axis| axis.values.into_iter().map(range).collect());
            let axes = grid.iter().zip(values).map(|(axis, values)| GridAxis { pointer: axis.pointer.clone(), values });
            gridded(text, template, axes.collect()).map_err(ReadError::Unfit)
        }
        (None, Some(_), None) => Err(unfit("/grid", "\"grid\" is missing; a template has axes with values")),
        (None, None, Some(_)) => Err(unfit("/template", "\"template\" is missing; the axes fill places of a job")),
        _ => Err(unfit("", "give either \"jobs\", or \"template\" and \"grid\"")),
    }
}

/// Returns the byte range of `part` within `text`.
fn range(text: &[u8], part: &str) -> Range<usize> {
    let start = part.as_ptr().addr() - text.as_ptr().addr();
    start..start + part.len()
}

/// The change that one axis makes to the template.
struct Edit {
    axis: usize,
    /// The byte range of the replaced text; empty if a field is added.
    replaced: Range<usize>,
    /// The text before the value: the name of an added field, else empty.
    before: String,
    /// Whether the field is added to an object without fields.
    in_empty: bool,
}

fn gridded(text: &[u8], template: &RawValue, axes: Vec<GridAxis>) -> Result<BatchLayout, Vec<Fault>> {
    let (mut edits, mut faults) = (Vec::<Edit>::new(), Vec::new());
    for (at, axis) in axes.iter().enumerate() {
        if axis.values.is_empty() {
            faults.push(Fault::new(format!("/grid/{at}/values"), "there is no value in it; give one at least"));
        }
        let overlaps = |other: &GridAxis| is_within(&axis.pointer, other) || is_within(&other.pointer, axis);
        let edit = match axes[..at].iter().position(overlaps) {
            Some(other) => Err(format!("it overlaps the place of /grid/{other}; give each axis a place of its own")),
            None => edit(text, template, (at, &axis.pointer)),
        };
        match edit {
            Ok(edit) => edits.push(edit),
            Err(detail) => faults.push(Fault::new(format!("/grid/{at}/pointer"), detail)),
        }
    }
    if !faults.is_empty() {
        return Err(faults);
    }
    edits.sort_by_key(|edit| (edit.replaced.start, edit.axis));
    let whole = range(text, template.get());
    let (mut pieces, mut from) = (Vec::new(), whole.start);
    for (at, edit) in edits.iter().enumerate() {
        pieces.extend([TemplatePiece::Text(from..edit.replaced.start), TemplatePiece::Written(edit.before.clone())]);
        pieces.push(TemplatePiece::Value(edit.axis));
        let is_last_there = edits.get(at + 1).is_none_or(|next| next.replaced.start != edit.replaced.start);
        if edit.replaced.is_empty() && !(edit.in_empty && is_last_there) {
            pieces.push(TemplatePiece::Written(",".to_owned()));
        }
        from = edit.replaced.end;
    }
    pieces.push(TemplatePiece::Text(from..whole.end));
    Ok(BatchLayout::Grid { template: pieces, axes })
}

/// Whether a pointer equals the pointer of an axis or leads into its place.
fn is_within(pointer: &str, axis: &GridAxis) -> bool {
    pointer.strip_prefix(axis.pointer.as_str()).is_some_and(|rest| rest.is_empty() || rest.starts_with('/'))
}

/// Returns the change that an axis makes to the template: it replaces the value at the pointer, or adds a missing field
/// to its object.
fn edit(text: &[u8], template: &RawValue, (axis, pointer): (usize, &str)) -> Result<Edit, String> {
    let tokens = pointer.strip_prefix('/').ok_or_else(|| {
        let pointer = shortened(pointer);
        format!("\"{pointer}\" is no pointer to a place in the template; it begins with / as in /plan/parameters/delta")
    })?;
    let tokens: Vec<String> = tokens.split('/').map(|token| token.replace("~1", "/").replace("~0", "~")).collect();
    let mut at = template;
    for (depth, name) in tokens.iter().enumerate() {
        let place = || tokens[..depth].iter().fold(String::new(), |place, name| place + "/" + &token(name));
        if let Ok(fields) = serde_json::from_str::<HashMap<String, &RawValue>>(at.get()) {
            match (fields.get(name), depth + 1 == tokens.len()) {
                (Some(value), _) => at = value,
                (None, true) => {
                    let start = range(text, at.get()).start + 1;
                    let name = serde_json::to_string(name).map_err(|error| error.to_string())?;
                    let (before, in_empty) = (format!("{name}:"), fields.is_empty());
                    return Ok(Edit { axis, replaced: start..start, before, in_empty });
                }
                (None, false) => {
                    let missing = format!("{}/{}", place(), token(name));
                    return Err(format!("the template has no {missing}; write it there, as {{}} if it is empty"));
                }
            }
        } else if let Ok(items) = serde_json::from_str::<Vec<&RawValue>>(at.get()) {
            let item = name.parse().ok().and_then(|index: usize| items.get(index));
            at = item.ok_or_else(|| {
                format!(
                    "the list at {} of the template has {} items, and no \"{}\"",
                    place(),
                    items.len(),
                    shortened(name)
                )
            })?;
        } else {
            return Err(format!("{} of the template is neither an object nor a list", place()));
        }
    }
    Ok(Edit { axis, replaced: range(text, at.get()), before: String::new(), in_empty: false })
}

/// Moves the pointer of a job's fault to the place in the batch that the client wrote.
pub fn placed(layout: &BatchLayout, job: usize, fault: Fault) -> Fault {
    let BatchLayout::Grid { axes, .. } = layout else { return fault.under(&format!("/jobs/{job}")) };
    let coordinates = layout.coordinates(job);
    let at_axis = axes.iter().zip(coordinates).enumerate().find_map(|(at, (axis, value))| {
        let rest = is_within(&fault.pointer, axis).then(|| &fault.pointer[axis.pointer.len()..])?;
        Some(format!("/grid/{at}/values/{value}{rest}"))
    });
    let fault = fault.under("/template");
    match at_axis {
        Some(pointer) => Fault { pointer, ..fault },
        None => fault,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn texts(batch: &str) -> Result<Vec<String>, ReadError> {
        let batch = Bytes::copy_from_slice(batch.as_bytes());
        let layout = layout(&batch)?;
        let n = usize::try_from(layout.n()).expect("few");
        Ok((0..n).map(|at| String::from_utf8(layout.text(&batch, at)).expect("text")).collect())
    }

    #[test]
    fn a_grid_fills_places_of_its_template() {
        let jobs = texts(
            r#"{"template": {"a": [1, {"b": "x"}], "c": {"d": 2}, "e": {}},
                "grid": [{"pointer": "/a/1/b", "values": [7, "y"]}, {"pointer": "/c/new", "values": [null]},
                         {"pointer": "/e/f~1g", "values": [[0], 1.50]}]}"#,
        );
        assert_eq!(
            jobs.expect("a batch"),
            [
                r#"{"a": [1, {"b": 7}], "c": {"new":null,"d": 2}, "e": {"f/g":[0]}}"#,
                r#"{"a": [1, {"b": 7}], "c": {"new":null,"d": 2}, "e": {"f/g":1.50}}"#,
                r#"{"a": [1, {"b": "y"}], "c": {"new":null,"d": 2}, "e": {"f/g":[0]}}"#,
                r#"{"a": [1, {"b": "y"}], "c": {"new":null,"d": 2}, "e": {"f/g":1.50}}"#,
            ]
        );
        assert_eq!(texts(r#"{"jobs": [ {"a" : 1} ,{}]}"#).expect("a batch"), [r#"{"a" : 1}"#, "{}"]);
    }

    #[test]
    fn several_axes_may_add_fields_to_one_object() {
        for template in ["{}", r#"{"x": 0}"#] {
            let jobs = texts(&format!(
                r#"{{"template": {template},
                    "grid": [{{"pointer": "/a", "values": [1, 2]}}, {{"pointer": "/b", "values": [3]}}]}}"#
            ));
            for (at, job) in jobs.expect("a batch").iter().enumerate() {
                let job: serde_json::Value = serde_json::from_str(job).expect("JSON");
                assert_eq!((&job["a"], &job["b"]), (&(at + 1).into(), &3.into()), "{template}");
            }
        }
    }

    #[test]
    fn what_is_no_batch_is_told_by_its_place() {
        let axis = r#"{"pointer": "/a", "values": [1]}"#;
        for (batch, pointer) in [
            ("{}".to_owned(), ""),
            (r#"{"jobs": []}"#.to_owned(), "/jobs"),
            (format!(r#"{{"jobs": [{{}}], "grid": [{axis}]}}"#), ""),
            (r#"{"template": {}}"#.to_owned(), "/grid"),
            (format!(r#"{{"grid": [{axis}]}}"#), "/template"),
            (r#"{"template": {}, "grid": []}"#.to_owned(), "/grid"),
            (format!(r#"{{"template": {{}}, "grid": [{}]}}"#, [axis; 9].join(",")), "/grid"),
            (format!(r#"{{"template": {{"a": 0}}, "grid": [{axis}, {axis}]}}"#), "/grid/1/pointer"),
            (r#"{"template": {}, "grid": [{"pointer": "/a", "values": []}]}"#.to_owned(), "/grid/0/values"),
            (r#"{"template": {}, "grid": [{"pointer": "a", "values": [1]}]}"#.to_owned(), "/grid/0/pointer"),
            (r#"{"template": {}, "grid": [{"pointer": "/a/b", "values": [1]}]}"#.to_owned(), "/grid/0/pointer"),
            (r#"{"template": {"a": [1]}, "grid": [{"pointer": "/a/1", "values": [1]}]}"#.to_owned(), "/grid/0/pointer"),
            (r#"{"template": {"a": 1}, "grid": [{"pointer": "/a/b", "values": [1]}]}"#.to_owned(), "/grid/0/pointer"),
            (r#"{"template": {}, "grid": [{"pointer": "/a", "value": [1]}]}"#.to_owned(), "/grid/0/value"),
            (r#"{"jobs": [{}], "gird": []}"#.to_owned(), "/gird"),
        ] {
            let Err(ReadError::Unfit(faults)) = texts(&batch) else { panic!("{batch}") };
            assert_eq!(faults[0].pointer, pointer, "{batch}: {faults:?}");
        }
    }
}
