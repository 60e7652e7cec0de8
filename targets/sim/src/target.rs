//! The target `sim`, on which the host runs plans.

use std::time::Duration;

use mdle_host::clap::{ArgMatches, Command};
use mdle_host::{EarsOf, NamedFile, Observation, Refusal, Replays, SettingsOf, StopRequest, Target, Time};
use mdle_runtime::{MetersPerSecond, RadiansPerSecond, Twist};
use mdle_simulator::alphabet;

use crate::observed::Observed;
use crate::{options, setup};

/// The target `sim`.
#[derive(Debug, Clone, Copy)]
pub struct Sim;

impl Target for Sim {
    const NAME: &'static str = alphabet::NAME;
    const PERIOD: Duration = Duration::from_nanos(alphabet::PERIOD.0);
    type Robot = Observed;
    const PATHS: Option<Replays<Observed>> = Some(Replays {
        // The limits of `go` in the alphabet.
        fastest: Twist { v: MetersPerSecond(1.0), omega: RadiansPerSecond(6.0) },
        take: Observed::take_paths,
        speed: |sensed| sensed.velocity.v,
    });
    const SETTINGS: Option<SettingsOf<Observed>> = Some(|robot| robot);
    const EARS: Option<EarsOf<Observed>> = Some(Observed::take_ears);
    const OBSERVATION: Option<Observation<Observed>> = Some(Observation {
        observer: |robot| robot,
        draws: true,
        batch: |matches, period| setup::batch(matches, period).map_err(Refusal::Usage),
    });

    fn arguments(command: Command) -> Command {
        options::arguments(command)
    }

    fn time(matches: &ArgMatches) -> Result<Time, String> {
        options::time(matches)
    }

    fn connect(matches: &ArgMatches, period: Duration, _: &StopRequest) -> Result<Observed, Refusal> {
        setup::robot(matches, period).map_err(Refusal::Usage)
    }

    fn files(matches: &ArgMatches) -> Vec<NamedFile> {
        options::files(matches)
    }
}
