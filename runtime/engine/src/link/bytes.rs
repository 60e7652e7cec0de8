//! Reads names and numbers from the bytes of a frame, and writes names (docs/src/reference/interfaces.md, 6.5).

/// Maximum length of a name in a frame, in bytes.
pub(super) const NAME: usize = 64;

/// Returns `true` if a name has a valid length for a frame: 1 to [`NAME`] bytes.
pub(super) fn fits(name: &str) -> bool {
    (1..=NAME).contains(&name.len())
}

/// Appends a name, preceded by its length. The length must be valid for a frame (see [`fits`]).
pub(super) fn put_name(to: &mut Vec<u8>, name: &str) {
    let bytes = name.as_bytes();
    let bytes = bytes.get(..bytes.len().min(NAME)).unwrap_or_default();
    to.push(bytes.len() as u8);
    to.extend(bytes);
}

/// Bytes of a frame, read from front to back.
pub(super) struct UnreadBytes<'b>(&'b [u8]);

impl<'b> UnreadBytes<'b> {
    pub(super) fn of(bytes: &'b [u8]) -> Self {
        Self(bytes)
    }

    /// Returns the bytes that have not been read yet.
    pub(super) fn rest(&self) -> &'b [u8] {
        self.0
    }

    /// Returns `true` if all bytes have been read.
    pub(super) fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// Reads all remaining bytes as text; `None` if they are not UTF-8.
    pub(super) fn text(&mut self) -> Option<String> {
        String::from_utf8(std::mem::take(&mut self.0).to_vec()).ok()
    }

    pub(super) fn take<const N: usize>(&mut self) -> Option<[u8; N]> {
        let (first, rest) = self.0.split_first_chunk()?;
        self.0 = rest;
        Some(*first)
    }

    pub(super) fn number(&mut self) -> Option<u64> {
        self.take().map(u64::from_le_bytes)
    }

    pub(super) fn name(&mut self) -> Option<String> {
        let [length] = self.take()?;
        let (name, rest) = self.0.split_at_checked(usize::from(length))?;
        self.0 = rest;
        String::from_utf8(name.to_vec()).ok().filter(|name| fits(name))
    }
}
