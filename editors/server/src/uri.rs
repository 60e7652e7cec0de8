//! URIs of documents: `file://` with a percent-encoded path.

use std::ffi::OsString;
use std::os::unix::ffi::{OsStrExt, OsStringExt};
use std::path::{Path, PathBuf};

/// Returns the path in a URI. For a document without a file, such as `untitled:1`, the path is the URI itself.
pub(crate) fn path(uri: &str) -> PathBuf {
    match uri.strip_prefix("file://") {
        Some(rest) => {
            // The URI may name a host between the slashes.
            let path = rest.find('/').and_then(|slash| rest.get(slash..)).unwrap_or(rest);
            OsString::from_vec(decoded(path.as_bytes())).into()
        }
        None => uri.into(),
    }
}

/// Returns the URI of a path, after making the path absolute.
pub(crate) fn of(path: &Path) -> String {
    let path = std::path::absolute(path).unwrap_or_else(|_| path.to_owned());
    let is_plain = |byte: u8| byte.is_ascii_alphanumeric() || b"/-._~".contains(&byte);
    let encoded = path.as_os_str().as_bytes().iter().map(|byte| match is_plain(*byte) {
        true => char::from(*byte).to_string(),
        false => format!("%{byte:02X}"),
    });
    format!("file://{}", encoded.collect::<String>())
}

fn decoded(text: &[u8]) -> Vec<u8> {
    let digit =
        |at: usize| text.get(at).and_then(|byte| char::from(*byte).to_digit(16)).and_then(|d| u8::try_from(d).ok());
    let mut bytes = Vec::with_capacity(text.len());
    let mut at = 0;
    while let Some(byte) = text.get(at) {
        match (*byte, digit(at + 1), digit(at + 2)) {
            (b'%', Some(high), Some(low)) => {
                bytes.push(high * 16 + low);
                at += 3;
            }
            _ => {
                bytes.push(*byte);
                at += 1;
            }
        }
    }
    bytes
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_path_survives_as_a_uri() {
        for name in ["/tmp/a b.mdle", "/größe/100%/x#y?.mdle", "/a%20b", "/∞"] {
            assert_eq!(path(&of(Path::new(name))), Path::new(name));
        }
        assert_eq!(of(Path::new("/a b/ü")), "file:///a%20b/%C3%BC");
        assert_eq!(path("file://localhost/x%2"), Path::new("/x%2"));
        assert_eq!(path("untitled:Untitled-1"), Path::new("untitled:Untitled-1"));
    }
}
