//! Links from a page into the page of recorded runs.

use std::path::Path;

use percent_encoding::{AsciiSet, NON_ALPHANUMERIC, percent_encode};

use crate::plot::escape;

/// The page of recorded runs, in the folder of the pages that link to it.
pub const VIEWER: &str = "view.html";

/// Characters that are percent-encoded in addresses, among them all that are special in HTML.
const ENCODED: &AsciiSet = &NON_ALPHANUMERIC.remove(b'-').remove(b'.').remove(b'_');

/// A part of the page of recorded runs.
#[derive(Clone, Copy, Debug, Default)]
pub struct ViewedPart<'a> {
    /// The runs; if empty, the page selects them.
    pub runs: &'a [&'a str],
    /// The track, if no run is stated.
    pub track: Option<&'a str>,
    /// The channel that is shown first.
    pub channel: Option<&'a str>,
    /// The stretch that is shown; `None` shows the whole runs.
    pub stretch: Option<Stretch>,
}

/// A stretch of a run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Stretch {
    /// Times since the first sample [s].
    Time(f64, f64),
    /// Distances along the track [m].
    Distance(f64, f64),
}

impl Stretch {
    /// A stretch from `from` to `to` [m] with margins of its own length, at least 10 m.
    pub fn around(from: f64, to: f64) -> Stretch {
        const MIN_MARGIN_M: f64 = 10.0;
        let margin = (to - from).max(MIN_MARGIN_M);
        Stretch::Distance(from - margin, to + margin)
    }
}

impl<'a> ViewedPart<'a> {
    /// Whole runs.
    pub fn of_runs(runs: &'a [&'a str]) -> Self {
        ViewedPart {
            runs,
            ..ViewedPart::default()
        }
    }

    /// A link to this part of the page at the address `viewer`, as HTML.
    pub fn link(&self, viewer: &str, text: &str) -> String {
        let mut parts = Vec::new();
        let mut state = |key: &str, value: &str| {
            let value = percent_encode(value.as_bytes(), ENCODED);
            parts.push(format!("{key}={value}"));
        };
        self.runs.iter().for_each(|run| state("run", run));
        self.track.iter().for_each(|track| state("track", track));
        self.channel.iter().for_each(|name| state("channel", name));
        if let Some(stretch) = self.stretch {
            let (over, from, to) = match stretch {
                Stretch::Time(from, to) => ("time", from, to),
                Stretch::Distance(from, to) => ("distance", from, to),
            };
            state("over", over);
            state("from", &format!("{from:.2}"));
            state("to", &format!("{to:.2}"));
        }
        let address = escape(&format!("{viewer}#{}", parts.join("&")));
        format!("<a href=\"{address}\">{}</a>", escape(text))
    }
}

/// The address of a file by its relative path from the page.
pub fn address(path: &Path) -> String {
    let parts = path.components().map(|part| {
        let bytes = part.as_os_str().as_encoded_bytes();
        percent_encode(bytes, ENCODED).to_string()
    });
    parts.collect::<Vec<_>>().join("/")
}

/// Links into the page of the runs as a paragraph; nothing without links.
pub fn viewer_links(links: &[String]) -> String {
    match links {
        [] => String::new(),
        links => format!("<p>In the viewer: {}</p>\n", links.join(", ")),
    }
}

/// A page whose links into the [`VIEWER`] of its folder lead to the address `viewer` instead.
pub fn linked_to(page: &str, viewer: &str) -> String {
    // Text of users has no quotes here: they are escaped.
    let link = |viewer: &str| format!("<a href=\"{viewer}#");
    page.replace(&link(VIEWER), &link(&escape(viewer)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_in_a_link_are_neither_html_nor_further_keys() {
        let part = ViewedPart {
            runs: &["A1 & B", "\"><script>"],
            channel: Some("v#1=2"),
            stretch: Some(Stretch::around(100.0, 104.0)),
            ..ViewedPart::default()
        };
        assert_eq!(
            part.link(VIEWER, "<a>"),
            "<a href=\"view.html#run=A1%20%26%20B&amp;run=%22%3E%3Cscript%3E&amp;channel=v%231%3D2\
             &amp;over=distance&amp;from=90.00&amp;to=114.00\">&lt;a&gt;</a>"
        );
    }

    #[test]
    fn a_page_elsewhere_links_to_the_same_file() {
        let part = ViewedPart {
            track: Some("east"),
            stretch: Some(Stretch::Time(1.0, 2.5)),
            ..ViewedPart::default()
        };
        let page = part.link(VIEWER, "href=\"view.html#");
        let viewer = address(Path::new("../my runs/view.html"));
        assert_eq!(viewer, "../my%20runs/view.html");
        assert_eq!(
            linked_to(&page, &viewer),
            "<a href=\"../my%20runs/view.html#track=east&amp;over=time&amp;from=1.00&amp;to=2.50\">\
             href=&quot;view.html#</a>"
        );
    }
}
