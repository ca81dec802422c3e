//! A drawing as a PDF of one page, its letters embedded; no date and no random identifier, so the same bytes everywhere.

use super::drawing::{Drawing, Mark, Paint, Shape, Step};
use super::face::Weight;
use pdf_writer::types::{
    CidFontType, FontFlags, LineJoinStyle, SystemInfo, TextRenderingMode, UnicodeCmap,
};
use pdf_writer::{Content, Finish, Name, Pdf, Rect, Ref, Str, TextStr};
use std::collections::{BTreeMap, BTreeSet};

/// Points (1/72 inch) of a millimetre.
const POINTS_OF_MM: f64 = 72.0 / 25.4;
/// How fonts say that their glyphs are numbered as in their file.
const ORDER: SystemInfo<'static> =
    SystemInfo { registry: Str(b"Adobe"), ordering: Str(b"Identity"), supplement: 0 };
const FONTS: [Name<'static>; 2] = [Name(b"R"), Name(b"B")];

/// Converts to what PDF counts in.
#[expect(clippy::cast_possible_truncation, reason = "a page is a few hundred points wide")]
fn short(x: f64) -> f32 {
    x as f32
}

/// What was used on the page.
#[derive(Default)]
struct Used {
    /// Opacities of fill and stroke (percent), by name.
    opacities: BTreeMap<(u8, u8), String>,
    /// By weight: the glyphs and what they say.
    glyphs: [BTreeSet<(u16, char)>; 2],
}

/// Writes `drawing` as a page that is `width_mm` mm wide.
pub(super) fn pdf(drawing: &Drawing, width_mm: f64) -> Vec<u8> {
    let weights = [Weight::of(false), Weight::of(true)];
    let scale = width_mm * POINTS_OF_MM / drawing.width;
    let (width, height) = (drawing.width * scale, drawing.height * scale);
    let mut used = Used::default();
    let mut content = Content::new();
    content.transform([scale, 0.0, 0.0, -scale, 0.0, height].map(short));
    for mark in &drawing.marks {
        draw(mark, &mut content, &mut used, &weights);
    }

    let mut next = 1;
    let mut new = || {
        next += 1;
        Ref::new(next - 1)
    };
    let (catalog, pages, page, contents, info) = (new(), new(), new(), new(), new());
    let fonts: [Option<[Ref; 5]>; 2] =
        [0, 1].map(|i: usize| (!used.glyphs[i].is_empty()).then(|| [0; 5].map(|_| new())));
    let mut file = Pdf::new();
    file.catalog(catalog).pages(pages);
    file.pages(pages).kids([page]).count(1);
    let mut leaf = file.page(page);
    leaf.parent(pages).media_box(Rect::new(0.0, 0.0, short(width), short(height)));
    leaf.contents(contents);
    let mut resources = leaf.resources();
    let mut named = resources.fonts();
    for (name, font) in FONTS.into_iter().zip(&fonts) {
        if let Some([font, ..]) = font {
            named.pair(name, *font);
        }
    }
    named.finish();
    let mut states = resources.ext_g_states();
    for ((fill, stroke), name) in &used.opacities {
        let mut state = states
            .insert(Name(name.as_bytes()))
            .start::<pdf_writer::writers::ExtGraphicsState<'_>>();
        state.non_stroking_alpha(f32::from(*fill) / 100.0);
        state.stroking_alpha(f32::from(*stroke) / 100.0);
    }
    states.finish();
    resources.finish();
    leaf.finish();
    file.stream(contents, &content.finish());
    for ((weight, font), glyphs) in weights.iter().zip(&fonts).zip(&used.glyphs) {
        if let Some(font) = font {
            embed(&mut file, weight, *font, glyphs);
        }
    }
    file.document_info(info).title(TextStr(&drawing.title)).producer(TextStr("Reenact"));
    file.finish()
}

/// Draws one mark.
fn draw(mark: &Mark, content: &mut Content, used: &mut Used, weights: &[Weight; 2]) {
    let Paint { fill, stroke, dash, .. } = &mark.paint;
    let stroke = stroke.filter(|_| mark.paint.stroke_width > 0.0);
    if fill.is_none() && stroke.is_none() {
        return;
    }
    content.save_state();
    content.transform(mark.matrix.map(short));
    if let Some([r, g, b]) = fill.map(|c| c.map(short)) {
        content.set_fill_rgb(r, g, b);
    }
    if let Some([r, g, b]) = stroke.map(|c| c.map(short)) {
        content.set_stroke_rgb(r, g, b);
        content.set_line_width(short(mark.paint.stroke_width));
        if mark.paint.round {
            content.set_line_join(LineJoinStyle::RoundJoin);
        }
        if !dash.is_empty() {
            content.set_dash_pattern(dash.iter().map(|x| short(*x)), 0.0);
        }
    }
    let opacity = [mark.paint.fill_opacity, mark.paint.stroke_opacity].map(percent);
    if opacity != [100, 100] {
        let count = used.opacities.len();
        let name =
            used.opacities.entry((opacity[0], opacity[1])).or_insert_with(|| format!("O{count}"));
        content.set_parameters(Name(name.as_bytes()));
    }
    match &mark.shape {
        Shape::Path(steps) => {
            for step in steps {
                match *step {
                    Step::Move(x, y) => content.move_to(short(x), short(y)),
                    Step::Line(x, y) => content.line_to(short(x), short(y)),
                    Step::Curve(points) => {
                        let [a, b, c, d, e, f] = points.map(short);
                        content.cubic_to(a, b, c, d, e, f)
                    }
                    Step::Close => content.close_path(),
                };
            }
            match (fill.is_some(), stroke.is_some()) {
                (true, true) => content.fill_nonzero_and_stroke(),
                (true, false) => content.fill_nonzero(),
                (false, _) => content.stroke(),
            };
        }
        Shape::Text { at, anchor, size, bold, text } => {
            let i = usize::from(*bold);
            let glyphs = weights[i].glyphs(text);
            let wide: f64 = glyphs.iter().map(|glyph| glyph.advance).sum::<f64>() / 1000.0 * size;
            let bytes: Vec<u8> =
                glyphs.iter().flat_map(|glyph| glyph.number.to_be_bytes()).collect();
            used.glyphs[i].extend(glyphs.iter().map(|glyph| (glyph.number, glyph.says)));
            // The rim of a text lies under it.
            let modes =
                [stroke.map(|_| TextRenderingMode::Stroke), fill.map(|_| TextRenderingMode::Fill)];
            for mode in modes.into_iter().flatten() {
                content.begin_text();
                content.set_font(FONTS[i], short(*size));
                content.set_text_rendering_mode(mode);
                let x = at.0 - anchor * wide;
                content.set_text_matrix([1.0, 0.0, 0.0, -1.0, short(x), short(at.1)]);
                content.show(Str(&bytes));
                content.end_text();
            }
        }
    }
    content.restore_state();
}

#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "0 to 100")]
fn percent(share: f64) -> u8 {
    (share.clamp(0.0, 1.0) * 100.0).round() as u8
}

/// Embeds a weight of the face, with what its `glyphs` say, so that text can be searched and copied.
fn embed(file: &mut Pdf, weight: &Weight, refs: [Ref; 5], glyphs: &BTreeSet<(u16, char)>) {
    let [font, cid_font, descriptor, cmap, data] = refs;
    let name = Name(weight.name.as_bytes());
    file.type0_font(font)
        .base_font(name)
        .encoding_predefined(Name(b"Identity-H"))
        .descendant_font(cid_font)
        .to_unicode(cmap);
    let mut cid = file.cid_font(cid_font);
    cid.subtype(CidFontType::Type2).base_font(name).system_info(ORDER).font_descriptor(descriptor);
    cid.default_width(0.0).cid_to_gid_map_predefined(Name(b"Identity"));
    cid.widths().consecutive(0, weight.advances().map(short));
    cid.finish();
    let ([left, bottom, right, top], [ascent, descent, capitals]) = weight.measures();
    let bold = weight.name.ends_with("Bold");
    file.font_descriptor(descriptor)
        .name(name)
        .flags(FontFlags::NON_SYMBOLIC)
        .bbox(Rect::new(short(left), short(bottom), short(right), short(top)))
        .italic_angle(0.0)
        .ascent(short(ascent))
        .descent(short(descent))
        .cap_height(short(capitals))
        .stem_v(if bold { 140.0 } else { 88.0 })
        .font_file2(data);
    let mut says = UnicodeCmap::new(Name(b"Says"), ORDER);
    for (number, c) in glyphs {
        says.pair(*number, *c);
    }
    file.cmap(cmap, &says.finish()).name(Name(b"Says")).system_info(ORDER);
    let length = i32::try_from(weight.file.len()).unwrap_or(i32::MAX);
    file.stream(data, weight.file).pair(Name(b"Length1"), length);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_page_is_as_wide_as_asked_and_holds_its_letters() {
        let svg = "<svg viewBox=\"0 0 400 200\"><title>Ends &amp; means</title>\
                   <rect width=\"400\" height=\"200\" fill=\"#fff\"/><path d=\"M1 2L3 4\" stroke=\"#000\" fill=\"none\" \
                   stroke-opacity=\"0.5\"/><text x=\"9\" y=\"9\">ours</text></svg>";
        let drawing = Drawing::read(svg).unwrap();
        let file = pdf(&drawing, 88.0);
        assert_eq!(file, pdf(&drawing, 88.0));
        let text = String::from_utf8_lossy(&file);
        for part in [
            "%PDF-1.7",
            "/MediaBox [0 0 249.44",
            "/BaseFont /ReenactSans-Regular",
            "/Title (Ends & means)",
            "/ca 1",
            "/CA 0.5",
            "%%EOF",
        ] {
            assert!(text.contains(part), "{part} is not in {}", &text[..2000]);
        }
        assert!(!text.contains("ReenactSans-Bold"), "no bold letter, no bold face");
        assert!(file.windows(4).any(|bytes| bytes == [0, 1, 0, 0]), "a TrueType file is in it");
    }
}
