//! Who may ask: pages that this server gave out, under its own name.

use crate::view::http::{Refusal, Request};

/// Refuses what a page of another site, or another name for this machine, could send.
///
/// The host must be this machine's own name with the server's port, so that a name that is made to point here
/// (DNS rebinding) gets nothing. What changes something must come from a page of the same origin and be JSON, which no
/// foreign form can send without asking first.
///
/// # Errors
/// [`Refusal`] 403, or 415 for a body that is not JSON.
pub fn check(request: &Request, port: u16) -> Result<(), Refusal> {
    let names = [format!("127.0.0.1:{port}"), format!("localhost:{port}")];
    let host = request.header("host").unwrap_or_default();
    if !names.iter().any(|name| name == host) {
        return Err(Refusal(
            403,
            format!("host {host:?}: expected {} or {}", names[0], names[1]),
        ));
    }
    let site = request.header("sec-fetch-site");
    if request.method == "GET" {
        // A link from elsewhere may lead here; nothing else of another site may look.
        let navigates = request.header("sec-fetch-mode") == Some("navigate");
        return match site {
            Some("cross-site" | "same-site") if !navigates => {
                Err(Refusal(403, "asked by a page of another site".into()))
            }
            _ => Ok(()),
        };
    }
    let origin = request.header("origin").unwrap_or_default();
    if origin != format!("http://{host}") || !matches!(site, None | Some("same-origin")) {
        return Err(Refusal(
            403,
            format!("origin {origin:?}: expected http://{host}"),
        ));
    }
    if request.header("content-type") != Some("application/json") {
        return Err(Refusal(415, "expected application/json".into()));
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn status(method: &str, headers: &[(&str, &str)]) -> u16 {
        let request = Request {
            method: method.into(),
            target: "/".into(),
            headers: headers
                .iter()
                .map(|(name, value)| (name.to_string(), value.to_string()))
                .collect(),
            body: Vec::new(),
        };
        check(&request, 4000).map_or_else(|refusal| refusal.0, |()| 200)
    }

    #[test]
    fn only_this_servers_own_names_are_hosts() {
        assert_eq!(status("GET", &[("host", "127.0.0.1:4000")]), 200);
        assert_eq!(status("GET", &[("host", "localhost:4000")]), 200);
        for host in [
            "127.0.0.1",
            "127.0.0.1:4001",
            "evil.example:4000",
            "localhost:4000.evil.example",
            "",
        ] {
            assert_eq!(status("GET", &[("host", host)]), 403, "{host}");
        }
        assert_eq!(status("GET", &[]), 403);
        let twice = [("host", "127.0.0.1:4000"), ("host", "evil.example")];
        assert_eq!(status("GET", &twice), 403);
    }

    #[test]
    fn only_a_page_of_the_same_origin_may_ask_for_work() {
        let (host, json) = (
            ("host", "127.0.0.1:4000"),
            ("content-type", "application/json"),
        );
        let own = ("origin", "http://127.0.0.1:4000");
        assert_eq!(status("POST", &[host, own, json]), 200);
        assert_eq!(
            status(
                "POST",
                &[host, own, json, ("sec-fetch-site", "same-origin")]
            ),
            200
        );
        assert_eq!(status("POST", &[host, json]), 403);
        assert_eq!(status("POST", &[host, json, ("origin", "null")]), 403);
        assert_eq!(
            status("POST", &[host, json, ("origin", "http://localhost:4000")]),
            403
        );
        assert_eq!(
            status("POST", &[host, json, ("origin", "https://evil.example")]),
            403
        );
        assert_eq!(
            status("POST", &[host, own, json, ("sec-fetch-site", "cross-site")]),
            403
        );
        assert_eq!(
            status("POST", &[host, own, ("content-type", "text/plain")]),
            415
        );
        assert_eq!(
            status("GET", &[host, ("sec-fetch-site", "cross-site")]),
            403
        );
        let link = [
            host,
            ("sec-fetch-site", "cross-site"),
            ("sec-fetch-mode", "navigate"),
        ];
        assert_eq!(status("GET", &link), 200);
    }
}
