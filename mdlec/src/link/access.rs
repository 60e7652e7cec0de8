//! Sets and checks the access rights of the cache. Only the user of the cache has access, because mdlec runs the files
//! in the cache and builds them into executables.

use std::fs::{self, DirBuilder, Metadata, Permissions};
use std::os::unix::fs::{DirBuilderExt, MetadataExt, PermissionsExt};
use std::path::{self, Path, PathBuf};

use rustix::process::geteuid;

use super::LinkError;

/// Mode of the cache: its user has all permissions, other users have none.
const OWN: u32 = 0o700;

/// Permission bit of folders, such as shared temporary folders, in which users cannot remove or rename the files of
/// other users.
const STICKY: u32 = 0o1000;

/// A folder that only its user can access.
#[derive(Debug)]
pub(super) struct Private {
    /// Path of the folder, without symbolic links.
    pub(super) folder: PathBuf,
    /// `true` if other users could write to the folder before this program removed their permissions.
    pub(super) was_open: bool,
}

/// Creates `folder`, or removes the permissions of other users if it exists.
///
/// # Errors
/// Fails if the folder, or a folder above it, belongs to another user who is not the superuser. Also fails if others
/// can write to a folder above it.
pub(super) fn private(folder: &Path) -> Result<Private, LinkError> {
    let failed = |error| LinkError::cache(folder, error);
    DirBuilder::new().recursive(true).mode(OWN).create(folder).map_err(failed)?;
    let place = folder.canonicalize().map_err(failed)?;
    // The owner of a symbolic link in the path can redirect it, so the folders of the unresolved path are checked as
    // well.
    let as_named = path::absolute(folder).map_err(failed)?;
    for above in as_named.ancestors().skip(1).chain(place.ancestors().skip(1)) {
        judge(above, &fs::symlink_metadata(above).map_err(failed)?)?;
    }
    let found = fs::metadata(&place).map_err(failed)?;
    if found.uid() != geteuid().as_raw() {
        return Err(LinkError::CacheOfOther { path: place, owner: found.uid() });
    }
    if found.mode() & 0o077 != 0 {
        fs::set_permissions(&place, Permissions::from_mode(OWN)).map_err(failed)?;
        // Some file systems have no permissions, and ignore the change without an error.
        if fs::metadata(&place).map_err(failed)?.mode() & 0o077 != 0 {
            return Err(LinkError::CacheOpen(place));
        }
    }
    Ok(Private { folder: place, was_open: others_write(&found) })
}

/// Fails if another user could replace the cache by changing `path`, a folder above it or a symbolic link on the way to
/// it.
fn judge(path: &Path, found: &Metadata) -> Result<(), LinkError> {
    if !is_trusted(found.uid()) {
        return Err(LinkError::CacheOfOther { path: path.to_owned(), owner: found.uid() });
    }
    if found.is_dir() && others_write(found) && found.mode() & STICKY == 0 {
        return Err(LinkError::CacheOpen(path.to_owned()));
    }
    Ok(())
}

/// Returns `true` for this process's user, the superuser, and the owner of the root folder. In a container with its own
/// users, the owner of the root folder is the superuser of the system outside.
fn is_trusted(user: u32) -> bool {
    let owns_all = || fs::metadata("/").is_ok_and(|root| root.uid() == user);
    user == geteuid().as_raw() || user == 0 || owns_all()
}

/// Returns `true` if anyone except the owner and the superuser can write to the file or folder.
fn others_write(found: &Metadata) -> bool {
    let mode = found.mode();
    mode & 0o002 != 0 || mode & 0o020 != 0 && !is_private(found.gid(), found.uid())
}

/// Returns `true` if only `owner` and the superuser are in this group, as on systems where each user has a
/// private group.
fn is_private(group: u32, owner: u32) -> bool {
    let users = fs::read_to_string("/etc/passwd");
    let groups = fs::read_to_string("/etc/group");
    group == 0 || matches!((users, groups), (Ok(users), Ok(groups)) if has_only(group, owner, &users, &groups))
}

/// Returns `true` if `owner` is the only member of `group`, according to the texts of `/etc/passwd` and
/// `/etc/group`. A group that is not listed there may have any members.
fn has_only(group: u32, owner: u32, users: &str, groups: &str) -> bool {
    let fields = |line: &str| line.split(':').map(str::to_owned).collect::<Vec<_>>();
    let users: Vec<_> = users.lines().map(fields).filter(|user| user.len() > 3).collect();
    let is = |field: &String, number: u32| field.parse() == Ok(number);
    let name = users.iter().find(|user| is(&user[2], owner)).map(|user| user[0].as_str());
    let Some(entry) = groups.lines().map(fields).find(|entry| entry.len() > 3 && is(&entry[2], group)) else {
        return false;
    };
    let members = entry[3].split(',').filter(|member| !member.is_empty());
    let others = users.iter().filter(|user| is(&user[3], group) && !is(&user[2], owner));
    members.into_iter().all(|member| Some(member) == name) && others.count() == 0
}

#[cfg(test)]
mod tests {
    use std::fs::{self, Permissions};
    use std::os::unix::fs::{MetadataExt, PermissionsExt, chown};
    use std::path::Path;

    use super::super::LinkError;
    use super::super::tests::folder;
    use super::{has_only, private};

    fn mode(path: &Path) -> u32 {
        fs::metadata(path).unwrap().mode() & 0o7777
    }

    fn set_mode(path: &Path, mode: u32) {
        fs::set_permissions(path, Permissions::from_mode(mode)).unwrap();
    }

    #[test]
    fn a_folder_is_made_for_its_user_alone() {
        let folder = folder("private").join("one/two");
        assert!(!private(&folder).unwrap().was_open);
        assert_eq!((mode(&folder), mode(folder.parent().unwrap())), (0o700, 0o700));
    }

    #[test]
    fn an_open_folder_of_ones_own_is_closed() {
        let folder = folder("closed");
        for (open, was_open) in [(0o755, false), (0o777, true), (0o1777, true), (0o700, false)] {
            set_mode(&folder, open);
            assert_eq!(private(&folder).unwrap().was_open, was_open, "{open:o}");
            assert_eq!(mode(&folder), 0o700);
        }
    }

    #[test]
    fn a_folder_above_that_others_can_write_to_is_refused() {
        let above = folder("above");
        let cache = above.join("cache");
        for (open, is_good) in [(0o777, false), (0o1777, true), (0o703, false), (0o755, true), (0o700, true)] {
            set_mode(&above, open);
            match private(&cache) {
                Err(LinkError::CacheOpen(path)) => assert!(!is_good && path == above, "{open:o}"),
                other => assert!(is_good && other.is_ok(), "{open:o}: {other:?}"),
            }
        }
    }

    #[test]
    fn a_folder_of_another_user_is_refused() {
        let above = folder("of_another");
        let cache = above.join("cache");
        private(&cache).unwrap();
        // Only the superuser can change the owner of a folder; the test ends here for other users.
        if chown(&cache, Some(12345), None).is_err() {
            return;
        }
        let is_refused = |expected: &Path| matches!(private(&cache), Err(LinkError::CacheOfOther { path, owner: 12345 }) if path == expected);
        assert!(is_refused(&cache));
        chown(&cache, Some(0), None).unwrap();
        chown(&above, Some(12345), None).unwrap();
        assert!(is_refused(&above));
        chown(&above, Some(0), None).unwrap();
        private(&cache).unwrap();
    }

    #[test]
    fn a_group_of_one_is_no_company() {
        let users = "root:x:0:0::/:\nann:x:1000:1000::/:\nbob:x:1001:100::/:\neve:x:1002:1002::/:\n";
        let groups = "root:x:0:\nusers:x:100:\nann:x:1000:ann\neve:x:1002:bob\n";
        let ann = |group| has_only(group, 1000, users, groups);
        assert!(ann(1000) && !ann(100) && !ann(1002) && !ann(4711));
        assert!(has_only(100, 1001, users, groups) && !has_only(1002, 1002, users, groups));
    }
}
