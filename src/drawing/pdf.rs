//! Writes a drawing as PDF.

mod fonts;
mod pack;
mod sheet;

use std::io::Write;

use pdf_writer::{Filter, Finish, Name, Pdf, Rect, Ref, TextStr};

use super::error::DrawError;
use super::scene::{Drawing, Lettering, Picture};
use crate::watch::Watch;
use pack::packed;
use sheet::{POINTS_A_PIXEL, PdfPage};

/// Writes a drawing as a PDF file of one page, as large as the drawing at 96 pixels an inch.
///
/// The file tells of no time and no program run, so that equal drawings are equal files. Letters are those of the
/// bundled font, of which the file holds what occurs.
///
/// # Errors
/// When the watch says stop, the bytes cannot be taken, or a picture is none.
pub fn pdf(drawing: &Drawing, lettering: Lettering, out: &mut dyn Write, watch: &Watch) -> Result<(), DrawError> {
    let sheet = PdfPage::of(drawing, lettering, watch)?;
    let mut ids = (1..).map(Ref::new);
    let mut next = || ids.next().expect("there are more numbers than objects");
    let mut pdf = Pdf::new();
    // the first version with transparency: typesetting programs warn of versions newer than their own
    pdf.set_version(1, 4);
    let [catalog, pages, page, content, info] = [next(), next(), next(), next(), next()];
    pdf.catalog(catalog).pages(pages);
    pdf.pages(pages).kids([page]).count(1);
    if !drawing.title.is_empty() {
        pdf.document_info(info).title(TextStr(&drawing.title));
    }
    let pictures: Vec<Ref> = sheet.pictures.iter().map(|_| next()).collect();
    let masks: Vec<Ref> = sheet.pictures.iter().map(|_| next()).collect();
    let fonts: Vec<(Ref, &fonts::PdfFont)> = sheet.fonts.iter().filter(|f| f.is_used()).map(|f| (next(), f)).collect();
    #[expect(clippy::cast_precision_loss, reason = "pictures have some thousand pixels a side")]
    let [width, height] = drawing.size.map(|side| side as f32 * POINTS_A_PIXEL);
    let mut leaf = pdf.page(page);
    leaf.parent(pages).media_box(Rect::new(0.0, 0.0, width, height)).contents(content);
    let mut resources = leaf.resources();
    let mut named = resources.x_objects();
    for (i, id) in pictures.iter().enumerate() {
        named.pair(Name(sheet::picture_name(i).as_bytes()), *id);
    }
    named.finish();
    let mut named = resources.fonts();
    for (id, font) in &fonts {
        named.pair(Name(font.name()), *id);
    }
    named.finish();
    let mut named = resources.ext_g_states();
    for alpha in &sheet.alphas {
        let share = f32::from(*alpha) / 255.0;
        let mut state = named
            .insert(Name(sheet::alpha_name(*alpha).as_bytes()))
            .start::<pdf_writer::writers::ExtGraphicsState<'_>>();
        state.stroking_alpha(share).non_stroking_alpha(share);
    }
    named.finish();
    resources.finish();
    leaf.finish();
    pdf.stream(content, &packed(&sheet.content.finish().into_vec())?).filter(Filter::FlateDecode);
    for ((picture, id), mask) in sheet.pictures.iter().zip(pictures).zip(masks) {
        watch.check()?;
        embed(&mut pdf, picture, [id, mask])?;
    }
    for (id, font) in fonts {
        font.write(&mut pdf, id, &mut next)?;
    }
    watch.check()?;
    out.write_all(&pdf.finish())?;
    Ok(())
}

/// Writes a picture and, where it lets something through, how much.
fn embed(pdf: &mut Pdf, picture: &Picture, [id, mask]: [Ref; 2]) -> Result<(), DrawError> {
    let [columns, rows] = picture.size;
    let [Ok(width), Ok(height)] = [columns, rows].map(i32::try_from) else {
        return Err(DrawError::Unfit(format!("a picture of {columns} x {rows} pixels cannot be written")));
    };
    let color: Vec<u8> = picture.pixels.chunks_exact(4).flat_map(|p| [p[0], p[1], p[2]]).collect();
    let alpha: Vec<u8> = picture.pixels.chunks_exact(4).map(|p| p[3]).collect();
    let opaque = alpha.iter().all(|a| *a == 255);
    let color = packed(&color)?;
    let mut image = pdf.image_xobject(id, &color);
    image.filter(Filter::FlateDecode);
    image.width(width).height(height).bits_per_component(8).interpolate(true);
    image.color_space().device_rgb();
    if opaque {
        return Ok(());
    }
    image.s_mask(mask);
    image.finish();
    let alpha = packed(&alpha)?;
    let mut image = pdf.image_xobject(mask, &alpha);
    image.filter(Filter::FlateDecode);
    image.width(width).height(height).bits_per_component(8).interpolate(true);
    image.color_space().device_gray();
    Ok(())
}
