//! Settings of a robot that a user can change while it drives, such as the order in which its sonars ping (paper, Fig.
//! 7).

use mdle_runtime::SONARS;

/// Settings of a robot, as texts that a user can read and type.
pub trait RobotSettings {
    /// Returns the name and a description of each setting. The result does not change in a run.
    fn settings(&self) -> &'static [(&'static str, &'static str)];

    /// Returns the value of a setting in the form in which a user may type it; `None` if there is no such setting.
    fn setting(&self, name: &str) -> Option<String>;

    /// Changes a setting from the next exchange on.
    ///
    /// # Errors
    /// Returns a message with the text to type instead if there is no such setting, or if the value is invalid.
    fn set(&mut self, name: &str, value: &str) -> Result<(), String>;
}

/// A function that returns the settings of a robot.
pub type SettingsOf<R> = fn(&mut R) -> &mut dyn RobotSettings;

/// Parses an order in which sonars ping: one to sixteen sonar numbers, counted from 0.
///
/// # Errors
/// Returns a message with the text to type instead if the order is invalid.
pub fn sonar_order(text: &str) -> Result<Vec<u8>, String> {
    let number = |word: &str| word.parse().ok().filter(|number: &u8| usize::from(*number) < SONARS);
    let order: Option<Vec<u8>> = text.split_whitespace().map(number).collect();
    let order = order.filter(|order| (1..=SONARS).contains(&order.len()));
    order.ok_or_else(|| format!("expected from one to sixteen numbers of sonars, from 0 to 15; found `{text}`"))
}

#[cfg(test)]
mod tests {
    use super::sonar_order;

    #[test]
    fn an_order_of_sonars_is_read() {
        assert_eq!(sonar_order(" 0 15  3"), Ok(vec![0, 15, 3]));
        let many = "1 ".repeat(17);
        for wrong in ["", "16", "-1", "0,1", "a", "0x1", &many] {
            let expected = format!("expected from one to sixteen numbers of sonars, from 0 to 15; found `{wrong}`");
            assert_eq!(sonar_order(wrong), Err(expected));
        }
    }
}
