//! Mutant schemata: a file in which every function contains its mutants beside its original body. A mutant is selected
//! at run time.
//!
//! A body becomes `match __mutant() { 17 => { the body with change 17 }, _ => { the original body } }`, so a single
//! build contains all mutants. This is impossible for code that rustc evaluates at compile time, and for functions that
//! return `impl Trait`.

use std::ops::Range;

use syn::spanned::Spanned;
use syn::visit::{self, Visit};
use syn::{Block, ReturnType, Signature, TypeImplTrait};

use crate::mutant::Mutant;

/// Environment variable with the number of the selected mutant. Without it, no mutant is selected.
pub(crate) const VARIABLE: &str = "MDLE_MUTANT";

/// Code that is added to each file. It reads the environment variable once, without `std`, which is not available in
/// the runtime.
const CHOICE: &str = r#"
fn __mutant() -> u32 {
    use core::ffi::{CStr, c_char};
    use core::sync::atomic::{AtomicU32, Ordering};
    unsafe extern "C" {
        safe fn getenv(name: *const c_char) -> *const c_char;
    }
    static CHOSEN: AtomicU32 = AtomicU32::new(u32::MAX);
    if CHOSEN.load(Ordering::Relaxed) == u32::MAX {
        let text = getenv(c"MDLE_MUTANT".as_ptr());
        let number = if text.is_null() { None } else { unsafe { CStr::from_ptr(text) }.to_str().ok() };
        CHOSEN.store(number.and_then(|number| number.parse().ok()).unwrap_or(0), Ordering::Relaxed);
    }
    CHOSEN.load(Ordering::Relaxed)
}
"#;

/// A file that contains mutants.
#[derive(Debug)]
pub(crate) struct Schema {
    pub(crate) text: String,
    variants: Vec<Variant>,
}

/// A version of a function's body, with its place in the text.
#[derive(Debug)]
struct Variant {
    place: Range<usize>,
    body: Body,
}

/// Version of a function's body.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) enum Body {
    /// Body with the change of this mutant.
    Changed(u32),
    /// Original body; contains the numbers of the mutants beside it.
    Original(Vec<u32>),
}

impl Schema {
    /// Returns the text of a file with these mutants, each with its number. Numbers begin at 1.
    ///
    /// # Errors
    /// Fails if the text is not Rust.
    pub(crate) fn new(text: &str, mutants: &[(u32, &Mutant)]) -> syn::Result<Self> {
        let mut bodies = Bodies::default();
        bodies.visit_file(&syn::parse_file(text)?);
        let mut schema = Self { text: String::new(), variants: Vec::new() };
        let mut end = 0;
        for body in bodies.places {
            let inside = |(_, mutant): &&(u32, &Mutant)| contains(&body, &mutant.place);
            let inside: Vec<_> = mutants.iter().filter(inside).collect();
            if inside.is_empty() {
                continue;
            }
            schema.text.push_str(&text[end..body.start]);
            schema.text.push_str("{ match __mutant() {\n");
            for (number, mutant) in &inside {
                let Mutant { place, new, .. } = mutant;
                let changed = [&text[body.start..place.start], new, &text[place.end..body.end]].concat();
                schema.variant(&number.to_string(), &changed, Body::Changed(*number));
            }
            let numbers = inside.iter().map(|(number, _)| *number).collect();
            schema.variant("_", &text[body.clone()], Body::Original(numbers));
            schema.text.push_str("} }");
            end = body.end;
        }
        schema.text.push_str(&text[end..]);
        schema.text.push_str(CHOICE);
        Ok(schema)
    }

    fn variant(&mut self, number: &str, text: &str, body: Body) {
        self.text.push_str(number);
        self.text.push_str(" => ");
        let start = self.text.len();
        self.text.push_str(text);
        self.variants.push(Variant { place: start..self.text.len(), body });
        self.text.push('\n');
    }

    /// Returns `true` if the text contains this mutant.
    pub(crate) fn holds(&self, number: u32) -> bool {
        self.variants.iter().any(|variant| variant.body == Body::Changed(number))
    }

    /// Returns the body that contains this byte.
    pub(crate) fn at(&self, byte: usize) -> Option<&Body> {
        self.variants.iter().find(|variant| variant.place.contains(&byte)).map(|variant| &variant.body)
    }
}

fn contains(outer: &Range<usize>, inner: &Range<usize>) -> bool {
    outer.start <= inner.start && inner.end <= outer.end
}

/// Functions whose mutants can be selected at run time, in the order of the file. Functions in modules are left out.
#[derive(Debug, Default)]
struct Bodies {
    places: Vec<Range<usize>>,
}

impl Bodies {
    fn body(&mut self, signature: &Signature, body: &Block) {
        if signature.constness.is_none() && !is_opaque(&signature.output) {
            self.places.push(body.span().byte_range());
        }
    }
}

impl<'ast> Visit<'ast> for Bodies {
    fn visit_item_mod(&mut self, _: &'ast syn::ItemMod) {}

    fn visit_item_fn(&mut self, function: &'ast syn::ItemFn) {
        self.body(&function.sig, &function.block);
    }

    fn visit_impl_item_fn(&mut self, function: &'ast syn::ImplItemFn) {
        self.body(&function.sig, &function.block);
    }

    fn visit_trait_item_fn(&mut self, function: &'ast syn::TraitItemFn) {
        if let Some(body) = &function.default {
            self.body(&function.sig, body);
        }
    }
}

/// Returns `true` if the return type contains `impl Trait`. The bodies would then have different types.
fn is_opaque(output: &ReturnType) -> bool {
    #[derive(Default)]
    struct Opaque(bool);
    impl<'ast> Visit<'ast> for Opaque {
        fn visit_type_impl_trait(&mut self, _: &'ast TypeImplTrait) {
            self.0 = true;
        }
    }
    let mut opaque = Opaque::default();
    visit::visit_return_type(&mut opaque, output);
    opaque.0
}

#[cfg(test)]
mod tests {
    use super::{Body, CHOICE, Schema};
    use crate::mutant::mutants;

    const TEXT: &str = "const C: u8 = 1; fn f() -> bool { a < b } const fn g() -> u8 { 2 } fn h() -> impl Ord { 3 }";

    fn schema() -> Schema {
        let mutants = mutants(0, "file.rs", TEXT).unwrap();
        let numbered: Vec<_> = (1..).zip(&mutants).collect();
        Schema::new(TEXT, &numbered).unwrap()
    }

    #[test]
    fn a_body_stands_beside_its_mutants() {
        let schema = schema();
        let text = schema.text.strip_suffix(CHOICE).unwrap();
        assert_eq!(
            text,
            TEXT.replace("{ a < b }", "{ match __mutant() {\n3 => { a <= b }\n_ => { a < b }\n} }"),
            "1 and 2 are the constant's"
        );
        assert_eq!((1..8).filter(|number| schema.holds(*number)).collect::<Vec<_>>(), [3]);
    }

    #[test]
    fn a_place_belongs_to_the_body_that_it_is_in() {
        let schema = schema();
        let at = |text| schema.at(schema.text.find(text).unwrap());
        assert_eq!(at("a <="), Some(&Body::Changed(3)));
        assert_eq!(at("a < b"), Some(&Body::Original(vec![3])));
        assert_eq!(at("const C"), None);
    }
}
