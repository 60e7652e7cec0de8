//! Finds the parts of a file that a mutant can change: expressions and statements outside its tests.

use std::ops::Range;

use syn::punctuated::Punctuated;
use syn::spanned::Spanned;
use syn::visit::{self, Visit};
use syn::{Attribute, Block, Expr, Ident, Lit, Member, Pat, RangeLimits, Token, Type, UnOp};

use crate::operators::{can_be_left_out, mistaken, neighbours, other_operator};
use crate::pieces::{can_be_deleted, is_alike, is_test, leaves};
use crate::template;

/// A change: `new` replaces the text in the range `place`.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Change {
    pub(crate) place: Range<usize>,
    pub(crate) new: String,
    /// Name of the function or constant that contains the change.
    pub(crate) function: String,
}

/// Returns all changes of a file.
///
/// # Errors
/// Fails if the text is not Rust.
pub(crate) fn changes(text: &str) -> syn::Result<Vec<Change>> {
    let file = syn::parse_file(text)?;
    let mut finder = Finder { text, function: String::new(), changes: Vec::new() };
    finder.visit_file(&file);
    Ok(finder.changes)
}

struct Finder<'t> {
    text: &'t str,
    function: String,
    changes: Vec<Change>,
}

impl Finder<'_> {
    /// Records a change, unless it leaves the text as it is.
    fn change(&mut self, place: Range<usize>, new: impl Into<String>) {
        let change = Change { place, new: new.into(), function: self.function.clone() };
        if !self.changes.contains(&change) && self.text[change.place.clone()] != change.new {
            self.changes.push(change);
        }
    }

    /// Returns the original text of a node.
    fn old(&self, node: &impl Spanned) -> String {
        self.text[range(node)].to_owned()
    }

    /// Visits the content of a function or constant.
    fn inside(&mut self, name: &Ident, visit: impl FnOnce(&mut Self)) {
        let around = std::mem::replace(&mut self.function, name.to_string());
        visit(self);
        self.function = around;
    }

    /// Records the exchange of two adjacent operands or statements.
    fn exchange(&mut self, one: &impl Spanned, other: &impl Spanned) {
        let (start, end) = (range(one), range(other));
        let between = self.text[start.end..end.start].to_owned();
        self.change(start.start..end.end, [self.old(other), between, self.old(one)].concat());
    }

    fn exchange_neighbours(&mut self, list: &Punctuated<Expr, Token![,]>) {
        for (one, other) in list.iter().zip(list.iter().skip(1)) {
            if is_alike(one, other) {
                self.exchange(one, other);
            }
        }
    }

    /// Records the exchange of the values of two arms of a `match`. A comma is added after an expression that replaces
    /// a block, because a block needs no comma.
    fn exchange_bodies(&mut self, one: &Expr, other: &Expr) {
        let (start, end) = (range(one), range(other));
        let (old, new) = (self.old(one), self.old(other));
        let between = self.text[start.end..end.start].trim_start_matches(',');
        let comma = if self.text[end.end..].starts_with(',') { "" } else { "," };
        if old != new {
            self.change(start.start..end.end, [&*new, ",", between, &old, comma].concat());
        }
    }

    /// Records the negation of a condition. Comparisons and negations are excluded, because their parts are changed
    /// anyway.
    fn negate(&mut self, condition: &Expr) {
        if !matches!(condition, Expr::Let(_) | Expr::Binary(_) | Expr::Unary(_) | Expr::Paren(_) | Expr::Lit(_)) {
            self.change(range(condition), format!("(!{})", self.old(condition)));
        }
    }
}

impl<'ast> Visit<'ast> for Finder<'_> {
    fn visit_attribute(&mut self, _: &'ast Attribute) {}

    fn visit_type(&mut self, _: &'ast Type) {}

    fn visit_item_mod(&mut self, module: &'ast syn::ItemMod) {
        if !module.attrs.iter().any(is_test) {
            visit::visit_item_mod(self, module);
        }
    }

    fn visit_item_fn(&mut self, function: &'ast syn::ItemFn) {
        self.inside(&function.sig.ident, |finder| visit::visit_item_fn(finder, function));
    }

    fn visit_impl_item_fn(&mut self, function: &'ast syn::ImplItemFn) {
        self.inside(&function.sig.ident, |finder| visit::visit_impl_item_fn(finder, function));
    }

    fn visit_trait_item_fn(&mut self, function: &'ast syn::TraitItemFn) {
        self.inside(&function.sig.ident, |finder| visit::visit_trait_item_fn(finder, function));
    }

    fn visit_impl_item_const(&mut self, constant: &'ast syn::ImplItemConst) {
        self.inside(&constant.ident, |finder| visit::visit_impl_item_const(finder, constant));
    }

    fn visit_item_const(&mut self, constant: &'ast syn::ItemConst) {
        self.inside(&constant.ident, |finder| visit::visit_item_const(finder, constant));
    }

    fn visit_expr_binary(&mut self, binary: &'ast syn::ExprBinary) {
        if let Some(other) = other_operator(&binary.op) {
            self.change(range(&binary.op), other);
        }
        visit::visit_expr_binary(self, binary);
    }

    fn visit_expr_unary(&mut self, unary: &'ast syn::ExprUnary) {
        if matches!(unary.op, UnOp::Not(_) | UnOp::Neg(_)) {
            self.change(range(&unary.op), "");
        }
        visit::visit_expr_unary(self, unary);
    }

    fn visit_lit(&mut self, literal: &'ast Lit) {
        match literal {
            Lit::Int(number) => {
                let both = neighbours(number.base10_digits(), number.suffix());
                both.into_iter().for_each(|number| self.change(range(literal), number));
            }
            Lit::Float(number) => {
                let is_zero = number.base10_parse::<f64>().is_ok_and(|number| number == 0.0);
                self.change(range(literal), if is_zero { "1.0" } else { "0.0" });
            }
            Lit::Bool(value) => self.change(range(literal), (!value.value).to_string()),
            // Texts are not changed, because they are for people; where code depends on a text, the comparison is
            // changed.
            _ => {}
        }
    }

    fn visit_expr_field(&mut self, field: &'ast syn::ExprField) {
        if let Member::Named(name) = &field.member
            && let Some(other) = mistaken(&name.to_string())
        {
            self.change(range(name), other);
        }
        visit::visit_expr_field(self, field);
    }

    fn visit_expr_method_call(&mut self, call: &'ast syn::ExprMethodCall) {
        let method = call.method.to_string();
        if let Some(other) = mistaken(&method) {
            self.change(range(&call.method), other);
        }
        if can_be_left_out(&method) {
            self.change(range(&call.receiver).end..range(call).end, "");
        }
        if method == "then" || method == "then_some" {
            self.negate(&call.receiver);
        }
        self.exchange_neighbours(&call.args);
        visit::visit_expr_method_call(self, call);
    }

    fn visit_expr_call(&mut self, call: &'ast syn::ExprCall) {
        if self.old(&call.func) == "Some" {
            self.change(range(call), "None");
        }
        self.exchange_neighbours(&call.args);
        visit::visit_expr_call(self, call);
    }

    fn visit_expr_array(&mut self, array: &'ast syn::ExprArray) {
        self.exchange_neighbours(&array.elems);
        let places: Vec<_> = array.elems.iter().map(range).collect();
        let ends = places.iter().skip(1).map(|next| next.start).chain([range(array).end.saturating_sub(1)]);
        for ((element, place), end) in array.elems.iter().zip(&places).zip(ends) {
            if matches!(element, Expr::Lit(literal) if matches!(literal.lit, Lit::Str(_))) {
                self.change(place.start..end, "");
            }
        }
        visit::visit_expr_array(self, array);
    }

    fn visit_expr_tuple(&mut self, tuple: &'ast syn::ExprTuple) {
        self.exchange_neighbours(&tuple.elems);
        visit::visit_expr_tuple(self, tuple);
    }

    fn visit_expr_struct(&mut self, literal: &'ast syn::ExprStruct) {
        if let Some(rest) = &literal.dot2_token {
            let starts = literal.fields.iter().skip(1).map(|field| range(field).start).chain([range(rest).start]);
            let places: Vec<_> = literal.fields.iter().map(|field| range(field).start).zip(starts).collect();
            places.into_iter().for_each(|(start, end)| self.change(start..end, ""));
        }
        visit::visit_expr_struct(self, literal);
    }

    fn visit_expr_range(&mut self, both: &'ast syn::ExprRange) {
        if both.end.is_some() {
            let other = if matches!(both.limits, RangeLimits::HalfOpen(_)) { "..=" } else { ".." };
            self.change(range(&both.limits), other);
        }
        visit::visit_expr_range(self, both);
    }

    fn visit_expr_if(&mut self, branch: &'ast syn::ExprIf) {
        self.negate(&branch.cond);
        visit::visit_expr_if(self, branch);
    }

    fn visit_expr_while(&mut self, repeated: &'ast syn::ExprWhile) {
        self.negate(&repeated.cond);
        visit::visit_expr_while(self, repeated);
    }

    fn visit_expr_match(&mut self, choice: &'ast syn::ExprMatch) {
        for (one, other) in choice.arms.iter().zip(choice.arms.iter().skip(1)) {
            self.exchange_bodies(&one.body, &other.body);
        }
        for arm in &choice.arms {
            if let Pat::Guard(guarded) = &arm.pat {
                self.change(range(&guarded.pat).end..range(&guarded.guard).end, "");
            }
        }
        visit::visit_expr_match(self, choice);
    }

    fn visit_block(&mut self, block: &'ast Block) {
        for statement in &block.stmts {
            // A branch that only leaves the function or loop is deleted together with its `if`.
            if can_be_deleted(statement) && !(block.stmts.len() == 1 && leaves(statement)) {
                self.change(range(statement), "");
            }
        }
        visit::visit_block(self, block);
    }

    fn visit_macro(&mut self, invocation: &'ast syn::Macro) {
        if invocation.path.is_ident("quote") {
            let text = self.text;
            template::changes(text, invocation.tokens.clone(), &mut |place, new| {
                self.change(place, new.unwrap_or_default());
            });
        } else if let Ok(arguments) = invocation.parse_body_with(Punctuated::<Expr, Token![,]>::parse_terminated) {
            arguments.iter().for_each(|argument| Visit::visit_expr(self, argument));
        }
    }
}

/// Returns the byte range of a node.
fn range(node: &impl Spanned) -> Range<usize> {
    node.span().byte_range()
}
