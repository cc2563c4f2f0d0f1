//! From the bytes of a file to its text.

use std::borrow::Cow;
use std::path::Path;

use super::SceneError;

/// Text of an OBJ or MTL file. Bytes that are not UTF-8 count as Latin-1,
/// since old exporters wrote names in the code page of their machine; different
/// names stay different.
///
/// # Errors
/// UTF-16, and files that hold control characters and so are no text.
pub(crate) fn lenient_text<'a>(bytes: &'a [u8], path: &Path) -> Result<Cow<'a, str>, SceneError> {
    let bytes = without_mark(bytes, path)?;
    refuse_binary(bytes, path)?;
    if let Ok(text) = std::str::from_utf8(bytes) {
        return Ok(Cow::Borrowed(text));
    }
    let mut text = String::with_capacity(bytes.len());
    for chunk in bytes.utf8_chunks() {
        text.push_str(chunk.valid());
        text.extend(chunk.invalid().iter().copied().map(char::from));
    }
    Ok(Cow::Owned(text))
}

/// Text of a scene file, which TOML wants to be UTF-8.
///
/// # Errors
/// Anything that is not UTF-8.
pub(crate) fn strict_text<'a>(bytes: &'a [u8], path: &Path) -> Result<&'a str, SceneError> {
    let bytes = without_mark(bytes, path)?;
    std::str::from_utf8(bytes).map_err(|error| {
        let line = line_of(bytes, error.valid_up_to());
        not_text(path, line, "is not UTF-8; save the file as UTF-8")
    })
}

/// Drops the byte order mark of UTF-8 and refuses those of UTF-16.
fn without_mark<'a>(bytes: &'a [u8], path: &Path) -> Result<&'a [u8], SceneError> {
    // Without its mark, UTF-16 shows by the upper half of the first letter.
    let is_wide = match bytes {
        [0xff, 0xfe, ..] | [0xfe, 0xff, ..] => true,
        [first, second, ..] => (*first == 0) != (*second == 0),
        _ => false,
    };
    if is_wide {
        return Err(not_text(path, 1, "is UTF-16 text; save the file as UTF-8"));
    }
    Ok(bytes.strip_prefix(&[0xef, 0xbb, 0xbf]).unwrap_or(bytes))
}

/// Control characters other than white space and the end mark of DOS (0x1a)
/// never stand in text.
fn refuse_binary(bytes: &[u8], path: &Path) -> Result<(), SceneError> {
    let is_junk = |b: &u8| *b < 0x20 && !matches!(*b, b'\t'..=b'\r' | 0x1a);
    match bytes.iter().position(is_junk) {
        None => Ok(()),
        Some(offset) => {
            let message = format!(
                "holds the byte {:#04x} and so is no text; give a text file in the OBJ or MTL format",
                bytes[offset]
            );
            Err(not_text(path, line_of(bytes, offset), &message))
        }
    }
}

fn line_of(bytes: &[u8], offset: usize) -> usize {
    1 + bytes[..offset].iter().filter(|&&b| b == b'\n').count()
}

fn not_text(path: &Path, line: usize, message: &str) -> SceneError {
    SceneError::Syntax {
        place: format!("{}:{line}", path.display()),
        message: format!("the file {message}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn marks_are_dropped_or_refused() {
        let path = Path::new("a.obj");
        let plain = lenient_text(b"\xef\xbb\xbfv 1 2 3", path).unwrap();
        assert_eq!(plain, "v 1 2 3");
        let wide = lenient_text(b"\xff\xfev\0 \0", path).unwrap_err();
        assert!(wide.to_string().contains("UTF-16"), "{wide}");
        let unmarked = lenient_text(b"v\0 \0", path).unwrap_err();
        assert!(unmarked.to_string().contains("UTF-16"), "{unmarked}");
        let junk = lenient_text(b"v 1\n\x00\x01", path).unwrap_err();
        assert!(junk.to_string().starts_with("a.obj:2: "), "{junk}");
        let latin = lenient_text(b"# caf\xe9\x1a", path).unwrap();
        assert_eq!(latin, "# café\x1a");
        assert!(strict_text(b"# caf\xe9", path).is_err());
    }
}
