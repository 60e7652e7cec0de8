//! Quantities that a quark can take as arguments. Each has its own type, so that a speed cannot be passed where an
//! angle is expected.

/// Declares quantities: a newtype over `f64` in one SI unit.
macro_rules! quantities {
    ($($(#[$doc:meta])* $name:ident;)*) => {$(
        $(#[$doc])*
        #[derive(Debug, Clone, Copy, PartialEq, PartialOrd, Default)]
        pub struct $name(pub f64);
    )*};
}

quantities! {
    /// A length, in metres.
    Meters;
    /// A speed, in metres per second.
    MetersPerSecond;
    /// An angle, in radians, counter-clockwise positive.
    Radians;
    /// A turn rate, in radians per second, counter-clockwise positive.
    RadiansPerSecond;
    /// A voltage, in volts.
    Volts;
}

impl Radians {
    /// Returns the angle of this many degrees, in radians.
    #[must_use]
    pub const fn from_degrees(degrees: f64) -> Self {
        Self(degrees * (core::f64::consts::PI / 180.0))
    }

    /// Returns this angle in degrees.
    #[must_use]
    pub const fn degrees(self) -> f64 {
        self.0 * (180.0 / core::f64::consts::PI)
    }

    /// Returns this direction as an angle between -π and π.
    #[must_use]
    pub fn wrapped(self) -> Self {
        use core::f64::consts::{PI, TAU};
        // Most angles are at most one turn outside the range. For these a subtraction is exact too, and much faster.
        let size = self.0.abs();
        if size < PI {
            self
        } else if PI < size && size < 3.0 * PI {
            Self(libm::copysign(1.0, self.0) * (size - TAU))
        } else {
            Self(libm::remainder(self.0, TAU))
        }
    }
}

/// A word of `N` bits, as in `atIsection 0100`, in the order in which they are written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Bits<const N: usize>(pub [bool; N]);

#[cfg(test)]
mod tests {
    use core::f64::consts::{FRAC_PI_2, PI, TAU};

    use super::*;

    #[test]
    fn a_wrapped_angle_lies_between_minus_pi_and_pi() {
        for (angle, wrapped) in [(0.0, 0.0), (PI, PI), (-PI, -PI), (3.0 * FRAC_PI_2, -FRAC_PI_2), (-TAU, 0.0)] {
            assert!((Radians(angle).wrapped().0 - wrapped).abs() < 1e-12, "{angle}");
        }
        for degrees in -2000..2000 {
            let angle = Radians::from_degrees(f64::from(degrees));
            let wrapped = angle.wrapped();
            assert!(wrapped.0.abs() <= PI, "{degrees}");
            assert!((libm::cos(wrapped.0) - libm::cos(angle.0)).abs() < 1e-9, "{degrees}");
            assert!((libm::sin(wrapped.0) - libm::sin(angle.0)).abs() < 1e-9, "{degrees}");
        }
    }

    #[test]
    fn a_wrapped_angle_is_the_remainder_to_the_bit() {
        let half_turns = (-9..=9).map(|half_turns| f64::from(half_turns) * PI);
        let beside = half_turns.flat_map(|angle| [angle.next_down(), angle, angle.next_up()]);
        let between = (-20_000..20_000).map(|step| f64::from(step) * 1e-3);
        for angle in beside.chain(between).chain([-0.0, f64::INFINITY, f64::NAN]) {
            let (wrapped, remainder) = (Radians(angle).wrapped().0, libm::remainder(angle, TAU));
            assert!(wrapped.to_bits() == remainder.to_bits() || remainder.is_nan() && wrapped.is_nan(), "{angle:?}");
        }
    }
}
