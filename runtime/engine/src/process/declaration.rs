//! The declaration, the first line of a child process: attributes that the child publishes and reads.

use mdle_compiler::alphabet::did_you_mean;
use mdle_runtime::{Nanos, Printable};
use serde_json::{Map, Value as Json};

use super::line::{LineForm, nanos, object};
use super::shown;
use crate::attribute::{AttributeName, Reading, Value};
use crate::module::Declare;

/// Keys of a declaration.
const KEYS: [&str; 3] = ["publishes", "reads", "latency"];

/// Declaration of a child process.
#[derive(Debug, Default, PartialEq)]
pub(super) struct Declaration {
    publishes: Vec<(String, LineForm)>,
    reads: Vec<(AttributeName, LineForm)>,
    /// Time, in stepped time, between sending a line to the child and reading the child's answer.
    latency: Nanos,
}

impl Declaration {
    /// Reads the first line of a child.
    ///
    /// # Errors
    /// Fails with a sentence if the line is not a declaration.
    pub(super) fn read(line: &[u8]) -> Result<Self, String> {
        let object = object(line)?;
        let refused = |sentence: String| format!("its declaration {} is wrong: {sentence}", shown(line));
        if let Some(key) = object.keys().find(|key| !KEYS.contains(&key.as_str())) {
            let near = did_you_mean(key, &KEYS);
            return Err(refused(format!(
                "there is no key `{}`{near}\nhelp: the keys are {}",
                Printable(key),
                KEYS.join(", ")
            )));
        }
        let publishes = forms(&object, "publishes", "{\"range\": \"m\"}").map_err(refused)?;
        let reads = forms(&object, "reads", "{\"sensors/x\": \"m\"}").map_err(refused)?;
        let reads = reads.into_iter().map(|(path, form)| match path.split_once('/') {
            Some((module, attribute)) => Ok((AttributeName::new(module, attribute), form)),
            None => Err(refused(format!("`{}` has to be `MODULE/ATTRIBUTE`, as in `sensors/x`", Printable(path)))),
        });
        let latency = object.get("latency").map_or(Some(Nanos::ZERO), |latency| latency.as_f64().and_then(nanos));
        let latency =
            latency.ok_or_else(|| refused("`latency` has to be a number of seconds from 0, as in `0.2`".to_owned()))?;
        Ok(Self { publishes, reads: reads.collect::<Result<_, _>>()?, latency })
    }

    /// Declares the attributes of the child, in the order of the declaration.
    pub(super) fn declare(&self, declare: &mut Declare) {
        declare.doc("A child process.");
        for (name, form) in &self.publishes {
            declare.publishes_as(name, form.kind, form.unit);
        }
        for (AttributeName { module, attribute }, form) in &self.reads {
            declare.reads_as(module, attribute, form.kind);
        }
        declare.latency(self.latency);
    }

    /// Returns the line that is sent to the child after the turn break at `now`. It contains each value that the child
    /// reads, or `null`.
    pub(super) fn question(&self, now: Nanos, readings: &[Option<Reading>]) -> String {
        let values = self.reads.iter().zip(readings).map(|((AttributeName { module, attribute }, form), reading)| {
            let value = reading.as_ref().map_or(Json::Null, |reading| form.write(&reading.value));
            (format!("{module}/{attribute}"), value)
        });
        let time = ("t".to_owned(), Json::from(now.seconds()));
        let object: Map<String, Json> = [time].into_iter().chain(values).collect();
        Json::Object(object).to_string() + "\n"
    }

    /// Returns the values in an answer of the child, each with the position of its attribute in the declaration.
    ///
    /// # Errors
    /// Fails with a sentence if the line is not an answer.
    pub(super) fn answer(&self, line: &[u8]) -> Result<Vec<(usize, Value)>, String> {
        let values = object(line)?.into_iter().filter(|(_, value)| !value.is_null());
        let read = values.map(|(name, value)| {
            let place = self.publishes.iter().position(|(known, _)| *known == name);
            let Some((place, (_, form))) = place.and_then(|place| Some((place, self.publishes.get(place)?))) else {
                let known: Vec<_> = self.publishes.iter().map(|(known, _)| known.as_str()).collect();
                let near = did_you_mean(&name, &known);
                return Err(format!("its process publishes `{}`, which it has not declared{near}", Printable(name)));
            };
            let wrong =
                |expected| format!("its process publishes `{name}` as {}; expected: {expected}", Printable(&value));
            form.read(&value).map(|value| (place, value)).map_err(wrong)
        });
        read.collect()
    }
}

/// Returns the names and forms in the table `key` of a declaration; an empty list if there is no such table.
fn forms(object: &Map<String, Json>, key: &str, example: &str) -> Result<Vec<(String, LineForm)>, String> {
    let Some(table) = object.get(key) else { return Ok(Vec::new()) };
    let table =
        table.as_object().ok_or_else(|| format!("`{key}` has to be an object, as in `\"{key}\": {example}`"))?;
    let forms = table.iter().map(|(name, word)| {
        let form = word.as_str().and_then(LineForm::from_word);
        let message = || format!("`{}` is {word}; expected one of {}", Printable(name), LineForm::words());
        form.map(|form| (name.clone(), form)).ok_or_else(message)
    });
    forms.collect()
}

#[cfg(test)]
mod tests {
    use mdle_runtime::Meters;

    use super::*;

    const WELL: &[u8] =
        br#"{"publishes": {"range": "cm"}, "reads": {"sensors/x": "m", "ears/said": "text"}, "latency": 0.2}"#;

    #[test]
    fn a_line_asks_and_its_answer_is_checked() {
        let declaration = Declaration::read(WELL).unwrap();
        assert_eq!(declaration.latency, Nanos(200_000_000));
        let reading = Some(Reading { value: Value::Text("left".into()), at: Nanos::ZERO });
        let question = declaration.question(Nanos(1_500_000_000), &[reading, None]);
        assert_eq!(question, "{\"ears/said\":\"left\",\"sensors/x\":null,\"t\":1.5}\n");
        assert_eq!(declaration.answer(b"{\"range\": 25}"), Ok(vec![(0, Value::Length(Meters(0.25)))]));
        assert_eq!(declaration.answer(b" {\"range\": null} "), Ok(Vec::new()));
        let wrong =
            ["{\"rang\": 1}", "{\"range\": \"far\"}", "{\"range\": [1]}", "[1]", "{\"range\": 1", "nothing", ""];
        let refused = wrong.map(|line| declaration.answer(line.as_bytes()).unwrap_err());
        insta::assert_snapshot!(refused.join("\n"));
    }

    #[test]
    fn a_wrong_declaration_is_refused_with_the_cure() {
        let wrong = [
            "Traceback (most recent call last):",
            "{\"publish\": {\"range\": \"m\"}}",
            "{\"publishes\": \"range\"}",
            "{\"publishes\": {\"range\": \"metres\"}}",
            "{\"publishes\": {\"range\": 3}}",
            "{\"reads\": {\"x\": \"m\"}}",
            "{\"latency\": -1}",
        ];
        insta::assert_snapshot!(wrong.map(|line| Declaration::read(line.as_bytes()).unwrap_err()).join("\n"));
        assert_eq!(Declaration::read(b"{}"), Ok(Declaration::default()));
    }
}
