//! Provides the texts of `mdlec explain`. For each code, there is a paragraph and two examples; a test compiles the
//! examples.

/// Explanation of a code: paragraphs, then a line that begins with `Wrong` and one with `Right`, each followed by an
/// example indented by four spaces. Such a line may contain, in backticks, the command that the example is for; the
/// default is `mdlec check plan.mdle`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Explanation(pub(super) &'static str);

/// An example in the explanation of a diagnostic code.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Example {
    /// Arguments with which `mdlec` reports the example's mistake.
    pub arguments: Vec<String>,
    /// Text of the file in the example.
    pub text: String,
}

impl Explanation {
    /// Returns the text of the explanation as it is printed.
    #[must_use]
    pub fn text(self) -> &'static str {
        self.0
    }

    /// Returns the example with the mistake; `None` if the explanation has no such example.
    #[must_use]
    pub fn wrong(self) -> Option<Example> {
        self.example("Wrong")
    }

    /// Returns the example without the mistake; `None` if the explanation has no such example.
    #[must_use]
    pub fn right(self) -> Option<Example> {
        self.example("Right")
    }

    fn example(self, word: &str) -> Option<Example> {
        let mut lines = self.0.lines().skip_while(|line| !line.starts_with(word));
        let mut named = lines.next()?.split('`').skip(1).step_by(2);
        let command = named.find(|text| text.starts_with("mdlec ")).unwrap_or("mdlec check plan.mdle");
        let is_inside = |line: &&str| line.is_empty() || line.starts_with("    ");
        let lines = lines.take_while(is_inside).map(|line| line.strip_prefix("    ").unwrap_or(line));
        let text = lines.collect::<Vec<_>>().join("\n").trim_matches('\n').to_owned() + "\n";
        Some(Example { arguments: command.split(' ').skip(1).map(str::to_owned).collect(), text })
    }
}
