//! Emits the signatures that a target's crate has to implement for the quarks of an alphabet. Each unit has its own
//! type.

use proc_macro2::{Ident, Literal, TokenStream};
use quote::{format_ident, quote};

use super::bound::Bound;
use crate::alphabet::ParameterKind;

/// Emits the function that constructs a quark from its arguments: `const fn go(arguments: &[Argument<'_>]) ->
/// Option<Go>`, preceded by `visibility`. The function fails to compile if the quark's type does not match the
/// alphabet.
pub(super) fn from_arguments(quark: &Bound<'_>, visibility: &TokenStream) -> TokenStream {
    let (kind, function, doc) = (&quark.kind, &quark.function, quark.doc());
    let parameters: Vec<_> = quark.parameters().collect();
    let names: Vec<_> = parameters.iter().map(|(name, _)| name).collect();
    let patterns = parameters.iter().map(|(name, kind)| {
        let variant = argument_variant(*kind);
        quote!(runtime::Argument::#variant(#name))
    });
    // Converts a slice to a word if the slice has the right length.
    let words = parameters
        .iter()
        .filter(|(_, kind)| matches!(kind, ParameterKind::Bits(_)))
        .map(|(name, _)| quote!(let Some(#name) = runtime::Bits::from_slice(#name) else { return None };));
    quote! {
        #[doc = #doc]
        #visibility const fn #function(arguments: &[runtime::Argument<'_>]) -> Option<#kind> {
            let &[#(#patterns),*] = arguments else { return None };
            #(#words)*
            Some(#kind::new(#(#names),*))
        }
    }
}

/// Returns the type of an argument of this kind.
pub(super) fn argument_type(kind: ParameterKind) -> TokenStream {
    match kind {
        ParameterKind::Length => quote!(runtime::Meters),
        ParameterKind::Speed => quote!(runtime::MetersPerSecond),
        ParameterKind::Angle => quote!(runtime::Radians),
        ParameterKind::AngularRate => quote!(runtime::RadiansPerSecond),
        ParameterKind::Time => quote!(runtime::Nanos),
        ParameterKind::Voltage => quote!(runtime::Volts),
        ParameterKind::Frequency | ParameterKind::Number => quote!(f64),
        ParameterKind::Integer => quote!(i64),
        ParameterKind::Count => quote!(u64),
        ParameterKind::Bits(length) => {
            let length = Literal::u32_unsuffixed(length);
            quote!(runtime::Bits<#length>)
        }
        ParameterKind::Sonar => quote!(runtime::SonarId),
        ParameterKind::Robot | ParameterKind::Module | ParameterKind::File => quote!(&'static str),
    }
}

/// Returns the variant of `Argument` for a parameter of this kind.
fn argument_variant(kind: ParameterKind) -> Ident {
    let name = match kind {
        ParameterKind::Length => "Length",
        ParameterKind::Speed => "Speed",
        ParameterKind::Angle => "Angle",
        ParameterKind::AngularRate => "AngularRate",
        ParameterKind::Time => "Time",
        ParameterKind::Voltage => "Voltage",
        ParameterKind::Frequency | ParameterKind::Number => "Number",
        ParameterKind::Integer => "Integer",
        ParameterKind::Count => "Count",
        ParameterKind::Bits(_) => "Bits",
        ParameterKind::Sonar => "Sonar",
        ParameterKind::Robot | ParameterKind::Module | ParameterKind::File => "Name",
    };
    format_ident!("{name}")
}
