//! The target `ros2`, on which the host runs plans.

use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::time::Duration;

use mdle_host::clap::{Arg, ArgAction, ArgMatches, Command, value_parser};
use mdle_host::{NamedFile, Observation, Refusal, Replays, StopRequest, Time};
use mdle_runtime::{MetersPerSecond, RadiansPerSecond, Twist};
use mdle_serial::Moment;

use crate::alphabet;
use crate::capabilities::Capabilities;
use crate::config::Configured;
use crate::dds_link::DdsLink;
use crate::driver::Ros2;
use crate::pacing::Pacing;

/// The target `ros2`, on which the host runs a plan.
#[derive(Debug, Clone, Copy)]
pub struct Target;

impl mdle_host::Target for Target {
    const NAME: &'static str = alphabet::NAME;
    const PERIOD: Duration = Duration::from_nanos(alphabet::PERIOD.0);
    type Robot = Ros2<DdsLink>;
    const PATHS: Option<Replays<Self::Robot>> = Some(Replays {
        fastest: Twist { v: MetersPerSecond(2.0), omega: RadiansPerSecond(6.0) },
        take: Ros2::take_paths,
        speed: |sensed| sensed.velocity.v,
    });
    const OBSERVATION: Option<Observation<Self::Robot>> = Some(Observation::by(|robot| robot));

    fn arguments(command: Command) -> Command {
        command
            .arg(
                Arg::new("config")
                    .long("config")
                    .value_name("FILE.toml")
                    .help("Configuration of the robot [default: that of --print-config]")
                    .long_help(
                        "Configuration of the robot: topics, domain, body, limits. `--print-config > FILE.toml` writes \
                         a file to start from, with every value and its unit, and the capabilities that it gives.",
                    )
                    .value_parser(value_parser!(PathBuf)),
            )
            .arg(
                Arg::new("print-config")
                    .long("print-config")
                    .action(ArgAction::SetTrue)
                    .help("Print the configuration and the origin of each value, and exit"),
            )
            .arg(
                Arg::new("lockstep")
                    .long("lockstep")
                    .action(ArgAction::SetTrue)
                    .help("Take each turn as soon as the robot has moved; for a simulator that waits for commands"),
            )
    }

    fn time(matches: &ArgMatches) -> Result<Time, String> {
        match pacing(matches, Duration::ZERO) {
            Ok(pacing) => Ok(pacing.time()),
            Err(Refusal::Usage(sentence) | Refusal::Fault(sentence)) => Err(sentence),
            Err(Refusal::Ended(_)) => Ok(Time::Wall),
        }
    }

    fn files(matches: &ArgMatches) -> Vec<NamedFile> {
        let config = config(matches);
        let file = config.map(|path| NamedFile { option: "--config", path: path.to_owned(), is_written: false });
        file.into_iter().collect()
    }

    fn answer(matches: &ArgMatches) -> Result<Option<String>, Refusal> {
        let printed = |configured: Configured| format!("{configured}{}", Capabilities::of(&configured.config));
        matches.get_flag("print-config").then(|| configured(matches).map(printed)).transpose()
    }

    fn accepts(matches: &ArgMatches, texts: &[&str]) -> Result<(), Refusal> {
        Capabilities::of(&configured(matches)?.config).suffice(texts).map_err(Refusal::Usage)
    }

    fn connect(matches: &ArgMatches, period: Duration, request: &StopRequest) -> Result<Self::Robot, Refusal> {
        let config = configured(matches)?.config;
        let (pacing, begun) = (pacing(matches, period)?, Moment::now());
        if pacing == Pacing::Wall && period > config.longest_gap() {
            let longest = config.longest_gap().as_millis();
            return Err(Refusal::Usage(format!(
                "a turn of {} ms is longer than the robot may be without a command, {longest} ms; give a shorter \
                 `--period`, or set `stale-scan` in the file of --config",
                period.as_millis()
            )));
        }
        let (link, sensing) = DdsLink::connect(&config, pacing, request, begun)?;
        for sentence in link.warnings() {
            // The plan can run without standard error.
            let _ = writeln!(io::stderr(), "warning: {sentence}");
        }
        Ok(Ros2::new(config, link, sensing, pacing, request.clone(), begun))
    }
}

/// Returns the file that the option `--config` names; `None` if the option is not given.
fn config(matches: &ArgMatches) -> Option<&Path> {
    matches.get_one::<PathBuf>("config").map(PathBuf::as_path)
}

/// Reads the configuration that the options select.
fn configured(matches: &ArgMatches) -> Result<Configured, Refusal> {
    Configured::read(config(matches)).map_err(Refusal::Usage)
}

/// Returns the time source of turns that the options select.
fn pacing(matches: &ArgMatches, period: Duration) -> Result<Pacing, Refusal> {
    if matches.get_flag("lockstep") {
        return Ok(Pacing::Lockstep(period));
    }
    let is_simulated = configured(matches)?.config.use_sim_time;
    Ok(if is_simulated { Pacing::Simulated(period) } else { Pacing::Wall })
}
