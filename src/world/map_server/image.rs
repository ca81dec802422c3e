//! Images in `map_server`'s form: colours of 8 bits, perhaps with alpha, row by row from the top.

mod netpbm;

use std::io::Cursor;
use thiserror::Error;

/// Largest image read (pixels): a map of 2896 by 2896. Reading takes 17 bytes a pixel, and is to take less than 200 MB.
const MAX_PIXELS: u64 = 1 << 23;

/// One pixel.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::world) struct Pixel {
    pub(in crate::world) color: [u8; 3],
    pub(in crate::world) alpha: Option<u8>,
}

impl Pixel {
    const fn grey(grey: u8) -> Self {
        Self { color: [grey; 3], alpha: None }
    }

    pub(in crate::world) fn color_sum(self) -> f64 {
        self.color.iter().map(|channel| f64::from(*channel)).sum()
    }
}

/// A decoded image of at least one pixel.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(in crate::world) struct Image {
    pub(in crate::world) width: i32,
    pub(in crate::world) height: i32,
    pub(in crate::world) pixels: Vec<Pixel>,
}

/// Why bytes are no image.
#[derive(Debug, Error)]
pub(in crate::world) enum ImageError {
    #[error("it begins like neither a PNG nor a picture of Netpbm (PGM, PPM, PBM)")]
    UnknownFormat,
    #[error("it is a {0}, which is not read")]
    Foreign(&'static str),
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

impl ImageError {
    /// Returns what to do about it, for the image `name`.
    pub(in crate::world) fn help(&self, name: &str) -> String {
        match self {
            Self::Foreign(_) => {
                let stem = name.rsplit_once('.').map_or(name, |(stem, _)| stem);
                format!(
                    "convert it (`convert {name} {stem}.png` of ImageMagick) and name `{stem}.png`"
                )
            }
            _ => "expected an 8 or 16 bit PNG, or a PGM, PPM or PBM (P1 to P6)".to_owned(),
        }
    }
}

/// Decodes a PNG or a picture of Netpbm.
pub(in crate::world) fn decode(bytes: &[u8]) -> Result<Image, ImageError> {
    match bytes {
        [0x89, b'P', b'N', b'G', ..] => decode_png(bytes),
        [b'P', b'1'..=b'6', ..] => netpbm::decode(bytes),
        [0xff, 0xd8, 0xff, ..] => Err(ImageError::Foreign("JPEG")),
        [b'B', b'M', ..] => Err(ImageError::Foreign("BMP")),
        [b'G', b'I', b'F', b'8', ..] => Err(ImageError::Foreign("GIF")),
        [b'I', b'I', 42, 0, ..] | [b'M', b'M', 0, 42, ..] => Err(ImageError::Foreign("TIFF")),
        [b'R', b'I', b'F', b'F', _, _, _, _, b'W', b'E', b'B', b'P', ..] => {
            Err(ImageError::Foreign("WebP"))
        }
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::document::mutation::{edits, mutate};
    use proptest::prelude::*;

    #[test]
    fn colours_and_bits_of_netpbm_are_read() {
        let plain = decode(b"P3\n2 1\n255\n10 20 30  255 0 7\n").unwrap();
        let raw = decode(b"P6 2 1 255\n\x0a\x14\x1e\xff\x00\x07").unwrap();
        assert_eq!(plain, raw);
        assert_eq!(raw.pixels[0].color, [10, 20, 30]);
        // A one is black; rows of raw bits fill bytes.
        let bits = decode(b"P1 # walls\n3 2\n1 0 1\n010").unwrap();
        assert_eq!(greys(&bits), [0, 255, 0, 255, 0, 255]);
        assert_eq!(decode(b"P4\n3 2\n\xa0\x40").unwrap(), bits);
        let wide = decode(b"P4 9 1\n\x00\x80").unwrap();
        assert_eq!(greys(&wide), [255, 255, 255, 255, 255, 255, 255, 255, 0]);
    }

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
            (&b"GIF89a"[..], "it is a GIF, which is not read"),
            (b"\xff\xd8\xff\xe0", "it is a JPEG, which is not read"),
            (b"BM6", "it is a BMP, which is not read"),
            (b"%PDF", "it begins like neither a PNG nor a picture of Netpbm (PGM, PPM, PBM)"),
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
            for bytes in [&file[..], b"P5\n3 2\n255\n\x00\x64\xcd\xfe\xff\x07", b"P2 3 1 15\n0 9 15", b"P4 9 1\n\x00\x80", b"P6 1 1 9\nabc"] {
                if let Ok(image) = decode(&mutate(bytes, &edits)) {
                    let area = i64::from(image.width) * i64::from(image.height);
                    prop_assert_eq!(i64::try_from(image.pixels.len()), Ok(area));
                }
            }
        }
    }
}
