//! The page itself.

use serde_json::Value;

/// What a page shows; each kind has its script.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// One solved contact.
    Press,
    /// A lookup table.
    Table,
    /// A series of contacts.
    Series,
    /// An evaluation of drivers.
    Evaluation,
    /// One contact with a form that solves again.
    View,
}

/// What the page may do: run what is in it, and speak to the server that it came from, if any.
pub const POLICY: &str = "default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'; \
    img-src data: blob:; connect-src 'self'; base-uri 'none'; form-action 'none'";

const TEMPLATE: &str = include_str!("../../assets/page.html");
const STYLE: &str = include_str!("../../assets/page.css");
const PLAIN: &str = include_str!("../../assets/plain.css");
const PICTURE: &str = include_str!("../../assets/picture.css");
const THREE: &str = include_str!("../../assets/three/three.min.js");
const BASE: &str = include_str!("../../assets/base.js");
const CHART: &str = include_str!("../../assets/chart.js");
const HEAT_MAP: &str = include_str!("../../assets/heat_map.js");
const SCENE: &str = include_str!("../../assets/scene.js");
const CONTACT: &str = include_str!("../../assets/contact.js");
const PRESS: &str = include_str!("../../assets/press.js");
const TABLE: &str = include_str!("../../assets/table.js");
const SERIES: &str = include_str!("../../assets/series.js");
const EVALUATION: &str = include_str!("../../assets/evaluation.js");
const VIEW: &str = include_str!("../../assets/view.js");

impl Kind {
    /// The scripts in the order in which they need each other.
    fn scripts(self) -> &'static [&'static str] {
        match self {
            Kind::Press => &[THREE, BASE, CHART, HEAT_MAP, SCENE, CONTACT, PRESS],
            Kind::View => &[THREE, BASE, CHART, HEAT_MAP, SCENE, CONTACT, VIEW],
            Kind::Table => &[THREE, BASE, CHART, HEAT_MAP, SCENE, TABLE],
            Kind::Series => &[BASE, CHART, SERIES],
            Kind::Evaluation => &[BASE, CHART, EVALUATION],
        }
    }
}

/// What made a page, as its head says.
const VERSION: &str = concat!("kufe ", env!("CARGO_PKG_VERSION"));

/// The whole page: one HTML file with its data, style and scripts.
///
/// The data of each kind are documented at the head of its script in `assets`.
pub fn page(kind: Kind, title: &str, data: &Value) -> String {
    let scripts = kind.scripts().concat();
    let style = [STYLE, PICTURE].concat();
    // The data come last: a text in them that looks like a slot is not filled.
    let slots = [
        ("{{policy}}", POLICY),
        ("{{title}}", &escape(title)),
        ("{{version}}", VERSION),
        ("{{style}}", &style),
        ("{{scripts}}", &scripts),
        ("{{data}}", &embedded(data)),
    ];
    let mut html = String::new();
    let mut rest = TEMPLATE;
    while let Some(at) = rest.find("{{") {
        html.push_str(&rest[..at]);
        rest = &rest[at..];
        let Some((slot, text)) = slots.iter().find(|(slot, _)| rest.starts_with(slot)) else {
            unreachable!("page.html has a slot that nothing fills");
        };
        html.push_str(text);
        rest = &rest[slot.len()..];
    }
    html + rest
}

/// A page of text, tables and pictures without scripts; `body` is HTML.
pub fn plain_page(title: &str, body: &str) -> String {
    format!(
        "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><meta name=\"viewport\" content=\"width=device-width,initial-scale=1\">\
<meta name=\"generator\" content=\"{VERSION}\"><title>{}</title><style>{PLAIN}{PICTURE}</style></head><body>\n{body}</body></html>\n",
        escape(title)
    )
}

/// Text as text in HTML.
pub fn escape(text: &str) -> String {
    text.replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('>', "&gt;")
        .replace('"', "&quot;")
}

/// JSON that cannot end the script element that it stands in.
fn embedded(data: &Value) -> String {
    data.to_string().replace('<', "\\u003c")
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn data_cannot_end_their_script_or_fill_a_slot() {
        let data = json!({ "name": "</script><b>{{title}}" });
        let html = page(Kind::Press, "a & b", &data);
        assert!(html.contains("<title>a &amp; b</title>"));
        assert!(html.contains("\\u003c/script>\\u003cb>{{title}}"));
    }

    #[test]
    fn every_kind_is_a_page_without_an_address_that_it_would_load() {
        for kind in [
            Kind::Press,
            Kind::Table,
            Kind::Series,
            Kind::Evaluation,
            Kind::View,
        ] {
            let html = page(kind, "x", &json!({}));
            for word in ["src=\"http", "href=\"http", "@import", "import("] {
                assert!(!html.contains(word), "{kind:?} has {word}");
            }
            assert!(html.contains(POLICY) && html.ends_with("</html>\n"));
            assert!(html.len() < 700_000, "{kind:?}: {} bytes", html.len());
        }
    }

    #[test]
    fn no_script_ends_its_element_early() {
        for text in [
            THREE, BASE, CHART, HEAT_MAP, SCENE, CONTACT, PRESS, TABLE, EVALUATION, VIEW,
        ] {
            assert!(!text.to_ascii_lowercase().contains("</script"));
        }
    }
}
