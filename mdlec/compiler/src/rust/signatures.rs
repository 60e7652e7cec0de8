//! Emits the signatures that a target's crate has to implement for the quarks of an alphabet. Each unit has its own
//! type.

use proc_macro2::{Ident, Literal, TokenStream};
use quote::{format_ident, quote};

use super::bound::Bound;
use crate::alphabet::Kind;

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
        .filter(|(_, kind)| matches!(kind, Kind::Bits(_)))
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
pub(super) fn argument_type(kind: Kind) -> TokenStream {
    match kind {
        Kind::Length => quote!(runtime::Meters),
        Kind::Speed => quote!(runtime::MetersPerSecond),
        Kind::Angle => quote!(runtime::Radians),
        Kind::AngularRate => quote!(runtime::RadiansPerSecond),
        Kind::Time => quote!(runtime::Nanos),
        Kind::Voltage => quote!(runtime::Volts),
        Kind::Frequency | Kind::Number => quote!(f64),
        Kind::Integer => quote!(i64),
        Kind::Count => quote!(u64),
        Kind::Bits(length) => {
            let length = Literal::u32_unsuffixed(length);
            quote!(runtime::Bits<#length>)
        }
        Kind::Sonar => quote!(runtime::SonarId),
        Kind::Robot | Kind::Module | Kind::File => quote!(&'static str),
    }
}

/// Returns the variant of `Argument` for a parameter of this kind.
fn argument_variant(kind: Kind) -> Ident {
    let name = match kind {
        Kind::Length => "Length",
        Kind::Speed => "Speed",
        Kind::Angle => "Angle",
        Kind::AngularRate => "AngularRate",
        Kind::Time => "Time",
        Kind::Voltage => "Voltage",
        Kind::Frequency | Kind::Number => "Number",
        Kind::Integer => "Integer",
        Kind::Count => "Count",
        Kind::Bits(_) => "Bits",
        Kind::Sonar => "Sonar",
        Kind::Robot | Kind::Module | Kind::File => "Name",
    };
    format_ident!("{name}")
}
