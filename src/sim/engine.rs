//! The physics engine's only door: a dynamic body that cannot pass through walls.
//!
//! rapier2d, 64 bit, enhanced determinism. The body is dynamic with its velocity set every step: kinematic
//! bodies go straight through walls.
//!
//! Where nothing is near, the engine moves a body freely: it integrates the velocity in substeps. That is done here, in the
//! engine's own arithmetic and to the same bits, and the engine runs only where something is near, which is an order of
//! magnitude cheaper in a building. In a contact the state that the engine keeps of the pair differs by a fraction of a
//! millimetre from what it would be had the engine run all the way.

use super::PHYSICS_PERIOD;
use crate::geometry::{Bounds, Outline, Point, Pose};
use crate::math;
use crate::robot::{Robot, Twist};
use rapier2d::math::{Pose as Isometry, Rotation};
use rapier2d::prelude::{
    ColliderBuilder, ColliderHandle, PhysicsWorld, RigidBodyBuilder, RigidBodyHandle, Vector,
};

/// The margin around a body (m) within which something may act on it: points of contact are predicted 2 cm ahead.
const VIGILANCE: f64 = 0.05;
/// Shortest distance travelled (m) after which nearness is tested again for a body near something.
const PATIENCE: f64 = 0.02;

/// One robot among fixed things.
pub(super) struct Engine {
    world: PhysicsWorld,
    body: RigidBodyHandle,
    shell: ColliderHandle,
    /// The heading as an angle; the engine keeps it as a rotation.
    pose: Pose,
    /// The position as the engine keeps it.
    isometry: Isometry,
    /// The engine runs where the bounds of something are this near (m): [`VIGILANCE`], but in tests.
    vigilance: f64,
    /// Bounds of what is solid, and how far the body reaches around its origin (m).
    bounds: Vec<Bounds>,
    reach: f64,
    /// Whether the bounds of something may be near, and the distance travelled (m) for which that holds.
    near: bool,
    holds_for: f64,
}

impl std::fmt::Debug for Engine {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Engine").field("pose", &self.pose).finish_non_exhaustive()
    }
}

impl Engine {
    /// Places `robot` at rest at `start` among the fixed `solid` outlines.
    pub(super) fn new(solid: &[Outline], robot: &Robot, start: Pose) -> Self {
        Self::watching(solid, robot, start, VIGILANCE)
    }

    fn watching(solid: &[Outline], robot: &Robot, start: Pose, vigilance: f64) -> Self {
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
        let isometry = *world.bodies[body].position();
        Self {
            world,
            body,
            shell,
            pose: start,
            isometry,
            vigilance,
            bounds: solid.iter().map(Outline::bounds).collect(),
            reach: robot.circumscribed_radius(),
            near: true,
            holds_for: 0.0,
        }
    }

    /// Advances one physics step with the body's velocity set to `twist`, and returns how it moved, in its own frame.
    pub(super) fn step(&mut self, twist: Twist) -> Pose {
        let (from, rotation) = (self.isometry.translation, self.isometry.rotation);
        let (cos, sin) = (rotation.re, rotation.im);
        let velocity = Vector::new(twist.linear * cos, twist.linear * sin);
        if self.is_near(twist.linear) {
            self.ask(velocity, twist.angular);
        } else {
            self.fly(velocity, twist.angular);
        }
        let (at, turned) = (self.isometry.translation, self.isometry.rotation);
        let heading = math::atan2(turned.im, turned.re);
        let (dx, dy) = (at.x - from.x, at.y - from.y);
        let turn = math::wrap_angle(heading - self.pose.heading);
        self.pose = Pose::new(at.x, at.y, heading);
        Pose::new(cos * dx + sin * dy, cos * dy - sin * dx, turn)
    }

    /// Runs one step of the engine.
    fn ask(&mut self, velocity: Vector, turning: f64) {
        let body = &mut self.world.bodies[self.body];
        if *body.position() != self.isometry {
            body.set_position(self.isometry, true);
        }
        body.set_linvel(velocity, true);
        body.set_angvel(turning, true);
        self.world.step();
        self.isometry = *self.world.bodies[self.body].position();
    }

    /// Advances a body that nothing is near to by one step, in the engine's arithmetic: about the centre of mass, in as
    /// many substeps, each with a linearised turn.
    fn fly(&mut self, velocity: Vector, turning: f64) {
        let parameters = &self.world.integration_parameters;
        let substeps = parameters.num_solver_iterations;
        #[expect(clippy::cast_precision_loss, reason = "a handful")]
        let dt = parameters.dt / substeps as f64;
        let center = self.world.bodies[self.body].mass_properties().local_mprops.local_com;
        let mut pose = self.isometry.prepend_translation(center);
        for _ in 0..substeps {
            let angle = turning * dt;
            let turned = pose.rotation;
            pose.rotation = Rotation::from_cos_sin_unchecked(
                turned.re - angle * turned.im,
                turned.im + angle * turned.re,
            )
            .normalize();
            pose.translation += velocity * dt;
        }
        self.isometry = pose.prepend_translation(-center);
    }

    /// Returns whether something may be near on a step at `speed` (m/s). The distance travelled since the last test
    /// bounds by how much that can have changed.
    fn is_near(&mut self, speed: f64) -> bool {
        let way = speed.abs() * PHYSICS_PERIOD.seconds().get();
        self.holds_for -= way;
        if self.holds_for <= 0.0 {
            let Point { x, y } = self.pose.position();
            let apart =
                |b: &Bounds| (b.min.x - x).max(x - b.max.x).max(b.min.y - y).max(y - b.max.y);
            let nearest = self.bounds.iter().map(apart).fold(f64::INFINITY, f64::min);
            let spare = nearest - self.reach - self.vigilance - way;
            self.near = spare <= 0.0;
            self.holds_for = if self.near { (-spare).max(PATIENCE) } else { spare };
        }
        self.near
    }

    /// Returns the pose in the world's frame.
    pub(super) fn pose(&self) -> Pose {
        self.pose
    }

    /// Returns whether the body touches something: a contact point at zero distance or under pressure, not merely a
    /// near one (the engine tracks points up to 2 cm away, and measures them before the step).
    pub(super) fn is_touching(&self) -> bool {
        if !self.near {
            return false;
        }
        self.world
            .contact_pairs_with(self.shell)
            .flat_map(rapier2d::prelude::ContactPair::manifolds)
            .flat_map(|manifold| &manifold.points)
            .any(|point| point.dist <= 0.0 || point.data.impulse > 0.0)
    }
}

/// Builds a collider in the shape of `outline` about the returned centre; `None` for degenerate outlines.
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
    use crate::rng::Seeds;

    /// Further than anything is away: the engine runs at every step.
    const ALWAYS: f64 = 1e6;

    fn disc() -> Robot {
        Robot::disc(0.2)
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

    /// Compares random drives between pillars and walls up to the first contact: to the bit before it, and within the
    /// engine's own tolerance at it, where its state of the pair plays a part.
    #[test]
    fn free_motion_has_the_engine_s_bits_and_contact_comes_at_the_same_step() {
        let solid = [
            Outline::rectangle(Point::new(0.0, 3.0), 8.0, 0.2, 0.0),
            Outline::rectangle(Point::new(0.0, -3.0), 8.0, 0.2, 0.0),
            Outline::rectangle(Point::new(4.0, 0.0), 0.2, 6.0, 0.0),
            Outline::rectangle(Point::new(-4.0, 0.0), 0.2, 6.0, 0.0),
            Outline::rectangle(Point::new(1.0, 1.5), 1.0, 0.1, 0.7),
            Outline::Circle { center: Point::new(-1.5, -1.0), radius: 0.3 },
        ];
        let mut corners = Vec::new();
        for (x, y) in [(0.25, 0.2), (0.235, 0.2485)] {
            for (sx, sy) in [(1.0, 1.0), (1.0, -1.0), (-1.0, 1.0), (-1.0, -1.0)] {
                corners.push(Point::new(sx * x + 0.01, sy * y));
            }
        }
        let footprint = Outline::Polygon(crate::geometry::convex_hull(&corners));
        let (mut contacts, mut flown) = (0, 0);
        for drive in 0..60_u64 {
            let robot = if drive % 2 == 0 {
                disc()
            } else {
                Robot { footprint: footprint.clone(), ..disc() }
            };
            let start = Pose::new(0.0, 0.0, 0.7);
            let mut always = Engine::watching(&solid, &robot, start, ALWAYS);
            let mut near = Engine::new(&solid, &robot, start);
            let mut stream = Seeds::new(9, vec![]).stream("twists");
            let mut twist = Twist::STOP;
            for step in 0..4000_u64 {
                if step % 50 == 0 {
                    stream.at(drive * 1000 + step);
                    twist = Twist {
                        linear: stream.between(-0.2, 0.7),
                        angular: stream.between(-1.0, 1.0),
                    };
                }
                always.step(twist);
                near.step(twist);
                assert_eq!(always.is_touching(), near.is_touching(), "drive {drive}, step {step}");
                flown += u32::from(!near.near);
                if always.is_touching() {
                    let off = always.pose().position().distance(near.pose().position());
                    assert!(off < 1e-3, "drive {drive}, step {step}: {off} m");
                    contacts += 1;
                    break;
                }
                assert_eq!(always.pose(), near.pose(), "drive {drive}, step {step}");
            }
        }
        assert!(contacts > 30 && flown > 10_000, "{contacts} contacts, {flown} steps flown");
    }
}
