//! Address, names and limits of a live page.

use crate::html::HtmlOptions;
use crate::macros::with_methods;

/// Address, names and limits of a [`LivePage`](super::LivePage).
///
/// ```
/// use mujoco_safe::html::HtmlOptions;
/// use mujoco_safe::live::LiveOptions;
///
/// let page = HtmlOptions::default().with_title("Balance").with_camera("side");
/// let options = LiveOptions::default().with_address("127.0.0.1:8000").with_page(page);
/// assert_eq!(options.clients, 8);
/// ```
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct LiveOptions {
    /// Address of the server, by default `127.0.0.1:0`: this machine only, on a port that the
    /// system selects. `0.0.0.0:8000` serves every network of this machine. The connection is not
    /// encrypted: prefer a tunnel of SSH.
    pub address: String,
    /// Names of this machine by which browsers may open the page, besides `localhost` and
    /// addresses in digits.
    pub hosts: Vec<String>,
    /// Largest number of browsers at the same time.
    pub clients: usize,
    /// Largest number of further simulations that the page shows, by default 63, at most 1000. A
    /// state has 28 bytes for each of their bodies.
    pub ghosts: usize,
    /// Title, camera, groups and spacing of the page. Other fields have no effect.
    pub page: HtmlOptions,
}

impl Default for LiveOptions {
    fn default() -> Self {
        Self {
            address: "127.0.0.1:0".to_owned(),
            hosts: Vec::new(),
            clients: 8,
            ghosts: 63,
            page: HtmlOptions::default(),
        }
    }
}

with_methods!(LiveOptions {
    with_address(address: impl Into<String>) = address.into(),
    with_hosts(hosts: impl IntoIterator<Item = String>) = hosts.into_iter().collect(),
    with_clients(clients: usize),
    with_ghosts(ghosts: usize),
    with_page(page: HtmlOptions),
});
