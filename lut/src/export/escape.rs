//! Escaping of external text for the languages of the exports.
//!
//! Every external string passes one of these functions: names, versions, hashes and paths.

use std::path::Path;

use crate::error::Error;

/// Whether a character ends a line in any of the languages, or moves the cursor.
fn ends_line(c: char) -> bool {
    c.is_control() || matches!(c, '\u{2028}' | '\u{2029}')
}

/// Text in a comment of C or MATLAB: one line that neither ends nor begins a comment.
///
/// Characters that end a line in any of the languages become spaces, and so do slashes and stars
/// next to one another and backslashes, which would continue a line.
pub(super) fn comment(text: &str) -> String {
    let mut safe = String::with_capacity(text.len());
    for c in text.chars() {
        if ends_line(c) || c == '\\' || c == '?' {
            safe.push(' ');
            continue;
        }
        if c == '/' && safe.ends_with('*') || c == '*' && safe.ends_with('/') {
            safe.push(' ');
        }
        safe.push(c);
    }
    safe
}

/// Text within XML, as content or in double quotes; characters that XML excludes are omitted.
pub(super) fn xml(text: &str) -> String {
    let excluded = |c: &char| c.is_control() || matches!(c, '\u{fffe}' | '\u{ffff}');
    let allowed: String = text.chars().filter(|c| !excluded(c)).collect();
    quick_xml::escape::escape(&allowed).into_owned()
}

/// An identifier of C and MATLAB: letters, digits and underscores, not starting with a digit.
pub(super) fn identifier(name: &str) -> String {
    let plain = |c: char| if c.is_ascii_alphanumeric() { c } else { '_' };
    let mut id: String = name.chars().map(plain).collect();
    if !id.starts_with(|c: char| c.is_ascii_alphabetic()) {
        id.insert_str(0, "lut_");
    }
    id
}

/// A path for a script.
///
/// # Errors
/// [`Error::Invalid`] if it is not Unicode or has characters that end a line or move the cursor.
pub(super) fn script_path(path: &Path) -> Result<&str, Error> {
    let text = path.to_str().filter(|text| !text.contains(ends_line));
    text.ok_or_else(|| {
        Error::Invalid(format!(
            "{}: expected a path of printable characters, which a script can name",
            path.to_string_lossy().escape_debug()
        ))
    })
}

/// A path as one word of a POSIX shell; quoted only if it needs it.
///
/// # Errors
/// As [`script_path`].
pub fn shell_word(path: &Path) -> Result<String, Error> {
    let text = script_path(path)?;
    let is_plain = |c: char| c.is_ascii_alphanumeric() || "/._-".contains(c);
    if !text.is_empty() && text.chars().all(is_plain) {
        return Ok(text.to_owned());
    }
    Ok(format!("'{}'", text.replace('\'', r"'\''")))
}

/// A path as the value of an option in a `#SBATCH` line: quoted, with percent signs doubled, since
/// they begin patterns.
///
/// # Errors
/// As [`script_path`].
pub(super) fn slurm_value(path: &Path) -> Result<String, Error> {
    let mut value = String::from("\"");
    for c in script_path(path)?.chars() {
        match c {
            '"' | '\\' => value.extend(['\\', c]),
            '%' => value += "%%",
            c => value.push(c),
        }
    }
    value.push('"');
    Ok(value)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_text_ends_a_comment_or_its_line() {
        for text in [
            "**// __attribute__((constructor)) void f(void) {} /**//*",
            "*/ int x; /*",
            "a\\\nb",
            "*\u{0}/",
            "??/\n",
            "1\rsystem('x')",
            "1\u{85}system('x')",
            "1\u{2028}system('x')\u{2029}\u{b}\u{c}",
        ] {
            let safe = comment(text);
            assert!(!safe.contains("*/") && !safe.contains("/*"), "{safe:?}");
            assert!(
                !safe.contains(['\\', '?', '\u{2028}', '\u{2029}']),
                "{safe:?}"
            );
            assert!(!safe.contains(char::is_control), "{safe:?}");
        }
        assert_eq!(comment("kufe 0.1.0, 1 / 2 * 3"), "kufe 0.1.0, 1 / 2 * 3");
    }

    #[test]
    fn strings_of_xml_stay_within_their_quotes() {
        assert_eq!(
            xml("<a b=\"c\">&'\n\u{ffff}"),
            "&lt;a b=&quot;c&quot;&gt;&amp;&apos;"
        );
    }

    #[test]
    fn names_become_identifiers() {
        for (name, id) in [
            ("front", "front"),
            ("2-rear", "lut_2_rear"),
            ("", "lut_"),
            ("_a", "lut__a"),
            ("a*/b\n", "a__b_"),
        ] {
            assert_eq!(identifier(name), id);
        }
    }

    #[test]
    fn paths_are_one_word_or_refused() {
        let word = shell_word(Path::new("/a b/$(touch X)'`;")).expect("a word");
        assert_eq!(word, r"'/a b/$(touch X)'\''`;'");
        let value = slurm_value(Path::new("/a b/100%\"\\")).expect("a value");
        assert_eq!(value, r#""/a b/100%%\"\\""#);
        for text in ["p\ntouch X\n#", "p\rX", "p\u{85}X", "p\u{2028}X"] {
            let error = shell_word(Path::new(text)).expect_err("a line's end");
            assert!(
                error.to_string().contains("printable characters"),
                "{error}"
            );
            assert!(!error.to_string().contains(['\n', '\r']), "{error}");
        }
    }
}
