//! The layout of the panels of a figure, and the outputs of their jobs.

use super::literal::WireLiteral;
use super::output::{OutputRequest, output};
use crate::drawing::{FontWeight, Label};
use crate::fault::{Fault, under};
use crate::job::{Output, panel_place};
use crate::math::parameter::Literal;
use crate::output::figure::{MAX_CAPTION_CHARS, MAX_COLUMNS, MAX_PANELS, PanelCell, PanelGrid, Sheet};

/// The request of a panel without its job.
#[derive(Debug)]
pub(super) struct Panel {
    /// Numbers of columns and rows that the panel spans.
    pub(super) span: Option<[u64; 2]>,
    /// The text below the panel.
    pub(super) caption: Option<String>,
    /// Whether the panel lies on the one before it.
    pub(super) overlay: bool,
    /// The outputs of the panel's job.
    pub(super) outputs: Vec<OutputRequest>,
}

/// A figure without the jobs of its panels.
#[derive(Debug)]
pub(super) struct FigureOutline {
    /// The layout of the panels.
    pub(super) grid: PanelGrid,
    /// The output that each panel shows.
    shown: Vec<OutputRequest>,
}

impl FigureOutline {
    /// Creates the outline of these panels; if `camera` is given, all pictures use it.
    ///
    /// # Errors
    /// All faults, with pointers into the request.
    pub(super) fn new(
        columns: Option<u64>,
        (title, letters): (Option<String>, bool),
        panels: &[Panel],
        camera: Option<&WireLiteral>,
    ) -> Result<Self, Vec<Fault>> {
        let n = panels.len();
        if n == 0 || n > MAX_PANELS {
            let detail = format!("{n} panels; a figure has 1 to {MAX_PANELS}");
            return Err(vec![Fault::new("/figure/panels", detail)]);
        }
        // the least square that holds all panels
        let usual = (1..=MAX_COLUMNS).find(|side| (side * side) as usize >= n).unwrap_or(MAX_COLUMNS);
        let columns = columns.map_or(Some(usual), |given| u32::try_from(given).ok());
        let Some(columns) = columns.filter(|columns| (1..=MAX_COLUMNS).contains(columns)) else {
            let detail = format!("a figure has 1 to {MAX_COLUMNS} columns");
            return Err(vec![Fault::new("/figure/columns", detail)]);
        };
        let mut faults = camera.and_then(shared_fault).unwrap_or_default();
        faults.extend(text_fault("/figure/title", title.as_deref(), FontWeight::Bold));
        let grid = PanelGrid { columns, title, letters, cells: Vec::new() };
        let mut outline = Self { grid, shown: Vec::new() };
        for (i, panel) in panels.iter().enumerate() {
            match cell(i, panel, columns) {
                Ok((cell, mut shown)) => {
                    match outline.grid.cells.last_mut().filter(|_| panel.overlay) {
                        Some(below) => below.layers += 1,
                        None => outline.grid.cells.push(cell),
                    }
                    camera.into_iter().for_each(|camera| shown.set("camera", camera.clone()));
                    outline.shown.push(shown);
                }
                Err(found) => faults.extend(found),
            }
        }
        if faults.is_empty() { Ok(outline) } else { Err(faults) }
    }

    /// Returns the outputs of the job of panel `i`, one for each output of the figure, in the size of the panel there.
    ///
    /// # Errors
    /// All faults, with pointers below the job.
    pub(super) fn outputs(&self, i: usize, figure: &[(&Output, Sheet)]) -> Result<Vec<Output>, Vec<Fault>> {
        let one = |(of, sheet): &(&Output, Sheet)| {
            let mut request = self.shown[i].clone();
            let size = sheet.pictures[i].size.map(|side| WireLiteral(Literal::Number(side.into())));
            ["width", "height"].into_iter().zip(size).for_each(|(name, side)| request.set(name, side));
            if request.describes() {
                let detail = "a panel is no file of its own; give it to the outputs of the figure";
                return Err(vec![Fault::new("/outputs/0/describe", detail)]);
            }
            let found = output(&request, 0).map_err(|found| under("/outputs/0", found))?;
            Ok(Output { name: of.name.clone(), ..found })
        };
        figure.iter().map(one).collect()
    }
}

/// Returns the fault of a text of the figure, if any.
fn text_fault(place: &str, text: Option<&str>, weight: FontWeight) -> Option<Fault> {
    let text = text?;
    if text.chars().count() > MAX_CAPTION_CHARS {
        return Some(Fault::new(place, format!("it has more than {MAX_CAPTION_CHARS} characters; write less")));
    }
    Label::parse(text, weight).err().map(|detail| Fault::new(place, detail))
}

/// Returns the faults of a camera that all panels share, if any.
fn shared_fault(camera: &WireLiteral) -> Option<Vec<Fault>> {
    let mut request = OutputRequest::of_format("png");
    request.set("camera", camera.clone());
    request.check().err().map(|found| under("/figure/shared", found))
}

/// Returns the faults of panel `i` as an overlay of the one before it.
fn overlay_faults(i: usize, panel: &Panel) -> Vec<Fault> {
    let mut faults = Vec::new();
    if panel.overlay && i == 0 {
        faults.push(Fault::new("/figure/panels/0/overlay", "the first panel has none below it; leave \"overlay\" out"));
    }
    for (name, is_given) in [("span", panel.span.is_some()), ("caption", panel.caption.is_some())] {
        if panel.overlay && is_given {
            let detail = format!("the panel that it lies on says the {name} of both; leave \"{name}\" out");
            faults.push(Fault::new(format!("/figure/panels/{i}/{name}"), detail));
        }
    }
    faults
}

/// Returns the cell of panel `i`, and the output that it shows.
fn cell(i: usize, panel: &Panel, columns: u32) -> Result<(PanelCell, OutputRequest), Vec<Fault>> {
    let mut faults = overlay_faults(i, panel);
    let [across, down] = panel.span.unwrap_or([1, 1]);
    if !(1..=u64::from(columns)).contains(&across) || !(1..=u64::from(MAX_COLUMNS)).contains(&down) {
        let detail = format!("a panel spans 1 to {columns} columns here, and 1 to {MAX_COLUMNS} rows");
        faults.push(Fault::new(format!("/figure/panels/{i}/span"), detail));
    }
    let place = panel_place(i);
    let caption = format!("/figure/panels/{i}/caption");
    faults.extend(text_fault(&caption, panel.caption.as_deref(), FontWeight::Regular));
    let mut shown = match panel.outputs.as_slice() {
        [] => OutputRequest::of_format("png"),
        [one] => one.clone(),
        several => {
            let detail = format!("{} outputs; the job of a panel has one, a picture", several.len());
            return Err(faults.into_iter().chain([Fault::new(format!("{place}/outputs"), detail)]).collect());
        }
    };
    if panel.overlay {
        shown.set_default("background", Literal::Text("transparent".into()));
    }
    let found = output(&shown, 0).map_err(|found| under(&format!("{place}/outputs/0"), found));
    let found = found.and_then(|found| {
        if found.format.paper().is_some() {
            return Ok(found);
        }
        let detail = format!("a panel shows a picture; {} is none, ask for png", found.format.name());
        Err(vec![Fault::new(format!("{place}/outputs/0/format"), detail)])
    });
    match found {
        Ok(found) if faults.is_empty() => {
            let side = |name: &str| found.options.integer(name).and_then(|side| u32::try_from(side).ok()).unwrap_or(1);
            let span = [across, down].map(|n| u32::try_from(n).unwrap_or(1));
            let caption = panel.caption.clone();
            Ok((PanelCell { span, proportion: ["width", "height"].map(side), caption, layers: 1 }, shown))
        }
        Ok(_) => Err(faults),
        Err(found) => Err(faults.into_iter().chain(found).collect()),
    }
}
