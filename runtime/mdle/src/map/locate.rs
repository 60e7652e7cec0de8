//! `mdle locate`: names the landmark at which a robot turned, and its pose there (docs/src/navigation.md).

use std::process::ExitCode;

use mdle_runtime::Printable;

use super::{pings, pose};
use crate::arguments::Locate;
use crate::evidence::{Fit, fit, read_map};
use crate::failure::{self, Failure};

/// Steps of 10 cm to either side in which the pose is searched.
const WAYS: i16 = 4;

/// Prints how well a record fits each map, the best first.
///
/// # Errors
/// Fails if the record or a map cannot be read, or if the record has no echo.
pub(crate) fn locate(arguments: &Locate) -> Result<ExitCode, Failure> {
    let near = pose(&arguments.at)?;
    let mut heard = Vec::new();
    let outcome = pings(&arguments.log, mdle_runtime::Pose::ORIGIN, &mut |ping| heard.push(*ping))?;
    let mut fits = Vec::new();
    for map in &arguments.maps {
        let name = map.file_stem().unwrap_or_default().display().to_string();
        let fit = fit(&read_map(map)?, &heard, near, WAYS);
        fits.push((name, fit.ok_or_else(|| Failure::Usage("the record has no echo of a sonar".to_owned()))?));
    }
    fits.sort_by(|(_, one), (_, other)| other.score.total_cmp(&one.score));
    for (name, Fit { origin, score }) in &fits {
        let (x, y, heading) = (origin.x.0, origin.y.0, origin.theta.wrapped().degrees());
        // Minus zero is zero.
        let [x, y] = [x, y].map(|metres| libm::round(metres * 100.0) / 100.0 + 0.0);
        let (heading, score) = (libm::round(heading * 10.0) / 10.0 + 0.0, libm::round(score * 100.0) / 100.0 + 0.0);
        failure::print_line(&format!("{}: score {score:.2}, began at {x:.2},{y:.2},{heading:.1}", Printable(name)))?;
    }
    Ok(outcome)
}
