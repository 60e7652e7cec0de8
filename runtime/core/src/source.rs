//! The source text of a plan: its conditions and operands as written, and their lines.

use crate::TextList;

/// Conditions and operands of a plan as written, with their lines, for reports: constants of an executable, or owned by
/// a plan that is loaded at run time.
pub trait Words {
    /// Returns the line and the condition of a bracket; `None` for a plan without source text.
    fn bracket(&self, bracket: u32) -> Option<BracketWords<'_>>;
    /// Returns the text and the line of operand `number`, counted from 0, in a bracket's condition; `None` if there is
    /// no such operand.
    fn operand(&self, bracket: u32, number: u32) -> Option<OperandWords<'_>>;
    /// Returns the name of the file that contains this line; an empty text if the file is not known.
    fn file(&self, at: SourceLine) -> &str;
}

impl<'w> dyn Words + 'w {
    /// Returns the operands of a bracket, in the order in which they are written.
    pub fn operands_of(&self, bracket: u32) -> impl Iterator<Item = OperandWords<'_>> {
        (0..).map_while(move |number| self.operand(bracket, number))
    }
}

/// The source text of a plan as constants. The texts are stored as rows of numbers and a few long joined texts, because
/// rustc takes long to compile many separate texts.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Source<'a> {
    /// Names of the files, without folders.
    pub files: &'a [&'a str],
    /// For each bracket: the number of the file, the line, the index of the first operand, and the count of operands.
    pub brackets: &'a [[u32; 4]],
    /// The condition of each bracket as written.
    pub conditions: TextList<'a>,
    /// For each operand of all conditions: the number of the file, the line, the index of the first value, and the
    /// count of values.
    pub operands: &'a [[u32; 4]],
    /// The condition text of each operand, as traces show it.
    pub texts: TextList<'a>,
    /// Each operand as written in the source text.
    pub written: TextList<'a>,
    /// Positions of the values in the texts of all operands.
    pub values: &'a [ValueWords<'a>],
}

/// A line of a source file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct SourceLine {
    /// Number of the file in [`Source::files`].
    pub file: u16,
    /// Number of the line, counted from 1.
    pub line: u32,
}

/// Line and condition of a bracket in the source text, for reports.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct BracketWords<'a> {
    /// Line in which the atom or the scope begins; 0 for a loop.
    pub at: SourceLine,
    /// Condition of the scope as written; empty for a loop and for a scope without a condition.
    pub condition: &'a str,
    /// Index of the bracket's first operand among the operands of all brackets.
    pub first: u32,
    /// Number of the bracket's operands.
    pub count: u32,
}

/// Text and line of an operand: one of the parts that AND and OR join to a condition.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OperandWords<'a> {
    /// Condition text of the operand, as traces show it.
    pub text: &'a str,
    /// Source text of the operand.
    pub written: &'a str,
    /// Line in which the operand begins.
    pub at: SourceLine,
    /// Positions in `written` at which measured values are shown: first the value of the signal, then the value of the
    /// signal with which it is compared.
    pub values: &'a [ValueWords<'a>],
}

/// Position in the text of an operand at which a measured value is shown.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ValueWords<'a> {
    /// Number of bytes of [`OperandWords::written`] before this position.
    pub after: u32,
    /// Unit of the signal; empty for a number.
    pub unit: &'a str,
    /// SI value of one unit.
    pub scale: f64,
}

impl Source<'_> {
    /// The source of a plan without source text, such as a plan that is written in Rust.
    pub const NONE: Self = Self {
        files: &[],
        brackets: &[],
        conditions: TextList::NONE,
        operands: &[],
        texts: TextList::NONE,
        written: TextList::NONE,
        values: &[],
    };
}

impl Words for Source<'_> {
    fn bracket(&self, bracket: u32) -> Option<BracketWords<'_>> {
        let [file, line, first, count] = *self.brackets.get(bracket as usize)?;
        Some(BracketWords { at: place(file, line), condition: self.conditions.text(bracket), first, count })
    }

    fn operand(&self, bracket: u32, number: u32) -> Option<OperandWords<'_>> {
        let words = self.bracket(bracket).filter(|words| number < words.count)?;
        let operand = words.first.checked_add(number)?;
        let [file, line, first, count] = *self.operands.get(operand as usize)?;
        let values = self.values.get(first as usize..)?.get(..count as usize)?;
        let (text, written) = (self.texts.text(operand), self.written.text(operand));
        Some(OperandWords { text, written, at: place(file, line), values })
    }

    fn file(&self, at: SourceLine) -> &str {
        self.files.get(usize::from(at.file)).copied().unwrap_or("")
    }
}

/// Returns line number `line` of file number `file`.
fn place(file: u32, line: u32) -> SourceLine {
    SourceLine { file: u16::try_from(file).unwrap_or(u16::MAX), line }
}
