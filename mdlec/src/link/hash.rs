//! Hashes of texts and files.

/// Returns the BLAKE3 hash of `bytes` in hexadecimal.
pub(super) fn hash(bytes: &[u8]) -> String {
    blake3::hash(bytes).to_hex().to_string()
}
