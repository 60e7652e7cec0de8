//! Parses the text of an `mdle.toml` into keys and values, each with its line number. No value contains U+0000.

use std::ops::Range;

use mdle_runtime::Printable;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

use mdle_compiler::alphabet::did_you_mean;

/// The keys outside the tables.
const KEYS: [&str; 5] = ["target", "world", "safety", "options", "modules"];

/// The values of an `mdle.toml`.
#[derive(Debug, Default, PartialEq, Eq)]
pub(super) struct SettingsText {
    pub(super) target: Option<Setting>,
    pub(super) world: Option<Setting>,
    /// File of the safety rules for runs of `mdle`.
    pub(super) safety: Option<Setting>,
    pub(super) options: Vec<OptionText>,
    /// Names and command lines of child processes that a run of `mdle` loads as modules.
    pub(super) modules: Vec<(String, Setting)>,
}

/// A value and its line number, counted from 1.
#[derive(Debug, PartialEq, Eq)]
pub(super) struct Setting {
    pub(super) line: usize,
    pub(super) value: String,
}

/// An entry of `[options]`.
#[derive(Debug, PartialEq, Eq)]
pub(super) struct OptionText {
    pub(super) line: usize,
    /// Name of the option, without `--`.
    pub(super) name: String,
    /// Arguments for the executable; empty if the option is `false`.
    pub(super) arguments: Vec<String>,
}

impl OptionText {
    /// Checks that the option is one of the options `known` of an executable, each of which has the placeholder of its
    /// value.
    ///
    /// # Errors
    /// Fails with a message if there is no such option, if its value is missing, or if it has a value and must not have
    /// one.
    pub(super) fn must_be_among(&self, known: &[(&str, &str)]) -> Result<(), String> {
        let name = &*self.name;
        let Some((_, value)) = known.iter().find(|(known, _)| *known == name) else {
            let names: Vec<_> = known.iter().map(|(name, _)| *name).collect();
            let near = did_you_mean(name, &names);
            return Err(format!("there is no option `{name}`{near}\nhelp: the options are {}", names.join(", ")));
        };
        let has_value = |argument: &String| argument.contains('=');
        match value.is_empty() {
            true if self.arguments.iter().any(has_value) => {
                Err(format!("`{name}` takes no value: write `{name} = true`"))
            }
            false if !self.arguments.iter().all(has_value) => {
                Err(format!("`{name}` needs a value, as in `{name} = \"{value}\"`"))
            }
            true | false => Ok(()),
        }
    }
}

/// An error and its line number, counted from 1.
#[derive(Debug, PartialEq, Eq)]
pub(super) struct SettingsError {
    pub(super) line: usize,
    pub(super) message: String,
}

/// Reads the text of an `mdle.toml`.
///
/// # Errors
/// Fails at the first entry that is not TOML, has an unknown key, or has a value of the wrong type.
pub(super) fn read(text: &str) -> Result<SettingsText, SettingsError> {
    let reading = SettingsReader(text);
    let table = DeTable::parse(text).map_err(|error| {
        let message = error.message().replace('\n', " ");
        SettingsError { line: reading.line(&error.span().unwrap_or_default()), message }
    })?;
    let mut settings = SettingsText::default();
    for (key, value) in in_order(table.get_ref()) {
        match &**key.get_ref() {
            "target" => settings.target = Some(reading.text(key, value, "target = \"sim\"")?),
            "world" => settings.world = Some(reading.text(key, value, "world = \"hall\"")?),
            "safety" => settings.safety = Some(reading.text(key, value, "safety = \"rules.toml\"")?),
            "options" => settings.options = reading.options(key, value)?,
            "modules" => settings.modules = reading.modules(key, value)?,
            unknown => {
                let near = did_you_mean(unknown, &KEYS);
                let message = format!(
                    "there is no key `{}`{near}\nhelp: the keys are {}; options of runs are in the table `options`",
                    Printable(unknown),
                    KEYS.join(", ")
                );
                return Err(reading.error(key, message));
            }
        }
    }
    Ok(settings)
}

/// Returns the entries of a table in the order of their lines.
fn in_order<'t, 'i>(table: &'t DeTable<'i>) -> Vec<(&'t TomlKey<'i>, &'t Spanned<DeValue<'i>>)> {
    let mut entries: Vec<_> = table.iter().collect();
    entries.sort_by_key(|(key, _)| key.span().start);
    entries
}

/// A key in the form in which the TOML parser returns it.
type TomlKey<'i> = Spanned<std::borrow::Cow<'i, str>>;

/// Reads the text of an `mdle.toml`.
struct SettingsReader<'t>(&'t str);

impl SettingsReader<'_> {
    /// Reads a value that must be text; `example` is a valid entry for the error message.
    fn text(&self, key: &TomlKey<'_>, value: &Spanned<DeValue<'_>>, example: &str) -> Result<Setting, SettingsError> {
        let found = value.get_ref();
        match found.as_str() {
            Some(text) if !text.contains('\0') => Ok(Setting { line: self.line(&key.span()), value: text.to_owned() }),
            Some(_) | None => {
                let message = format!("`{}` has to be text, as in `{example}`; found: {}", key.get_ref(), kind(found));
                Err(self.error(value, message))
            }
        }
    }

    /// Reads the entries of `[modules]`.
    fn modules(
        &self,
        key: &TomlKey<'_>,
        value: &Spanned<DeValue<'_>>,
    ) -> Result<Vec<(String, Setting)>, SettingsError> {
        let example = "ears = \"python3 ears.py\"";
        let Some(table) = value.get_ref().as_table() else {
            let found = kind(value.get_ref());
            let message = format!("`modules` has to be a table, as in `modules = {{ {example} }}`; found: {found}");
            return Err(self.error(key, message));
        };
        let module =
            |(key, value): (&TomlKey<'_>, _)| Ok((key.get_ref().clone().into_owned(), self.text(key, value, example)?));
        in_order(table).into_iter().map(module).collect()
    }

    /// Reads the entries of `[options]`.
    fn options(&self, key: &TomlKey<'_>, value: &Spanned<DeValue<'_>>) -> Result<Vec<OptionText>, SettingsError> {
        let Some(table) = value.get_ref().as_table() else {
            let found = kind(value.get_ref());
            let message =
                format!("`options` has to be a table, as in `options = {{ speed = \"max\" }}`; found: {found}");
            return Err(self.error(key, message));
        };
        in_order(table).into_iter().map(|(key, value)| self.option(key, value)).collect()
    }

    fn option(&self, key: &TomlKey<'_>, value: &Spanned<DeValue<'_>>) -> Result<OptionText, SettingsError> {
        let name = &**key.get_ref();
        if KEYS.contains(&name) {
            return Err(self.error(key, format!("`{name}` is no option: write it above `[options]`")));
        }
        let is_name = |letter: char| letter.is_ascii_lowercase() || letter.is_ascii_digit() || letter == '-';
        if !name.starts_with(|first: char| first.is_ascii_lowercase()) || !name.chars().all(is_name) {
            let message = format!(
                "`{}` is no name of an option: write it without `--`, as in `speed = \"max\"`",
                Printable(name)
            );
            return Err(self.error(key, message));
        }
        let arguments = match value.get_ref() {
            DeValue::Boolean(true) => vec![format!("--{name}")],
            DeValue::Boolean(false) => Vec::new(),
            DeValue::Array(values) => {
                values.iter().map(|value| self.argument(name, value)).collect::<Result<_, _>>()?
            }
            DeValue::String(_) | DeValue::Integer(_) | DeValue::Float(_) | DeValue::Datetime(_) | DeValue::Table(_) => {
                vec![self.argument(name, value)?]
            }
        };
        Ok(OptionText { line: self.line(&key.span()), name: name.to_owned(), arguments })
    }

    /// Reads the value of an option, which is text or a number.
    fn argument(&self, name: &str, value: &Spanned<DeValue<'_>>) -> Result<String, SettingsError> {
        let found = value.get_ref();
        let text = match found {
            DeValue::String(text) if !text.contains('\0') => text,
            // Options accept numbers as TOML writes them, except for TOML's digit separators.
            DeValue::Integer(number) if number.radix() == 10 => return Ok(format!("--{name}={number}")),
            DeValue::Float(number) => return Ok(format!("--{name}={number}")),
            DeValue::String(_)
            | DeValue::Integer(_)
            | DeValue::Boolean(_)
            | DeValue::Datetime(_)
            | DeValue::Array(_)
            | DeValue::Table(_) => {
                let message = format!(
                    "`{name}` has to be text, a decimal number, true, false, or a list of texts and numbers; found: {}",
                    kind(found)
                );
                return Err(self.error(value, message));
            }
        };
        Ok(format!("--{name}={text}"))
    }

    fn error<T>(&self, place: &Spanned<T>, message: String) -> SettingsError {
        SettingsError { line: self.line(&place.span()), message }
    }

    /// Returns the number of the line in which a span begins, counted from 1.
    fn line(&self, span: &Range<usize>) -> usize {
        self.0.bytes().take(span.start).filter(|byte| *byte == b'\n').count() + 1
    }
}

/// Returns the name of a value's type, for messages.
fn kind(value: &DeValue<'_>) -> &'static str {
    match value {
        DeValue::String(text) if text.contains('\0') => "text with U+0000",
        DeValue::String(_) => "text",
        DeValue::Integer(number) if number.radix() != 10 => "number of another base",
        DeValue::Integer(_) | DeValue::Float(_) => "number",
        DeValue::Boolean(true) => "true",
        DeValue::Boolean(false) => "false",
        DeValue::Datetime(_) => "date or time",
        DeValue::Array(_) => "list",
        DeValue::Table(_) => "table",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn refused(text: &str) -> String {
        let SettingsError { line, message } = read(text).unwrap_err();
        format!("{line}: {message}")
    }

    #[test]
    fn values_come_in_the_order_of_their_lines() {
        let text = "target = \"../rover\"\nworld = \"hall\"\n\n[options]\nspeed = \"max\"\nseed = 1_000\nperiod = 0.05\n\
                    watch = true\njson = false\nrequire = [\"r0 < 1m\", 'bumper']\n";
        let settings = read(text).unwrap();
        assert_eq!(settings.target, Some(Setting { line: 1, value: "../rover".to_owned() }));
        assert_eq!(settings.world, Some(Setting { line: 2, value: "hall".to_owned() }));
        let options: Vec<_> = settings.options.iter().map(|it| (it.line, &*it.name, it.arguments.join(" "))).collect();
        let expected = [
            (5, "speed", "--speed=max"),
            (6, "seed", "--seed=1000"),
            (7, "period", "--period=0.05"),
            (8, "watch", "--watch"),
            (9, "json", ""),
            (10, "require", "--require=r0 < 1m --require=bumper"),
        ];
        assert_eq!(options, expected.map(|(line, name, arguments)| (line, name, arguments.to_owned())));
        assert_eq!(read("# nothing yet\n"), Ok(SettingsText::default()));
        assert_eq!(read("options.seed = 7").unwrap().options[0].arguments, ["--seed=7"]);
    }

    #[test]
    fn unknown_keys_are_refused_with_the_nearest() {
        let keys =
            "help: the keys are target, world, safety, options, modules; options of runs are in the table `options`";
        assert_eq!(
            refused("\ntagret = \"sim\""),
            format!("2: there is no key `tagret`; did you mean `target`?\n{keys}")
        );
        assert_eq!(refused("speed = \"max\""), format!("1: there is no key `speed`\n{keys}"));
        assert_eq!(refused("\"a\\u001b\" = 1"), format!("1: there is no key `aU+001B`\n{keys}"));
        assert_eq!(
            refused("[target]\nname = 1\n"),
            "1: `target` has to be text, as in `target = \"sim\"`; found: table"
        );
        assert_eq!(refused("[options]\nworld = \"hall\""), "2: `world` is no option: write it above `[options]`");
        let name = "is no name of an option: write it without `--`, as in `speed = \"max\"`";
        assert_eq!(refused("[options]\n\n--speed = \"max\""), format!("3: `--speed` {name}"));
        assert_eq!(refused("[options]\n\"speed=max\" = \"\""), format!("2: `speed=max` {name}"));
    }

    #[test]
    fn wrong_types_are_refused_with_their_line() {
        assert_eq!(refused("target = 7"), "1: `target` has to be text, as in `target = \"sim\"`; found: number");
        assert_eq!(
            refused("safety = true"),
            "1: `safety` has to be text, as in `safety = \"rules.toml\"`; found: true"
        );
        assert_eq!(refused("world = [\"hall\"]"), "1: `world` has to be text, as in `world = \"hall\"`; found: list");
        let table = "`options` has to be a table, as in `options = { speed = \"max\" }`; found";
        assert_eq!(refused("\noptions = \"--speed max\""), format!("2: {table}: text"));
        assert_eq!(refused("options = [\"--speed\", \"max\"]"), format!("1: {table}: list"));
        let value = "has to be text, a decimal number, true, false, or a list of texts and numbers; found";
        assert_eq!(refused("[options]\nspeed = {}"), format!("2: `speed` {value}: table"));
        assert_eq!(refused("[options]\nstart = [[1, 2]]"), format!("2: `start` {value}: list"));
        assert_eq!(refused("[options]\nlog = \"a\\u0000b\""), format!("2: `log` {value}: text with U+0000"));
        assert_eq!(refused("[options]\nseed = 0x10"), format!("2: `seed` {value}: number of another base"));
        assert_eq!(refused("[options]\nrequire = [\n'a',\n1979-05-27]"), format!("4: `require` {value}: date or time"));
    }

    #[test]
    fn what_is_no_toml_is_refused_with_its_line() {
        for (text, line) in [("target = sim", 1), ("\n\n{ P }", 3), ("target = 'a'\ntarget = 'b'", 2), ("world = '", 1)]
        {
            let error = read(text).unwrap_err();
            assert_eq!(error.line, line, "{text}: {}", error.message);
            assert!(!error.message.is_empty() && !error.message.contains('\n'));
        }
    }
}
