//! The logical camera: the tags within its cone, as seen from the base frame.

use crate::geometry::{Bounds, Outline, Point, Pose, Segment};
use crate::robot::{Detection, LogicalCamera};
use crate::world::Tag;
use std::sync::Arc;

/// Whether anything hides a tag.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Occlusion {
    /// Nothing does: Gazebo's logical camera sees through walls.
    None,
    /// Whatever the lidar sees hides what is behind it.
    Walls,
}

/// A logical camera among tags.
#[derive(Debug, Clone)]
pub struct CameraScene<'a> {
    /// The camera as the study uses it.
    pub camera: LogicalCamera,
    /// What it can detect.
    pub tags: &'a [Tag],
    /// Whether anything hides them.
    pub occlusion: Occlusion,
}

#[derive(Debug)]
pub(super) struct Camera {
    model: LogicalCamera,
    tags: Vec<Seen>,
    /// The outlines that hide tags, with their bounds.
    screens: Vec<(Bounds, Outline)>,
    /// Distance and bearing (m, rad) of the tags in view, with their numbers.
    found: Vec<(f64, f64, usize)>,
}

/// A tag as the camera tells of it.
#[derive(Debug)]
struct Seen {
    id: Arc<str>,
    color: Arc<str>,
    pose: Pose,
}

impl Camera {
    /// Creates a camera whose view the `visible` outlines block where `scene` requires it.
    pub(super) fn new(scene: CameraScene<'_>, visible: &[Outline]) -> Self {
        let screens = match scene.occlusion {
            Occlusion::None => Vec::new(),
            Occlusion::Walls => visible.iter().map(|o| (o.bounds(), o.clone())).collect(),
        };
        let seen = |tag: &Tag| Seen {
            id: tag.id.as_str().into(),
            color: tag.color.as_str().into(),
            pose: tag.pose,
        };
        let tags = scene.tags.iter().map(seen).collect();
        Self { model: scene.camera, tags, screens, found: Vec::new() }
    }

    /// Detects tags from the base at `base` and writes them over `detections`: nearest first, then from right to left.
    /// The order, like all else but the ids themselves, does not depend on ids.
    pub(super) fn look(&mut self, base: Pose, detections: &mut Vec<Detection>) {
        detections.clear();
        self.found.clear();
        let eye = base.compose(self.model.mount);
        for (number, tag) in self.tags.iter().enumerate() {
            let at = tag.pose.position();
            // The square first: most tags are far away.
            let far = self.model.far;
            if (at.x - eye.x).abs() > far || (at.y - eye.y).abs() > far {
                continue;
            }
            if self.model.covers(base.inverse_transform(at)) && !self.is_hidden(eye.position(), at)
            {
                let seen = eye.inverse_transform(at);
                self.found.push((seen.norm(), crate::math::atan2(seen.y, seen.x), number));
            }
        }
        let tags = &self.tags;
        self.found.sort_unstable_by(|a, b| {
            let same_place = a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1));
            let (a_number, b_number) = (a.2, b.2);
            let (a, b) = (&tags[a_number], &tags[b_number]);
            same_place
                .then_with(|| a.pose.heading.total_cmp(&b.pose.heading))
                .then_with(|| a.color.cmp(&b.color))
                .then(a_number.cmp(&b_number))
        });
        for &(_, _, number) in &self.found {
            let tag = &self.tags[number];
            detections.push(Detection {
                id: Arc::clone(&tag.id),
                color: Arc::clone(&tag.color),
                pose: base.relative(tag.pose),
            });
        }
    }

    /// Returns whether a screen stands between `eye` and `tag`. A tag on a wall's face is not behind it.
    fn is_hidden(&self, eye: Point, tag: Point) -> bool {
        const ON_THE_FACE: f64 = 1e-6;
        let distance = eye.distance(tag);
        if distance <= ON_THE_FACE {
            return false;
        }
        let sight = Bounds::EMPTY.including(eye).including(tag);
        let direction = (tag - eye) * (1.0 / distance);
        self.screens.iter().any(|(bounds, outline)| {
            let apart = bounds.min.x > sight.max.x
                || bounds.max.x < sight.min.x
                || bounds.min.y > sight.max.y
                || bounds.max.y < sight.min.y;
            !apart
                && match outline {
                    Outline::Circle { center, radius } => {
                        Segment::new(eye, tag).distance(*center) < radius - ON_THE_FACE
                    }
                    Outline::Polygon(_) => outline.sides().any(|side| {
                        side.ray_range(eye, direction)
                            .is_some_and(|range| range < distance - ON_THE_FACE)
                    }),
                }
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn model() -> LogicalCamera {
        LogicalCamera {
            name: "ids".into(),
            mount: Pose::new(0.1, 0.0, 0.0),
            near: 0.05,
            far: 6.0,
            horizontal_fov: 2.1,
            rate_hz: 10.0,
        }
    }

    fn tag(id: &str, x: f64, y: f64) -> Tag {
        Tag { id: id.into(), color: "green".into(), pose: Pose::new(x, y, 0.5) }
    }

    fn seen(tags: &[Tag], visible: &[Outline], occlusion: Occlusion, base: Pose) -> Vec<Detection> {
        let scene = CameraScene { camera: model(), tags, occlusion };
        let mut detections = Vec::new();
        Camera::new(scene, visible).look(base, &mut detections);
        detections
    }

    fn ids(detections: &[Detection]) -> Vec<&str> {
        detections.iter().map(|detection| &*detection.id).collect()
    }

    #[test]
    fn the_cone_begins_at_the_camera_and_ends_where_the_urdf_says() {
        let edge = 1.05_f64;
        let at = |angle: f64, range: f64| {
            let (sin, cos) = crate::math::sin_cos(angle);
            (0.1 + range * cos, range * sin)
        };
        for (angle, range, expected) in [
            (0.0, 5.99, true),
            (0.0, 6.01, false),
            (0.0, 0.06, true),
            (0.0, 0.04, false),
            (edge - 0.01, 3.0, true),
            (edge + 0.01, 3.0, false),
            (-edge + 0.01, 3.0, true),
            (-edge - 0.01, 3.0, false),
            (std::f64::consts::PI, 1.0, false),
        ] {
            let (x, y) = at(angle, range);
            let detections = seen(&[tag("a", x, y)], &[], Occlusion::None, Pose::default());
            assert_eq!(!detections.is_empty(), expected, "{angle} {range}");
        }
    }

    #[test]
    fn detections_are_in_the_base_frame_nearest_first_and_carry_id_colour_and_pose_alone() {
        let tags = [tag("far", 1.0, 6.0), tag("near", 1.0, 4.0), tag("behind", 1.0, 0.0)];
        let base = Pose::new(1.0, 2.0, std::f64::consts::FRAC_PI_2);
        let detections = seen(&tags, &[], Occlusion::None, base);
        assert_eq!(ids(&detections), ["near", "far"]);
        let pose = detections[0].pose;
        assert!((pose.x - 2.0).abs() < 1e-12 && pose.y.abs() < 1e-12);
        assert!((pose.heading - (0.5 - std::f64::consts::FRAC_PI_2)).abs() < 1e-12);
        assert_eq!(&*detections[0].color, "green");
    }

    #[test]
    fn permuted_ids_change_nothing_but_the_ids() {
        // Two pairs at equal distance, and two tags at the same place with different colours.
        let places = [(2.0, 1.0), (2.0, -1.0), (3.0, 0.5), (3.0, -0.5), (4.0, 0.0), (4.0, 0.0)];
        let with = |names: [&str; 6]| {
            let mut tags: Vec<Tag> =
                names.iter().zip(places).map(|(id, (x, y))| tag(id, x, y)).collect();
            tags[5].color = "red".into();
            // As a world lists them.
            tags.sort_by(|a, b| a.id.cmp(&b.id));
            seen(&tags, &[], Occlusion::None, Pose::default())
        };
        let first = with(["a", "b", "c", "d", "e", "f"]);
        let second = with(["f", "c", "e", "a", "d", "b"]);
        assert_eq!(first.len(), 6);
        for (a, b) in first.iter().zip(&second) {
            assert_eq!((&a.color, a.pose), (&b.color, b.pose));
        }
    }

    #[test]
    fn walls_hide_tags_only_where_they_are_told_to() {
        let wall = Outline::rectangle(Point::new(2.0, 1.0), 0.2, 2.0, 0.0);
        let pillar = Outline::Circle { center: Point::new(2.0, -1.5), radius: 0.3 };
        let tags =
            [tag("behind-wall", 4.0, 1.0), tag("on-its-face", 1.9, 0.5), tag("beside", 4.0, -0.5)];
        let visible = [wall, pillar];
        let clear = seen(&tags, &visible, Occlusion::Walls, Pose::default());
        assert_eq!(ids(&clear), ["on-its-face", "beside"]);
        assert_eq!(seen(&tags, &visible, Occlusion::None, Pose::default()).len(), 3);
        let hidden = [tag("behind-pillar", 4.0, -3.0), tag("before-it", 1.2, -0.9)];
        let clear = seen(&hidden, &visible, Occlusion::Walls, Pose::default());
        assert_eq!(ids(&clear), ["before-it"]);
    }
}
