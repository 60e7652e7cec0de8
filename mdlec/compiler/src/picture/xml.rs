//! Escapes text for XML, and replaces characters that XML does not allow by their code points.

use mdle_runtime::{Printable, is_printable};

/// Returns the text in a form that is valid as XML content and as an attribute value in double quotes.
pub(super) fn escaped(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for letter in text.chars() {
        match letter {
            '&' => escaped.push_str("&amp;"),
            '<' => escaped.push_str("&lt;"),
            '>' => escaped.push_str("&gt;"),
            '"' => escaped.push_str("&quot;"),
            '\n' => escaped.push('\n'),
            letter if !is_printable(letter) => escaped += &Printable(letter).to_string(),
            letter => escaped.push(letter),
        }
    }
    escaped
}

#[cfg(test)]
mod tests {
    use super::escaped;

    #[test]
    fn what_xml_reads_otherwise_is_escaped() {
        assert_eq!(
            escaped("a < b && \"c\" > 'd'\u{7}\u{FFFE}ξ"),
            "a &lt; b &amp;&amp; &quot;c&quot; &gt; 'd'U+0007U+FFFEξ"
        );
    }
}
