//! A drawing in three back ends: painted pixels, written vectors, and the effect of texts on both.

mod curves;
mod hatching;
mod hidden_lines;

use planish::drawing::{
    Axes, Axis, Cap, Discs, Drawing, DrawingItem, FontWeight, Group, HorizontalAlign, Label, Legend, LegendEntry,
    LegendSample, Lettering, Mark, Picture, Stroke, Text, VerticalAlign, color_bar, pdf, pixels, svg,
};
use planish::math::functions::sin;
use planish::watch::Watch;

fn label(text: &str) -> Label {
    Label::parse(text, FontWeight::Regular).expect("it can be set")
}

/// Returns a drawing with every kind of item.
fn everything() -> Drawing {
    let x = Axis { low: -1.0, high: 3.0, label: Some(label(r"parameter \alpha_0")) };
    let y = Axis { low: 0.0, high: 0.5, label: Some(label("max |d^{k}| in \u{211d}^2")) };
    let axes = Axes { border: [80.0, 30.0, 300.0, 200.0], x, y, grid: true, size_px: 12.0 };
    let line = |phase: f64| (0..=60).map(|i| f64::from(i) / 15.0 - 1.0).map(move |x| [x, 0.25 + 0.2 * sin(x - phase)]);
    let run = |phase| line(phase).map(|p| axes.place(p)).collect::<Vec<_>>();
    let dashed = Stroke { dash: vec![6.0, 4.0], cap: Cap::Butt, ..Stroke::solid(2.0, [220, 38, 38, 255]) };
    let solid = Stroke::solid(2.0, [37, 99, 235, 255]);
    let discs = |centres| Discs { centres, radius_px: 5.0, ring_px: 1.5, color: [71, 85, 105, 255], ring: [255; 4] };
    let legend = Legend {
        entries: vec![
            LegendEntry { key: LegendSample::Line(solid.clone()), label: label("sin(x)") },
            LegendEntry { key: LegendSample::Line(dashed.clone()), label: label("sin(x - \\pi/2)") },
            LegendEntry { key: LegendSample::Disc(discs(Vec::new())), label: label("points p_i") },
            LegendEntry { key: LegendSample::Area([16, 185, 129, 120]), label: label("between") },
        ],
        size_px: 12.0,
    };
    let mut items = vec![axes.grid()];
    let between = run(0.0).into_iter().chain(run(1.0).into_iter().rev()).collect();
    items.push(DrawingItem::new("area", Mark::Areas(vec![between], [16, 185, 129, 120])));
    items.push(DrawingItem::lines("curve", vec![run(0.0)], solid).titled("a sine"));
    items.push(DrawingItem::lines("curve", vec![run(1.0)], dashed));
    items.push(DrawingItem::new("points", Mark::Discs(discs(run(0.0).into_iter().step_by(15).collect()))));
    items.extend(axes.items());
    items.extend(legend.items([90.0, 40.0]));
    let gray = |share: f64| {
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a share of 255")]
        let byte = (255.0 * share) as u8;
        [byte, 80, 255 - byte, 255]
    };
    items.extend(color_bar(
        [420.0, 50.0, 16.0, 180.0],
        ([-2e-6, 2e-6], [false, true]),
        gray,
        Some(label("H")),
        12.0,
        500.0,
    ));
    let ways = [
        (HorizontalAlign::Start, VerticalAlign::Baseline),
        (HorizontalAlign::Middle, VerticalAlign::Middle),
        (HorizontalAlign::End, VerticalAlign::Top),
    ];
    for (i, (anchor, level)) in (0_u8..).zip(ways) {
        let label = Label::plain("Ägypten (γ)", FontWeight::Bold).expect("it can be set");
        let at = [540.0, 60.0 + 50.0 * f32::from(i)];
        let text = Text { label, at, size_px: 16.0, anchor, level, turn_deg: 30.0, color: [0, 0, 0, 255] };
        items.push(DrawingItem::new("label", Mark::Text(text)));
    }
    let pixels = (0..16).flat_map(|i| [16 * i, 255 - 16 * i, 0, if i < 8 { 255 } else { 128 }]).collect();
    let picture = Picture { size: [4, 4], pixels, at: [0.0, 0.0], extent: [40.0, 40.0] };
    let cut = Group {
        shift: [560.0, 200.0],
        scale: 1.5,
        clip: Some([5.0, 5.0, 30.0, 30.0]),
        items: vec![
            DrawingItem::new("picture", Mark::Picture(picture)),
            DrawingItem::lines("line", vec![vec![[0.0, 0.0], [40.0, 40.0]]], Stroke::solid(2.0, [0, 0, 0, 255])),
        ],
    };
    items.push(DrawingItem::new("cut", Mark::Group(cut)));
    let title = "</title><script>alert(1)</script>".into();
    Drawing { size: [640, 290], background: [255; 4], title, items }
}

fn written(drawing: &Drawing, lettering: Lettering) -> [Vec<u8>; 2] {
    let [mut a, mut b] = [Vec::new(), Vec::new()];
    svg(drawing, lettering, &mut a, &Watch::new()).expect("it can be written");
    pdf(drawing, lettering, &mut b, &Watch::new()).expect("it can be written");
    [a, b]
}

fn text(bytes: &[u8]) -> &str {
    std::str::from_utf8(bytes).expect("SVG is text")
}

#[test]
fn equal_drawings_are_equal_files_that_tell_of_no_time() {
    for lettering in [Lettering::Text, Lettering::Outlines] {
        let [a, b] = [written(&everything(), lettering), written(&everything(), lettering)];
        assert_eq!(a, b);
        let pdf = String::from_utf8_lossy(&a[1]).into_owned();
        assert!(pdf.starts_with("%PDF-") && pdf.ends_with("%%EOF"), "it is a PDF file");
        assert!(!pdf.contains("Date") && !pdf.contains("/ID"), "it tells when it was written");
    }
}

#[test]
fn letters_are_text_or_outlines() {
    let [svg, pdf] = written(&everything(), Lettering::Text);
    assert!(text(&svg).contains(">parameter α</tspan>"), "letters can be searched");
    assert!(String::from_utf8_lossy(&pdf).contains("+DejaVuSans-Bold"), "the font is in the file");
    let [svg, pdf] = written(&everything(), Lettering::Outlines);
    assert!(!text(&svg).contains("<text") && !text(&svg).contains("font"), "there is no text");
    assert!(!String::from_utf8_lossy(&pdf).contains("DejaVu"), "there is no font");
}

#[test]
fn texts_stay_in_their_elements() {
    let attack = "</text></title><script>alert('1')</script>\" onload=\"x";
    let label = Label::plain(attack, FontWeight::Regular).expect("it can be set");
    let (anchor, level) = (HorizontalAlign::Start, VerticalAlign::Baseline);
    let (at, color) = ([5.0, 20.0], [0, 0, 0, 255]);
    let text_item = Text { label, at, size_px: 12.0, anchor, level, turn_deg: 0.0, color };
    let item = DrawingItem::new("label", Mark::Text(text_item)).titled(attack);
    let drawing = Drawing { size: [300, 40], background: [0; 4], title: attack.into(), items: vec![item] };
    let [svg, _] = written(&drawing, Lettering::Text);
    let svg = text(&svg);
    let tags = svg.matches('<').count();
    // svg, title, g, title, text and tspan, each opened and closed
    assert_eq!(tags, 12, "{svg}");
    assert_eq!(svg.matches('"').count() % 2, 0, "{svg}");
    assert!(!svg.contains("<script") && !svg.contains("\" onload"), "{svg}");
}

/// Returns red, green, blue and alpha of a pixel.
fn pixel(drawing: &Drawing, [x, y]: [usize; 2]) -> [u8; 4] {
    let pixels = pixels(drawing, &Watch::new()).expect("it can be painted");
    let at = 4 * (y * drawing.size[0] as usize + x);
    [0, 1, 2, 3].map(|k| pixels[at + k])
}

#[test]
fn groups_move_scale_and_cut_what_they_hold() {
    let black = [0, 0, 0, 255];
    let inner = Drawing {
        size: [10, 10],
        background: [255, 0, 0, 255],
        title: String::new(),
        items: vec![DrawingItem::rectangle("", [-50.0, 4.0, 100.0, 2.0], black)],
    };
    let items = vec![inner.into_group([20.0, 10.0, 60.0, 40.0])];
    let outer = Drawing { size: [100, 60], background: [255; 4], title: String::new(), items };
    // a height of 40 pixels is four times as large, from 30 to 70
    assert_eq!(pixel(&outer, [28, 12]), [255; 4]);
    assert_eq!(pixel(&outer, [32, 12]), [255, 0, 0, 255]);
    assert_eq!(pixel(&outer, [68, 48]), [255, 0, 0, 255]);
    assert_eq!(pixel(&outer, [50, 30]), black);
    assert_eq!(pixel(&outer, [25, 30]), [255; 4]);
}

#[test]
fn pixels_of_a_picture_that_fall_on_pixels_stay_as_they_are() {
    let pixels: Vec<u8> = (0..64).map(|i| if i % 4 == 3 { 255 } else { 4 * i }).collect();
    let picture = Picture { size: [4, 4], pixels: pixels.clone().into(), at: [3.0, 2.0], extent: [4.0, 4.0] };
    let items = vec![DrawingItem::new("", Mark::Picture(picture))];
    let drawing = Drawing { size: [10, 10], background: [255; 4], title: String::new(), items };
    for i in 0..16 {
        assert_eq!(pixel(&drawing, [3 + i % 4, 2 + i / 4]), [0, 1, 2, 3].map(|k| pixels[4 * i + k]));
    }
}
