//! Exact decimal numbers. Arguments are compared by their exact values as written, without rounding
//! (docs/src/reference/semantics.md, 7.2).

use std::fmt;

/// An exact decimal number: a sign, digits without leading or trailing zeros, and a power of ten.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Decimal {
    negative: bool,
    /// Digits from 0 to 9, most significant first; empty for zero.
    digits: Vec<u8>,
    /// Power of ten of the last digit.
    exponent: i64,
}

impl Decimal {
    /// Parses the text of a number token, with sign, digits, fraction and exponent. Returns `None` for any other text.
    #[must_use]
    pub fn parse(text: &str) -> Option<Self> {
        let (negative, rest) = match text.strip_prefix('-') {
            Some(rest) => (true, rest),
            None => (false, text.strip_prefix('+').unwrap_or(text)),
        };
        let (mantissa, power) = match rest.split_once(['e', 'E']) {
            Some((mantissa, power)) => (mantissa, power.parse::<i32>().ok()?),
            None => (rest, 0),
        };
        let (whole, fraction) = mantissa.split_once('.').unwrap_or((mantissa, ""));
        if whole.is_empty() || !whole.bytes().chain(fraction.bytes()).all(|byte| byte.is_ascii_digit()) {
            return None;
        }
        let digits = whole.bytes().chain(fraction.bytes()).map(|byte| byte - b'0').collect();
        let exponent = i64::from(power) - i64::try_from(fraction.len()).ok()?;
        Some(Self { negative, digits, exponent }.normalized())
    }

    /// Returns the number zero.
    #[must_use]
    pub fn zero() -> Self {
        Self { negative: false, digits: Vec::new(), exponent: 0 }
    }

    /// Returns the exact product of the number, `factor`, and ten to the power `exponent`.
    #[must_use]
    pub fn scaled(&self, factor: u32, exponent: i32) -> Self {
        let mut product = Vec::with_capacity(self.digits.len() + 10);
        let mut carry = 0_u64;
        for digit in self.digits.iter().rev() {
            let value = u64::from(*digit) * u64::from(factor) + carry;
            product.push((value % 10) as u8);
            carry = value / 10;
        }
        while carry > 0 {
            product.push((carry % 10) as u8);
            carry /= 10;
        }
        product.reverse();
        let exponent = self.exponent + i64::from(exponent);
        Self { negative: self.negative, digits: product, exponent }.normalized()
    }

    /// Returns the nearest `f64`; infinity if the number is too large.
    #[must_use]
    pub fn to_f64(&self) -> f64 {
        let sign = if self.negative { "-" } else { "" };
        let digits: String = self.digits.iter().map(|digit| char::from(b'0' + digit)).collect();
        format!("{sign}0{digits}e{}", self.exponent).parse().unwrap_or(f64::INFINITY)
    }

    /// Returns the number in billionths, rounded to the nearest whole number (halves are rounded up); `None` if the
    /// result is negative or does not fit into `u64`.
    #[must_use]
    pub fn to_nanos(&self) -> Option<u64> {
        if self.digits.is_empty() {
            return Some(0);
        }
        if self.negative {
            return None;
        }
        let exponent = self.exponent + 9;
        let mut value = 0_u128;
        let length = i64::try_from(self.digits.len()).ok()?;
        if length + exponent > 25 {
            return None;
        }
        for position in 0..(length + exponent).max(0) {
            let digit = usize::try_from(position).ok().and_then(|index| self.digits.get(index)).copied().unwrap_or(0);
            value = value * 10 + u128::from(digit);
        }
        let first_dropped = usize::try_from(length + exponent).ok().and_then(|index| self.digits.get(index));
        let rounded = value + u128::from(first_dropped.is_some_and(|digit| *digit >= 5));
        u64::try_from(rounded).ok()
    }

    /// Returns `true` if the decimal is a whole number.
    #[must_use]
    pub fn is_whole(&self) -> bool {
        self.digits.is_empty() || self.exponent >= 0
    }

    fn normalized(mut self) -> Self {
        let zeros = self.digits.iter().take_while(|digit| **digit == 0).count();
        self.digits.drain(..zeros);
        while self.digits.last() == Some(&0) {
            self.digits.pop();
            self.exponent += 1;
        }
        if self.digits.is_empty() {
            return Self { negative: false, digits: self.digits, exponent: 0 };
        }
        self
    }
}

impl fmt::Display for Decimal {
    /// Writes the number without an exponent, unless it would then be longer than forty digits.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.digits.is_empty() {
            return f.write_str("0");
        }
        let digits: String = self.digits.iter().map(|digit| char::from(b'0' + digit)).collect();
        if self.negative {
            f.write_str("-")?;
        }
        let point = i64::try_from(digits.len()).unwrap_or(i64::MAX).saturating_add(self.exponent);
        if !(-40..=40).contains(&point) || self.exponent < -60 {
            return write!(f, "{digits}e{}", self.exponent);
        }
        if self.exponent >= 0 {
            return write!(f, "{digits}{}", "0".repeat(usize::try_from(self.exponent).unwrap_or(0)));
        }
        match usize::try_from(point) {
            Ok(point) if point > 0 => write!(f, "{}.{}", &digits[..point], &digits[point..]),
            Ok(_) | Err(_) => write!(f, "0.{}{digits}", "0".repeat(usize::try_from(-point).unwrap_or(0))),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::Decimal;

    fn decimal(text: &str) -> Decimal {
        Decimal::parse(text).expect(text)
    }

    #[test]
    fn spellings_of_one_number_are_equal_and_print_plainly() {
        for (spellings, plain) in [
            (&["20", "20.0", "2e1", "+20.00", "020", "0.2e2"][..], "20"),
            (&["-0.36", "-36e-2", "-0.360"], "-0.36"),
            (&["0", "-0", "0.000", "0e9"], "0"),
            (&["0.001", "1e-3"], "0.001"),
            (&["1234.5"], "1234.5"),
            (&["1e100"], "1e100"),
        ] {
            for spelling in spellings {
                assert_eq!(decimal(spelling), decimal(plain), "{spelling}");
                assert_eq!(decimal(spelling).to_string(), plain, "{spelling}");
            }
        }
        assert_eq!(["", "-", "1.2.3", "a", ".5", "1e", "1e99999999999"].map(Decimal::parse), [const { None }; 7]);
    }

    #[test]
    fn units_scale_exactly() {
        assert_eq!(decimal("1").scaled(254, -4), decimal("0.0254"));
        assert_eq!(decimal("0.5").scaled(3600, 0), decimal("1800"));
        assert_eq!(decimal("20").scaled(1, -2), decimal("0.2"));
    }

    #[test]
    fn nanoseconds_round_to_the_nearest() {
        for (seconds, nanos) in [
            ("7", Some(7_000_000_000)),
            ("0.0000000015", Some(2)),
            ("0.0000000014", Some(1)),
            ("0.0000000005", Some(1)),
            ("0.00000000049", Some(0)),
            ("1e-30", Some(0)),
            ("18446744073.709551615", Some(u64::MAX)),
            ("18446744073.709551616", None),
            ("1e30", None),
            ("-1", None),
            ("-0", Some(0)),
        ] {
            assert_eq!(decimal(seconds).to_nanos(), nanos, "{seconds}");
        }
    }
}
