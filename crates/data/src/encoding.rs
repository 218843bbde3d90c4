//! The bytes of a text file as UTF-8.

use std::borrow::Cow;

/// A text in UTF-8, and its original encoding if that is to be reported.
type Decoded<'a> = (Cow<'a, [u8]>, Option<&'static str>);

/// The text in UTF-8, without a byte-order mark and with lines that end in `\n`, and how it was
/// encoded. `None` for bytes that are not text.
pub(super) fn decoded(bytes: &[u8]) -> Option<Decoded<'_>> {
    let (mut text, encoding) = in_utf8(bytes)?;
    // Some programs end lines in `\r` alone.
    if text.contains(&b'\r') && !text.contains(&b'\n') {
        text.to_mut()
            .iter_mut()
            .filter(|byte| **byte == b'\r')
            .for_each(|byte| *byte = b'\n');
    }
    Some((text, encoding))
}

fn in_utf8(bytes: &[u8]) -> Option<Decoded<'_>> {
    let utf16 = |bytes: &[u8], unit: fn([u8; 2]) -> u16| {
        let units = bytes.chunks_exact(2).map(|pair| unit([pair[0], pair[1]]));
        let text: String = char::decode_utf16(units)
            .map(|c| c.unwrap_or(char::REPLACEMENT_CHARACTER))
            .collect();
        Some((Cow::Owned(text.into_bytes()), Some("UTF-16")))
    };
    match bytes {
        [0xff, 0xfe, rest @ ..] => return utf16(rest, u16::from_le_bytes),
        [0xfe, 0xff, rest @ ..] => return utf16(rest, u16::from_be_bytes),
        _ => {}
    }
    let bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
    if bytes[..bytes.len().min(512)].contains(&0) {
        return None;
    }
    if std::str::from_utf8(bytes).is_ok() {
        return Some((Cow::Borrowed(bytes), None));
    }
    // One byte for each character, as in Western Europe before UTF-8: the first 256 characters of
    // Unicode are those of Latin-1.
    let text: String = bytes.iter().map(|byte| char::from(*byte)).collect();
    Some((Cow::Owned(text.into_bytes()), Some("Latin-1")))
}
