//! The physics engine's only door: a dynamic body that cannot pass through walls.
//!
//! rapier2d, 64 bit, enhanced determinism. The body is dynamic with its velocity set every step: kinematic
//! bodies go straight through walls.

use super::PHYSICS_PERIOD;
use crate::geometry::{Outline, Point, Pose};
use crate::math;
use crate::robot::{Robot, Twist};
use rapier2d::prelude::{
    ColliderBuilder, ColliderHandle, PhysicsWorld, RigidBodyBuilder, RigidBodyHandle, Vector,
};

/// One robot among fixed things.
pub(super) struct Engine {
    world: PhysicsWorld,
    body: RigidBodyHandle,
    shell: ColliderHandle,
    /// The heading as an angle; the engine keeps it as a rotation.
    pose: Pose,
}

impl std::fmt::Debug for Engine {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Engine").field("pose", &self.pose).finish_non_exhaustive()
    }
}

impl Engine {
    /// `robot` at rest at `start` among the fixed `solid` outlines.
    pub(super) fn new(solid: &[Outline], robot: &Robot, start: Pose) -> Self {
        let mut world = PhysicsWorld::new();
        // Seen from above: nothing falls.
        world.gravity = Vector::ZERO;
        world.integration_parameters.dt = PHYSICS_PERIOD.seconds().get();
        for outline in solid {
            if let Some((collider, center)) = collider(outline) {
                let fixed = RigidBodyBuilder::fixed().translation(vector(center));
                world.insert(fixed, collider.friction(0.0).restitution(0.0));
            }
        }
        let body = RigidBodyBuilder::dynamic()
            .translation(Vector::new(start.x, start.y))
            .rotation(start.heading)
            .can_sleep(false);
        let shell = collider(&robot.footprint).map_or_else(
            || ColliderBuilder::ball(robot.circumscribed_radius()),
            |(collider, center)| collider.translation(vector(center)),
        );
        let (body, shell) =
            world.insert(body, shell.friction(0.0).restitution(0.0).mass(robot.mass.max(1.0)));
        Self { world, body, shell, pose: start }
    }

    /// Advances one physics step with the body's velocity set to `twist`.
    pub(super) fn step(&mut self, twist: Twist) {
        let (sin, cos) = math::sin_cos(self.pose.heading);
        let body = &mut self.world.bodies[self.body];
        body.set_linvel(Vector::new(twist.linear * cos, twist.linear * sin), true);
        body.set_angvel(twist.angular, true);
        self.world.step();
        let body = &self.world.bodies[self.body];
        let (at, turned) = (body.translation(), body.rotation());
        self.pose = Pose::new(at.x, at.y, math::atan2(turned.im, turned.re));
    }

    /// The pose in the world's frame.
    pub(super) fn pose(&self) -> Pose {
        self.pose
    }

    /// Whether the body touches something: a contact point at no distance or pressed upon, not merely a near
    /// one (the engine tracks points up to 2 cm away, and measures them before the step).
    pub(super) fn is_touching(&self) -> bool {
        self.world
            .contact_pairs_with(self.shell)
            .flat_map(rapier2d::prelude::ContactPair::manifolds)
            .flat_map(|manifold| &manifold.points)
            .any(|point| point.dist <= 0.0 || point.data.impulse > 0.0)
    }
}

/// A collider in the shape of `outline` about the returned centre; `None` for degenerate outlines.
fn collider(outline: &Outline) -> Option<(ColliderBuilder, Point)> {
    match outline {
        Outline::Circle { center, radius } => Some((ColliderBuilder::ball(*radius), *center)),
        Outline::Polygon(corners) => {
            let bounds = outline.bounds();
            let center = (bounds.min + bounds.max) * 0.5;
            let local: Vec<Vector> = corners.iter().map(|&c| vector(c - center)).collect();
            let collider = if is_convex(corners) {
                ColliderBuilder::convex_hull(&local)?
            } else {
                let count = u32::try_from(local.len()).ok()?;
                let sides: Vec<[u32; 2]> = (0..count).map(|i| [i, (i + 1) % count]).collect();
                ColliderBuilder::convex_decomposition(&local, &sides)
            };
            Some((collider, center))
        }
    }
}

fn is_convex(corners: &[Point]) -> bool {
    let turn = |i: usize| {
        let n = corners.len();
        let (a, b, c) = (corners[i], corners[(i + 1) % n], corners[(i + 2) % n]);
        (b - a).cross(c - b)
    };
    (0..corners.len()).all(|i| turn(i) >= 0.0) || (0..corners.len()).all(|i| turn(i) <= 0.0)
}

fn vector(point: Point) -> Vector {
    Vector::new(point.x, point.y)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::robot::{Drive, DriveKind};

    fn disc() -> Robot {
        Robot {
            name: "disc".into(),
            footprint: Outline::Circle { center: Point::ZERO, radius: 0.2 },
            body_z: [0.0, 0.4],
            mass: 5.0,
            drive: Drive {
                kind: DriveKind::Differential,
                wheel_separation: 0.23,
                wheel_diameter: 0.07,
                max_linear: None,
                max_angular: None,
            },
            lidar: None,
            camera: None,
            compass: None,
        }
    }

    fn run(engine: &mut Engine, twist: Twist, steps: usize) {
        for _ in 0..steps {
            engine.step(twist);
        }
    }

    #[test]
    fn a_free_body_goes_where_it_is_driven() {
        let mut engine = Engine::new(&[], &disc(), Pose::new(1.0, 2.0, 0.0));
        run(&mut engine, Twist { linear: 1.0, angular: 0.0 }, 100);
        assert!((engine.pose().x - 2.0).abs() < 1e-9 && (engine.pose().y - 2.0).abs() < 1e-9);
        run(&mut engine, Twist { linear: 0.0, angular: 1.0 }, 100);
        assert!((engine.pose().heading - 1.0).abs() < 1e-4, "{}", engine.pose().heading);
    }

    #[test]
    fn a_quarter_circle_ends_where_geometry_says() {
        let mut engine = Engine::new(&[], &disc(), Pose::default());
        run(&mut engine, Twist { linear: 1.0, angular: 1.0 }, 157);
        let end = engine.pose();
        assert!((end.x - 1.0).abs() < 0.01 && (end.y - 1.0).abs() < 0.01, "{end:?}");
    }

    #[test]
    fn a_wall_stops_the_body_head_on_and_lets_it_slide_along() {
        let wall = [Outline::rectangle(Point::new(2.0, 0.0), 0.2, 20.0, 0.0)];
        let mut engine = Engine::new(&wall, &disc(), Pose::default());
        run(&mut engine, Twist { linear: 1.0, angular: 0.0 }, 500);
        assert!(engine.pose().x < 1.71 && engine.pose().x > 1.68, "{}", engine.pose().x);
        assert!(engine.is_touching());

        let mut engine = Engine::new(&wall, &disc(), Pose::new(1.6, 0.0, 1.2));
        run(&mut engine, Twist { linear: 1.0, angular: 0.0 }, 300);
        assert!(engine.pose().x < 1.72 && engine.pose().y > 2.0, "{:?}", engine.pose());
    }

    #[test]
    fn nearness_is_not_contact() {
        let wall = [Outline::rectangle(Point::new(0.31, 0.0), 0.2, 2.0, 0.0)];
        let mut engine = Engine::new(&wall, &disc(), Pose::default());
        engine.step(Twist::STOP);
        assert!(!engine.is_touching(), "1 cm away");
    }
}
