//! Operators and methods that are exchanged for each other, and methods that can be left out because the type stays the
//! same.

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

/// Returns the name for which `name` is easily mistaken.
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

/// Returns the operator for which `operator` is easily mistaken.
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
        // Of other crates' enums there may be more.
        _ => return None,
    })
}

/// Returns the numbers before and after a number, with its suffix.
pub(crate) fn neighbours(digits: &str, suffix: &str) -> Vec<String> {
    let Ok(number) = digits.parse::<u64>() else { return Vec::new() };
    let both = [number.checked_sub(1), number.checked_add(1)];
    both.into_iter().flatten().map(|number| format!("{number}{suffix}")).collect()
}
