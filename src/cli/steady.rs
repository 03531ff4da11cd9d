//! `mpjr steady`: steady gross sliding at each of a list of velocities.

use std::path::{Path, PathBuf};
use std::str::FromStr;
use std::time::{Instant, SystemTime};

use clap::Args;
use mpi::topology::SimpleCommunicator;
use mpi::traits::Communicator;

use super::run::default_output;
use super::summary::seconds;
use super::telling::Telling;
use super::terminal::tell;
use crate::composition;
use crate::error::Result;
use crate::output::{Metadata, steady::Curve, steady::write};
use crate::parallel::{agree, share_text};
use crate::petsc::Session;
use crate::scene::{self, Scene, Source};
use crate::steady::{Sliding, State};

/// The arguments of `mpjr steady`.
#[derive(Args)]
pub struct SteadyArguments {
    /// The scene: a layer with periodic sides, of which the last phase says what is held
    scene: PathBuf,
    /// Velocities from one to another, m/s, so many to a decade [default: that of the last phase]
    #[arg(long, value_name = "FROM:TO:PER_DECADE")]
    velocities: Option<Ladder>,
    /// In space, where it slides: degrees from +x towards +y [default: as in the last phase, or along x]
    #[arg(long, value_name = "DEGREES", allow_negative_numbers = true)]
    direction: Option<f64>,
    /// Where the results go [default: the scene's stem + .h5, in the current directory]
    #[arg(long, value_name = "FILE.h5")]
    out: Option<PathBuf>,
    /// Change a key of the scene, such as layer.depth=0.5 or phase.slide.approach=2e-3
    #[arg(long = "set", value_name = "KEY.PATH=VALUE")]
    set: Vec<String>,
    #[command(flatten)]
    telling: Telling,
}

/// Velocities evenly spaced by their logarithm.
#[derive(Debug, Clone, PartialEq)]
pub struct Ladder(Vec<f64>);

/// More velocities than anybody draws.
const MOST: f64 = 1e5;

impl FromStr for Ladder {
    type Err = String;

    fn from_str(text: &str) -> std::result::Result<Self, String> {
        let reason = || "must be FROM:TO:PER_DECADE, all above 0 and TO not below FROM, such as 1e-6:1e4:10".to_owned();
        let numbers: Vec<f64> =
            text.split(':').map(str::parse).collect::<std::result::Result<_, _>>().map_err(|_| reason())?;
        let [from, to, per_decade] = numbers[..] else { return Err(reason()) };
        let usable = |number: f64| number > 0.0 && number.is_finite();
        if !(usable(from) && usable(to) && usable(per_decade) && to >= from) {
            return Err(reason());
        }
        // The last one is met but for round-off of the logarithms.
        let steps = ((to / from).log10() * per_decade * (1.0 + 1e-12)).floor();
        if steps >= MOST {
            return Err(format!("asks for {steps:.0} velocities; up to {MOST:.0} are taken"));
        }
        Ok(Self((0..=steps as usize).map(|i| from * 10f64.powf(i as f64 / per_decade)).collect()))
    }
}

/// Solves on all ranks of the launcher, each a stretch of the velocities.
pub fn run(arguments: &SteadyArguments) -> Result<()> {
    arguments.telling.begin(false);
    super::in_session(&[], |session, world| solve((session, world), arguments))
}

fn solve((session, world): (&Session, &SimpleCommunicator), arguments: &SteadyArguments) -> Result<()> {
    let (clock, started) = (Instant::now(), SystemTime::now());
    let file = &arguments.scene;
    let open = |file: &Path| share_text(world, || scene::open(file));
    let source = Source { file: file.clone(), overrides: arguments.set.clone() };
    let scene = scene::read_with(&open(file)?, &source, &open)?;
    let velocities = match &arguments.velocities {
        Some(Ladder(velocities)) => velocities.clone(),
        None => vec![composition::last_velocity(&scene, file)?],
    };
    let heading = composition::heading(&scene, arguments.direction)?;
    let mut sliding = composition::steady(world, &scene, file, heading)?;
    let out = arguments.out.clone().unwrap_or_else(|| default_output(file));
    let states = sliding.curve(world, &velocities)?;
    let mine = if world.rank() == 0 {
        record((session, world, started), &scene, (file, &out), (&sliding, &states))
    } else {
        Ok(())
    };
    agree(world, mine)?;
    if world.rank() == 0 {
        tell(table(&sliding, &states));
        let count = states.len();
        tell(format_args!(
            "{count} velocit{} in {}",
            if count == 1 { "y" } else { "ies" },
            seconds(clock.elapsed().as_secs_f64())
        ));
        tell(format_args!("results:       {}", out.display()));
    }
    Ok(())
}

fn record(
    (session, world, started): (&Session, &SimpleCommunicator, SystemTime),
    scene: &Scene,
    (file, out): (&Path, &Path),
    (sliding, states): (&Sliding, &[State]),
) -> Result<()> {
    let metadata = Metadata {
        title: scene.title.clone(),
        scene: scene.to_toml(),
        inputs: composition::inputs(scene, file)?,
        version: env!("CARGO_PKG_VERSION").into(),
        git_commit: env!("MPJR_GIT_COMMIT").into(),
        petsc_version: session.petsc_version(),
        ranks: world.size() as usize,
        started,
        warnings: Vec::new(),
    };
    let curve = Curve { times: sliding.times(), face: &sliding.face, heading: sliding.heading.into(), states };
    write(out, &metadata, &curve)
}

/// One line for each velocity, or for some of many; forces along the velocity.
fn table(sliding: &Sliding, states: &[State]) -> String {
    const LINES: usize = 40;
    let unit = if sliding.face.in_space { "N" } else { "N/m" };
    let forces = ["N", "Q", "hyst."].map(|name| format!("{name}, {unit}"));
    let [normal, tangential, hysteretic] = &forces;
    let head = ["v, m/s", "D, m", normal, tangential, hysteretic, "friction", "contact"];
    let mut text = head.map(|title| format!("{title:>11}")).join(" ");
    let every = states.len().div_ceil(LINES);
    for state in states.iter().step_by(every.max(1)) {
        let State { velocity, approach, normal_force, contact_fraction, across, .. } = state;
        let along = |x: f64, y: f64| sliding.heading.x * x + sliding.heading.y * y;
        let tangential_force = along(state.tangential_force, across[0]);
        let hysteretic_force = along(state.hysteretic_force, across[1]);
        let friction = (tangential_force + hysteretic_force) / normal_force;
        text += &format!(
            "\n{velocity:>11.4e} {approach:>11.4e} {normal_force:>11.4e} {tangential_force:>11.4e} {hysteretic_force:>11.3e} \
             {friction:>11.5} {contact_fraction:>11.4}"
        );
    }
    text
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    /// Both ends are met; what is no ladder is refused.
    #[test]
    fn a_ladder_has_both_its_ends() {
        let Ladder(all) = "1e-6:1e4:10".parse().unwrap();
        assert_eq!((all.len(), all[0]), (101, 1e-6));
        assert!((all[100] / 1e4 - 1.0).abs() < 1e-13 && (all[10] / 1e-5 - 1.0).abs() < 1e-13);
        assert_eq!("2:2:5".parse::<Ladder>().unwrap(), Ladder(vec![2.0]));
        for wrong in ["", "1", "1:2", "1:2:0", "2:1:3", "0:1:3", "-1:1:3", "1:inf:3", "1:2:3:4", "a:b:c", "1:2:1e9"] {
            assert!(wrong.parse::<Ladder>().is_err(), "{wrong}");
        }
    }
}
