//! Images in `map_server`'s form: colours of 8 bits, perhaps with alpha, row by row from the top.

use std::io::Cursor;
use thiserror::Error;

/// Largest image read (pixels): a map of 2896 by 2896. Reading takes 17 bytes a pixel, and is to take less than 200 MB.
const MAX_PIXELS: u64 = 1 << 23;

/// One pixel.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Pixel {
    pub(super) color: [u8; 3],
    pub(super) alpha: Option<u8>,
}

impl Pixel {
    const fn grey(grey: u8) -> Self {
        Self { color: [grey; 3], alpha: None }
    }

    pub(super) fn color_sum(self) -> f64 {
        self.color.iter().map(|channel| f64::from(*channel)).sum()
    }
}

/// A decoded image of at least one pixel.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Image {
    pub(super) width: i32,
    pub(super) height: i32,
    pub(super) pixels: Vec<Pixel>,
}

/// Why bytes are no image.
#[derive(Debug, Error)]
pub(super) enum ImageError {
    #[error("it begins like neither a PNG nor a PGM")]
    UnknownFormat,
    #[error("{0}")]
    Png(#[from] png::DecodingError),
    #[error("it has {width} x {height} pixels, expected 1 to {MAX_PIXELS}")]
    Size { width: u64, height: u64 },
    #[error("its header has no {0}")]
    Header(&'static str),
    #[error("its largest grey is {0}, expected 1 to 65535")]
    Depth(u64),
    #[error("it ends after {found} of {expected} pixels")]
    Short { found: usize, expected: usize },
    #[error("pixel {index} is {found}, expected at most {largest}")]
    Bright { index: usize, found: u64, largest: u64 },
}

/// Decodes a PNG or PGM.
pub(super) fn decode(bytes: &[u8]) -> Result<Image, ImageError> {
    match bytes {
        [0x89, b'P', b'N', b'G', ..] => decode_png(bytes),
        [b'P', b'2' | b'5', ..] => decode_pgm(bytes),
        _ => Err(ImageError::UnknownFormat),
    }
}

/// Checks a size and returns it with the number of pixels.
fn checked(width: u64, height: u64) -> Result<(i32, i32, usize), ImageError> {
    let count = width.saturating_mul(height);
    match (i32::try_from(width), i32::try_from(height), usize::try_from(count)) {
        (Ok(w), Ok(h), Ok(n)) if (1..=MAX_PIXELS).contains(&count) => Ok((w, h, n)),
        _ => Err(ImageError::Size { width, height }),
    }
}

fn decode_png(bytes: &[u8]) -> Result<Image, ImageError> {
    let mut decoder = png::Decoder::new(Cursor::new(bytes));
    decoder.set_transformations(png::Transformations::EXPAND | png::Transformations::STRIP_16);
    let mut reader = decoder.read_info()?;
    let info = reader.info();
    let (width, height, count) = checked(info.width.into(), info.height.into())?;
    let size = reader.output_buffer_size().unwrap_or(usize::MAX).min(count.saturating_mul(4));
    let mut buffer = vec![0; size];
    let frame = reader.next_frame(&mut buffer)?;
    let samples = frame.color_type.samples();
    let pixels: Vec<Pixel> = buffer
        .chunks_exact(samples)
        .take(count)
        .map(|channels| match *channels {
            [grey, alpha] => Pixel { color: [grey; 3], alpha: Some(alpha) },
            [red, green, blue] => Pixel { color: [red, green, blue], alpha: None },
            [red, green, blue, alpha] => Pixel { color: [red, green, blue], alpha: Some(alpha) },
            _ => Pixel::grey(channels[0]),
        })
        .collect();
    if pixels.len() < count {
        return Err(ImageError::Short { found: pixels.len(), expected: count });
    }
    Ok(Image { width, height, pixels })
}

/// Decodes Netpbm's PGM, plain (P2) or raw (P5): netpbm.sourceforge.net/doc/pgm.html. Greys are scaled to 0..255.
fn decode_pgm(bytes: &[u8]) -> Result<Image, ImageError> {
    let mut at = 2;
    let width = header_number(bytes, &mut at).ok_or(ImageError::Header("width"))?;
    let height = header_number(bytes, &mut at).ok_or(ImageError::Header("height"))?;
    let largest = header_number(bytes, &mut at).ok_or(ImageError::Header("largest grey"))?;
    let (width, height, count) = checked(width, height)?;
    if !(1..=65535).contains(&largest) {
        return Err(ImageError::Depth(largest));
    }
    let mut pixels = Vec::new();
    if bytes[1] == b'2' {
        while pixels.len() < count {
            let Some(grey) = header_number(bytes, &mut at) else { break };
            pixels.push(scaled(grey, largest, pixels.len())?);
        }
    } else {
        at += 1; // the one blank after the header
        let wide = if largest > 255 { 2 } else { 1 };
        for sample in bytes.get(at..).unwrap_or(&[]).chunks_exact(wide).take(count) {
            let grey = sample.iter().fold(0, |grey, byte| grey * 256 + u64::from(*byte));
            pixels.push(scaled(grey, largest, pixels.len())?);
        }
    }
    if pixels.len() < count {
        return Err(ImageError::Short { found: pixels.len(), expected: count });
    }
    Ok(Image { width, height, pixels })
}

fn scaled(grey: u64, largest: u64, index: usize) -> Result<Pixel, ImageError> {
    if grey > largest {
        return Err(ImageError::Bright { index, found: grey, largest });
    }
    Ok(Pixel::grey(u8::try_from((grey * 255 + largest / 2) / largest).unwrap_or(u8::MAX)))
}

/// Reads the decimal number after blanks and `#` comments at `at`, which moves behind it.
fn header_number(bytes: &[u8], at: &mut usize) -> Option<u64> {
    loop {
        match bytes.get(*at)? {
            b'#' => *at += bytes[*at..].iter().position(|b| *b == b'\n')?,
            byte if byte.is_ascii_whitespace() => *at += 1,
            _ => break,
        }
    }
    let digits = bytes[*at..].iter().take_while(|b| b.is_ascii_digit()).count();
    let text = std::str::from_utf8(&bytes[*at..*at + digits]).ok()?;
    *at += digits;
    text.parse().ok()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::document::mutation::{edits, mutate};
    use proptest::prelude::*;

    fn greys(image: &Image) -> Vec<u8> {
        image.pixels.iter().map(|pixel| pixel.color[0]).collect()
    }

    #[test]
    fn plain_and_raw_pgm_are_the_same_picture() {
        let plain = decode(b"P2 # map\n3 2\n# CREATOR\n255\n0 100 205\n254 255 7\n").unwrap();
        let raw = decode(b"P5\n3 2\n255\n\x00\x64\xcd\xfe\xff\x07").unwrap();
        assert_eq!(plain, raw);
        assert_eq!((raw.width, raw.height, greys(&raw)), (3, 2, vec![0, 100, 205, 254, 255, 7]));
        let deep = decode(b"P5 2 1 65535\n\x00\x00\xff\xff").unwrap();
        assert_eq!(greys(&deep), [0, 255]);
        assert_eq!(greys(&decode(b"P2 2 1 1\n0 1").unwrap()), [0, 255]);
    }

    #[test]
    fn what_is_wrong_is_said() {
        for (bytes, said) in [
            (&b"GIF89a"[..], "it begins like neither a PNG nor a PGM"),
            (b"P5\n3", "its header has no height"),
            (b"P5\n0 3\n255\n", "it has 0 x 3 pixels, expected 1 to 8388608"),
            (b"P5\n99999 99999\n255\n", "it has 99999 x 99999 pixels, expected 1 to 8388608"),
            (b"P5\n2 2\n255\nabc", "it ends after 3 of 4 pixels"),
            (b"P5\n2 2\n0\nabcd", "its largest grey is 0, expected 1 to 65535"),
            (b"P2\n2 1\n9\n3 10", "pixel 1 is 10, expected at most 9"),
        ] {
            assert_eq!(decode(bytes).unwrap_err().to_string(), said);
        }
    }

    proptest! {
        #[test]
        fn damaged_images_never_panic(edits in edits()) {
            let mut file = Vec::new();
            let mut encoder = png::Encoder::new(&mut file, 6, 5);
            encoder.set_color(png::ColorType::Rgba);
            encoder.write_header().unwrap().write_image_data(&[77; 120]).unwrap();
            for bytes in [&file[..], b"P5\n3 2\n255\n\x00\x64\xcd\xfe\xff\x07", b"P2 3 1 15\n0 9 15"] {
                if let Ok(image) = decode(&mutate(bytes, &edits)) {
                    let area = i64::from(image.width) * i64::from(image.height);
                    prop_assert_eq!(i64::try_from(image.pixels.len()), Ok(area));
                }
            }
        }
    }
}
