//! Names of robots in scenarios and in link files.

/// Maximum length of a name, in bytes, as in a frame of the state link.
const LONGEST: usize = 64;
/// Description of valid robot names, for error messages.
pub(crate) const FORM: &str = "a name is a letter, then letters, digits and `_`, at most 64";

/// Returns `true` if `name` is a valid name of a robot, which is also valid in plans.
pub(crate) fn is_robot_name(name: &str) -> bool {
    let mut letters = name.chars();
    letters.next().is_some_and(|first| first.is_ascii_alphabetic())
        && letters.all(|letter| letter.is_ascii_alphanumeric() || letter == '_')
        && name.len() <= LONGEST
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_name_is_one_that_a_plan_can_write() {
        assert!(["a", "robot_1", &"n".repeat(64)].into_iter().all(is_robot_name));
        assert!(!["", "1a", "a b", "a\n", "é", "_a", &"n".repeat(65)].into_iter().any(is_robot_name));
    }
}
