//! `mdle locate`: finds the landmark at which a robot turned on the spot, and its pose there (docs/src/navigation.md).

use std::process::ExitCode;

use mdle_runtime::Printable;

use super::pings;
use crate::arguments::Locate;
use crate::evidence::{Fit, SavedMap, fit, pose};
use crate::failure::{self, Failure};

/// Maximum distance of the search from the expected pose along each axis, in steps of 10 cm.
const WAYS: i16 = 4;

/// Exit status if the robot is not at any of the landmarks.
const NOWHERE: u8 = 1;

/// Prints how well a record fits each map. The landmarks at which the robot may be come first, beginning with the best
/// fit.
///
/// # Errors
/// Fails if the record or a map cannot be read, or if the record has no echo.
pub(crate) fn locate(arguments: &Locate) -> Result<ExitCode, Failure> {
    let near = pose("--at", &arguments.at)?;
    let mut heard = Vec::new();
    let outcome = pings(&arguments.log, mdle_runtime::Pose::ORIGIN, &mut |ping| heard.push(*ping))?;
    let mut fits = Vec::new();
    for map in &arguments.maps {
        let name = map.file_stem().unwrap_or_default().display().to_string();
        let map = SavedMap::read(map)?;
        let fit = fit(&map.grid, &heard, near, WAYS);
        let fit = fit.ok_or_else(|| Failure::Usage("the record has no echo of a sonar".to_owned()))?;
        fits.push((name, map.objection(&fit), fit));
    }
    fits.sort_by(|(_, not_one, one), (_, not_other, other)| {
        not_one.is_some().cmp(&not_other.is_some()).then(other.score.total_cmp(&one.score))
    });
    for (name, objection, Fit { origin, score, .. }) in &fits {
        let (x, y, heading) = (origin.x.0, origin.y.0, origin.theta.wrapped().degrees());
        // Adding zero removes the sign of a negative zero.
        let [x, y] = [x, y].map(|metres| libm::round(metres * 100.0) / 100.0 + 0.0);
        let (heading, score) = (libm::round(heading * 10.0) / 10.0 + 0.0, libm::round(score * 100.0) / 100.0 + 0.0);
        let not = objection.as_ref().map_or_else(String::new, |why| format!("; not there: {why}"));
        let line = format!("{}: score {score:.2}, began at {x:.2},{y:.2},{heading:.1}{not}", Printable(name));
        failure::print_line(&line)?;
    }
    let is_nowhere = fits.iter().all(|(_, objection, _)| objection.is_some());
    Ok(if is_nowhere { ExitCode::from(NOWHERE) } else { outcome })
}
