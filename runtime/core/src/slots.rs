//! Storage for one value for each level of scopes or loops.

/// Storage for one value for each level: an array in generated code, a boxed slice for a plan loaded at run
/// time.
pub trait Slots<T>: AsRef<[T]> + AsMut<[T]> {}

impl<T, S: AsRef<[T]> + AsMut<[T]>> Slots<T> for S {}
