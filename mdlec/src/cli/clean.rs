//! `mdlec clean`: empties the cache.

use super::progress::ProgressOutput;
use super::{CommandFailure, report};
use crate::link::{self, Cache};

/// Removes the contents of the cache, and prints their size.
pub(super) fn clean() -> Result<(), CommandFailure> {
    let folder = Cache::folder_of_user()?;
    let mut shown = ProgressOutput::default();
    let freed = link::clear(&folder, &mut |progress| shown.progress(&progress));
    shown.close();
    let freed = freed?;
    report::note(format_args!("{}: {:.1} MB freed", folder.display(), freed as f64 / 1e6));
    Ok(())
}
