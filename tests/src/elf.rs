//! Reads the sizes of an executable's sections. The tools that print them are not installed on every machine.

/// Returns the names and the sizes in bytes of the sections of a 64-bit ELF file with this machine's byte order.
///
/// # Panics
/// If the file has another format.
#[must_use]
pub fn sections(file: &[u8]) -> Vec<(String, usize)> {
    assert!(file.starts_with(b"\x7fELF\x02"), "a 64-bit ELF file");
    // The file header contains the position, the size and the number of the section headers, and the index of the
    // section with the names.
    let (table, length, count, names) = (word(file, 0x28), half(file, 0x3a), half(file, 0x3c), half(file, 0x3e));
    let headers: Vec<_> = file[table..].chunks_exact(length).take(count).collect();
    let names = &file[word(headers[names], 0x18)..];
    headers.iter().map(|header| (text(&names[int(header, 0)..]), word(header, 0x20))).collect()
}

fn half(bytes: &[u8], at: usize) -> usize {
    usize::from(u16::from_ne_bytes(bytes[at..at + 2].try_into().unwrap()))
}

fn int(bytes: &[u8], at: usize) -> usize {
    u32::from_ne_bytes(bytes[at..at + 4].try_into().unwrap()).try_into().unwrap()
}

fn word(bytes: &[u8], at: usize) -> usize {
    u64::from_ne_bytes(bytes[at..at + 8].try_into().unwrap()).try_into().unwrap()
}

/// Returns the text before the first zero byte.
fn text(bytes: &[u8]) -> String {
    bytes.iter().take_while(|byte| **byte != 0).map(|byte| char::from(*byte)).collect()
}
