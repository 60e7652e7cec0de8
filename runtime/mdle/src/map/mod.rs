//! `mdle map`: writes the evidence grid of a recorded run as a ROS map (docs/src/navigation.md). `mdle locate`
//! determines in which of several maps a robot was.

mod locate;

use std::path::Path;
use std::process::ExitCode;

use mdle_runtime::Pose;

use crate::arguments::MakeMap;
use crate::evidence::{GridPing, MapFiles, MapMaker, PingOrder, pose};
use crate::failure::Failure;
use crate::log::damaged;
use crate::replay;
pub(crate) use locate::locate;

/// Makes the map of a record.
///
/// # Errors
/// Fails if the record cannot be read, or if the map cannot be written.
pub(crate) fn map(arguments: &MakeMap) -> Result<ExitCode, Failure> {
    let origin = pose("--at", &arguments.at)?;
    let files = MapFiles::new(&arguments.file, arguments.png.as_deref())?;
    let mut maker = MapMaker::new();
    let outcome = pings(&arguments.log, origin, &mut |ping| maker.take(ping))?;
    files.save(&maker.map()).map_err(Failure::Usage)?;
    Ok(outcome)
}

/// Calls `take` with each ping of a record. `origin` is the pose on the map at which the robot's odometry was zero.
/// Returns the exit status.
///
/// # Errors
/// Fails if the record cannot be read.
fn pings(log: &Path, origin: Pose, take: &mut dyn FnMut(&GridPing)) -> Result<ExitCode, Failure> {
    let (_, records) = replay::record(log)?;
    let mut order = PingOrder::new(origin);
    for turn in records.with_messages() {
        match turn {
            Ok((turn, _)) => order.take(&turn.y).iter().for_each(&mut *take),
            Err(error) => return damaged(log, &error),
        }
    }
    Ok(ExitCode::SUCCESS)
}
