//! Requests of HTTP: the head, the checks of its names and its token, and the answers.

use std::io::{self, Read, Write};
use std::net::{Ipv4Addr, Ipv6Addr, Shutdown, TcpStream};
use std::time::{Duration, Instant};

use subtle::ConstantTimeEq;
use tungstenite::Error;
use tungstenite::error::ProtocolError;
use tungstenite::handshake::machine::{HandshakeMachine, RoundResult, StageResult};
use tungstenite::handshake::server::{Request, Response, create_response};

/// Time in which the head of a request must arrive.
const HEAD_TIME: Duration = Duration::from_secs(5);

/// Refused request: status and explanation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Refusal(pub(super) &'static str, pub(super) &'static str);

const MALFORMED: Refusal = Refusal("400 Bad Request", "the request is malformed");
const LATE: Refusal = Refusal("408 Request Timeout", "the request took too long");

/// Allowed request.
#[derive(Debug)]
pub(super) enum Allowed {
    Page,
    /// Handshake of a WebSocket: the answer, and the bytes after the head of the request.
    Socket(Box<Response>, Vec<u8>),
}

/// Names and token that a request needs.
#[derive(Debug)]
pub(super) struct Gate {
    pub(super) token: String,
    pub(super) hosts: Vec<String>,
}

impl Gate {
    /// Reads the head of a request and checks it.
    pub(super) fn read(&self, stream: &TcpStream) -> Result<Allowed, Refusal> {
        let (request, rest) = read_head(stream)?;
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
            "live" => Ok(Allowed::Socket(Box::new(create_response(&request).map_err(|_| MALFORMED)?), rest)),
            _ => Err(Refusal("404 Not Found", "there is only the page")),
        }
    }

    /// Checks the name by which the browser found the server. A name that an attacker controls, and
    /// which leads to this machine, is none of them (DNS rebinding); an address in digits cannot
    /// lead elsewhere. The port may be that of a tunnel.
    fn is_name_of_server(&self, host: &str) -> bool {
        let name = host.rsplit_once(':').filter(|(_, port)| port.parse::<u16>().is_ok()).map_or(host, |(name, _)| name);
        let is_address = match name.strip_prefix('[').and_then(|name| name.strip_suffix(']')) {
            Some(address) => address.parse::<Ipv6Addr>().is_ok(),
            None => name.parse::<Ipv4Addr>().is_ok(),
        };
        let is_known = |known: &str| known.eq_ignore_ascii_case(name);
        is_address || is_known("localhost") || self.hosts.iter().any(|known| is_known(known))
    }
}

/// Returns `true` if the origin is the page at this host, directly or behind a proxy with TLS.
fn is_origin(origin: Option<&str>, host: &str) -> bool {
    let name = origin.and_then(|origin| origin.strip_prefix("http://").or_else(|| origin.strip_prefix("https://")));
    name.is_some_and(|name| name.eq_ignore_ascii_case(host))
}

/// Returns the value of a header. More than one value is an error.
fn single<'r>(request: &'r Request, name: &str) -> Result<Option<&'r str>, Refusal> {
    let mut values = request.headers().get_all(name).iter();
    let value = values.next().map(|value| value.to_str().map_err(|_| MALFORMED)).transpose()?;
    if values.next().is_some() { Err(MALFORMED) } else { Ok(value) }
}

/// Reads the head of a request. Returns it, and the bytes after it.
fn read_head(stream: &TcpStream) -> Result<(Request, Vec<u8>), Refusal> {
    let end = Instant::now() + HEAD_TIME;
    let mut reading = HandshakeMachine::start_read(stream);
    loop {
        // A timeout of zero is an error.
        let rest = end.saturating_duration_since(Instant::now());
        stream.set_read_timeout(Some(rest)).map_err(|_| LATE)?;
        reading = match reading.single_round::<Request>() {
            Ok(RoundResult::StageFinished(StageResult::DoneReading { result, tail, .. })) => return Ok((result, tail)),
            Ok(RoundResult::Incomplete(reading)) => reading,
            Ok(_) | Err(Error::Io(_)) => return Err(LATE),
            Err(Error::AttackAttempt) => {
                return Err(Refusal("431 Request Header Fields Too Large", "the request is too long"));
            }
            Err(Error::Protocol(ProtocolError::WrongHttpMethod)) => {
                return Err(Refusal("405 Method Not Allowed", "the page accepts only GET"));
            }
            Err(_) => return Err(MALFORMED),
        };
    }
}

/// Writes an answer.
pub(super) fn write(stream: &mut TcpStream, status: &str, kind: &str, body: &[u8]) -> io::Result<()> {
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
    io::copy(&mut stream.take(1 << 16), &mut io::sink())?;
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
