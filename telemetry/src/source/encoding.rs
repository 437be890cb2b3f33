//! Text of any age.

use std::borrow::Cow;

/// The text of a file: UTF-8 with or without its mark, UTF-16 with its mark, else Windows-1252's Latin letters, which any bytes are.
pub(crate) fn text_of(bytes: &[u8]) -> Cow<'_, str> {
    let wide = |of: fn([u8; 2]) -> u16| -> Cow<'_, str> {
        let units = bytes[2..]
            .chunks_exact(2)
            .map(|pair| of([pair[0], pair[1]]));
        char::decode_utf16(units)
            .map(|c| c.unwrap_or(char::REPLACEMENT_CHARACTER))
            .collect::<String>()
            .into()
    };
    if bytes.starts_with(&[0xff, 0xfe]) {
        return wide(u16::from_le_bytes);
    }
    if bytes.starts_with(&[0xfe, 0xff]) {
        return wide(u16::from_be_bytes);
    }
    let plain = bytes.strip_prefix(&[0xef, 0xbb, 0xbf]).unwrap_or(bytes);
    match std::str::from_utf8(plain) {
        Ok(text) => text.into(),
        Err(_) => plain
            .iter()
            .map(|byte| char::from(*byte))
            .collect::<String>()
            .into(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_degree_sign_is_read_in_every_encoding() {
        let wide = |big: bool| -> Vec<u8> {
            "\u{feff}°/s"
                .encode_utf16()
                .flat_map(|u| {
                    if big {
                        u.to_be_bytes()
                    } else {
                        u.to_le_bytes()
                    }
                })
                .collect()
        };
        for bytes in [
            "°/s".as_bytes().to_vec(),
            "\u{feff}°/s".as_bytes().to_vec(),
            vec![0xb0, b'/', b's'],
            wide(true),
            wide(false),
        ] {
            assert_eq!(text_of(&bytes), "°/s", "{bytes:?}");
        }
    }
}
