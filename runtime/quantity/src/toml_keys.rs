//! Explains common mistakes in TOML files to people who do not know TOML.

/// Keys of a TOML format, by the kind of their values.
#[derive(Debug, Clone, Copy)]
pub struct TomlKeys {
    /// Keys whose value is a number that may have a fraction.
    pub numbers: &'static [&'static str],
    /// Keys whose value is a list of numbers or of lists of numbers, each with an example of its value.
    pub lists: &'static [(&'static str, &'static str)],
    /// Keys whose value is `true` or `false`.
    pub flags: &'static [&'static str],
    /// Names of tables that a file may have several times, as in `[[wall]]`.
    pub tables: &'static [&'static str],
}

/// A mistake in a TOML file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct TomlMistake {
    /// Description of the mistake.
    pub message: String,
    /// Text that the user can type instead.
    pub help: String,
}

/// The place at which the TOML parser refuses a text.
struct Place<'t> {
    /// Message of the parser.
    refusal: &'t str,
    /// Text before the place.
    before: &'t str,
    /// Rest of the line from the place on.
    after: &'t str,
    /// Key of the last `=` before the place; empty if there is none.
    key: &'t str,
    /// Rest of the line after that `=`, without leading spaces.
    value: &'t str,
}

/// Explains the mistake at a place; `None` if the rule does not understand the text there.
type Rule = fn(&TomlKeys, &Place<'_>) -> Option<TomlMistake>;

/// The rules, each with the beginnings of the parser's messages to which it applies. The first rule that understands
/// the text explains the mistake.
const RULES: [(&[&str], Rule); 8] = [
    (&["unexpected key or value", "extra comma in inline table", "invalid literal string"], decimal_comma),
    (&["invalid mantissa", "invalid fraction"], lone_dot),
    (&["string values must be quoted"], missing_comma),
    (&["string values must be quoted", "invalid boolean", "invalid float", "invalid type"], flag),
    (&["invalid type: map, expected a sequence", "duplicate key"], single_brackets),
    (&["invalid type"], table_value),
    (&["duplicate key"], duplicate_key),
    (&["string values must be quoted", "unexpected key or value", "invalid type"], list_form),
];

impl TomlKeys {
    /// Explains why the TOML parser refuses `text` at the byte `start` with the message `refusal`; `None` if the text
    /// there is not understood.
    #[must_use]
    pub fn mistake(&self, text: &str, start: usize, refusal: &str) -> Option<TomlMistake> {
        let (before, after) = text.split_at_checked(start)?;
        let line = |text| str::lines(text).next().unwrap_or_default();
        let (assigned, _) = before.rsplit_once('=').unwrap_or_default();
        let value = text.get(assigned.len()..).and_then(|rest| rest.strip_prefix('=')).unwrap_or_default();
        let place =
            Place { refusal, before, after: line(after), key: last_word(assigned), value: line(value).trim_start() };
        let applies = |prefixes: &[&str]| prefixes.iter().any(|prefix| refusal.starts_with(prefix));
        RULES.iter().filter(|(prefixes, _)| applies(prefixes)).find_map(|(_, rule)| rule(self, &place))
    }
}

impl Place<'_> {
    /// Returns `true` if the parser refuses the beginning of the value of `key`.
    fn is_value(&self) -> bool {
        self.before.trim_end().ends_with('=')
    }
}

fn mistake(message: impl Into<String>, help: impl Into<String>) -> Option<TomlMistake> {
    Some(TomlMistake { message: message.into(), help: help.into() })
}

/// Explains a number with a comma, as `0,5`.
fn decimal_comma(keys: &TomlKeys, place: &Place<'_>) -> Option<TomlMistake> {
    let end = place.value.find(|letter| !is_numeric(letter) && letter != ',').unwrap_or(place.value.len());
    let (word, rest) = place.value.split_at_checked(end)?;
    // In an inline table, the comma after the number separates the next key.
    let number = word.strip_suffix(',').filter(|_| place.refusal.starts_with("extra comma")).unwrap_or(word);
    let (whole, fraction) = number.split_once(',')?;
    let is_whole = is_number(whole) && !whole.contains('.');
    let is_complete = number != word || rest.trim_start().chars().next().is_none_or(|next| "#}".contains(next));
    if !keys.numbers.contains(&place.key) || !is_whole || !are_digits(fraction) || !is_complete {
        return None;
    }
    let message = format!("`{number}` has a comma; a number has a dot before its fraction, and no comma");
    // A comma before three digits may also separate thousands.
    let is_thousands = fraction.len() == 3 && whole.trim_start_matches(['+', '-']) != "0";
    mistake(
        message,
        match is_thousands {
            true => format!("write `{whole}{fraction}` or `{whole}.{fraction}`"),
            false => format!("write `{whole}.{fraction}`"),
        },
    )
}

/// Explains a number with a dot at its beginning or end, as `.5` and `1.`.
fn lone_dot(keys: &TomlKeys, place: &Place<'_>) -> Option<TomlMistake> {
    let (head, tail) = (place.before.trim_end_matches(is_numeric), place.after.trim_start_matches(is_numeric));
    let number = format!(
        "{}{}",
        place.before.strip_prefix(head).unwrap_or_default(),
        place.after.strip_suffix(tail).unwrap_or_default()
    );
    let unsigned = number.trim_start_matches(['+', '-']);
    let sign = number.strip_suffix(unsigned)?;
    let (whole, fraction) = unsigned.split_once('.').filter(|_| unsigned != ".")?;
    let or_zero = |digits: &str| if digits.is_empty() { "0".to_owned() } else { digits.to_owned() };
    let written = format!("{sign}{}.{}", or_zero(whole), or_zero(fraction));
    let is_known = keys.numbers.contains(&place.key) || keys.example(place.key).is_some();
    let is_complete = tail.chars().next().is_none_or(|next| next.is_whitespace() || ",]}#".contains(next));
    if !is_known || !is_number(&written) || !is_complete {
        return None;
    }
    mistake(
        format!("`{number}` lacks a digit; a number has digits before and after its dot"),
        format!("write `{written}`"),
    )
}

/// Explains numbers of a list without a comma between them, as `[1 2]`.
fn missing_comma(keys: &TomlKeys, place: &Place<'_>) -> Option<TomlMistake> {
    let end = place.after.find([',', ']', '#']).unwrap_or(place.after.len());
    let written = place.after.get(..end)?.trim();
    let numbers: Vec<_> = written.split([' ', '\t', ';']).filter(|word| !word.is_empty()).collect();
    // After a comma without a space, the first number may be the fraction of another one, as in `[0,5 1]`.
    let begins = place.before.ends_with(['[', ' ', '\t', '\n']) && !place.is_value();
    let are_numbers = numbers.len() > 1 && numbers.iter().all(|number| is_number(number));
    keys.example(place.key).filter(|_| begins && are_numbers)?;
    mistake(format!("no comma between the numbers `{written}`"), format!("write `{}`", numbers.join(", ")))
}

/// Explains the value of a flag that is neither `true` nor `false`, as `yes`.
fn flag(keys: &TomlKeys, place: &Place<'_>) -> Option<TomlMistake> {
    let key = keys.flags.iter().find(|key| **key == place.key).filter(|_| place.is_value())?;
    mistake(format!("`{key}` is neither `true` nor `false`"), "write `true` or `false`, without quotes")
}

/// Explains the head of a table that has single brackets, as `[wall]` instead of `[[wall]]`, at the place or before it.
fn single_brackets(keys: &TomlKeys, place: &Place<'_>) -> Option<TomlMistake> {
    let name = first_word(place.after.trim_start_matches(['[', ' ']));
    let line = place.before.rsplit('\n').next()?.to_owned() + place.after;
    let is_head = |line: &str| {
        let rest = line.trim_start().strip_prefix('[').and_then(|line| line.trim_start().strip_prefix(name));
        rest.is_some_and(|rest| rest.trim_start().starts_with(']'))
    };
    let has_head = is_head(&line) || line.trim_start().starts_with("[[") && place.before.lines().any(is_head);
    keys.tables.iter().find(|table| has_head && **table == name)?;
    mistake(format!("`[{name}]` has single brackets"), format!("write `[[{name}]]` each time, as there may be several"))
}

/// Explains a value of a key that is the name of tables, as `wall = 3`.
fn table_value(keys: &TomlKeys, place: &Place<'_>) -> Option<TomlMistake> {
    let name = keys.tables.iter().find(|table| **table == place.key).filter(|_| place.is_value())?;
    mistake(
        format!("`{name}` cannot have this value"),
        format!("write `[[{name}]]`, and its keys and values in the lines below"),
    )
}

/// Names a key that a table has twice.
fn duplicate_key(_: &TomlKeys, place: &Place<'_>) -> Option<TomlMistake> {
    let key = first_word(place.after);
    let help = "leave one of the two out";
    if key.is_empty() { None } else { mistake(format!("the key `{key}` is given twice"), help) }
}

/// Shows the form of a list whose value has too few or too many brackets, or contains other text than numbers.
fn list_form(keys: &TomlKeys, place: &Place<'_>) -> Option<TomlMistake> {
    let (key, example) = (place.key, keys.example(place.key)?);
    let is_wrong = match place.refusal.strip_prefix("invalid type: ") {
        Some(types) => types.ends_with("expected a sequence") || types.starts_with("sequence, expected f64"),
        None => place.refusal.starts_with("string values") || !place.value.starts_with('['),
    };
    let help = format!("write it in the form of `{key} = {example}`");
    if is_wrong { mistake(format!("the value of `{key}` has a wrong form"), help) } else { None }
}

impl TomlKeys {
    /// Returns the example of the value of a list; `None` if the key is of another kind.
    fn example(&self, key: &str) -> Option<&'static str> {
        self.lists.iter().find(|(list, _)| *list == key).map(|(_, example)| *example)
    }
}

/// Returns `true` if `word` is a number without an exponent, as TOML has it.
fn is_number(word: &str) -> bool {
    let digits = word.strip_prefix(['+', '-']).unwrap_or(word);
    let (whole, fraction) = digits.split_once('.').unwrap_or((digits, "0"));
    are_digits(whole) && are_digits(fraction) && (whole == "0" || !whole.starts_with('0'))
}

fn are_digits(text: &str) -> bool {
    !text.is_empty() && text.chars().all(|letter| letter.is_ascii_digit())
}

fn is_numeric(letter: char) -> bool {
    letter.is_ascii_digit() || matches!(letter, '+' | '-' | '.')
}

fn is_part_of_key(letter: char) -> bool {
    letter.is_ascii_alphanumeric() || matches!(letter, '_' | '-')
}

fn first_word(text: &str) -> &str {
    let end = text.find(|letter| !is_part_of_key(letter)).unwrap_or(text.len());
    text.get(..end).unwrap_or_default()
}

fn last_word(text: &str) -> &str {
    let text = text.trim_end();
    text.strip_prefix(text.trim_end_matches(is_part_of_key)).unwrap_or_default()
}
