//! Pictures of Netpbm (netpbm.sourceforge.net/doc): bits, greys and colours, plain (P1 to P3) or raw (P4 to P6). Greys and
//! colours are scaled to 0..255.

use super::{Image, ImageError, Pixel, checked};

/// Decodes a picture that begins with `P1` to `P6`.
pub(super) fn decode(bytes: &[u8]) -> Result<Image, ImageError> {
    let mut at = 2;
    let width = number(bytes, &mut at).ok_or(ImageError::Header("width"))?;
    let height = number(bytes, &mut at).ok_or(ImageError::Header("height"))?;
    let kind = bytes[1];
    let has_bits = matches!(kind, b'1' | b'4');
    let largest = if has_bits {
        1
    } else {
        number(bytes, &mut at).ok_or(ImageError::Header("largest grey"))?
    };
    let (width, height, count) = checked(width, height)?;
    if !(1..=65535).contains(&largest) {
        return Err(ImageError::Depth(largest));
    }
    // The one blank after the header.
    let raw = bytes.get(at + 1..).unwrap_or(&[]);
    let channels = if matches!(kind, b'3' | b'6') { 3 } else { 1 };
    let samples: Vec<u32> = match kind {
        b'1' => {
            let digits = bytes[at..].iter().filter(|byte| matches!(byte, b'0' | b'1'));
            digits.take(count).map(|digit| u32::from(*digit == b'0')).collect()
        }
        b'4' => {
            let row = usize::try_from(width).unwrap_or(1);
            let rows = raw.chunks_exact(row.div_ceil(8));
            let bit = |bytes: &[u8], x: usize| u32::from(bytes[x / 8] >> (7 - x % 8) & 1 == 0);
            rows.flat_map(|bytes| (0..row).map(move |x| bit(bytes, x))).take(count).collect()
        }
        b'2' | b'3' => {
            let samples = std::iter::from_fn(|| number(bytes, &mut at)).take(count * channels);
            samples.map(|sample| u32::try_from(sample).unwrap_or(u32::MAX)).collect()
        }
        _ => {
            let wide = if largest > 255 { 2 } else { 1 };
            let samples = raw.chunks_exact(wide).take(count * channels);
            samples.map(|s| s.iter().fold(0, |grey, byte| grey * 256 + u32::from(*byte))).collect()
        }
    };
    if let Some(index) = samples.iter().position(|sample| u64::from(*sample) > largest) {
        let found = u64::from(samples[index]);
        return Err(ImageError::Bright { index: index / channels, found, largest });
    }
    let scaled = |sample: u32| {
        u8::try_from((u64::from(sample) * 255 + largest / 2) / largest).unwrap_or(u8::MAX)
    };
    let pixels: Vec<Pixel> = samples
        .chunks_exact(channels)
        .map(|sample| match *sample {
            [red, green, blue] => {
                Pixel { color: [scaled(red), scaled(green), scaled(blue)], alpha: None }
            }
            _ => Pixel::grey(scaled(sample[0])),
        })
        .collect();
    if pixels.len() < count {
        return Err(ImageError::Short { found: pixels.len(), expected: count });
    }
    Ok(Image { width, height, pixels })
}

/// Reads the decimal number after blanks and `#` comments at `at`, which moves behind it.
fn number(bytes: &[u8], at: &mut usize) -> Option<u64> {
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
