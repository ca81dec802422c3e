//! `reenact replay`: any archived trial again, with full recording.

use crate::cli::args::{DataFormat, ReplayArgs};
use crate::cli::exit::{Exit, Failure};
use crate::cli::progress::Working;
use crate::cli::terminal::{Terminal, counted};
use crate::cli::{checked, load};
use crate::geometry::Pose;
use crate::plan::Plan;
use crate::report::{
    GainView, Played, Sensing, Shown, bag_under_banner, drawing_under_banner, foxglove_layout,
    gain_svg, page_under_banner, play, replay_page, still_svg,
};
use crate::studies::prior_map;
use crate::studies::recording::Recording;
use crate::verify::plan_of;
use crate::world::map_server;
use serde_json::{Value, json};
use std::path::{Path, PathBuf};

/// Re-enacts one trial or two.
pub(in crate::cli) fn run(args: &ReplayArgs, terminal: Terminal) -> Result<Exit, Failure> {
    let asked = [&args.html, &args.svg, &args.mcap, &args.map, &args.plans];
    if asked.iter().all(|file| file.is_none()) {
        return Err(Failure::not_understood(
            "say what to write: `--html FILE` for a page in which the trial plays, `--svg FILE` for a still, `--mcap FILE` \
             for a bag of ROS 2 messages, `--map FILE.yaml` for the map that the robot made, `--plans DIR` for the plans of a deadline study",
        ));
    }
    let checked::Checked { bundle, words, banner } =
        checked::bundle(&args.bundle, args.unchecked, args.limits)?;
    let banner = banner.as_deref();
    let (plan, _) = plan_of(&bundle).map_err(Failure::not_understood)?;
    let mut exit = Exit::Yes;
    let mut played: Vec<(String, Recording)> = Vec::new();
    let mut notes = Vec::new();
    let mut trials: Vec<Value> = Vec::new();
    let mut written = Written { files: Vec::new(), told: told_to(args, terminal) };
    for wanted in &args.trials {
        let spec = plan.find(wanted).map_err(Failure::not_understood)?;
        let name = format!("{}/{}", spec.condition.slug(), spec.trial);
        let sensing = match args.mcap {
            Some(_) if played.is_empty() => Sensing::EveryScan,
            _ => Sensing::Shown,
        };
        let working = Working::at(&format!("re-enacting {name}"), terminal);
        let again = play(&bundle, &plan, spec, sensing);
        drop(working);
        let Played { title, recording, note } =
            again.map_err(|fault| Failure { exit: Exit::No, message: fault.to_string() })?;
        if !note.good {
            exit = Exit::No;
        }
        trials.push(json!({
            "trial": name,
            "key": spec.key.to_string(),
            "matches": note.good,
            "outcome": recording.outcome,
        }));
        notes.push(note);
        played.push((title, recording));
    }
    if let Some(path) = &args.html {
        let trials: Vec<(String, &Recording)> =
            played.iter().map(|(name, recording)| (name.clone(), recording)).collect();
        let page = replay_page(&plan.experiment.title, &trials, &notes);
        let page = banner.map_or(page.clone(), |banner| page_under_banner(&page, banner));
        load::write(path, page.as_bytes())?;
        written.tell(&[path]);
    }
    if let (Some(path), Some((_, recording))) = (&args.svg, played.first()) {
        let still = match args.decision {
            None => {
                let at = match args.at_coverage {
                    None => args.at,
                    Some(percent) => Some(instant_of(percent, recording)?),
                };
                let shown = if args.plain { Shown::MapAndTrail } else { Shown::Everything };
                still_svg(recording, at, shown)
            }
            Some(decision) => gain_still(&plan, args, decision, recording)?,
        };
        let still = banner.map_or(still.clone(), |banner| drawing_under_banner(&still, banner));
        load::write(path, still.as_bytes())?;
        written.tell(&[path]);
    }
    if let (Some(path), Some((_, recording))) = (&args.mcap, played.first()) {
        let bag = bag_under_banner(recording, args.scan_rate, banner).map_err(Failure::failed)?;
        load::write(path, &bag.bytes)?;
        let layout = path.with_extension("foxglove-layout.json");
        load::write(&layout, foxglove_layout(&bag).as_bytes())?;
        written.tell(&[path, &layout]);
        for (topic, count) in &bag.counts {
            written.note(&format!("  {topic}: {}", counted(*count as usize, "message")));
        }
    }
    if let (Some(path), Some((name, recording))) = (&args.map, played.first()) {
        let image = write_map(path, name, recording)?;
        written.tell(&[path, &image]);
    }
    if let (Some(folder), Some((_, recording))) = (&args.plans, played.first()) {
        for (i, plan) in recording.plans.iter().enumerate() {
            let name = format!("plan-{:03}-at-{:.1}-s.json", i + 1, plan.time_s);
            let path = folder.join(name);
            load::write(&path, plan.document.as_bytes())?;
            written.files.push(path);
        }
        let count = counted(recording.plans.len(), "plan");
        written.note(&format!("wrote {count} to {}", folder.display()));
    }
    terminal.result(&match args.format {
        DataFormat::Human => {
            let told = notes.iter().map(|note| note.text.as_str());
            let told: Vec<&str> = std::iter::once(words.as_str()).chain(told).collect();
            told.join("\n")
        }
        DataFormat::Json => json!({
            "checked": words,
            "results_digest": format!("sha256:{}", bundle.results_digest()),
            "trials": trials,
            "written": written.files,
        })
        .to_string(),
    });
    Ok(exit)
}

/// Returns the terminal where people are told of files as they are written: programs find them in the answer.
fn told_to(args: &ReplayArgs, terminal: Terminal) -> Option<Terminal> {
    (args.format == DataFormat::Human).then_some(terminal)
}

/// The files that were written so far.
struct Written {
    files: Vec<PathBuf>,
    told: Option<Terminal>,
}

impl Written {
    /// Tells of files that were written together.
    fn tell(&mut self, files: &[&Path]) {
        let names: Vec<String> = files.iter().map(|file| file.display().to_string()).collect();
        self.note(&format!("wrote {}", names.join(" and ")));
        self.files.extend(files.iter().map(|file| (*file).to_owned()));
    }

    fn note(&self, text: &str) {
        if let Some(terminal) = self.told {
            terminal.note(text);
        }
    }
}

/// Writes the map of the trial `name` to `path` and its image beside it, in the world's frame; returns the path of the image.
fn write_map(path: &Path, name: &str, recording: &Recording) -> Result<PathBuf, Failure> {
    let Some(map) = recording.final_map() else {
        return Err(Failure::not_understood(format!("the robot of {name} made no metric map")));
    };
    let image = path.with_extension("pgm");
    let image_name = image.file_name().unwrap_or_default().to_string_lossy();
    let corner = map.frame().origin;
    let origin = recording.map_pose.compose(Pose::new(corner.x, corner.y, 0.0));
    let [descriptor, pixels] = map_server::write_at(&map, origin, &image_name);
    load::write(path, &descriptor)?;
    load::write(&image, &pixels)?;
    Ok(image)
}

/// Returns when (s) the trial first covered `percent`.
fn instant_of(percent: f64, recording: &Recording) -> Result<f64, Failure> {
    let reached = recording.frames.iter().find(|frame| frame.coverage_percent >= percent);
    reached.map(|frame| frame.time_s).ok_or_else(|| {
        let most = recording.frames.iter().map(|frame| frame.coverage_percent);
        let most = most.fold(0.0, f64::max);
        Failure::not_understood(format!(
            "the trial never covered {percent} %: it ended with {most:.1} % at most; choose a lower `--at-coverage`"
        ))
    })
}

/// Draws what a candidate of the first trial's choice promises.
fn gain_still(
    plan: &Plan,
    args: &ReplayArgs,
    decision: usize,
    recording: &Recording,
) -> Result<String, Failure> {
    let spec = plan.find(&args.trials[0]).map_err(Failure::not_understood)?;
    let Some(setup) = spec.setup.of::<prior_map::Setup>() else {
        return Err(Failure::not_understood(format!(
            "`--decision` draws information gains, which the study `{}` has none of; `--plans DIR` writes its plans",
            plan.experiment.kind.name()
        )));
    };
    let view = GainView {
        decision,
        candidate: args.gain,
        range_cells: setup.gain_range_cells(),
        known_obstacles_occlude: setup.parameters.exploration.known_obstacles_occlude,
    };
    gain_svg(recording, view).map_err(Failure::not_understood)
}
