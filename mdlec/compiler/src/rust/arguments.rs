//! Emits quarks and their arguments as Rust values, in SI units.

use mdle_runtime::Radians;
use proc_macro2::{Literal, TokenStream};
use quote::quote;

use super::names::quark_type;
use crate::alphabet::ParameterKind;
use crate::plan::{Compared, Comparison, Operator, Quark, QuarkId, Value, in_degrees};

/// Emits the type of a quark: `robot::Go`, or for a comparison `runtime::Comparison<robot::R, robot::X>`. `quarks`
/// contains all quarks of the plan.
pub(super) fn type_of(quark: &Quark, quarks: &[Quark]) -> TokenStream {
    let Some(comparison) = &quark.comparison else {
        let kind = quark_type(&quark.name, quark.overload);
        return quote!(robot::#kind);
    };
    let signal = type_of(&quarks[comparison.signal.0 as usize], quarks);
    let with = match comparison.with {
        Compared::Signal(other) => type_of(&quarks[other.0 as usize], quarks),
        Compared::Value(_) => quote!(runtime::NoSignal),
    };
    quote!(runtime::Comparison<#signal, #with>)
}

/// Emits a comparison: `runtime::Comparison::new(…)`. `signal` emits the signals of the comparison. If a signal is
/// compared with a value, `none` is used as the type of the second signal.
pub(super) fn compared(
    comparison: &Comparison,
    none: &TokenStream,
    signal: impl Fn(QuarkId) -> TokenStream,
) -> TokenStream {
    let left = signal(comparison.signal);
    let tolerance = number(comparison.tolerance.in_si());
    let operator = match (comparison.operator, &comparison.tolerance) {
        (Operator::Equal, Value::Quantity { kind: ParameterKind::Angle, .. }) => quote!(SameDirection(#tolerance)),
        (Operator::Equal, _) => quote!(Equal(#tolerance)),
        (Operator::Less, _) => quote!(Less),
        (Operator::LessOrEqual, _) => quote!(LessOrEqual),
        (Operator::Greater, _) => quote!(Greater),
        (Operator::GreaterOrEqual, _) => quote!(GreaterOrEqual),
    };
    let with = match &comparison.with {
        Compared::Signal(other) => {
            let other = signal(*other);
            quote!(runtime::Operand::Signal(#other))
        }
        Compared::Value(value) => {
            let value = number(value.in_si());
            quote!(runtime::Operand::<#none>::Value(#value))
        }
    };
    quote!(runtime::Comparison::new(#left, runtime::Operator::#operator, #with))
}

/// Emits a quark with its arguments for use in a constant: `robot::Go::new(…)`. `quarks` contains all quarks of the
/// plan.
pub(super) fn quark_value(quark: &Quark, quarks: &[Quark]) -> TokenStream {
    if let Some(comparison) = &quark.comparison {
        return compared(comparison, &quote!(runtime::NoSignal), |signal| {
            quark_value(&quarks[signal.0 as usize], quarks)
        });
    }
    let kind = quark_type(&quark.name, quark.overload);
    let arguments = arguments(quark);
    quote!(robot::#kind::new(#(#arguments),*))
}

/// Emits the arguments of a quark that is not a comparison.
pub(super) fn arguments(quark: &Quark) -> impl Iterator<Item = TokenStream> {
    quark.args.iter().map(argument)
}

/// Emits an angle. If a number of degrees with at most six decimals converts to exactly this angle, emits degrees;
/// otherwise, emits radians.
pub(super) fn angle(radians: f64) -> TokenStream {
    if let Some(degrees) = exact_degrees(radians).map(number) {
        return quote!(runtime::Radians::from_degrees(#degrees));
    }
    let radians = number(radians);
    quote!(runtime::Radians(#radians))
}

/// Returns the number of degrees that converts to exactly this angle; `None` if there is no such number. The angles of
/// nested frames are added in radians: the sum of 30° and 45° is not exactly the value of 75°, but the floating-point
/// number next to it.
pub(super) fn exact_degrees(radians: f64) -> Option<f64> {
    in_degrees(radians).filter(|degrees| Radians::from_degrees(*degrees).0 == radians)
}

/// Emits a number. The sign is a separate token in Rust's syntax.
pub(super) fn number(value: f64) -> TokenStream {
    let digits = Literal::f64_unsuffixed(value.abs());
    if value.is_sign_negative() { quote!(-#digits) } else { quote!(#digits) }
}

/// Emits an argument as a value of the type for its unit.
fn argument(value: &Value) -> TokenStream {
    match value {
        Value::Quantity { kind, exact, .. } => {
            let si = value.in_si();
            let number = number(si);
            match kind {
                ParameterKind::Length => quote!(runtime::Meters(#number)),
                ParameterKind::Speed => quote!(runtime::MetersPerSecond(#number)),
                ParameterKind::Angle => angle(si),
                ParameterKind::AngularRate => quote!(runtime::RadiansPerSecond(#number)),
                ParameterKind::Voltage => quote!(runtime::Volts(#number)),
                ParameterKind::Time => {
                    let nanos = Literal::u64_unsuffixed(exact.to_nanos().unwrap_or(u64::MAX));
                    quote!(runtime::Nanos(#nanos))
                }
                ParameterKind::Frequency
                | ParameterKind::Number
                | ParameterKind::Integer
                | ParameterKind::Count
                | ParameterKind::Bits(_)
                | ParameterKind::Sonar
                | ParameterKind::Robot
                | ParameterKind::Module
                | ParameterKind::File => quote!(#number),
            }
        }
        Value::Infinity(ParameterKind::Time) => quote!(runtime::Nanos::MAX),
        Value::Infinity(_) => quote!(u64::MAX),
        Value::Bits(bits) => quote!(runtime::Bits([#(#bits),*])),
        Value::Integer(whole) => {
            let digits = Literal::u64_unsuffixed(whole.unsigned_abs());
            if *whole < 0 { quote!(-#digits) } else { quote!(#digits) }
        }
        Value::Sonar(sonar) => {
            let sonar = Literal::u8_unsuffixed(*sonar);
            quote!(runtime::SonarId::new(#sonar))
        }
        Value::Name(_, name) => quote!(#name),
    }
}

#[cfg(test)]
mod tests {
    use super::{Radians, angle, exact_degrees};

    #[test]
    fn an_angle_is_emitted_in_degrees_only_where_these_give_the_same_value() {
        let [alone, sum] = [30.0, 30.0 + 45.0].map(|degrees| Radians::from_degrees(degrees).0);
        assert_eq!(angle(alone).to_string(), "runtime :: Radians :: from_degrees (30.0)");
        let nested = alone + Radians::from_degrees(45.0).0;
        assert_ne!(nested, sum);
        assert_eq!(angle(nested).to_string(), format!("runtime :: Radians ({nested})"));
        for (outer, inner) in (-720..720).zip((0..360).rev().cycle()) {
            let nested = Radians::from_degrees(f64::from(outer)).0 + Radians::from_degrees(f64::from(inner)).0;
            let same = exact_degrees(nested).is_none_or(|degrees| Radians::from_degrees(degrees).0 == nested);
            assert!(same, "{outer}° + {inner}°");
        }
    }
}
