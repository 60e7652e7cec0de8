//! Operators and methods that are exchanged for each other, and methods whose calls can be left out without a type
//! error.

use syn::BinOp;

/// Pairs of methods, fields and names that are easily mistaken for each other.
const MISTAKEN: &[(&str, &str)] = &[
    ("all", "any"),
    ("checked_add", "checked_mul"),
    ("first", "last"),
    ("is_ascii_lowercase", "is_ascii_uppercase"),
    ("is_none", "is_some"),
    ("is_none_or", "is_some_and"),
    ("is_sign_negative", "is_sign_positive"),
    ("max", "min"),
    ("pop_first", "pop_last"),
    ("saturating_add", "saturating_sub"),
    ("split_first", "split_last"),
    ("starts_with", "ends_with"),
    ("take", "skip"),
    ("take_while", "skip_while"),
];

/// Methods whose result has the type of their receiver.
const LEFT_OUT: &[&str] = &[
    "abs",
    "also",
    "chain",
    "filter",
    "help",
    "max",
    "min",
    "or",
    "or_else",
    "replace",
    "rev",
    "saturating_add",
    "saturating_mul",
    "saturating_sub",
    "skip",
    "skip_while",
    "take",
    "take_while",
    "to_ascii_lowercase",
    "to_ascii_uppercase",
];

/// Returns the name that is easily mistaken for `name`, or `None` if there is none.
pub(crate) fn mistaken(name: &str) -> Option<&'static str> {
    MISTAKEN.iter().find_map(|&(one, other)| match name {
        _ if name == one => Some(other),
        _ if name == other => Some(one),
        _ => None,
    })
}

/// Returns `true` if a call of this method can be left out.
pub(crate) fn can_be_left_out(method: &str) -> bool {
    LEFT_OUT.contains(&method)
}

/// Returns the operator that is easily mistaken for `operator`, or `None` if there is none.
pub(crate) fn other_operator(operator: &BinOp) -> Option<&'static str> {
    Some(match operator {
        BinOp::Add(_) => "-",
        BinOp::Sub(_) | BinOp::Mul(_) | BinOp::Div(_) => "+",
        BinOp::Rem(_) => "/",
        BinOp::And(_) => "||",
        BinOp::Or(_) => "&&",
        BinOp::BitAnd(_) => "|",
        BinOp::BitOr(_) | BinOp::BitXor(_) => "&",
        BinOp::Shl(_) => ">>",
        BinOp::Shr(_) => "<<",
        BinOp::Eq(_) => "!=",
        BinOp::Ne(_) => "==",
        BinOp::Lt(_) => "<=",
        BinOp::Le(_) => "<",
        BinOp::Ge(_) => ">",
        BinOp::Gt(_) => ">=",
        BinOp::AddAssign(_) => "-=",
        BinOp::SubAssign(_) | BinOp::MulAssign(_) => "+=",
        // The enum belongs to another crate and may get further variants.
        _ => return None,
    })
}

/// Returns the number minus 1 and the number plus 1, each with the suffix.
pub(crate) fn neighbours(digits: &str, suffix: &str) -> Vec<String> {
    let Ok(number) = digits.parse::<u64>() else { return Vec::new() };
    let both = [number.checked_sub(1), number.checked_add(1)];
    both.into_iter().flatten().map(|number| format!("{number}{suffix}")).collect()
}
