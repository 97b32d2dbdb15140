//! Requests of HTTP: the head, the checks of its names and its token, and the answers.

use std::io::{ErrorKind, Read, Write};
use std::net::{IpAddr, Ipv6Addr, Shutdown, TcpStream};
use std::time::{Duration, Instant};

use subtle::ConstantTimeEq;
use tungstenite::http::{self, Method};

/// Largest size of the head of a request, bytes.
const LARGEST_HEAD: usize = 8192;

/// Time in which the head of a request must arrive.
const HEAD_TIME: Duration = Duration::from_secs(5);

/// Refused request: status and explanation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Refusal(pub(super) &'static str, pub(super) &'static str);

const MALFORMED: Refusal = Refusal("400 Bad Request", "the request is malformed");

/// Allowed request.
#[derive(Debug)]
pub(super) enum Allowed {
    Page,
    /// Handshake of a WebSocket, and the bytes after the head.
    Socket(Box<http::Request<()>>, Vec<u8>),
}

/// Names and token that a request needs.
#[derive(Debug)]
pub(super) struct Gate {
    pub(super) token: String,
    pub(super) hosts: Vec<String>,
}

impl Gate {
    /// Reads the head of a request and checks it.
    pub(super) fn read(&self, stream: &mut TcpStream) -> Result<Allowed, Refusal> {
        let (head, rest) = read_head(stream)?;
        let request = parse(&head)?;
        if request.method() != Method::GET {
            return Err(Refusal("405 Method Not Allowed", "the page accepts only GET"));
        }
        let host = single(&request, "host")?.ok_or(MALFORMED)?;
        if !self.is_name_of_server(host) {
            return Err(Refusal("403 Forbidden", "the page has another name: see LiveOptions::hosts"));
        }
        let path = request.uri().path().trim_matches('/');
        let (token, place) = path.split_once('/').unwrap_or((path, ""));
        if !bool::from(token.as_bytes().ct_eq(self.token.as_bytes())) {
            return Err(Refusal("403 Forbidden", "the address needs the token that the program printed"));
        }
        match place {
            "" => Ok(Allowed::Page),
            // Browsers send the origin with each handshake. Scripts cannot change it.
            "live" if !is_origin(single(&request, "origin")?, host) => {
                Err(Refusal("403 Forbidden", "only the page itself may connect"))
            }
            "live" => Ok(Allowed::Socket(Box::new(request), rest)),
            _ => Err(Refusal("404 Not Found", "there is only the page")),
        }
    }

    /// Checks the name by which the browser found the server. A name that an attacker controls, and
    /// which leads to this machine, is none of them (DNS rebinding); an address in digits cannot
    /// lead elsewhere. The port may be that of a tunnel.
    fn is_name_of_server(&self, host: &str) -> bool {
        let is_port = |text: &str| text.is_empty() || text.parse::<u16>().is_ok();
        if let Some((address, port)) = host.strip_prefix('[').and_then(|rest| rest.split_once(']')) {
            return address.parse::<Ipv6Addr>().is_ok() && is_port(port.strip_prefix(':').unwrap_or(port));
        }
        let (name, port) = host.split_once(':').unwrap_or((host, ""));
        let is_known = |known: &str| known.eq_ignore_ascii_case(name);
        let is_name = is_known("localhost") || self.hosts.iter().any(|known| is_known(known));
        is_port(port) && (is_name || name.parse::<IpAddr>().is_ok())
    }
}

/// Returns `true` if the origin is the page at this host, directly or behind a proxy with TLS.
fn is_origin(origin: Option<&str>, host: &str) -> bool {
    let name = origin.and_then(|origin| origin.strip_prefix("http://").or_else(|| origin.strip_prefix("https://")));
    name.is_some_and(|name| name.eq_ignore_ascii_case(host))
}

/// Returns the value of a header. More than one value is an error.
fn single<'r>(request: &'r http::Request<()>, name: &str) -> Result<Option<&'r str>, Refusal> {
    let mut values = request.headers().get_all(name).iter();
    let value = values.next().map(|value| value.to_str().map_err(|_| MALFORMED)).transpose()?;
    if values.next().is_some() { Err(MALFORMED) } else { Ok(value) }
}

/// Reads to the empty line. Returns the head and the bytes after it.
fn read_head(stream: &mut TcpStream) -> Result<(Vec<u8>, Vec<u8>), Refusal> {
    let end = Instant::now() + HEAD_TIME;
    let mut head = Vec::new();
    let mut block = [0; 1024];
    loop {
        let rest = end.saturating_duration_since(Instant::now());
        // A timeout of zero is an error.
        let is_late = rest.is_zero() || stream.set_read_timeout(Some(rest)).is_err();
        let read = if is_late { Err(ErrorKind::TimedOut.into()) } else { stream.read(&mut block) };
        let number = match read {
            Ok(0) => return Err(MALFORMED),
            Ok(number) => number,
            Err(error) if error.kind() == ErrorKind::Interrupted => continue,
            Err(_) => return Err(Refusal("408 Request Timeout", "the request took too long")),
        };
        let before = head.len().saturating_sub(3);
        head.extend_from_slice(&block[..number]);
        if let Some(at) = head[before..].windows(4).position(|bytes| bytes == b"\r\n\r\n") {
            let rest = head.split_off(before + at + 4);
            return Ok((head, rest));
        }
        if head.len() > LARGEST_HEAD {
            return Err(Refusal("431 Request Header Fields Too Large", "the request is too long"));
        }
    }
}

fn parse(head: &[u8]) -> Result<http::Request<()>, Refusal> {
    let mut headers = [httparse::EMPTY_HEADER; 64];
    let mut parsed = httparse::Request::new(&mut headers);
    if !parsed.parse(head).is_ok_and(|status| status.is_complete()) {
        return Err(MALFORMED);
    }
    let (Some(method), Some(path), Some(1)) = (parsed.method, parsed.path, parsed.version) else {
        return Err(MALFORMED);
    };
    let builder = http::Request::builder().method(method).uri(path).version(http::Version::HTTP_11);
    let builder = parsed.headers.iter().fold(builder, |builder, header| builder.header(header.name, header.value));
    builder.body(()).map_err(|_| MALFORMED)
}

/// Writes the page.
pub(super) fn write_page(stream: &mut TcpStream, page: &[u8]) -> std::io::Result<()> {
    write(stream, "200 OK", "text/html", page)
}

/// Writes a refusal.
pub(super) fn write_refusal(stream: &mut TcpStream, Refusal(status, text): Refusal) -> std::io::Result<()> {
    write(stream, status, "text/plain", format!("{text}\n").as_bytes())
}

fn write(stream: &mut TcpStream, status: &str, kind: &str, body: &[u8]) -> std::io::Result<()> {
    let head = format!(
        "HTTP/1.1 {status}\r\nContent-Type: {kind}; charset=utf-8\r\nContent-Length: {}\r\nConnection: close\r\n\
         Cache-Control: no-store\r\nContent-Security-Policy: frame-ancestors 'none'\r\nX-Frame-Options: DENY\r\n\
         Cross-Origin-Opener-Policy: same-origin\r\nCross-Origin-Resource-Policy: same-origin\r\n\
         Referrer-Policy: no-referrer\r\nX-Content-Type-Options: nosniff\r\n\r\n",
        body.len()
    );
    stream.write_all(head.as_bytes())?;
    stream.write_all(body)?;
    // The system discards what was written if the browser still sends.
    stream.shutdown(Shutdown::Write)?;
    stream.set_read_timeout(Some(Duration::from_secs(1)))?;
    std::io::copy(&mut stream.take(1 << 16), &mut std::io::sink())?;
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::{Gate, is_origin};

    #[test]
    fn only_names_that_nobody_else_controls_are_names_of_the_server() {
        let gate = Gate { token: String::new(), hosts: vec!["robot.lan".to_owned()] };
        for host in
            ["localhost", "LOCALHOST:8000", "127.0.0.1:1", "10.1.2.3:65535", "[::1]", "[::1]:8000", "robot.lan:80"]
        {
            assert!(gate.is_name_of_server(host), "{host}");
        }
        for host in [
            "",
            ":8000",
            "evil.example",
            "127.0.0.1.evil.example:8000",
            "localhost.evil.example",
            "127.0.0.1:65536",
            "127.0.0.1:8000:9",
            "[::1].evil.example",
            "[evil]",
            "::1",
            "robot.lan.evil.example",
            "user@localhost",
        ] {
            assert!(!gate.is_name_of_server(host), "{host}");
        }
    }

    #[test]
    fn only_the_page_itself_is_an_origin() {
        for origin in ["http://localhost:80", "https://LocalHost:80"] {
            assert!(is_origin(Some(origin), "localhost:80"), "{origin}");
        }
        for origin in ["null", "", "localhost:80", "http://localhost", "http://localhost:81", "http://a@localhost:80"] {
            assert!(!is_origin(Some(origin), "localhost:80"), "{origin}");
        }
        assert!(!is_origin(None, "localhost:80"), "a browser sends an origin");
    }
}
