//! A mind that drives through a trial's world, step by step, with exact drive and odometry and nothing recorded.

use reenact::grid::Cell;
use reenact::robot::{Lidar, Scan, Twist};
use reenact::sim::{DriveNoise, OdometryNoise, Scene, Simulator};
use reenact::studies::TrialSpec;
use reenact::studies::prior_map::Setup;
use reenact::studies::prior_map::explorer::{CONTROL_PERIOD, Explorer};
use reenact::studies::prior_map::information_gain::AlignedPrior;
use reenact::units::Tick;

/// A robot on its way.
pub(crate) struct Drive<'a> {
    pub(crate) setup: &'a Setup,
    pub(crate) lidar: Lidar,
    pub(crate) sim: Simulator,
    pub(crate) mind: Explorer,
    scan: Scan,
    next_control: Tick,
}

/// What happened at an instant of a drive.
pub(crate) struct Step {
    /// Where a scan was taken into the map: the cells of the lattice that changed.
    pub(crate) changes: Option<Vec<Cell>>,
    /// Where a control cycle ran: its command.
    pub(crate) twist: Option<Twist>,
    /// Whether a location was chosen.
    pub(crate) chose: bool,
}

impl<'a> Drive<'a> {
    /// Creates a robot at the start of the trial.
    pub(crate) fn new(spec: &'a TrialSpec) -> Self {
        let setup = setup(spec);
        let lidar = lidar(setup);
        let sim = simulator(spec, &lidar);
        let mind = mind(spec, &lidar);
        let scan = sim.blank_scan();
        Self { setup, lidar, sim, mind, scan, next_control: Tick(0) }
    }

    /// Goes on to the next instant at which something happens. The mind has done its part then, the body not yet.
    pub(crate) fn step(&mut self) -> Step {
        self.sim.advance_to(self.next_control.min(self.sim.next_scan()));
        let (odometry, choices) = (self.sim.odometry_at_scan(), self.mind.choices());
        let mut changes = None;
        if self.sim.now() == odometry.stamp && self.mind.wants_scan(odometry) {
            self.sim.read_scan(&mut self.scan);
            let changed = self.mind.take_scan(odometry, &self.scan);
            changes = changed.map(|all| all.iter().map(|change| change.cell).collect());
        }
        let is_due = self.sim.now() >= self.next_control;
        let twist = is_due.then(|| {
            self.next_control = self.next_control + CONTROL_PERIOD;
            let twist = self.mind.control(self.sim.odometry());
            self.sim.command(twist);
            twist
        });
        Step { changes, twist, chose: self.mind.choices() > choices }
    }
}

/// The setup of a trial of the prior-map study.
pub(crate) fn setup(spec: &TrialSpec) -> &Setup {
    spec.setup.of::<Setup>().expect("it is of this study")
}

/// The lidar as the trial uses it.
pub(crate) fn lidar(setup: &Setup) -> Lidar {
    let own = setup.robot.lidar.clone().expect("it has a scanner");
    let sensing = &setup.parameters.sensing;
    Lidar {
        max_range: sensing.range_m.unwrap_or(own.max_range),
        noise_sd: sensing.range_noise_sd_m.unwrap_or(own.noise_sd),
        ..own
    }
}

/// The trial's prior on the lattice of the robot's map.
pub(crate) fn prior(setup: &Setup) -> Option<AlignedPrior> {
    let resolution = setup.parameters.mapping.resolution_m;
    setup.prior.as_ref().map(|prior| AlignedPrior::new(prior, setup.start, resolution))
}

/// A mind as the trial has it.
pub(crate) fn mind(spec: &TrialSpec, lidar: &Lidar) -> Explorer {
    let setup = setup(spec);
    let [delays, particles] = ["decision-delay", "slam"].map(|name| spec.seeds.stream(name));
    Explorer::new(&setup.parameters, lidar, prior(setup), delays, particles)
}

/// The trial's world with a robot at its start that has `lidar`.
pub(crate) fn simulator(spec: &TrialSpec, lidar: &Lidar) -> Simulator {
    let setup = setup(spec);
    let scene = Scene {
        visible: &setup.world.slice(lidar.height),
        solid: &setup.world.contact(setup.robot.body_z[0], setup.robot.body_z[1]),
        robot: &setup.robot,
        lidar: lidar.clone(),
        camera: None,
        compass: None,
        start: setup.start,
        drive_noise: DriveNoise::NONE,
        odometry_noise: OdometryNoise::NONE,
    };
    Simulator::new(scene, &spec.seeds)
}
