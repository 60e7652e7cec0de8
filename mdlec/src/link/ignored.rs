//! Finds configuration files of cargo and rustup that builds ignore because they are not in cargo's home.

use std::path::{Path, PathBuf};
use std::{fs, path};

use super::toolchain::cargo_home;

/// Files that cargo and rustup read in the folder of a build and in each folder above it.
const NAMES: [&str; 4] = [".cargo/config.toml", ".cargo/config", "rust-toolchain.toml", "rust-toolchain"];

/// Returns the first configuration file in `folders` or above them that is not in cargo's home, and that builds
/// therefore ignore.
#[must_use]
pub fn ignored_configuration(folders: &[&Path]) -> Option<PathBuf> {
    first(folders, cargo_home().as_deref())
}

fn first(folders: &[&Path], home: Option<&Path>) -> Option<PathBuf> {
    let home = home.and_then(|home| fs::canonicalize(home).ok());
    // Like cargo, resolve symbolic links and `..` before searching the folders above.
    let place = |folder: &&Path| fs::canonicalize(folder).or_else(|_| path::absolute(folder)).ok();
    let folders: Vec<PathBuf> = folders.iter().filter_map(place).collect();
    let files =
        folders.iter().flat_map(|folder| folder.ancestors()).flat_map(|folder| NAMES.map(|name| folder.join(name)));
    let is_in_home =
        |file: &PathBuf| home.is_some() && file.parent().and_then(|folder| fs::canonicalize(folder).ok()) == home;
    files.into_iter().find(|file| file.is_file() && !is_in_home(file))
}

#[cfg(test)]
mod tests {
    use std::fs;

    use super::first;
    use crate::link::tests::folder;

    #[test]
    fn configuration_in_the_home_of_cargo_is_not_ignored() {
        let folder = fs::canonicalize(folder("ignored")).unwrap();
        let (home, plans) = (folder.join(".cargo"), folder.join("plans/new"));
        fs::create_dir_all(&home).unwrap();
        fs::create_dir_all(&plans).unwrap();
        fs::write(home.join("config.toml"), "").unwrap();
        // A folder above the test's folder may contain a configuration file.
        let above = first(&[&folder.join("..")], Some(&home));
        assert_eq!(first(&[&plans], Some(&home)), above);
        assert_eq!(first(&[&plans], None), Some(home.join("config.toml")));
        assert_eq!(first(&[&plans.join("..")], None), Some(home.join("config.toml")));
        let own = folder.join("plans/rust-toolchain.toml");
        fs::write(&own, "").unwrap();
        assert_eq!(first(&[&plans], Some(&home)), Some(own));
    }
}
