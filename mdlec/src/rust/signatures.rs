//! The signatures of an alphabet's quarks as Rust: what a target's crate must have, with a type for each unit.

use proc_macro2::{Ident, Literal, TokenStream};
use quote::{format_ident, quote};

use super::bind::Bound;
use super::names::Distinct;
use crate::alphabet::{Alphabet, Capability, Kind};

/// `mod signatures`: what does not compile where a quark is not as the alphabet says.
pub(super) fn signatures(quarks: &[Bound<'_>], alphabet: &Alphabet) -> TokenStream {
    let mut names = Distinct::functions();
    let functions = quarks.iter().map(|quark| {
        let (kind, doc) = (&quark.kind, quark.doc());
        let function = names.scope_function(&kind.to_string());
        let (arguments, types): (Vec<_>, Vec<_>) =
            quark.parameters().map(|(name, kind)| (name, parameter_type(kind))).unzip();
        quote! {
            #[doc = #doc]
            const fn #function(#(#arguments: #types),*) -> #kind { #kind::new(#(#arguments),*) }
        }
    });
    let capabilities: Vec<_> = alphabet.capabilities.iter().filter_map(capability_trait).collect();
    let capable = (!capabilities.is_empty()).then(|| {
        quote! {
            #[doc = " The output has what the capabilities need."]
            const fn capable<Y: #(runtime::capability::#capabilities)+*>() {}
            const _: () = capable::<Output>();
        }
    });
    quote! {
        #[doc = " The quarks as plans make them: a crate whose quarks are otherwise does not compile."]
        #[allow(dead_code, reason = "what stands here is to be compiled, not called")]
        mod signatures {
            use super::*;
            #capable
            #(#functions)*
        }
    }
}

/// The trait of a capability; `None` for one that no trait of ours stands for.
fn capability_trait(capability: &Capability) -> Option<Ident> {
    let name = match capability.name.as_str() {
        "odometry" => "Odometry",
        "bumper" => "Bumpers",
        "diff_drive" => "DiffDrive",
        "sonar" => "SonarRing",
        "paths" => "Paths",
        "power" => "Power",
        _ => return None,
    };
    Some(format_ident!("{name}"))
}

/// The type that a parameter of this kind has in `new`.
fn parameter_type(kind: Kind) -> TokenStream {
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

/// The variant of `Argument` that a parameter of this kind takes.
pub(super) fn argument_variant(kind: Kind) -> Ident {
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
