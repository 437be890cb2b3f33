//! What a file names, read from its text.

use std::collections::BTreeSet;

/// The text without comments, literals and blocks under `#[cfg(test)]`.
pub fn code_of(text: &str) -> String {
    let mut code = String::with_capacity(text.len());
    let bytes: Vec<char> = text.chars().collect();
    let mut i = 0;
    while i < bytes.len() {
        let rest = &bytes[i..];
        if rest.starts_with(&['/', '/']) {
            i += rest.iter().position(|&c| c == '\n').unwrap_or(rest.len());
        } else if rest.starts_with(&['/', '*']) {
            let end = rest.windows(2).position(|w| w == ['*', '/']);
            i += end.map_or(rest.len(), |e| e + 2);
        } else if rest[0] == 'r'
            && rest.len() > 2
            && (rest[1] == '"' || rest[1..].starts_with(&['#', '"']))
        {
            let hashes = usize::from(rest[1] == '#');
            let close: Vec<char> = if hashes == 1 {
                vec!['"', '#']
            } else {
                vec!['"']
            };
            let from = 2 + hashes;
            let end = rest[from..].windows(close.len()).position(|w| w == close);
            i += end.map_or(rest.len(), |e| from + e + close.len());
            code.push_str("\"\"");
        } else if rest[0] == '"' {
            let mut j = 1;
            while j < rest.len() && rest[j] != '"' {
                j += if rest[j] == '\\' { 2 } else { 1 };
            }
            i += j + 1;
            code.push_str("\"\"");
        } else if rest[0] == '\'' && rest.len() > 3 && (rest[2] == '\'' || rest[1] == '\\') {
            let end = rest[2..].iter().position(|&c| c == '\'').unwrap_or(0);
            i += end + 3;
            code.push(' ');
        } else {
            code.push(rest[0]);
            i += 1;
        }
    }
    without_tests(&code)
}

fn without_tests(code: &str) -> String {
    const MARK: &str = "#[cfg(test)]";
    let mut kept = String::with_capacity(code.len());
    let mut rest = code;
    while let Some(start) = rest.find(MARK) {
        kept.push_str(&rest[..start]);
        let after = &rest[start + MARK.len()..];
        let brace = after.find('{').unwrap_or(after.len());
        let semicolon = after.find(';').unwrap_or(after.len());
        if semicolon < brace {
            rest = &after[semicolon + 1..];
            continue;
        }
        let mut depth = 0usize;
        let mut end = after.len();
        for (at, c) in after.char_indices().skip(brace) {
            match c {
                '{' => depth += 1,
                '}' if depth == 1 => {
                    end = at + 1;
                    break;
                }
                '}' => depth -= 1,
                _ => {}
            }
        }
        rest = &after[end..];
    }
    kept.push_str(rest);
    kept
}

/// The paths that a `use` tree names, each with the name by which it is known here; `*` for a glob.
pub fn leaves(prefix: &str, tree: &str, found: &mut Vec<(String, String)>) {
    let tree = tree.trim();
    if let Some(open) = tree.find('{') {
        let prefix = format!("{prefix}{}", tree[..open].trim());
        let inner = tree[open + 1..].trim_end().trim_end_matches('}');
        let mut depth = 0;
        let mut start = 0;
        for (at, c) in inner.char_indices().chain([(inner.len(), ',')]) {
            match c {
                '{' => depth += 1,
                '}' => depth -= 1,
                ',' if depth == 0 => {
                    if !inner[start..at].trim().is_empty() {
                        leaves(&prefix, &with_its_braces(&inner[start..at]), found);
                    }
                    start = at + 1;
                }
                _ => {}
            }
        }
        return;
    }
    let (path, known) = match tree.split_once(" as ") {
        Some((path, alias)) => (path.trim(), alias.trim().to_string()),
        None => (
            tree,
            tree.rsplit("::").next().unwrap_or(tree).trim().to_string(),
        ),
    };
    let whole = format!("{prefix}{path}");
    match whole.strip_suffix("::self") {
        Some(module) => {
            let name = module.rsplit("::").next().unwrap_or(module).to_string();
            found.push((module.to_string(), name));
        }
        None => found.push((whole, known)),
    }
}

fn with_its_braces(tree: &str) -> String {
    let open = tree.matches('{').count();
    let close = tree.matches('}').count();
    format!("{}{}", tree, "}".repeat(open.saturating_sub(close)))
}

/// Every `use` declaration: whether it passes names on, and its paths.
pub fn uses(code: &str) -> Vec<(bool, String, String)> {
    let mut found = Vec::new();
    let mut rest = code;
    while let Some(at) = rest.find("use ") {
        let before = rest[..at].trim_end();
        let starts = rest[..at]
            .chars()
            .next_back()
            .is_none_or(|c| !c.is_alphanumeric() && c != '_');
        let body = &rest[at + 4..];
        let Some(end) = body.find(';') else { break };
        if starts {
            let line = before.rsplit(['\n', ';', '}']).next().unwrap_or("");
            let passes =
                before.ends_with("pub") || (before.ends_with(')') && line.contains("pub("));
            let mut paths = Vec::new();
            leaves(
                "",
                &body[..end].split_whitespace().collect::<Vec<_>>().join(" "),
                &mut paths,
            );
            found.extend(
                paths
                    .into_iter()
                    .map(|(path, name)| (passes, path.replace(' ', ""), name)),
            );
        }
        rest = &body[end..];
    }
    found
}

/// `crate::a::b` of a path that begins with `crate`, `self`, `super`, or a child's name.
pub fn absolute(
    path: &str,
    module: &str,
    is_first_page: bool,
    children: &BTreeSet<String>,
) -> Option<String> {
    let mut parts: Vec<&str> = path.split("::").collect();
    // `self` of any file is the file's own module; its children stand below it if it is a first page.
    let mut at: Vec<&str> = module.split("::").collect();
    match parts.first().copied()? {
        "crate" => return Some(path.to_string()),
        "self" => {
            parts.remove(0);
        }
        "super" => {
            while parts.first() == Some(&"super") {
                parts.remove(0);
                at.pop();
            }
        }
        name if is_first_page && children.contains(&format!("{module}::{name}")) => {}
        _ => return None,
    }
    at.extend(parts);
    (!at.is_empty()).then(|| at.join("::"))
}

/// Paths that begin with `crate::` or `super::` outside of `use`.
pub fn paths_in(code: &str) -> Vec<String> {
    let mut found = Vec::new();
    let mut statements = String::new();
    // Without `use` declarations, which are read on their own.
    let mut rest = code;
    while let Some(at) = rest.find("use ") {
        let starts = rest[..at]
            .chars()
            .next_back()
            .is_none_or(|c| c.is_whitespace());
        let end = rest[at..].find(';').map_or(rest.len(), |e| at + e);
        statements.push_str(&rest[..if starts { at } else { end }]);
        rest = &rest[end..];
    }
    statements.push_str(rest);
    for word in ["crate::", "super::"] {
        for (at, _) in statements.match_indices(word) {
            let before = statements[..at].chars().next_back();
            if before.is_some_and(|c| {
                c.is_alphanumeric() || c == '_' || c == ':' || c == '$' || c == '('
            }) && !statements[..at].ends_with('(')
            {
                continue;
            }
            let path: String = statements[at..]
                .chars()
                .take_while(|c| c.is_alphanumeric() || *c == '_' || *c == ':')
                .collect();
            let path = path.trim_end_matches(':').to_string();
            if path.contains("::") {
                found.push(path);
            }
        }
    }
    found
}
