//! Positions comments. A comment at the end of a line stays there, and a comment on its own line stays on its own line.

use super::{INDENT, Layout};

/// A comment, and the number of line ends before it.
#[derive(Debug)]
pub(super) struct Comment<'s> {
    /// Whole text of the comment, including its slashes.
    text: &'s str,
    /// Number of line ends between the previous token or comment and this comment.
    lines: usize,
}

impl Comment<'_> {
    /// Returns `true` if no other text can follow the comment on its line.
    fn ends_line(&self) -> bool {
        self.text.starts_with("//")
    }

    /// Returns the comment without trailing spaces on its lines.
    fn trimmed(&self) -> String {
        self.text.lines().map(str::trim_end).collect::<Vec<_>>().join("\n")
    }
}

/// Comments and line ends between two tokens.
#[derive(Debug, Default)]
pub(super) struct Gap<'s> {
    /// Comments in the order of the text.
    pub(super) comments: Vec<Comment<'s>>,
    /// Number of line ends after the last comment.
    lines: usize,
}

/// Returns the comments and line ends in the text between two tokens.
pub(super) fn gap(text: &str) -> Gap<'_> {
    let mut gap = Gap::default();
    let mut rest = text;
    while let Some(start) = [rest.find("//"), rest.find("/*")].into_iter().flatten().min() {
        let (blank, comment) = rest.split_at(start);
        let length = if comment.starts_with("//") {
            comment.find('\n')
        } else {
            comment.get(2..).and_then(|inside| inside.find("*/")).map(|end| end + 4)
        };
        let (comment, behind) = comment.split_at(length.unwrap_or(comment.len()));
        gap.comments.push(Comment { text: comment, lines: line_ends(blank) });
        rest = behind;
    }
    gap.lines = line_ends(rest);
    gap
}

fn line_ends(blank: &str) -> usize {
    blank.matches('\n').count()
}

/// Position of a piece that begins a line. It determines whether an empty line precedes the piece.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Before {
    /// The first of several pieces. No empty line precedes it.
    First,
    /// A later piece. An empty line before it is kept.
    Next,
    /// A plan after other plans. An empty line precedes it.
    Apart,
    /// A closing bracket, or the end of the text. No empty line precedes it.
    Close,
}

impl Layout<'_> {
    /// Writes the comments before the next piece, which begins a line.
    pub(super) fn boundary(&mut self, before: Before) {
        let indent = INDENT * self.depth;
        // Comments before a closing bracket belong to its content.
        let inner =
            if before == Before::Close && self.pieces.kind(self.at).is_some() { indent + INDENT } else { indent };
        let Gap { comments, lines: behind } = self.pieces.take_gap(self.at);
        let behind = if before == Before::Close { behind.max(1) } else { behind };
        let starts_text = self.lines.is_empty();
        let keeps_empty = before != Before::First;
        let has_empty = comments.iter().map(|comment| comment.lines).chain([behind]).any(|lines| lines > 1);
        let mut needs_empty = before == Before::Apart && !has_empty;
        // Comments between two pieces on one line belong to the second piece.
        let leads = behind == 0 && comments.iter().all(|comment| comment.lines == 0 && !comment.ends_line());
        let mut is_fresh = false;
        for (number, comment) in comments.iter().enumerate() {
            let stays = comment.lines == 0 && !starts_text;
            if number == 0 && stays && !leads {
                self.lines.trail(&comment.trimmed());
                continue;
            }
            if number > 0 && comment.lines == 0 {
                self.lines.append(&comment.trimmed(), comment.ends_line());
                continue;
            }
            let is_empty_kept = comment.lines > 1 && (keeps_empty || is_fresh);
            self.line(inner, needs_empty || is_empty_kept);
            self.lines.append(&comment.trimmed(), comment.ends_line());
            (needs_empty, is_fresh) = (false, true);
        }
        let follows_on_line = behind == 0 && is_fresh;
        if self.pieces.kind(self.at).is_some() && !follows_on_line {
            let is_empty_kept = behind > 1 && before != Before::Close && (keeps_empty || is_fresh);
            self.line(indent, needs_empty || is_empty_kept);
        }
    }

    /// Begins a line, after an empty line if `behind_empty` is `true`.
    fn line(&mut self, indent: usize, behind_empty: bool) {
        if behind_empty {
            self.lines.skip();
        }
        self.lines.start(indent);
    }

    /// Writes the comments before the next piece, which is inside an element.
    pub(super) fn comments_inside(&mut self, further: usize) {
        for comment in self.pieces.take_gap(self.at).comments {
            let is_apart = comment.ends_line() && comment.lines > 0 && !self.lines.is_blank();
            if comment.ends_line() && comment.lines == 0 && !self.lines.is_closed() {
                self.lines.trail(&comment.trimmed());
                continue;
            }
            if self.lines.is_closed() || is_apart {
                self.lines.start(further);
            }
            self.lines.append(&comment.trimmed(), comment.ends_line());
        }
    }
}
