//! The tree-sitter grammar of MDLe. The build script generates and compiles its parser from `editors/tree-sitter`.

use tree_sitter_language::LanguageFn;

unsafe extern "C" {
    fn tree_sitter_mdle() -> *const ();
}

/// The tree-sitter grammar of MDLe.
// SAFETY: the generated parser defines this function, and its result is valid forever.
pub const LANGUAGE: LanguageFn = unsafe { LanguageFn::from_raw(tree_sitter_mdle) };
