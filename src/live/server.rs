//! Threads of the server: one that accepts connections, and one for each connection.

use std::io::Write;
use std::net::{IpAddr, Ipv4Addr, Ipv6Addr, Shutdown, SocketAddr, TcpListener, TcpStream};
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

use tungstenite::handshake::server::{create_response, write_response};
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

/// Shortest time between two states for a browser.
const SHORTEST_PERIOD: Duration = Duration::from_millis(8);

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

/// Server, which ends with its threads when it is dropped.
#[derive(Debug)]
pub(super) struct Server {
    site: Arc<Site>,
    address: SocketAddr,
    thread: Option<JoinHandle<()>>,
}

impl Server {
    pub(super) fn start(listener: TcpListener, site: Arc<Site>) -> std::io::Result<Self> {
        let address = listener.local_addr()?;
        let for_thread = site.clone();
        let thread =
            thread::Builder::new().name("live page".to_owned()).spawn(move || accept(&listener, &for_thread))?;
        Ok(Self { site, address, thread: Some(thread) })
    }

    pub(super) fn address(&self) -> SocketAddr {
        self.address
    }
}

impl Drop for Server {
    fn drop(&mut self) {
        self.site.slots.close();
        // Ends the wait for a connection. If the connection fails, others are waiting.
        let _ = TcpStream::connect_timeout(&reachable(self.address), Duration::from_secs(1));
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
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

/// Connections with their threads.
type Connections = Vec<(TcpStream, JoinHandle<()>)>;

fn accept(listener: &TcpListener, site: &Arc<Site>) {
    let mut connections = Connections::new();
    for client in 0.. {
        let accepted = listener.accept();
        if site.slots.is_closed() {
            break;
        }
        connections.retain(|(_, thread)| !thread.is_finished());
        match accepted {
            Ok((stream, _)) if connections.len() < site.most.saturating_add(OTHER_CONNECTIONS) => {
                // A failure affects only this connection.
                let _ = connect(&mut connections, stream, site, client);
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

fn connect(connections: &mut Connections, stream: TcpStream, site: &Arc<Site>, client: u64) -> std::io::Result<()> {
    let other_end = stream.try_clone()?;
    stream.set_nodelay(true)?;
    stream.set_write_timeout(Some(WRITE_TIME))?;
    let site = site.clone();
    let serve = move || {
        if let Err(error) = serve(stream, &site, client) {
            log::debug!("a connection of a live page ends: {error}");
        }
    };
    connections.push((other_end, thread::Builder::new().name("live client".to_owned()).spawn(serve)?));
    Ok(())
}

/// Answers a request. Returns at the end of the connection.
fn serve(mut stream: TcpStream, site: &Site, client: u64) -> Result<(), Error> {
    let refused = match site.gate.read(&mut stream) {
        Ok(Allowed::Page) => return Ok(http::write_page(&mut stream, &site.page)?),
        Ok(Allowed::Socket(request, rest)) => match create_response(&request) {
            Ok(response) => {
                let increased = |browsers: usize| (browsers < site.most).then_some(browsers + 1);
                if site.browsers.fetch_update(Ordering::AcqRel, Ordering::Acquire, increased).is_ok() {
                    let result = write_response(&mut stream, &response).and_then(|()| Ok(stream.flush()?));
                    let result = result.and_then(|()| converse(stream, rest, site, client));
                    site.browsers.fetch_sub(1, Ordering::AcqRel);
                    return result;
                }
                Refusal("503 Service Unavailable", "too many browsers show the page")
            }
            Err(_) => Refusal("400 Bad Request", "the handshake is malformed"),
        },
        Err(refusal) => refusal,
    };
    log::debug!("a live page refuses a request: {}", refused.1);
    Ok(http::write_refusal(&mut stream, refused)?)
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
    let result = answer(&mut socket, site, client);
    site.slots.request(client, Message::LetGo);
    let (code, reason) = match &result {
        Ok(()) => (CloseCode::Away, "the page is closed".to_owned()),
        Err(Ended::Wrong(error)) => {
            log::warn!("a live page disconnects a browser: {error}");
            (CloseCode::Policy, error.to_string().chars().take(60).collect())
        }
        Err(Ended::Connection(Error::Capacity(_))) => (CloseCode::Size, "the message is too long".to_owned()),
        Err(Ended::Connection(_)) => (CloseCode::Protocol, String::new()),
    };
    let _ = socket.close(Some(CloseFrame { code, reason: reason.into() }));
    let _ = socket.flush();
    let _ = socket.get_mut().shutdown(Shutdown::Both);
    Ok(())
}

/// End of a conversation.
enum Ended {
    Wrong(crate::error::Error),
    Connection(Error),
}

impl From<Error> for Ended {
    fn from(error: Error) -> Self {
        Self::Connection(error)
    }
}

/// Answers each request for a state by one, so a browser receives no more than it asks for. Returns
/// when the page is closed.
fn answer(socket: &mut WebSocket<TcpStream>, site: &Site, client: u64) -> Result<(), Ended> {
    let (mut bytes, mut last) = (Vec::new(), Instant::now());
    loop {
        let message = match socket.read()? {
            tungstenite::Message::Text(text) => site.limits.parse(&text).map_err(Ended::Wrong)?,
            tungstenite::Message::Binary(_) => {
                let error = crate::error::Error::Unsupported("a binary message".to_owned());
                return Err(Ended::Wrong(error));
            }
            _ => continue,
        };
        if message != Message::Next {
            site.slots.request(client, message);
            thread::sleep(PAUSE);
            continue;
        }
        thread::sleep(SHORTEST_PERIOD.saturating_sub(last.elapsed()));
        last = Instant::now();
        if !site.slots.next(LONGEST_PERIOD, &mut bytes) {
            return Ok(());
        }
        socket.send(tungstenite::Message::Binary(Bytes::copy_from_slice(&bytes)))?;
    }
}
