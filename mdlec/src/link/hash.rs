//! Hashes of texts and files.

/// Returns the hash of some bytes as text.
pub(super) fn hash(bytes: &[u8]) -> String {
    blake3::hash(bytes).to_hex().to_string()
}
