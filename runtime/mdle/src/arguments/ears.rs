//! The options `--ears` and `--head` of `mdle run` and `mdle shell`.

use std::path::PathBuf;

use clap::{Arg, ArgMatches, Command};
use mdle_quantity::Quantity;

/// Source of sound, which the option `--ears` names.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) enum EarsOption {
    /// The robot's own microphones.
    Robot,
    /// A WAV file.
    Wav(PathBuf),
    /// A recorder that writes raw samples to a pipe. Contains the path of the pipe; `None` means standard input.
    Raw(Option<PathBuf>),
}

impl EarsOption {
    /// Reads the value of `--ears`.
    fn read(text: &str) -> Self {
        let path = PathBuf::from(text);
        let is_wav = path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("wav"));
        match text {
            "robot" => Self::Robot,
            "-" => Self::Raw(None),
            _ if is_wav => Self::Wav(path),
            _ => Self::Raw(Some(path)),
        }
    }
}

/// Adds the options `--ears` and `--head` to `command`.
pub(super) fn with_ears(command: Command) -> Command {
    let ears = Arg::new("ears")
        .long("ears")
        .value_name("robot|FILE|-")
        .help("Sound whose bearing the module `heading` publishes: the robot's microphones, a WAV file or a pipe")
        .conflicts_with("point");
    let head = Arg::new("head")
        .long("head")
        .value_name("RADIUS")
        .help("Radius of the head between the ears, in metres or as in `9cm` [default: 0.0875]")
        .requires("ears")
        .value_parser(head);
    command.args([ears, head])
}

/// Returns the source of the sound (`None` without `--ears`), and the radius of the head in metres.
pub(super) fn ears(matches: &ArgMatches) -> (Option<EarsOption>, f64) {
    let ears = matches.get_one::<String>("ears").map(|text| EarsOption::read(text));
    (ears, matches.get_one("head").copied().unwrap_or(mdle_sound::RADIUS))
}

/// Reads the radius of a head, in metres.
///
/// # Errors
/// Fails with a message if the text is not a length from 2 cm to 50 cm.
pub(crate) fn head(text: &str) -> Result<f64, String> {
    let radius = Quantity::Length.read(text, "m")?;
    if (0.02..=0.5).contains(&radius) { Ok(radius) } else { Err("expected 2 cm to 50 cm".to_owned()) }
}
