//! Checks the battery and charger states that the robot reports.

use std::format;

use mdle_runtime::capability::Power;
use mdle_runtime::{Alphabet, Interrupt as _, Signal as _};

use super::trial::Trial;
use super::{Out, Room, Stage, Supplied, Verdict};

/// Minimum and maximum plausible voltage of a battery, in volts.
const VOLTS: (f64, f64) = (1.0, 1000.0);
/// Time, in seconds, within which a robot must report a change of its supply.
const TELLS: f64 = 5.0;

/// State of the power supply that a robot reports.
#[derive(Debug, Clone, Copy)]
struct ReportedSupply {
    volts: f64,
    is_low: bool,
    is_plugged: bool,
}

/// Returns the supply state that the robot reports `TELLS` seconds after the stage has set `supplied`.
fn reported<S: Stage>(stage: &mut S, supplied: Supplied) -> Result<ReportedSupply, Verdict>
where
    Out<S>: Power,
{
    let mut trial = Trial::of(stage, &Room::open())?;
    trial.supply(supplied);
    trial.drive(0.0, 0.0, TELLS)?;
    let y = &trial.y;
    let supply = ReportedSupply { volts: y.battery().0, is_low: y.is_low(), is_plugged: y.is_plugged() };
    let (least, most) = VOLTS;
    if !(least..=most).contains(&supply.volts) {
        return Err(Verdict::Broken(format!("`battery` is {} V, and {least} to {most} V are meant", supply.volts)));
    }
    agree::<S>(y, supply)?;
    Ok(supply)
}

/// Checks that the interrupts `lowBattery` and `charger` and the signal `battery` agree with the output `y`.
fn agree<S: Stage>(y: &Out<S>, supply: ReportedSupply) -> Result<(), Verdict> {
    for (name, wanted) in [("lowBattery", supply.is_low), ("charger", supply.is_plugged)] {
        let interrupt = S::Alphabet::interrupt(name, &[]).ok_or(Verdict::NotOffered)?;
        if interrupt.fired(y) != wanted {
            return Err(Verdict::Broken(format!("`{name}` and what the output says of it do not agree")));
        }
    }
    let signal = S::Alphabet::signal("battery", &[]).ok_or(Verdict::NotOffered)?;
    if signal.value(y) != supply.volts {
        return Err(Verdict::Broken("the signal `battery` is not the battery's voltage in volts".into()));
    }
    Ok(())
}

/// Checks that the robot reports a state only with the power supply that causes it, not with the other two.
fn only(what: &str, where_it_is: bool, where_not: [bool; 2]) -> Result<(), String> {
    match (where_it_is, where_not) {
        (true, [false, false]) => Ok(()),
        (false, _) => Err(format!("{what}, and it does not say so (or the stage does not do it: see `Stage::supply`)")),
        (true, _) => Err(format!("it says so where it is not so: {what}")),
    }
}

pub(super) fn battery<S: Stage>(stage: &mut S) -> Result<(), Verdict>
where
    Out<S>: Power,
{
    let [well, low, plugged] = each(stage)?;
    only("its battery is low", low.is_low, [well.is_low, plugged.is_low])?;
    if low.volts >= well.volts {
        let why = format!("its battery is at {} V when it is low, and at {} V before", low.volts, well.volts);
        return Err(Verdict::Broken(why));
    }
    Ok(())
}

pub(super) fn charger<S: Stage>(stage: &mut S) -> Result<(), Verdict>
where
    Out<S>: Power,
{
    let [well, low, plugged] = each(stage)?;
    only("it is on its charger", plugged.is_plugged, [well.is_plugged, low.is_plugged])?;
    Ok(())
}

/// Returns the states that the robot reports with a charged battery, with a low battery, and on its charger.
fn each<S: Stage>(stage: &mut S) -> Result<[ReportedSupply; 3], Verdict>
where
    Out<S>: Power,
{
    Ok([reported(stage, Supplied::Well)?, reported(stage, Supplied::Low)?, reported(stage, Supplied::Plugged)?])
}
