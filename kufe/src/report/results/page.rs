//! The page of any document: title, pictures, links and tables.

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;

use crate::plot::escape;
use crate::report::html::{fold, plain_page, small};
use crate::report::results::sections::{capital, document};
use crate::report::viewer::viewer_links;
use crate::results::Datum;

/// A picture of a page.
pub struct Picture {
    /// Name, which is the alternative text.
    pub name: String,
    /// Bytes of the PNG file.
    pub png: Vec<u8>,
}

/// A PNG file as a data URL.
pub fn picture_url(png: &[u8]) -> String {
    format!("data:image/png;base64,{}", STANDARD.encode(png))
}

/// Number of pictures before the figures; further pictures are folded after them.
const FIRST_PICTURES: usize = 3;

/// The page of documents, each with the name of its kind, under a title and a headline. `links` are
/// links into the page of the runs.
pub fn results_page(
    [title, headline]: [&str; 2],
    pictures: &[Picture],
    links: &[String],
    documents: &[(String, Datum)],
) -> String {
    let (first, further) = pictures.split_at(pictures.len().min(FIRST_PICTURES));
    let shown = |pictures: &[Picture]| pictures.iter().map(shown).collect::<String>();
    let mut out = format!("<h1>{}</h1>\n", escape(title));
    if !headline.is_empty() {
        out += &format!("<p>{}</p>\n", escape(headline));
    }
    out += &viewer_links(links);
    out += &shown(first);
    for (kind, value) in documents {
        out += &format!("<h2>{}</h2>\n{}", escape(&capital(kind)), document(value));
    }
    if !further.is_empty() {
        out += &fold(&format!("{} more pictures", further.len()), &shown(further));
    }
    let mut versions = documents.iter();
    let version = versions.find_map(|(_, document)| document.group()?.get("version")?.text());
    out += &version.map_or(String::new(), |version| small(&format!("kufe {version}")));
    plain_page(title, &out)
}

/// A framed picture. A checkbox without a script switches it to full size on a click.
fn shown(Picture { name, png }: &Picture) -> String {
    let (name, url) = (escape(name), picture_url(png));
    format!(
        "<label class=\"picture\" title=\"a click shows it at full size\"><input type=\"checkbox\">\
         <img alt=\"{name}\" src=\"{url}\"></label>\n"
    )
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    fn page(document: serde_json::Value) -> String {
        let document = Datum::of(&document).expect("figures");
        results_page(["a <b>", "b"], &[], &[], &[("friction".into(), document)])
    }

    #[test]
    fn figures_have_names_units_and_errors() {
        let page = page(json!({
            "p_max_pa": 1.395e8, "p_max_error_pa": 1.1e6, "mu": 0.00412345, "left_out": [], "left_out_as_fitted": [], "solver_rounds": 12, "cells": 7, "faces": 8, "stopped": null,
            "points": [{ "v_mps": 5.0, "mu": 4.1e-3, "mu_error": 2e-5 }, { "v_mps": 10.0, "note": "x & <y>" }],
        }));
        assert!(page.contains("<title>a &lt;b&gt;</title>"));
        let at = |text: &str| {
            page.find(text)
                .unwrap_or_else(|| panic!("{text} in {page}"))
        };
        let peak = at(
            "<tr><td>peak pressure<td>139.5 ± 1.1 MPa\n<tr><td>coefficient of friction<td>4.123 · 10⁻³\n",
        );
        let table =
            at("<tr><th class=n>speed [m/s]<th class=n>coefficient of friction [10⁻³]<th>note\n");
        at(
            "<tr><td class=n>5<td class=n>4.100 ± 0.020<td>\n<tr><td class=n>10<td class=n><td>x &amp; &lt;y&gt;\n",
        );
        let rest = at("<details><summary>Further figures</summary>");
        assert!(peak < table && table < rest && rest < at("<td>solver rounds<td>12"));
        at("<p>left out: none; left out as fitted: none</p>");
        assert!(!page.contains("_pa") && !page.contains("stopped"));
    }

    #[test]
    fn what_is_nested_is_a_table_of_its_own_and_never_a_cell() {
        let page = page(json!({
            "front": { "k_n_per_rad": { "value": 10538.0, "low": 10497.0, "high": 10581.0 }, "rank": 2 },
            "rear": { "k_n_per_rad": { "value": 49832.0, "low": 49742.0, "high": 49922.0 }, "rank": 2 },
            "tracks": [{ "track": "east", "left_rms": { "along_n": 21.0 }, "missing": {}, "runs": [{ "run": "A1", "sd_m": 1.2 }] }],
            "differences": [{ "column": "t_s", "largest": 0.0014, "largest_at_m": 880.0 }, { "column": "alpha_rad", "largest": 0.0078, "largest_at_m": 497.0 }],
            "case": { "ice": { "youngs_modulus_pa": 9e9 } },
        }));
        for part in [
            "<tr><th><th>front<th>rear\n<tr><td>stiffness over slip, K<td>10.54 (10.50 to 10.58) kN/rad<td>49.83 (49.74 to 49.92) kN/rad\n",
            "<tr><th>track<th class=n>residual, r.m.s.: along [N]\n<tr><td>east<td class=n>21\n",
            "<tr><th>track<th>run<th class=n>standard deviation [m]\n<tr><td>east<td>A1<td class=n>1.200\n",
            "<tr><td>time<td class=n>1.400 ms<td class=n>880\n<tr><td>slip angle<td class=n>7.800 mrad<td class=n>497\n",
            "<details><summary>Case, as stated</summary>\n<div class=\"wide\"><table>\n<tr><td>ice.youngs_modulus_pa<td>9e9\n",
        ] {
            assert!(page.contains(part), "{part} in {page}");
        }
        assert!(!page.contains("missing"));
    }

    #[test]
    fn names_and_units_of_foreign_files_are_text() {
        let image = "<img src=x onerror=alert(1)>";
        let page = page(json!({
            image: 1.0,
            "k_n_per_<img src=x onerror=alert(1)>": 2.0,
            "of": { "size_n_per_<img src=x onerror=alert(1)>": [1.0, 2.0], image: image },
            "rows": [{ "column": image, "k_n_per_'<img src=x onerror=alert(1)>\"": 3.0, image: image }],
            "front": { "from_n_per_<img src=x onerror=alert(1)>": 0.0 },
            "case": { image: image },
        }));
        assert!(
            page.matches("onerror").count() > 6 && !page.contains("<img"),
            "{page}"
        );
        assert!(page.contains("default-src 'none'; style-src"));
    }

    #[test]
    fn a_stretch_has_both_ends_in_one_unit_and_few_figures_no_fold() {
        let page =
            page(json!({ "track": "east", "from_m": -2e-4, "to_m": 1249.7, "stretches": 1 }));
        let rows = "<tr><td>from<td>0 m\n<tr><td>to<td>1250 m\n";
        assert!(
            page.contains(rows)
                && page.contains("<td>stretches<td>1")
                && !page.contains("<details"),
            "{page}"
        );
    }

    #[test]
    fn many_pictures_do_not_push_the_figures_away() {
        let picture = |k: usize| Picture {
            name: format!("picture {k}"),
            png: vec![0; k],
        };
        let pictures: Vec<Picture> = (0..5).map(picture).collect();
        let figures = Datum::of(&json!({ "mu": 0.004 })).expect("figures");
        let page = results_page(["a", ""], &pictures, &[], &[("figures".into(), figures)]);
        let at = |text: &str| {
            page.find(text)
                .unwrap_or_else(|| panic!("{text} in {page}"))
        };
        assert!(
            at("picture 2") < at("<h2>Figures")
                && at("<h2>Figures") < at("<summary>2 more pictures")
                && at("more pictures") < at("picture 3")
        );
    }
}
