//! An example of a target and a plan in plain Rust: a cart that shuttles on a track. For a real robot, an author writes
//! the first half of such a file, and `mdlec` generates the second half.
//!
//! Run it with `cargo run -p mdle-host --example cart -- --speed max --timeout 20`. The tests of this package run the
//! program.

use std::fs::File;
use std::io::Write;
use std::path::PathBuf;
use std::process::ExitCode;
use std::time::Duration;

use mdle_host::clap::{Arg, ArgAction, ArgMatches, Command, value_parser};
use mdle_host::{Pace, Refusal, Replays, StopRequest, Target, Time, run};
use mdle_runtime::fsm::{Atom, Bracket};
use mdle_runtime::{
    Begin, Cause, Cursor, Ending, Fsm, Meters, MetersPerSecond, Nanos, Output, Plan, RadiansPerSecond, Robot, Twist,
};

fn main() -> ExitCode {
    run::<CartTarget, _>("shuttle", || Shuttle { forward: true })
}

/// The output of the cart.
struct Sensed {
    at: Meters,
    track: Meters,
    /// `true` if the law of this turn hangs.
    hangs: bool,
}

impl Output for Sensed {}

/// A simulated cart.
struct Cart {
    at: Meters,
    track: Meters,
    period: Duration,
    exchanges: u64,
    /// Number of the exchange that fails, and the kind of failure; `None` if no exchange fails.
    broken: Option<(u64, Breakdown)>,
    /// Number of the exchange after which the law hangs.
    hung: Option<u64>,
    /// `true` if the cart prints its commands to standard error.
    tells: bool,
    /// File of the cart's journal.
    journal: Option<File>,
}

/// Failure of an exchange.
#[derive(Debug, Clone, Copy)]
enum Breakdown {
    Fails,
    Panics,
    Hangs,
}

impl Cart {
    fn tell(&self, what: std::fmt::Arguments<'_>) {
        if self.tells {
            // Written in one call, because the host writes to standard error too.
            let _ = std::io::stderr().write_all(format!("cart: {what}\n").as_bytes());
        }
        if let Some(mut journal) = self.journal.as_ref() {
            let _ = writeln!(journal, "{what}");
        }
    }
}

impl Robot for Cart {
    type Output = Sensed;
    type Input = Speed;
    type Error = &'static str;

    fn exchange(&mut self, input: &Speed) -> Result<Sensed, &'static str> {
        let MetersPerSecond(speed) = input.0;
        self.tell(format_args!("{speed} m/s"));
        match self.broken {
            Some((exchange, breakdown)) if exchange == self.exchanges => match breakdown {
                Breakdown::Fails => return Err("the cart fell off its track"),
                Breakdown::Panics => self.explode(),
                Breakdown::Hangs => loop {
                    std::thread::park();
                },
            },
            Some(_) | None => {}
        }
        let hangs = self.hung == Some(self.exchanges);
        self.exchanges += 1;
        self.at.0 = (self.at.0 + speed * self.period.as_secs_f64()).clamp(0.0, self.track.0);
        Ok(Sensed { at: self.at, track: self.track, hangs })
    }

    fn stop(&mut self) -> Result<(), &'static str> {
        self.tell(format_args!("stop"));
        Ok(())
    }
}

impl Cart {
    #[expect(clippy::panic, reason = "shows that even a bug leaves no robot moving")]
    fn explode(&self) {
        panic!("the cart exploded");
    }
}

/// Input of the cart, a speed; the null input is a speed of zero.
#[derive(Default)]
struct Speed(MetersPerSecond);

/// The cart as a target.
struct CartTarget;

impl Target for CartTarget {
    const NAME: &'static str = "cart";
    const PERIOD: Duration = Duration::from_millis(100);
    type Robot = Cart;
    const PATHS: Option<Replays<Cart>> = Some(Replays {
        fastest: Twist { v: MetersPerSecond(0.5), omega: RadiansPerSecond(0.0) },
        take: |_, _| {},
        speed: |_| MetersPerSecond(0.5),
    });

    fn arguments(command: Command) -> Command {
        let number = |name| Arg::new(name).long(name).value_name("N").value_parser(value_parser!(u64));
        command
            .arg(Arg::new("track").long("track").value_name("METERS").value_parser(value_parser!(f64)))
            .arg(Arg::new("speed").long("speed").value_parser(["wall", "max"]).help("How time passes [default: wall]"))
            .arg(number("fail-at").help("Fail at this exchange"))
            .arg(number("panic-at").help("Panic at this exchange"))
            .arg(number("hang-at").help("Hang at this exchange"))
            .arg(number("hang-law-at").help("Hang in the law after this exchange"))
            .arg(number("start").help("Milliseconds that it takes to be opened"))
            .arg(
                Arg::new("journal")
                    .long("journal")
                    .value_parser(value_parser!(PathBuf))
                    .help("Where to write what the cart is told"),
            )
            .arg(Arg::new("tell").long("tell").action(ArgAction::SetTrue).help("Tell what the cart is told"))
    }

    fn time(matches: &ArgMatches) -> Result<Time, String> {
        let fastest = matches.get_one::<String>("speed").is_some_and(|speed| speed == "max");
        Ok(if fastest { Time::Stepped(Pace::Max) } else { Time::Wall })
    }

    fn connect(matches: &ArgMatches, period: Duration, request: &StopRequest) -> Result<Cart, Refusal> {
        let track = matches.get_one("track").copied().unwrap_or(1.0);
        if !(0.0..=1e3).contains(&track) {
            return Err(Refusal::Usage("a track is at most 1000 m long".to_owned()));
        }
        let broken_at = |name, breakdown| matches.get_one::<u64>(name).map(|exchange| (*exchange, breakdown));
        let broken = broken_at("fail-at", Breakdown::Fails).or(broken_at("panic-at", Breakdown::Panics));
        let broken = broken.or(broken_at("hang-at", Breakdown::Hangs));
        let tells = matches.get_flag("tell");
        let journal = matches.get_one::<PathBuf>("journal").map(File::create).transpose();
        let journal = journal.map_err(|error| Refusal::Usage(error.to_string()))?;
        let hung = matches.get_one("hang-law-at").copied();
        let (at, track) = (Meters(0.0), Meters(track));
        let mut cart = Cart { at, track, period, exchanges: 0, broken, hung, tells, journal };
        if let Some(millis) = matches.get_one("start") {
            cart.tell(format_args!("start"));
            request.wait(Duration::from_millis(*millis));
            if request.is_made() {
                return Err(Refusal::Ended(cart.stop().map_err(str::to_owned)));
            }
        }
        Ok(cart)
    }
}

/// The plan `{ Shuttle (wait 1000) ((Atom (far) go 0.5) (Atom (near) go -0.5))^inf }`.
struct Shuttle {
    forward: bool,
}

const LIMIT: Nanos = Nanos(1_000_000_000_000);

const FSM: Fsm<'static> = Fsm {
    brackets: &[
        Bracket::scope(0, 0, 1, 0),
        Bracket::repeat(0, 0, 0, 0, 1, 0),
        Bracket::scope(1, 0, 0, 1),
        Bracket::scope(1, 1, 1, 1),
    ],
    atoms: &[Atom::new(2, 1), Atom::new(3, 2)],
    termination: 3,
};

impl Plan for Shuttle {
    type Output = Sensed;
    type Input = Speed;
    type Entered = [Nanos; 2];
    type Left = [u64; 1];

    fn fsm(&self) -> Fsm<'_> {
        FSM
    }

    fn slots(&self) -> ([Nanos; 2], [u64; 1]) {
        ([Nanos::ZERO; 2], [0])
    }

    fn enter(&mut self, atom: u32, _: &Sensed, _: Begin) {
        self.forward = atom == 0;
    }

    fn next(&self, cursor: &Cursor<[Nanos; 2], [u64; 1]>, y: &Sensed, t: Nanos) -> Option<Ending> {
        if cursor.since(0, t) >= LIMIT {
            return Some(Cause::Fired(0).into());
        }
        let there = if self.forward { y.at.0 >= y.track.0 } else { y.at.0 <= 0.0 };
        there.then(|| Cause::Fired(1).into())
    }

    fn input(&mut self, y: &Sensed, _: Nanos) -> Speed {
        if y.hangs {
            loop {
                std::thread::park();
            }
        }
        Speed(MetersPerSecond(if self.forward { 0.5 } else { -0.5 }))
    }

    fn law(&self, atom: u32) -> &str {
        if atom == 0 { "go 0.5" } else { "go -0.5" }
    }

    fn condition(&self, scope: u32) -> &str {
        ["wait 1000", "", "far", "near"].get(scope as usize).unwrap_or(&"")
    }

    fn name(&self, scope: u32) -> &str {
        if scope == 0 { "Shuttle" } else { "" }
    }
}
