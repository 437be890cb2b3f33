//! Pages with scripts: template, style, scripts and data in one HTML file.

use std::sync::OnceLock;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use serde::Serialize;

use crate::plot::escape;

/// Kind of a page; each kind has its script.
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
    /// Recorded runs over time and distance.
    Runs,
    /// One contact with a form that solves again.
    View,
}

const TEMPLATE: &str = include_str!("../../assets/page.html");
const STYLE: &str = include_str!("../../assets/page.css");
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
const RUNS: &str = include_str!("../../assets/runs.js");
const VIEW: &str = include_str!("../../assets/view.js");

impl Kind {
    /// The scripts in the order of their dependencies.
    fn scripts(self) -> &'static [&'static str] {
        match self {
            Kind::Press => &[THREE, BASE, CHART, HEAT_MAP, SCENE, CONTACT, PRESS],
            Kind::View => &[THREE, BASE, CHART, HEAT_MAP, SCENE, CONTACT, VIEW],
            Kind::Table => &[THREE, BASE, CHART, HEAT_MAP, SCENE, TABLE],
            Kind::Series => &[BASE, CHART, SERIES],
            Kind::Evaluation => &[BASE, CHART, EVALUATION],
            Kind::Runs => &[BASE, RUNS],
        }
    }

    /// The text of the page's only script element.
    fn script(self) -> String {
        format!("\n{}", self.scripts().concat())
    }

    /// The content security policy of the page.
    ///
    /// It allows only the page's script, by its digest: no inline event handler and no script
    /// within the data. The page may send requests to its own server.
    pub fn policy(self) -> String {
        static DIGESTS: [OnceLock<String>; 6] = [const { OnceLock::new() }; 6];
        let digest = DIGESTS[self as usize].get_or_init(|| {
            let digits = kufe_files::sha256(self.script().as_bytes());
            let byte = |k: usize| u8::from_str_radix(&digits[2 * k..2 * k + 2], 16);
            let bytes: Vec<u8> = (0..32).filter_map(|k| byte(k).ok()).collect();
            STANDARD.encode(bytes)
        });
        format!(
            "default-src 'none'; script-src 'sha256-{digest}'; style-src 'unsafe-inline'; \
             img-src data: blob:; connect-src 'self'; base-uri 'none'; form-action 'none'"
        )
    }
}

/// The generator that a page's head states.
const VERSION: &str = concat!("kufe ", env!("CARGO_PKG_VERSION"));

/// The whole page: one HTML file with its data, style and scripts.
///
/// The data of each kind are documented at the head of its script in `assets`.
///
/// # Panics
/// Where the data cannot be written as JSON.
pub fn page(kind: Kind, title: &str, data: &impl Serialize) -> String {
    let (script, policy) = (kind.script(), kind.policy());
    let style = [STYLE, PICTURE].concat();
    // The data are the last slot: a text in them that has the form of a slot is not replaced.
    let slots = [
        ("{{policy}}", policy.as_str()),
        ("{{title}}", &escape(title)),
        ("{{version}}", VERSION),
        ("{{style}}", &style),
        ("{{script}}", &script),
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

/// JSON for a script element, escaped so that no text ends the element or begins another.
fn embedded(data: &impl Serialize) -> String {
    let text = serde_json::to_string(data).expect("data of a page are plain structs");
    text.replace('<', "\\u003c").replace('>', "\\u003e")
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
        assert!(html.contains("\\u003c/script\\u003e\\u003cb\\u003e{{title}}"));
    }

    #[test]
    fn every_kind_is_a_page_without_an_address_that_it_would_load() {
        for kind in [
            Kind::Press,
            Kind::Table,
            Kind::Series,
            Kind::Evaluation,
            Kind::Runs,
            Kind::View,
        ] {
            let html = page(kind, "x", &json!({}));
            for word in ["src=\"http", "href=\"http", "@import", "import("] {
                assert!(!html.contains(word), "{kind:?} has {word}");
            }
            assert!(html.contains(&kind.policy()) && html.ends_with("</html>\n"));
            assert_eq!(html.matches("<script>").count(), 1, "{kind:?}");
            assert!(
                !kind.policy().contains("script-src 'unsafe-inline'"),
                "{kind:?}"
            );
            assert!(html.len() < 700_000, "{kind:?}: {} bytes", html.len());
        }
    }

    #[test]
    fn no_script_ends_its_element_early() {
        for text in [
            THREE, BASE, CHART, HEAT_MAP, SCENE, CONTACT, PRESS, TABLE, EVALUATION, RUNS, VIEW,
        ] {
            assert!(!text.to_ascii_lowercase().contains("</script"));
        }
    }
}
