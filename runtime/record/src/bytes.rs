//! Writes numbers and texts as little-endian bytes, and reads them.

use mdle_runtime::{Meters, Nanos, Pose, Radians};

pub(crate) fn put_u32(to: &mut Vec<u8>, number: u32) {
    to.extend_from_slice(&number.to_le_bytes());
}

pub(crate) fn put_u64(to: &mut Vec<u8>, number: u64) {
    to.extend_from_slice(&number.to_le_bytes());
}

/// Writes all bits of a single-precision number.
pub(crate) fn put_f32(to: &mut Vec<u8>, number: f32) {
    put_u32(to, number.to_bits());
}

/// Writes all bits of a number, including a NaN.
pub(crate) fn put_f64(to: &mut Vec<u8>, number: f64) {
    put_u64(to, number.to_bits());
}

pub(crate) fn put_pose(to: &mut Vec<u8>, pose: &Pose) {
    for number in [pose.x.0, pose.y.0, pose.theta.0] {
        put_f64(to, number);
    }
}

/// Writes a text that is shorter than 4 GiB; a longer text is written as an empty text.
pub(crate) fn put_text(to: &mut Vec<u8>, text: &str) {
    let (length, text) = u32::try_from(text.len()).map_or((0, ""), |length| (length, text));
    put_u32(to, length);
    to.extend_from_slice(text.as_bytes());
}

/// Bytes to read. Each function reads a value from the start of the remaining bytes, or returns `None` if there are too
/// few bytes.
#[derive(Debug, Clone, Copy)]
pub(crate) struct ByteReader<'b>(pub(crate) &'b [u8]);

impl<'b> ByteReader<'b> {
    pub(crate) fn take(&mut self, count: usize) -> Option<&'b [u8]> {
        let (taken, rest) = self.0.split_at_checked(count)?;
        self.0 = rest;
        Some(taken)
    }

    pub(crate) fn u8(&mut self) -> Option<u8> {
        self.take(1)?.first().copied()
    }

    pub(crate) fn u32(&mut self) -> Option<u32> {
        Some(u32::from_le_bytes(self.take(4)?.try_into().ok()?))
    }

    pub(crate) fn u64(&mut self) -> Option<u64> {
        Some(u64::from_le_bytes(self.take(8)?.try_into().ok()?))
    }

    pub(crate) fn f32(&mut self) -> Option<f32> {
        self.u32().map(f32::from_bits)
    }

    pub(crate) fn f64(&mut self) -> Option<f64> {
        self.u64().map(f64::from_bits)
    }

    pub(crate) fn nanos(&mut self) -> Option<Nanos> {
        self.u64().map(Nanos)
    }

    pub(crate) fn pose(&mut self) -> Option<Pose> {
        Some(Pose { x: Meters(self.f64()?), y: Meters(self.f64()?), theta: Radians(self.f64()?) })
    }

    pub(crate) fn text(&mut self) -> Option<String> {
        let length = self.u32()? as usize;
        String::from_utf8(self.take(length)?.to_vec()).ok()
    }

    /// Reads a list: the number of items, and then each item.
    pub(crate) fn list<T>(&mut self, mut item: impl FnMut(&mut Self) -> Option<T>) -> Option<Vec<T>> {
        (0..self.u32()?).map(|_| item(self)).collect()
    }
}
