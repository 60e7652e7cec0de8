//! Formats a text in the canonical layout: two spaces for each level, and one element per line in a scope with several
//! elements.
//!
//! The formatter does not change the tokens, and every comment keeps its position among them. The tree only determines
//! where lines may be broken.

mod comments;
mod lines;
mod pieces;

use super::source::FileText;
use super::token::Tok;
use super::tree::{Element, File, Plan, Primary};
use super::{arena_for, parse, printed};
use crate::diagnostic::{Diagnostic, SourceId, Span, has_errors};
use comments::Before;
use lines::FormattedLines;
use pieces::Pieces;

/// Maximum width of a line, in columns; only text that cannot be broken is wider.
const WIDTH: usize = 100;

/// Number of spaces per level.
const INDENT: usize = 2;

/// Returns the text in the canonical layout.
///
/// # Errors
/// Returns the diagnostics if the text has errors. Such a text is not formatted, because the parser had to guess its
/// structure.
pub fn format(id: SourceId, text: &str) -> Result<String, Vec<Diagnostic>> {
    let arena = arena_for(text);
    let (_, found) = parse(id, text, &arena);
    if has_errors(&found) {
        return Err(found);
    }
    let text = printed::with_braces(FileText::new(id, text));
    let arena = arena_for(&text);
    let (file, _) = parse(id, &text, &arena);
    let source = FileText::new(id, &text);
    let mut layout =
        Layout { id: source.id, pieces: Pieces::of(source), at: 0, lines: FormattedLines::default(), depth: 0 };
    layout.file(&file);
    Ok(layout.lines.text())
}

/// State of the formatter: the remaining pieces, in order, and the lines that have been written so far.
struct Layout<'s> {
    id: SourceId,
    pieces: Pieces<'s>,
    /// Index of the next piece.
    at: usize,
    lines: FormattedLines,
    depth: usize,
}

impl Layout<'_> {
    fn file(&mut self, file: &File<'_>) {
        let mut plans = file.plans.iter();
        let mut before = Before::First;
        while let Some(kind) = self.pieces.kind(self.at) {
            if kind == Tok::Use {
                self.boundary(before);
                self.flow(self.at + 2);
                before = Before::Next;
            } else if let Some(plan) = plans.next() {
                self.boundary(if before == Before::First { before } else { Before::Apart });
                self.plan(plan);
                before = Before::Apart;
            } else {
                self.flow(self.at + 1);
            }
        }
        self.boundary(Before::Close);
    }

    /// Writes a plan. If the plan is short, it is written on one line.
    fn plan(&mut self, plan: &Plan<'_>) {
        let end = self.behind(plan.span);
        if breaks(plan) || !self.fits(end) {
            self.list(plan.elements);
        }
        self.flow(end);
    }

    fn element(&mut self, element: &Element<'_>) {
        let end = self.behind(element.span);
        let is_broken = is_broken(element) || !self.fits(end);
        if is_broken {
            match &element.primary {
                Primary::Plan(plan) => self.list(plan.elements),
                Primary::Exec(exec) if self.is_braced(exec.body) => self.list(exec.body),
                Primary::String(body) => self.list(body),
                Primary::Formal(formal) if !is_one_call(formal.body) => self.list(formal.body),
                Primary::Atom(atom) => {
                    let law = self.first(atom.control.span);
                    let is_in_parentheses = self.pieces.kind(law.wrapping_sub(1)) == Some(Tok::LParen);
                    self.pieces.may_break_before(law - usize::from(is_in_parentheses));
                }
                Primary::Exec(_) | Primary::Formal(_) | Primary::Ref(_) | Primary::Broken => {}
            }
        }
        self.flow(end);
    }

    /// Writes the pieces before `elements`, and then each element on separate lines.
    fn list(&mut self, elements: &[Element<'_>]) {
        let Some(first) = elements.first() else { return };
        self.flow(self.first(first.span));
        self.depth += 1;
        let mut before = Before::First;
        for element in elements {
            self.boundary(before);
            self.element(element);
            before = Before::Next;
        }
        if self.pieces.kind(self.at) == Some(Tok::SigmaNull) {
            self.boundary(before);
            self.flow(self.at + 1);
        }
        self.depth -= 1;
        self.boundary(Before::Close);
    }

    /// Returns `true` if the pieces before `end` fit into the current line.
    fn fits(&self, end: usize) -> bool {
        let column = self.lines.width() + usize::from(!self.lines.is_blank());
        !self.pieces.have_comments(self.at + 1, end) && column + self.pieces.width(self.at, end) <= WIDTH
    }

    /// Returns `true` if the body of a loop is in braces and is not the name of a plan.
    fn is_braced(&self, body: &[Element<'_>]) -> bool {
        let first = body.first().map_or(0, |element| self.first(element.span));
        first.checked_sub(1).and_then(|before| self.pieces.kind(before)) == Some(Tok::LBrace)
    }

    /// Returns the index of the first piece of a span.
    fn first(&self, span: Span) -> usize {
        self.pieces.at_byte(span.within(self.id).start)
    }

    /// Returns the index of the first piece after a span.
    fn behind(&self, span: Span) -> usize {
        self.pieces.at_byte(span.within(self.id).end)
    }

    /// Writes the pieces before `end` on the current line; a line that would be too long breaks before an operator or a
    /// law.
    fn flow(&mut self, end: usize) {
        let further = INDENT * self.depth + 2 * INDENT;
        while self.at < end {
            self.comments_inside(further);
            let chunk = self.pieces.chunk(self.at, end);
            let is_full = chunk.may_break && self.lines.width() + 1 + chunk.width > WIDTH;
            if self.lines.is_closed() || is_full && self.lines.width() > further {
                self.lines.start(further);
            }
            self.lines.word(&self.pieces.get(self.at).text, self.pieces.get(self.at).is_glued);
            self.at += 1;
        }
    }
}

/// Returns `true` if a plan is written on several lines even if it is short.
fn breaks(plan: &Plan<'_>) -> bool {
    plan.elements.len() > 1 || plan.elements.iter().any(is_broken)
}

/// Returns `true` if a body is a single law or the name of a plan.
fn is_one_call(body: &[Element<'_>]) -> bool {
    matches!(body, [Element { primary: Primary::Ref(_), .. }])
}

fn is_broken(element: &Element<'_>) -> bool {
    match &element.primary {
        Primary::Plan(plan) => breaks(plan),
        Primary::Exec(exec) => exec.body.iter().any(is_broken),
        Primary::String(body) => body.iter().any(is_broken),
        Primary::Formal(formal) => formal.body.iter().any(is_broken),
        Primary::Atom(_) | Primary::Ref(_) | Primary::Broken => false,
    }
}
