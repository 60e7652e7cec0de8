//! Fits a line to a wall's echoes while the robot drives along the wall; the sonar that faces the wall receives these
//! echoes.

use crate::Nanos;

/// Maximum distance, in metres, of an echo from the line of its wall.
const APART: f64 = 0.1;
/// Maximum number of echoes that a line takes into account.
const KEPT: f64 = 24.0;
/// Minimum value of `RegressionLine::squares`, in square metres, for which the direction of a wall is treated as known:
/// at this value, range errors of 1.5 cm cause a direction error of 1 degree. The sides of boxes, which may lie at any
/// angle, are too short to reach it.
const KNOWN: f64 = 1.0;
/// Minimum value of `RegressionLine::squares`, in square metres, for which the slope of the line is used to predict the
/// next echo of the wall.
const GUESSED: f64 = 0.02;

/// Regression line through echoes, from their coordinates along and across an axis, in metres.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct RegressionLine {
    count: f64,
    along: f64,
    across: f64,
    /// Sum of the squared deviations of the coordinates along the axis from their mean, in square metres. `products` is
    /// the sum of the products of the deviations along and across the axis.
    pub(super) squares: f64,
    products: f64,
    /// `true` if the last echo did not fit the line.
    strays: bool,
    pub(super) last: Nanos,
}

impl RegressionLine {
    /// Creates a line without echoes. It accepts only echoes after the time `last`.
    pub(super) fn since(last: Nanos) -> Self {
        Self { last, ..Self::default() }
    }

    /// Adds an echo to the line. The second consecutive echo that does not fit the line begins a new line.
    pub(super) fn take(&mut self, along: f64, across: f64) {
        let slope = if self.squares >= GUESSED { self.products / self.squares } else { 0.0 };
        let line = self.across + slope * (along - self.along);
        let strays = self.count > 0.0 && (across - line).abs() > APART;
        if strays && !self.strays {
            self.strays = true;
            return;
        }
        if strays {
            *self = Self { last: self.last, ..Self::default() };
        }
        self.strays = false;
        if self.count >= KEPT {
            self.squares *= 1.0 - 1.0 / KEPT;
            self.products *= 1.0 - 1.0 / KEPT;
        } else {
            self.count += 1.0;
        }
        let (from_along, from_across) = (along - self.along, across - self.across);
        self.along += from_along / self.count;
        self.across += from_across / self.count;
        self.squares += from_along * (along - self.along);
        self.products += from_along * (across - self.across);
    }

    /// Returns the slope of the line; `None` while it is not known.
    pub(super) fn slope(&self) -> Option<f64> {
        (self.squares >= KNOWN).then(|| self.products / self.squares)
    }
}
