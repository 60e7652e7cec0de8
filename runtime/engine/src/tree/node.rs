//! The nodes of the tree, the operations on nodes, and the roles that may perform these operations.

use std::collections::{BTreeMap, BTreeSet};

use mdle_quantity::Quantity;

/// All nodes by path. A folder is a prefix of the paths of several nodes.
pub type Tree = BTreeMap<String, Node>;

/// Returns the names in a folder; folder names end with `/`.
pub(super) fn names(tree: &Tree, folder: &str) -> Vec<String> {
    let inside = format!("{folder}/");
    let names = tree.keys().filter_map(|path| path.strip_prefix(&inside));
    let names = names.map(|rest| rest.split_once('/').map_or(rest.to_owned(), |(folder, _)| format!("{folder}/")));
    names.collect::<BTreeSet<_>>().into_iter().collect()
}

/// An attribute or a method of the tree.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Node {
    /// Operations that the node permits.
    pub access: Access,
    /// Kind of the node's value.
    pub kind: ValueKind,
    /// Lowest role that may set or call the node.
    pub role: Role,
    /// Description of the node, as a noun phrase.
    pub doc: &'static str,
}

/// Operations that a node permits.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Access {
    /// The node can be read.
    Read,
    /// The node can be read and set.
    Write,
    /// The node can be called.
    Call,
}

/// Kind of a value.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ValueKind {
    /// `true` or `false`.
    Flag,
    /// A whole number.
    Integer,
    /// A number without a unit.
    Number,
    /// A number of this quantity, in this unit.
    Quantity(Quantity, &'static str),
    /// Text.
    Text,
    /// A position and a heading in the plane: two lengths and an angle.
    Pose,
    /// Numbers without a unit.
    Numbers,
    /// Bytes, as hexadecimal digits.
    Bytes,
}

/// Role of a user. Each role includes the rights of all lower roles.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Role {
    /// Role that may only read.
    View,
    /// Role that may change settings.
    Tune,
    /// Role that may replace plans.
    Swap,
    /// Role that may change safety rules and end the session.
    Admin,
}

impl Role {
    /// All roles, lowest first.
    pub const ALL: [Self; 4] = [Self::View, Self::Tune, Self::Swap, Self::Admin];

    /// Returns the name of the role.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::View => "view",
            Self::Tune => "tune",
            Self::Swap => "swap",
            Self::Admin => "admin",
        }
    }
}

impl Node {
    /// Creates an attribute that can only be read.
    #[must_use]
    pub const fn reading(kind: ValueKind, doc: &'static str) -> Self {
        Self { access: Access::Read, kind, role: Role::View, doc }
    }

    /// Creates an attribute that a user with this role may set.
    #[must_use]
    pub const fn setting(kind: ValueKind, role: Role, doc: &'static str) -> Self {
        Self { access: Access::Write, kind, role, doc }
    }

    /// Creates a method that a user with this role may call.
    #[must_use]
    pub const fn method(role: Role, doc: &'static str) -> Self {
        Self { access: Access::Call, kind: ValueKind::Text, role, doc }
    }
}
