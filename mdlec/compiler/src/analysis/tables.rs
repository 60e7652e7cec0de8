//! Truth tables with one bit for each combination of the values of some variables, stored in words of 64 bits.

/// Maximum number of variables for which all choices are enumerated.
pub(super) const VARIABLES: usize = 12;

/// A truth table. The index of a bit is the number of a choice; bit `i` of this number is the value of variable `i`.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct TruthTable(Vec<u64>);

/// Truth tables of the first six variables, each of which fits into one word.
const SHORT: [u64; 6] = [
    0xAAAA_AAAA_AAAA_AAAA,
    0xCCCC_CCCC_CCCC_CCCC,
    0xF0F0_F0F0_F0F0_F0F0,
    0xFF00_FF00_FF00_FF00,
    0xFFFF_0000_FFFF_0000,
    0xFFFF_FFFF_0000_0000,
];

impl TruthTable {
    /// Returns a table for `variables` variables that contains `value` for every choice.
    pub(super) fn constant(variables: usize, value: bool) -> Self {
        let words = 1_usize << variables.saturating_sub(SHORT.len());
        Self(vec![if value { u64::MAX } else { 0 }; words])
    }

    /// Returns a table for `variables` variables that is true for the choices in which the variable `index` is true.
    pub(super) fn variable(variables: usize, index: usize) -> Self {
        let mut table = Self::constant(variables, false);
        for (number, word) in table.0.iter_mut().enumerate() {
            *word = match SHORT.get(index) {
                Some(short) => *short,
                None if number >> (index - SHORT.len()) & 1 == 1 => u64::MAX,
                None => 0,
            };
        }
        table
    }

    /// Returns the conjunction of two tables.
    pub(super) fn and(mut self, other: &Self) -> Self {
        self.0.iter_mut().zip(&other.0).for_each(|(word, other)| *word &= other);
        self
    }

    /// Returns the disjunction of two tables.
    pub(super) fn or(mut self, other: &Self) -> Self {
        self.0.iter_mut().zip(&other.0).for_each(|(word, other)| *word |= other);
        self
    }

    /// Returns the negation of the table.
    pub(super) fn not(mut self) -> Self {
        self.0.iter_mut().for_each(|word| *word = !*word);
        self
    }

    /// Returns `true` if the table is true for the choice with this number.
    pub(super) fn holds(&self, choice: usize) -> bool {
        self.0.get(choice / 64).is_some_and(|word| word >> (choice % 64) & 1 == 1)
    }

    /// Returns `true` if the table is true for at least one choice.
    pub(super) fn is_possible(&self) -> bool {
        self.0.iter().any(|word| *word != 0)
    }
}

#[cfg(test)]
mod tests {
    use super::TruthTable;

    #[test]
    fn tables_are_what_the_operators_say_of_every_choice() {
        for variables in 1..=9_usize {
            let of = |index| TruthTable::variable(variables, index);
            let [one, other] = [0, variables - 1];
            let (both, any, not) = (of(one).and(&of(other)), of(one).or(&of(other)), of(one).not());
            for choice in 0..1 << variables {
                let [first, last] = [one, other].map(|index| choice >> index & 1 == 1);
                assert_eq!([of(one).holds(choice), of(other).holds(choice)], [first, last]);
                assert_eq!([both.holds(choice), any.holds(choice)], [first & last, first | last]);
                assert_eq!(not.holds(choice), !first);
            }
            assert!(!of(one).and(&of(one).not()).is_possible() && TruthTable::constant(variables, true).is_possible());
        }
    }
}
