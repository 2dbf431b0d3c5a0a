//! The names in the legend of a picture of a mesh: of the colours of faces, and of lines and dots.

use super::coat::COLOR_BY;
use super::lines::{self, LEGEND_ITEM};
use super::options::Options;
use super::shading::{self, SURFACE};
use crate::drawing::{Color, FontWeight, Label, LegendEntry, LegendSample};
use crate::fault::Fault;
use crate::math::parameter::Values;
use crate::output::colors::{byte, encoded, mark};
use crate::output::counts::ShapeKind;
use crate::shape::attachments::Attachments;
use crate::shape::coordinate_system::CoordinateSystem;
use crate::shape::labels::Labels;
use crate::shape::topology::NONE;

/// Returns the entries of the legend of a picture of a mesh with the attachments `carried`; none if it is not shown.
pub(super) fn entries(carried: &Attachments, options: &Options<'_>) -> Vec<LegendEntry> {
    if !options.values.has("show", LEGEND_ITEM) {
        return Vec::new();
    }
    let labels = match options.values.choice(COLOR_BY.name) {
        Some("groups") => &carried.groups,
        Some("materials") => &carried.materials,
        _ => &Labels::NONE,
    };
    // names may contain characters that cannot be typeset
    let name = |(i, name): (usize, &String)| {
        let label = label(name).or_else(|| label(&format!("name {i}")));
        label.map(|label| LegendEntry { key: LegendSample::Area(shown(mark(i))), label })
    };
    let mut found: Vec<LegendEntry> = labels.names.iter().enumerate().filter_map(name).collect();
    if labels.of_faces.contains(&NONE) {
        let key = LegendSample::Area(shading::color(options, SURFACE));
        found.extend(label("without a name").map(|label| LegendEntry { key, label }));
    }
    if shading::shows_normals(options) {
        let axis = |k: usize| {
            label(AXIS_MEANINGS[k]).map(|label| LegendEntry { key: LegendSample::Area(axis_color(k)), label })
        };
        found.extend((0..AXIS_MEANINGS.len()).filter_map(axis));
    }
    let line = |(name, key): (&str, LegendSample)| label(name).map(|label| LegendEntry { key, label });
    found.extend(lines::meanings(options).into_iter().filter_map(line));
    found
}

/// Refuses a legend without entries.
pub(crate) fn check(kind: ShapeKind, carried: &Attachments, values: &Values) -> Result<(), Fault> {
    let has_no_entries = || entries(carried, &Options::new(values, CoordinateSystem::default())).is_empty();
    if kind == ShapeKind::Mesh && values.has("show", LEGEND_ITEM) && has_no_entries() {
        let detail = "there is nothing that a \"legend\" could explain: it tells the names of groups or materials that \
                      \"color_by\" shows, the colours of normals, and what lines and dots are";
        return Err(Fault::new("/show", detail));
    }
    Ok(())
}

/// The names in legends of the colours of normals along the positive axes.
const AXIS_MEANINGS: [&str; 3] = ["normal +x", "normal +y", "normal +z"];

/// Returns the colour of a normal along axis `k`.
fn axis_color(k: usize) -> Color {
    let mut color = [128, 128, 128, 255];
    color[k] = 255;
    color
}

fn label(text: &str) -> Option<Label> {
    Label::plain(text, FontWeight::Regular).ok()
}

/// Converts linear light to bytes.
fn shown(light: [f32; 3]) -> Color {
    let [r, g, b] = light.map(|x| byte(encoded(f64::from(x))));
    [r, g, b, 255]
}
