use super::*;
use crate::document::mutation::{edits, mutate};
use crate::grid::Cell;
use crate::world::originals;
use Occupancy::{Free, Occupied, Unknown};
use proptest::prelude::*;

const YAML: &str = "image: a.png\nresolution: 0.1\norigin: [-11.9, -7.1, 0.0]\n\
                    occupied_thresh: 0.65\nfree_thresh: 0.196\nnegate: 0\n";

/// Returns the cells of a one-row image of `pixels`, read under the descriptor `yaml`.
fn cells(yaml: &str, color: png::ColorType, pixels: &[u8], options: Options) -> Vec<Occupancy> {
    let mut file = Vec::new();
    let count = u32::try_from(pixels.len() / color.samples()).unwrap();
    let mut encoder = png::Encoder::new(&mut file, count, 1);
    encoder.set_color(color);
    encoder.write_header().unwrap().write_image_data(pixels).unwrap();
    read(&Source::new("m.yaml", yaml), "a.png", &file, options).unwrap().values().to_vec()
}

#[test]
fn the_top_of_the_image_is_north() {
    let image = b"P2 2 3 255\n 0 254  254 254  205 0\n";
    let map = read(&Source::new("m.yaml", YAML), "a.pgm", image, Options::default()).unwrap();
    let frame = map.frame();
    assert_eq!((frame.width, frame.height, frame.resolution), (2, 3, 0.1));
    assert_eq!(frame.origin, Point::new(-11.9, -7.1));
    assert_eq!(map.values(), [Unknown, Occupied, Free, Free, Occupied, Free]);
    assert_eq!(map.at(Cell::new(0, 2)), Occupied);
    assert_eq!(image_path(&Source::new("m.yaml", YAML)).unwrap(), "a.png");
}

#[test]
fn thresholds_are_map_servers() {
    let grey = |greys: &[u8]| cells(YAML, png::ColorType::Grayscale, greys, Options::default());
    assert_eq!(
        grey(&[0, 89, 90, 205, 206, 255]),
        [Occupied, Occupied, Unknown, Unknown, Free, Free]
    );
    // Averaging the alpha channel moves the thresholds for opaque images to 34 and 188.
    let opaque: Vec<u8> = [33, 34, 188, 189, 205].iter().flat_map(|g| [*g, *g, *g, 255]).collect();
    assert_eq!(
        cells(YAML, png::ColorType::Rgba, &opaque, Options::default()),
        [Occupied, Unknown, Unknown, Free, Free]
    );
    assert_eq!(
        cells(YAML, png::ColorType::Rgba, &opaque, Options { average_alpha: false }),
        [Occupied, Occupied, Unknown, Unknown, Unknown]
    );
    let negated = YAML.replace("negate: 0", "negate: 1");
    assert_eq!(
        cells(&negated, png::ColorType::Grayscale, &[0, 100, 255], Options::default()),
        [Free, Unknown, Occupied]
    );
}

#[test]
fn scale_and_raw_are_cut_in_the_middle() {
    let scale = YAML.to_owned() + "mode: scale\n";
    // Half way between the thresholds lies a darkness of 0.423, a grey of 147.
    assert_eq!(
        cells(&scale, png::ColorType::Grayscale, &[0, 146, 148, 255], Options::default()),
        [Occupied, Occupied, Free, Free]
    );
    assert_eq!(
        cells(&scale, png::ColorType::GrayscaleAlpha, &[147, 0], Options::default()),
        [Unknown]
    );
    let raw = YAML.to_owned() + "mode: raw\n";
    assert_eq!(
        cells(&raw, png::ColorType::Grayscale, &[0, 49, 50, 100, 101, 255], Options::default()),
        [Free, Free, Occupied, Occupied, Unknown, Unknown]
    );
}

#[test]
fn faults_say_where() {
    let fault = |from: &str, to: &str| {
        let source = Source::new("m.yaml", YAML.replace(from, to));
        let faults = read(&source, "a.pgm", b"P2 1 1 1\n0", Options::default()).unwrap_err();
        faults.iter().map(|fault| fault.render(false)).collect::<String>()
    };
    assert_eq!(
        fault("resolution: 0.1", "resolution: -0.1"),
        "\
error: resolution out of range
 --> m.yaml:2:13
  |
2 | resolution: -0.1
  |             ^^^^ expected metres per pixel, above zero
"
    );
    assert!(fault(", 0.0]", ", 0.5]").contains("turned maps cannot be read"));
    assert!(
        fault("free_thresh: 0.196", "free_thresh: 0.7")
            .contains("expected a number above free_thresh")
    );
    assert!(fault("negate: 0", "negate: 2").contains("expected 0 or 1"));
    assert!(fault("resolution: 0.1", "resolutoin: 0.1").contains("resolution"));
    let source = Source::new("m.yaml", YAML);
    let faults = read(&source, "maps/a.gif", b"GIF89a", Options::default()).unwrap_err();
    assert_eq!(
        faults[0].render(false),
        "error: cannot read the image `maps/a.gif`: it begins like neither a PNG nor a PGM\n |\n \
         = help: expected an 8 or 16 bit PNG, or a PGM (P2 or P5)\n"
    );
}

/// Checks the cells counted by the authors' maps: occupied, free.
#[test]
fn the_original_maps_hold_the_published_counts() {
    let Some(folder) = originals::folder("the_original_maps_hold_the_published_counts") else {
        return;
    };
    for (name, occupied, free) in [
        ("basic_no_furniture", 1290, 14860),
        ("basic", 1868, 12770),
        ("office", 13428, 181_228),
        ("closed", 13116, 144_004),
    ] {
        let yaml = originals::source(&folder.join(format!("maps/{name}.yaml")));
        let path = image_path(&yaml).unwrap();
        let image = std::fs::read(folder.join("maps").join(&path)).unwrap();
        let map = read(&yaml, &path, &image, Options::default()).unwrap();
        assert_eq!((map.count(Occupied), map.count(Free)), (occupied, free), "{name}");
    }
    // The previous map t1: its greys of 205 are free with the alpha channel averaged, unknown without.
    let yaml =
        originals::source(&folder.join("priors/blueprint_map_server_sequential_t1_map.yaml"));
    let path = image_path(&yaml).unwrap();
    let image = std::fs::read(folder.join("priors").join(&path)).unwrap();
    let map = read(&yaml, &path, &image, Options::default()).unwrap();
    assert_eq!((map.count(Occupied), map.count(Free), map.count(Unknown)), (1868, 17322, 0));
    let plain = read(&yaml, &path, &image, Options { average_alpha: false }).unwrap();
    assert!(plain.count(Unknown) > 4000);
}

proptest! {
    #[test]
    fn damaged_descriptors_never_panic(edits in edits()) {
        let text = String::from_utf8_lossy(&mutate(YAML.as_bytes(), &edits)).into_owned();
        if let Ok(map) = read(&Source::new("m.yaml", text), "a.pgm", b"P2 1 1 1\n0", Options::default()) {
            prop_assert_eq!(map.values().len(), 1);
        }
    }
}
