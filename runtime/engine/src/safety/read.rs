//! Reads the rules of a safety file (docs/src/safety.md).

use mdle_quantity::Quantity;
use mdle_runtime::{Nanos, Printable};
use toml::de::{DeTable, DeValue};

use super::error::RulesError;
use super::section::{Section, TomlValue, kind, line};
use super::{ConditionText, Fence, Guard, Limits, Measure, PlanEntry, Rules, Then};

/// Tables that a safety file may contain.
const TABLES: [&str; 6] = ["limits", "fence", "contact", "stale", "overrun", "guards"];

/// Reads the rules of a file.
///
/// # Errors
/// Fails if the text is not TOML, or contains an invalid key, value or fence.
pub fn read(text: &str) -> Result<Rules, RulesError> {
    let parsed = DeTable::parse(text).map_err(|error| RulesError {
        line: line(text, error.span().map_or(0, |span| span.start)),
        message: error.message().replace('\n', "; "),
    })?;
    let file = Section::of_file(text, parsed.get_ref()).only(&TABLES)?;
    let mut reading = SafetyReader { file, rules: Rules::default() };
    for (key, value) in file.entries() {
        match &**key.get_ref() {
            "limits" => reading.limits(value)?,
            "fence" => reading.fences(value)?,
            "contact" => {
                let section = file.table("contact", value)?.only(&["then"])?;
                reading.rules.contact = Some(reading.then(section, &ALL)?);
            }
            "stale" => {
                let section = file.table("stale", value)?.only(&["output", "module", "then"])?;
                let age = |key| {
                    let age = section.get(key).map(|value| section.time(key, value)).transpose()?;
                    Ok(age.map(|age| Nanos(u64::try_from(age.as_nanos()).unwrap_or(u64::MAX))))
                };
                let (output, module) = (age("output")?, age("module")?);
                if module.is_none() {
                    section.needed("output", "\"400ms\"")?;
                }
                let then = reading.then(section, &HOLD_OR_END)?;
                reading.rules.stale = output.map(|age| (age, then));
                reading.rules.stale_module = module.map(|age| (age, then));
            }
            "overrun" => {
                let section = file.table("overrun", value)?.only(&["turns", "then"])?;
                let turns = section.count("turns", section.needed("turns", "3")?)?;
                reading.rules.overrun = Some((turns, reading.then(section, &HOLD_OR_END)?));
            }
            _ => reading.guards(value)?,
        }
    }
    Ok(reading.rules)
}

/// Words for the consequences of a rule; the last one stands for the file of a plan.
const ALL: [&str; 4] = ["hold", "hold forward", "end", "retreat.mdle"];
/// Words for the consequences of a rule that cannot divert to another plan.
const HOLD_OR_END: [&str; 2] = ["hold", "end"];

struct SafetyReader<'t, 'i> {
    file: Section<'t, 'i>,
    rules: Rules,
}

impl<'t, 'i> SafetyReader<'t, 'i> {
    fn limits(&mut self, value: &'t TomlValue<'i>) -> Result<(), RulesError> {
        let section = self.file.table("limits", value)?.only(&Measure::ALL.map(Measure::key))?;
        let mut limits = Limits::default();
        for measure in Measure::ALL {
            let Some(value) = section.get(measure.key()) else { continue };
            let read = section.quantity(measure.key(), value, measure.quantity(), false)?;
            *measure.of(&mut limits) = measure.in_si(read);
        }
        self.rules.limits = limits;
        Ok(())
    }

    fn fences(&mut self, value: &'t TomlValue<'i>) -> Result<(), RulesError> {
        let Some(fences) = value.get_ref().as_array() else {
            let message = format!("write `[[fence]]`, as there may be several; found: {}", kind(value.get_ref()));
            return Err(self.file.error(value, message));
        };
        for value in fences {
            let section = self.file.table("fence", value)?.only(&["inside", "margin", "deceleration"])?;
            let inside = section.needed("inside", "[[0, 0], [2, 0], [2, 1], [0, 1]]")?;
            let corners = corners(section, inside)?;
            let margin =
                section.get("margin").map(|value| section.quantity("margin", value, (Quantity::Length, "m"), true));
            let braking = section.needed("deceleration", "\"0.5m/s2\"")?;
            let deceleration = section.quantity("deceleration", braking, (Quantity::Acceleration, "m/s2"), false)?;
            let number = self.rules.fences.len() + 1;
            let name = if number == 1 { "fence".to_owned() } else { format!("fence {number}") };
            let fence = Fence { name, corners, margin: margin.transpose()?.unwrap_or(0.0), deceleration };
            if let Some(fault) = fence.fault() {
                return Err(section.error(inside, format!("there is no such fence: {fault}")));
            }
            self.rules.fences.push(fence);
        }
        Ok(())
    }

    fn guards(&mut self, value: &'t TomlValue<'i>) -> Result<(), RulesError> {
        let guards = self.file.table("guards", value)?;
        for (key, value) in guards.entries() {
            let name = key.get_ref();
            let is_name =
                !name.is_empty() && name.chars().all(|letter| letter.is_ascii_alphanumeric() || letter == '_');
            if !is_name || RESERVED.contains(&&**name) {
                let message = format!(
                    "`{}` is no name of a guard: use ASCII letters, digits and `_`, and no rule's name",
                    Printable(name)
                );
                return Err(guards.error(key, message));
            }
            let section = guards.table(name, value)?.only(&["when", "then"])?;
            let when = section.needed("when", "\"r0 < 20cm AND v > 5cm/s\"")?;
            let text = section.text("when", when, "\"r0 < 20cm AND v > 5cm/s\"")?;
            let (line, bytes) = section.place(&when.span(), text);
            let when = ConditionText { text: text.to_owned(), line, bytes };
            let then = self.then(section, &ALL)?;
            self.rules.guards.push(Guard { name: name.to_string(), when, then });
        }
        Ok(())
    }

    /// Reads the consequence of a rule; `words` are the permitted words.
    fn then(&mut self, section: Section<'t, 'i>, words: &[&str]) -> Result<Then, RulesError> {
        let value = section.needed("then", "\"hold\"")?;
        let text = section.text("then", value, "\"hold\"")?;
        match text {
            "hold" => Ok(Then::Hold),
            "end" => Ok(Then::End),
            "hold forward" if words.contains(&text) => Ok(Then::HoldForward),
            plan if plan.ends_with(".mdle") && words.len() == ALL.len() => {
                let known = self.rules.plans.iter().position(|known| known.file == plan);
                Ok(Then::Divert(known.unwrap_or_else(|| {
                    let (line, _) = section.place(&value.span(), plan);
                    self.rules.plans.push(PlanEntry { file: plan.to_owned(), line });
                    self.rules.plans.len() - 1
                })))
            }
            other => {
                let word = |word: &&str| match word.ends_with(".mdle") {
                    true => format!("the file of a plan, such as \"{word}\""),
                    false => format!("\"{word}\""),
                };
                let words: Vec<_> = words.iter().map(word).collect();
                let (last, first) = words
                    .split_last()
                    .map_or((String::new(), String::new()), |(last, first)| (last.clone(), first.join(", ")));
                let message = format!("`then` has to be {first} or {last}; found: {}", Printable(other));
                Err(section.error(value, message))
            }
        }
    }
}

/// Names of other rules, which a guard must not have.
const RESERVED: [&str; 8] =
    ["stale", "stale_module", "overrun", "contact", "speed", "turn_rate", "acceleration", "fence"];

/// Reads the corners of a fence.
fn corners(section: Section<'_, '_>, value: &TomlValue<'_>) -> Result<Vec<[f64; 2]>, RulesError> {
    let wrong = |place: &TomlValue<'_>, what: &str| {
        section.error(place, format!("{what}, as in `inside = [[0, 0], [2, 0], [2, 1], [0, 1]]`, in metres"))
    };
    let Some(points) = value.get_ref().as_array().filter(|points| points.len() >= 3) else {
        return Err(wrong(value, "`inside` has to be a list of three corners or more"));
    };
    let number = |value: &TomlValue<'_>| match value.get_ref() {
        DeValue::Integer(number) if number.radix() == 10 => number.as_str().parse().ok(),
        DeValue::Float(number) => number.as_str().parse().ok(),
        DeValue::Integer(_) | DeValue::String(_) | DeValue::Boolean(_) | DeValue::Datetime(_) => None,
        DeValue::Array(_) | DeValue::Table(_) => None,
    };
    let number = |value: &TomlValue<'_>| number(value).filter(|number: &f64| number.abs() <= 1e6);
    let corner = |point: &TomlValue<'_>| {
        let pair = point.get_ref().as_array().filter(|pair| pair.len() == 2);
        let [x, y] = [0, 1].map(|axis| number(pair?.get(axis)?));
        x.zip(y).map(|(x, y)| [x, y]).ok_or_else(|| wrong(point, "a corner has to be two numbers"))
    };
    points.iter().map(corner).collect()
}
