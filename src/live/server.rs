//! Threads of the server: one that accepts connections, and one for each connection.

use std::net::{IpAddr, Ipv4Addr, Ipv6Addr, Shutdown, SocketAddr, TcpListener, TcpStream};
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::thread::{self, JoinHandle};
use std::time::Duration;

use tungstenite::handshake::server::write_response;
use tungstenite::protocol::frame::coding::CloseCode;
use tungstenite::protocol::{CloseFrame, Role, WebSocketConfig};
use tungstenite::{Bytes, Error, WebSocket};

use super::http::{self, Allowed, Gate, Refusal};
use super::message::{Limits, Message};
use super::slots::Slots;

/// Largest message of a browser, bytes.
const LARGEST_MESSAGE: usize = 1024;

/// Time after which a browser that sends nothing is disconnected.
const IDLE_TIME: Duration = Duration::from_secs(30);

/// Time after which a browser that receives nothing is disconnected.
const WRITE_TIME: Duration = Duration::from_secs(5);

/// Shortest time between two other messages of a browser that are read.
const PAUSE: Duration = Duration::from_millis(1);

/// Longest time between two states, if the simulation publishes none.
const LONGEST_PERIOD: Duration = Duration::from_secs(1);

/// Number of connections besides those of the largest number of browsers: loads of the page, and
/// requests whose head has not arrived.
const OTHER_CONNECTIONS: usize = 16;

/// Contents of the page, and what the threads share.
#[derive(Debug)]
pub(super) struct Site {
    pub(super) page: Vec<u8>,
    pub(super) gate: Gate,
    pub(super) limits: Limits,
    pub(super) slots: Slots,
    /// Largest number of browsers.
    pub(super) most: usize,
    pub(super) browsers: AtomicUsize,
}

/// Starts the server.
pub(super) fn start(listener: TcpListener, site: Arc<Site>) -> std::io::Result<JoinHandle<()>> {
    thread::Builder::new().name("live page".to_owned()).spawn(move || accept(&listener, &site))
}

/// Returns the address by which this machine reaches the server.
pub(super) fn reachable(mut address: SocketAddr) -> SocketAddr {
    match address.ip() {
        IpAddr::V4(ip) if ip.is_unspecified() => address.set_ip(Ipv4Addr::LOCALHOST.into()),
        IpAddr::V6(ip) if ip.is_unspecified() => address.set_ip(Ipv6Addr::LOCALHOST.into()),
        _ => {}
    }
    address
}

fn accept(listener: &TcpListener, site: &Arc<Site>) {
    let mut connections: Vec<(TcpStream, JoinHandle<()>)> = Vec::new();
    for (client, accepted) in (0..).zip(listener.incoming()) {
        if site.slots.is_closed() {
            break;
        }
        connections.retain(|(_, thread)| !thread.is_finished());
        match accepted {
            Ok(stream) if connections.len() < site.most.saturating_add(OTHER_CONNECTIONS) => {
                // A failure affects only this connection.
                connections.extend(connect(stream, site.clone(), client));
            }
            Ok(_) => log::debug!("a live page has too many connections, and refuses another one"),
            Err(error) => {
                // Such as too many open files.
                log::warn!("a live page cannot accept a connection: {error}");
                thread::sleep(Duration::from_millis(100));
            }
        }
    }
    for (stream, _) in &connections {
        let _ = stream.shutdown(Shutdown::Both);
    }
    for (_, thread) in connections {
        let _ = thread.join();
    }
}

/// Starts the thread of a connection, and returns it with a copy of the stream.
fn connect(stream: TcpStream, site: Arc<Site>, client: u64) -> std::io::Result<(TcpStream, JoinHandle<()>)> {
    let copy = stream.try_clone()?;
    stream.set_nodelay(true)?;
    stream.set_write_timeout(Some(WRITE_TIME))?;
    let serve = move || {
        if let Err(error) = serve(stream, &site, client) {
            log::debug!("a connection of a live page ends: {error}");
        }
    };
    Ok((copy, thread::Builder::new().name("live client".to_owned()).spawn(serve)?))
}

/// Answers a request. Returns at the end of the connection.
fn serve(mut stream: TcpStream, site: &Site, client: u64) -> Result<(), Error> {
    let increased = |browsers: usize| (browsers < site.most).then_some(browsers + 1);
    let Refusal(status, text) = match site.gate.read(&stream) {
        Ok(Allowed::Page) => return Ok(http::write(&mut stream, "200 OK", "text/html", &site.page)?),
        Ok(Allowed::Socket(response, rest)) => {
            if site.browsers.fetch_update(Ordering::AcqRel, Ordering::Acquire, increased).is_ok() {
                let result = write_response(&mut stream, &response);
                let result = result.and_then(|()| converse(stream, rest, site, client));
                site.browsers.fetch_sub(1, Ordering::AcqRel);
                return result;
            }
            Refusal("503 Service Unavailable", "too many browsers show the page")
        }
        Err(refusal) => refusal,
    };
    log::debug!("a live page refuses a request: {text}");
    Ok(http::write(&mut stream, status, "text/plain", format!("{text}\n").as_bytes())?)
}

/// Exchanges messages with a browser.
fn converse(stream: TcpStream, rest: Vec<u8>, site: &Site, client: u64) -> Result<(), Error> {
    stream.set_read_timeout(Some(IDLE_TIME))?;
    let config = WebSocketConfig::default()
        .read_buffer_size(4096)
        .write_buffer_size(0)
        .max_message_size(Some(LARGEST_MESSAGE))
        .max_frame_size(Some(LARGEST_MESSAGE));
    let mut socket = WebSocket::from_partially_read(stream, rest, Role::Server, Some(config));
    let end = answer(&mut socket, site, client).unwrap_or_else(|error| match error {
        Error::Capacity(_) => end(CloseCode::Size, "the message is too long"),
        _ => end(CloseCode::Protocol, ""),
    });
    site.slots.request(client, Message::LetGo);
    let _ = socket.close(Some(end));
    let _ = socket.flush();
    let _ = socket.get_mut().shutdown(Shutdown::Both);
    Ok(())
}

fn end(code: CloseCode, reason: &str) -> CloseFrame {
    CloseFrame { code, reason: reason.into() }
}

/// Answers each request for a state by one, so a browser receives no more than it asks for. Returns
/// the reason when the page is closed, or after a wrong message.
fn answer(socket: &mut WebSocket<TcpStream>, site: &Site, client: u64) -> Result<CloseFrame, Error> {
    let mut bytes = Vec::new();
    loop {
        let message = match socket.read()? {
            tungstenite::Message::Text(text) => site.limits.parse(&text),
            tungstenite::Message::Binary(_) => Err(crate::error::Error::Unsupported("a binary message".to_owned())),
            _ => continue,
        };
        match message {
            Ok(Message::Next) => {
                if !site.slots.next(LONGEST_PERIOD, &mut bytes) {
                    return Ok(end(CloseCode::Away, "the page is closed"));
                }
                socket.send(tungstenite::Message::Binary(Bytes::copy_from_slice(&bytes)))?;
            }
            Ok(message) => {
                site.slots.request(client, message);
                thread::sleep(PAUSE);
            }
            Err(error) => {
                log::warn!("a live page disconnects a browser: {error}");
                let reason: String = error.to_string().chars().take(60).collect();
                return Ok(end(CloseCode::Policy, &reason));
            }
        }
    }
}
