use super::*;
use crate::document::mutation::{edits, mutate};
use crate::geometry::Point;
use crate::grid::{Cell, Occupancy};
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
    assert_eq!(Descriptor::read(&Source::new("m.yaml", YAML)).unwrap().image(), "a.png");
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
    assert_eq!(
        fault(", 0.0]", ", 90]"),
        "\
error: the map is turned by more than once around
 --> m.yaml:3:23
  |
3 | origin: [-11.9, -7.1, 90]
  |                       ^^ expected a yaw in radians: is this in degrees?
"
    );
    assert!(
        fault("free_thresh: 0.196", "free_thresh: 0.7")
            .contains("expected a number above free_thresh")
    );
    assert!(fault("negate: 0", "negate: 2").contains("expected 0, 1, true or false"));
    assert!(fault("resolution: 0.1", "resolutoin: 0.1").contains("`resolution`"));
    let source = Source::new("m.yaml", YAML);
    let image = |bytes: &[u8]| {
        let faults = read(&source, "maps/a.gif", bytes, Options::default()).unwrap_err();
        faults[0].render(false)
    };
    assert_eq!(
        image(b"GIF89a"),
        "error: cannot read the image `maps/a.gif`: it is a GIF, which is not read\n |\n \
         = help: convert it (`convert maps/a.gif maps/a.png` of ImageMagick) and name `maps/a.png`\n"
    );
    assert_eq!(
        image(b"%PDF"),
        "error: cannot read the image `maps/a.gif`: it begins like neither a PNG nor a picture of Netpbm (PGM, PPM, PBM)\n |\n \
         = help: expected an 8 or 16 bit PNG, or a PGM, PPM or PBM (P1 to P6)\n"
    );
}

/// Checks what Nav2's own maps hold: keys of other programs, truth values, a byte order mark, an origin that is turned.
#[test]
fn descriptors_of_other_programs_are_read() {
    let text = format!("\u{feff}{YAML}map_type: occupancy\nocupied_thresh: 0.5\n");
    let text = text.replace("negate: 0", "negate: true");
    let descriptor = Descriptor::read(&Source::new("m.yaml", text)).unwrap();
    let warnings: String = descriptor.warnings().iter().map(|fault| fault.render(false)).collect();
    assert_eq!(
        warnings,
        "\
warning: `map_type` means nothing to a map
 --> m.yaml:7:1
  |
7 | map_type: occupancy
  | ^^^^^^^^ left out, as in ROS
  |
  = help: known: image, resolution, origin, occupied_thresh, free_thresh, negate, mode
warning: `ocupied_thresh` means nothing to a map
 --> m.yaml:8:1
  |
8 | ocupied_thresh: 0.5
  | ^^^^^^^^^^^^^^ left out, as in ROS
  |
  = help: did you mean `occupied_thresh`? (known: image, resolution, origin, occupied_thresh, free_thresh, negate, mode)
"
    );
    let map = descriptor.map("a.pgm", b"P2 3 1 255\n0 255 128\n", Options::default()).unwrap();
    assert_eq!(map.values(), [Free, Occupied, Unknown]);

    let turned = YAML.replace("0.0]", "1.5707963]");
    let source = Source::new("m.yaml", turned);
    let map = read(&source, "a.pgm", b"P2 2 1 255\n0 254\n", Options::default()).unwrap();
    // Its row stands upright, to the left of where it began.
    assert_eq!((map.frame().width, map.frame().height), (1, 2));
    assert!(map.frame().origin.distance(Point::new(-12.0, -7.1)) < 1e-6);
    assert_eq!(map.values(), [Occupied, Free]);
}

#[test]
fn a_map_that_is_mostly_wall_is_doubted() {
    let doubt = |text: &str| {
        let descriptor = Descriptor::read(&Source::new("m.yaml", text)).unwrap();
        let map = descriptor.map("a.png", b"P2 4 1 255\n0 254 254 254\n", Options::default());
        descriptor.doubt(&map.unwrap()).map(|fault| fault.render(false))
    };
    assert_eq!(doubt(YAML), None);
    assert_eq!(
        doubt(&YAML.replace("negate: 0", "negate: 1")).unwrap(),
        "\
warning: the map of `a.png` is mostly wall
 --> m.yaml:6:1
  |
6 | negate: 1
  | ^^^^^^ 3 cells are occupied and 1 free
  |
  = help: in most maps white is free: is `negate` the wrong way round, or a threshold?
"
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
        let path = Descriptor::read(&yaml).unwrap().image().to_owned();
        let image = std::fs::read(folder.join("maps").join(&path)).unwrap();
        let map = read(&yaml, &path, &image, Options::default()).unwrap();
        assert_eq!((map.count(Occupied), map.count(Free)), (occupied, free), "{name}");
    }
    // The previous map t1: its greys of 205 are free with the alpha channel averaged, unknown without.
    let yaml =
        originals::source(&folder.join("priors/blueprint_map_server_sequential_t1_map.yaml"));
    let path = Descriptor::read(&yaml).unwrap().image().to_owned();
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
            // A cell that is turned lies in up to four.
            prop_assert!((1..=4).contains(&map.values().len()), "{}", map.values().len());
        }
    }
}
