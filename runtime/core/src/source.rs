//! The source text of a plan: the words of conditions and operands, and their lines.

use crate::TextList;

/// The words and places of a plan, for reports: constants of an executable, or owned by a plan that was loaded.
pub trait Words {
    /// Returns the words of a bracket; `None` for a plan without source text.
    fn bracket(&self, bracket: u32) -> Option<BracketWords<'_>>;
    /// Returns the words of an operand of a bracket's condition, by its number among them, from 0.
    fn operand(&self, bracket: u32, number: u32) -> Option<OperandWords<'_>>;
    /// Returns the name of the file of a line; empty if the file is not known.
    fn file(&self, at: SourceLine) -> &str;
}

impl<'w> dyn Words + 'w {
    /// Returns the operands of a bracket, in the order in which they are written.
    pub fn operands_of(&self, bracket: u32) -> impl Iterator<Item = OperandWords<'_>> {
        (0..).map_while(move |number| self.operand(bracket, number))
    }
}

/// The words and places of a plan as constants: rows of numbers and long texts, as rustc takes long for many texts.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Source<'a> {
    /// The names of the files, without folders.
    pub files: &'a [&'a str],
    /// For each bracket its file, its line, the first of its operands, and the number of its operands.
    pub brackets: &'a [[u32; 4]],
    /// The condition of each bracket as it is written.
    pub conditions: TextList<'a>,
    /// For each operand of the conditions of all brackets its file, its line, the first of its values, and the number
    /// of its values.
    pub operands: &'a [[u32; 4]],
    /// The condition text of each operand, as traces have it.
    pub texts: TextList<'a>,
    /// The words of each operand as they are written.
    pub written: TextList<'a>,
    /// The values of all operands.
    pub values: &'a [ValueWords<'a>],
}

/// A line of a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct SourceLine {
    /// The number of the file in [`Source::files`].
    pub file: u16,
    /// Number of the line, from 1.
    pub line: u32,
}

/// The words of a bracket.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct BracketWords<'a> {
    /// The line in which the atom or the scope begins; 0 for a loop.
    pub at: SourceLine,
    /// The condition of the scope as it is written; empty for a loop and for a scope without a condition.
    pub condition: &'a str,
    /// The first of its operands among those of all brackets.
    pub first: u32,
    /// The number of its operands.
    pub count: u32,
}

/// The words of an operand: of a part of a condition that AND and OR join.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OperandWords<'a> {
    /// The condition text, as traces have it.
    pub text: &'a str,
    /// The operand as it is written.
    pub written: &'a str,
    /// The line in which the bracket begins.
    pub at: SourceLine,
    /// The places in the written words at which measured values are shown: of the signal, then of the signal that it is
    /// compared with.
    pub values: &'a [ValueWords<'a>],
}

/// A place in the words of an operand at which a measured value is shown.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ValueWords<'a> {
    /// The number of bytes of the words before it.
    pub after: u32,
    /// The unit of the signal; empty for a number.
    pub unit: &'a str,
    /// The SI value of this unit.
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

/// Returns a line of the file of this number.
fn place(file: u32, line: u32) -> SourceLine {
    SourceLine { file: u16::try_from(file).unwrap_or(u16::MAX), line }
}
