//! Evaluates the subset of ECMAScript expressions that occurs in the conditions of mdlec's SCXML machines.

use std::collections::BTreeMap;

/// A value.
#[derive(Debug, Clone, PartialEq)]
pub enum Value {
    /// `undefined`.
    Undefined,
    /// `null`.
    Null,
    /// `true` or `false`.
    Bool(bool),
    /// A number.
    Number(f64),
    /// A string.
    Text(String),
    /// An array.
    List(Vec<Value>),
    /// An object.
    Object(BTreeMap<String, Value>),
}

impl Value {
    /// Returns `true` if a condition with this value holds.
    #[must_use]
    pub fn is_true(&self) -> bool {
        match self {
            Self::Undefined | Self::Null => false,
            Self::Bool(value) => *value,
            Self::Number(value) => *value != 0.0 && !value.is_nan(),
            Self::Text(text) => !text.is_empty(),
            Self::List(_) | Self::Object(_) => true,
        }
    }

    fn number(&self) -> f64 {
        let Self::Number(value) = self else { panic!("{self:?} is no number") };
        *value
    }

    fn member(&self, name: &str) -> Self {
        let Self::Object(members) = self else { panic!("{self:?} has no `{name}`") };
        members.get(name).cloned().unwrap_or(Self::Undefined)
    }
}

/// Returns the value of an expression.
///
/// # Panics
/// If the expression is not in the supported subset.
#[must_use]
pub fn evaluate(text: &str, data: &BTreeMap<String, Value>) -> Value {
    let mut reader = Reader { rest: text, data };
    let value = reader.conditional(true);
    assert!(reader.rest.trim().is_empty(), "{:?} is left of {text:?}", reader.rest);
    value
}

/// Parser that evaluates an expression in the same pass. Parts with `live` set to `false` are parsed but not evaluated.
struct Reader<'r> {
    rest: &'r str,
    data: &'r BTreeMap<String, Value>,
}

impl Reader<'_> {
    fn takes(&mut self, sign: &str) -> bool {
        let behind = self.rest.trim_start().strip_prefix(sign);
        behind.inspect(|rest| self.rest = rest).is_some()
    }

    fn conditional(&mut self, live: bool) -> Value {
        let condition = self.or(live);
        if !self.takes("?") {
            return condition;
        }
        let holds = condition.is_true();
        let one = self.conditional(live && holds);
        assert!(self.takes(":"));
        let other = self.conditional(live && !holds);
        if holds { one } else { other }
    }

    fn or(&mut self, live: bool) -> Value {
        let mut value = self.and(live);
        while self.takes("||") {
            let other = self.and(live && !value.is_true());
            value = if value.is_true() { value } else { other };
        }
        value
    }

    fn and(&mut self, live: bool) -> Value {
        let mut value = self.comparison(live);
        while self.takes("&&") {
            let other = self.comparison(live && value.is_true());
            value = if value.is_true() { other } else { value };
        }
        value
    }

    fn comparison(&mut self, live: bool) -> Value {
        let value = self.sum(live);
        let sign = ["!==", "==", ">=", "<"].into_iter().find(|sign| self.takes(sign));
        let Some(sign) = sign else { return value };
        let other = self.sum(live);
        if !live {
            return Value::Undefined;
        }
        Value::Bool(match sign {
            "!==" => value != other,
            "==" => value == other,
            ">=" => value.number() >= other.number(),
            _ => value.number() < other.number(),
        })
    }

    fn sum(&mut self, live: bool) -> Value {
        let mut value = self.product(live);
        while let Some(sign) = ["+", "-"].into_iter().find(|sign| self.takes(sign)) {
            let other = self.product(live);
            if live {
                let other = if sign == "-" { -other.number() } else { other.number() };
                value = Value::Number(value.number() + other);
            }
        }
        value
    }

    fn product(&mut self, live: bool) -> Value {
        let mut value = self.unary(live);
        while self.takes("*") {
            let other = self.unary(live);
            if live {
                value = Value::Number(value.number() * other.number());
            }
        }
        value
    }

    fn unary(&mut self, live: bool) -> Value {
        if self.takes("!") {
            return Value::Bool(!self.unary(live).is_true());
        }
        if self.takes("-") {
            let value = self.unary(live);
            return if live { Value::Number(-value.number()) } else { value };
        }
        self.member(live)
    }

    fn member(&mut self, live: bool) -> Value {
        if self.takes("Math.round(") {
            let value = self.conditional(live);
            assert!(self.takes(")"));
            // ECMAScript rounds half up.
            return if live { Value::Number((value.number() + 0.5).floor()) } else { value };
        }
        let mut value = self.primary(live);
        while self.takes(".") {
            let name = self.name();
            if name == "indexOf" {
                assert!(self.takes("("));
                let wanted = self.conditional(live);
                assert!(self.takes(")"));
                value = match (value, live) {
                    (Value::List(all), true) => {
                        Value::Number(all.iter().position(|one| *one == wanted).map_or(-1.0, |place| place as f64))
                    }
                    (_, false) => Value::Undefined,
                    (other, true) => panic!("{other:?} has no indexOf"),
                };
            } else if live {
                value = value.member(&name);
            }
        }
        value
    }

    fn name(&mut self) -> String {
        let rest = self.rest.trim_start();
        let end = rest.find(|letter: char| !letter.is_alphanumeric() && letter != '_').unwrap_or(rest.len());
        let name = rest[..end].to_owned();
        assert!(!name.is_empty(), "a name before {rest:?}");
        self.rest = &rest[end..];
        name
    }

    /// Reads a string in double quotes.
    fn text(&mut self) -> String {
        let mut letters = self.rest.trim_start().strip_prefix('"').expect("a quote").chars();
        let mut text = String::new();
        loop {
            match letters.next().expect("a string ends") {
                '"' => break,
                '\\' => match letters.next() {
                    Some(letter @ ('"' | '\\')) => text.push(letter),
                    other => panic!("the escape {other:?}"),
                },
                letter => text.push(letter),
            }
        }
        self.rest = letters.as_str();
        text
    }

    fn primary(&mut self, live: bool) -> Value {
        if self.takes("(") {
            let value = self.conditional(live);
            assert!(self.takes(")"), "a parenthesis before {:?}", self.rest);
            return value;
        }
        if self.takes("[]") {
            return Value::List(Vec::new());
        }
        let rest = self.rest.trim_start();
        if rest.starts_with('"') {
            return Value::Text(self.text());
        }
        let name = self.name();
        match name.as_str() {
            "null" => Value::Null,
            "true" => Value::Bool(true),
            "false" => Value::Bool(false),
            number if number.starts_with(|digit: char| digit.is_ascii_digit()) => {
                Value::Number(number.parse().expect("a number"))
            }
            _ if live => self.data.get(&name).unwrap_or_else(|| panic!("no data `{name}`")).clone(),
            _ => Value::Undefined,
        }
    }
}
