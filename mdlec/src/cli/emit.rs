//! Argument of `--emit`: the form in which a plan is printed, and the file to which it is written.

use std::path::PathBuf;

use clap::ValueEnum;

/// The argument of `--emit`.
#[derive(Debug, Clone)]
pub(super) struct Emit {
    pub(super) kind: EmitKind,
    /// File to write; `None` for standard output.
    pub(super) file: Option<PathBuf>,
}

/// The kinds of `--emit`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(super) enum EmitKind {
    /// Syntax tree
    Tree,
    /// Plans of the robots of a group, as MDLe
    Projected,
    /// Plan with all names resolved
    Plan,
    /// Plan without repeated interrupts
    Nondegenerate,
    /// Plan with finite loops unrolled and atoms numbered
    Expanded,
    /// Finite state machine, as JSON
    Fsm,
    /// Transition matrices, in the paper's notation or as MatrixMarket files
    Matrices,
    /// Picture for Graphviz
    Dot,
    /// Picture for mermaid, a `stateDiagram-v2`
    Mermaid,
    /// W3C SCXML machine that is equivalent to the plan
    Scxml,
    /// Plan in the paper's formal notation
    Formal,
    /// Generated Rust source
    Rust,
    /// Executable
    Exe,
}

impl EmitKind {
    /// Returns `true` if this form is read by people rather than by programs.
    pub(super) fn is_for_people(self) -> bool {
        match self {
            Self::Tree
            | Self::Projected
            | Self::Plan
            | Self::Nondegenerate
            | Self::Expanded
            | Self::Matrices
            | Self::Formal => true,
            Self::Fsm | Self::Dot | Self::Mermaid | Self::Scxml | Self::Rust | Self::Exe => false,
        }
    }
}

impl Emit {
    /// Parses the argument, which is a kind that may be followed by `=FILE`.
    pub(super) fn parse(text: &str) -> Result<Self, String> {
        let (kind, file) = match text.split_once('=') {
            Some((_, "")) => return Err("name a file after `=`, or leave `=` out".into()),
            Some((kind, "-")) => (kind, None),
            Some((kind, file)) => (kind, Some(PathBuf::from(file))),
            None => (text, None),
        };
        let kinds: Vec<_> = EmitKind::value_variants().iter().filter_map(ValueEnum::to_possible_value).collect();
        let names: Vec<_> = kinds.iter().map(|kind| kind.get_name().to_owned()).collect();
        let kind = EmitKind::from_str(kind, false).map_err(|_| format!("the kinds are {}", names.join(", ")))?;
        Ok(Self { kind, file })
    }
}
