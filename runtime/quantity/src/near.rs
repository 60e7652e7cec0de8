//! Names that are similar to an unknown name, for messages.

/// Returns the name in `names` that is most similar to `name`, if it is so similar that the user probably meant it.
#[must_use]
pub fn nearest<'n>(name: &str, names: impl Iterator<Item = &'n str>) -> Option<&'n str> {
    let lower = name.to_lowercase();
    let distance = |other: &str| strsim::damerau_levenshtein(&lower, &other.to_lowercase());
    let length = name.chars().count();
    let allowed = (length / 3).max(1).min(length.saturating_sub(1));
    let near = names.map(|other| (distance(other), other)).filter(|(found, _)| *found <= allowed);
    // Of names at the same distance, one that has all the letters of `name` in order is meant rather than another.
    let likeness = |other: &str| strsim::jaro_winkler(&lower, &other.to_lowercase());
    let order = |(one, this): &(usize, &str), (two, that): &(usize, &str)| {
        one.cmp(two).then_with(|| likeness(that).total_cmp(&likeness(this))).then_with(|| this.cmp(that))
    };
    near.min_by(order).map(|(_, other)| other)
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
        assert_eq!(nearest("bild", ["bind", "build"].into_iter()), Some("build"));
        assert_eq!(nearest("bint", ["bind", "build", "bits"].into_iter()), Some("bind"));
        assert_eq!([did_you_mean("battery", &known), did_you_mean("x", &known)], ["", ""]);
    }
}
