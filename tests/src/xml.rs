//! A strict parser of the XML that mdlec writes. Text that is not well-formed is an error.

use std::collections::BTreeMap;

/// An element of a document.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Element {
    /// Name of the element.
    pub name: String,
    /// Attributes of the element.
    pub attributes: BTreeMap<String, String>,
    /// Elements directly inside the element.
    pub children: Vec<Element>,
    /// Text of the element, without the text of its children.
    pub text: String,
}

impl Element {
    /// Returns the value of an attribute; panics if the element does not have this attribute.
    #[must_use]
    pub fn attribute(&self, name: &str) -> &str {
        self.attributes.get(name).unwrap_or_else(|| panic!("<{}> has no `{name}`", self.name))
    }

    /// Returns the element and all nested elements, outer elements first.
    #[must_use]
    pub fn all(&self) -> Vec<&Self> {
        let (mut all, mut open) = (Vec::new(), vec![self]);
        while let Some(element) = open.pop() {
            all.push(element);
            open.extend(element.children.iter().rev());
        }
        all
    }
}

/// Returns the root element of a document.
#[must_use]
pub fn read(text: &str) -> Element {
    assert!(text.chars().all(|letter| !letter.is_control() || letter == '\n'), "a control character");
    let mut open = vec![Element::default()];
    let mut rest = text.strip_prefix("<?xml version=\"1.0\" encoding=\"UTF-8\"?>").unwrap_or(text);
    while let Some((before, tag)) = rest.split_once('<') {
        put(&mut open, before);
        let (tag, behind) = tag.split_once('>').expect("a tag ends");
        rest = behind;
        if let Some(name) = tag.strip_prefix('/') {
            let closed = open.pop().unwrap();
            assert_eq!(closed.name, name, "what is closed is what was opened last");
            open.last_mut().expect("it was open").children.push(closed);
        } else {
            let empty = tag.strip_suffix('/');
            let element = element(empty.unwrap_or(tag));
            match empty {
                Some(_) => open.last_mut().unwrap().children.push(element),
                None => open.push(element),
            }
        }
    }
    put(&mut open, rest);
    let mut document = open.pop().unwrap();
    assert!(open.is_empty() && document.text.trim().is_empty() && document.children.len() == 1, "one element");
    document.children.swap_remove(0)
}

fn put(open: &mut [Element], text: &str) {
    assert!(!text.contains('>'), "a `>` in {text:?}");
    open.last_mut().expect("an element").text += &unescaped(text);
}

/// Parses the text of a tag between its brackets.
fn element(tag: &str) -> Element {
    let (name, mut rest) = tag.split_once(' ').unwrap_or((tag, ""));
    assert!(!name.is_empty() && name.chars().all(char::is_alphanumeric), "the name {name:?}");
    let mut element = Element { name: name.to_owned(), ..Element::default() };
    while !rest.is_empty() {
        let (key, value) = rest.split_once("=\"").unwrap_or_else(|| panic!("an attribute in {tag:?}"));
        let (value, behind) = value.split_once('"').expect("a value ends");
        assert!(key.chars().all(|letter| letter.is_alphanumeric() || "-:".contains(letter)), "the name {key:?}");
        let twice = element.attributes.insert(key.to_owned(), unescaped(value));
        assert_eq!(twice, None, "{key} twice");
        rest = behind.strip_prefix(' ').unwrap_or(behind);
        assert!(rest.is_empty() || behind.starts_with(' '), "a blank between attributes in {tag:?}");
    }
    element
}

fn unescaped(text: &str) -> String {
    let mut parts = text.split('&');
    let mut unescaped = parts.next().unwrap_or_default().to_owned();
    for part in parts {
        let (name, behind) = part.split_once(';').expect("an entity ends");
        let letter = match name {
            "amp" => '&',
            "lt" => '<',
            "gt" => '>',
            "quot" => '"',
            other => panic!("the entity {other:?}"),
        };
        unescaped.push(letter);
        unescaped += behind;
    }
    unescaped
}
