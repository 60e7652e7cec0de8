//! Names that are similar to an unknown name, for messages.

/// Returns the name in `names` that is most similar to `name`, if it is so similar that the user probably meant it.
#[must_use]
pub fn nearest<'n>(name: &str, names: impl Iterator<Item = &'n str>) -> Option<&'n str> {
    let lower = name.to_lowercase();
    let distance = |other: &str| strsim::damerau_levenshtein(&lower, &other.to_lowercase());
    let length = name.chars().count();
    let allowed = (length / 3).max(1).min(length.saturating_sub(1));
    names.map(|other| (distance(other), other)).filter(|(found, _)| *found <= allowed).min().map(|(_, other)| other)
}

/// Returns the end of a sentence about an unknown name. It suggests the name in `known` that is similar, or is empty if
/// no name is similar.
#[must_use]
pub fn did_you_mean(name: &str, known: &[&str]) -> String {
    let near = nearest(name, known.iter().copied());
    near.map(|near| format!("; did you mean `{near}`?")).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_similar_name_is_meant() {
        let known = ["odom", "cmd-vel", "scan"];
        assert_eq!(did_you_mean("cmd_vel", &known), "; did you mean `cmd-vel`?");
        assert_eq!(did_you_mean("ODOM", &known), "; did you mean `odom`?");
        assert_eq!([did_you_mean("battery", &known), did_you_mean("x", &known)], ["", ""]);
    }
}
