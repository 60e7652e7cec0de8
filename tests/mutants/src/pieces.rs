//! Parts of syntax that can be exchanged for each other, or deleted.

use syn::{Attribute, Expr, Ident, Lit, Stmt};

/// Returns `true` if two expressions are of the same simple kind and may thus have the same type: names, numbers, or
/// references to these.
pub(crate) fn is_alike(one: &Expr, other: &Expr) -> bool {
    let is_variable = |expression: &Expr| match expression {
        Expr::Path(path) => path.path.get_ident().is_some_and(|name| !name.to_string().starts_with(char::is_uppercase)),
        Expr::Field(_) => true,
        _ => false,
    };
    match (one, other) {
        (Expr::Lit(one), Expr::Lit(other)) => !matches!((&one.lit, &other.lit), (Lit::Str(_), _) | (_, Lit::Str(_))),
        (Expr::Reference(one), Expr::Reference(other)) => is_alike(&one.expr, &other.expr),
        _ => is_variable(one) && is_variable(other),
    }
}

/// Returns `true` if a statement is deleted as a whole. Of the statements with a block, only an `if` that leaves the
/// function or loop is deleted as a whole; in other blocks, the statements are deleted one by one.
pub(crate) fn can_be_deleted(statement: &Stmt) -> bool {
    let Stmt::Expr(expression, end) = statement else { return false };
    match expression {
        Expr::MethodCall(_) | Expr::Call(_) | Expr::Assign(_) | Expr::Binary(_) | Expr::Try(_) => end.is_some(),
        Expr::Return(_) | Expr::Break(_) | Expr::Continue(_) => true,
        Expr::If(branch) => branch.else_branch.is_none() && branch.then_branch.stmts.last().is_some_and(leaves),
        _ => false,
    }
}

/// Returns `true` if a statement leaves the function or the loop.
pub(crate) fn leaves(statement: &Stmt) -> bool {
    matches!(statement, Stmt::Expr(Expr::Return(_) | Expr::Break(_) | Expr::Continue(_), _))
}

/// Returns `true` if an item with this attribute is for tests only.
pub(crate) fn is_test(attribute: &Attribute) -> bool {
    attribute.path().is_ident("cfg") && attribute.parse_args::<Ident>().is_ok_and(|condition| condition == "test")
}
