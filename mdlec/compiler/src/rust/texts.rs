//! Emits many short texts as one long text, because rustc needs no more time for a long literal than for a short one.

use proc_macro2::{Literal, TokenStream};
use quote::quote;

/// Emits a list of texts: `runtime::TextList::new(concat!["go 20 0", "stop"], &[7, 11])`.
pub(super) fn text_list<'t>(texts: impl Iterator<Item = &'t str>) -> TokenStream {
    let (mut parts, mut ends, mut end) = (Vec::new(), Vec::new(), 0_usize);
    for text in texts {
        end += text.len();
        ends.push(Literal::usize_unsuffixed(end));
        parts.extend(Some(text).filter(|text| !text.is_empty()));
    }
    match parts.is_empty() {
        // The list contains no texts at all.
        true if ends.is_empty() => quote!(runtime::TextList::NONE),
        true => quote!(runtime::TextList::new("", &[#(#ends),*])),
        false => quote!(runtime::TextList::new(concat![#(#parts),*], &[#(#ends),*])),
    }
}
