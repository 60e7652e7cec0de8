//! The battery. Driving and standby discharge it, a charger charges it, and its voltage falls with its charge.

use std::sync::Arc;

use mdle_runtime::{Supply, Volts};

/// A battery and its consumers, in watts, joules and volts.
///
/// The documents on the robots give no figures, so the figures are assumptions: a pair of lead-acid batteries that
/// suits the size of the robot, and the power of a computer with sonars. The energy per metre assumes rolling friction
/// of a twentieth of the weight and motors of 30 % efficiency.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Pack {
    /// Energy of the full battery, in joules.
    pub(crate) capacity: f64,
    /// Power that is consumed all the time, in watts.
    pub(crate) standby: f64,
    /// Energy that the motors need per metre of rolling, in joules. The distance is the mean of both wheels.
    pub(crate) metre: f64,
    /// Power that the charger supplies, in watts.
    pub(crate) charger: f64,
    /// Number of lead-acid cells.
    pub(crate) cells: f64,
}

/// Number of joules in a watt-hour.
const WATT_HOUR: f64 = 3600.0;
/// Three voltages of a cell at rest: of an empty cell, of a full cell, and the voltage below which the battery has to
/// be charged (10.8 V for six cells).
const EMPTY: f64 = 1.75;
const FULL: f64 = 2.12;
const LOW: f64 = 1.8;

impl Pack {
    /// Battery of a robot with a mass of 25 kg: 12 V, 36 Ah.
    pub(crate) const SCOUT: Self =
        Self { capacity: 432.0 * WATT_HOUR, standby: 30.0, metre: 41.0, charger: 120.0, cells: 6.0 };
    /// Battery of a robot with a mass of 40 kg: 24 V, 30 Ah.
    pub(crate) const ATRV: Self =
        Self { capacity: 720.0 * WATT_HOUR, standby: 40.0, metre: 65.0, charger: 200.0, cells: 12.0 };
}

/// A battery, with its current charge.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Battery {
    /// Constants of the battery, which all robots with the same body share.
    pack: Arc<Pack>,
    /// Charge, from 0 (empty) to 1 (full).
    charge: f64,
}

impl Battery {
    /// Creates a battery with this charge, from 0 to 1.
    pub(crate) fn new(pack: impl Into<Arc<Pack>>, charge: f64) -> Self {
        Self { pack: pack.into(), charge: charge.clamp(0.0, 1.0) }
    }

    /// Sets the charge, from 0 to 1.
    pub(crate) fn charge(&mut self, charge: f64) {
        self.charge = charge.clamp(0.0, 1.0);
    }

    /// Updates the charge after a time of `seconds`, in which the wheels have rolled `rolled` metres. `is_plugged` is
    /// `true` on the charger.
    pub(crate) fn passed(&mut self, seconds: f64, rolled: f64, is_plugged: bool) {
        let Pack { capacity, standby, metre, charger, .. } = *self.pack;
        let given = if is_plugged { charger } else { 0.0 };
        self.charge = (self.charge + ((given - standby) * seconds - metre * rolled) / capacity).clamp(0.0, 1.0);
    }

    /// Returns `true` if the battery is too empty to drive.
    pub(crate) fn is_empty(&self) -> bool {
        self.charge <= 0.0
    }

    /// Returns the voltage and the flags that the robot measures.
    pub(crate) fn supply(&self, is_plugged: bool) -> Supply {
        let cell = EMPTY + (FULL - EMPTY) * self.charge;
        Supply { battery: Volts(cell * self.pack.cells), is_low: cell < LOW, is_plugged }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_full_battery_lasts_for_its_capacity() {
        let mut battery = Battery::new(Pack::SCOUT, 1.0);
        // An hour at 50 cm/s: 30 W and 20.5 W of 432 Wh.
        (0..36_000).for_each(|_| battery.passed(0.1, 0.05, false));
        assert!((battery.charge - (1.0 - 50.5 / 432.0)).abs() < 1e-9, "{battery:?}");
        (0..360).for_each(|_| battery.passed(3600.0, 0.0, false));
        assert!(battery.is_empty() && battery.supply(false).is_low);
        assert!((battery.supply(false).battery.0 - 10.5).abs() < 1e-9);
    }

    #[test]
    fn a_charger_charges_until_the_battery_is_full() {
        let mut battery = Battery::new(Pack::SCOUT, 0.1);
        assert!(battery.supply(true).is_low);
        battery.passed(3600.0, 0.0, true);
        assert!((battery.charge - (0.1 + 90.0 / 432.0)).abs() < 1e-9 && !battery.supply(true).is_low);
        battery.passed(1e6, 0.0, true);
        assert!((battery.supply(true).battery.0 - 12.72).abs() < 1e-9);
    }
}
