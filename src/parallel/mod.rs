//! Work in several threads, and the simulations that it runs in.

mod chunks;
mod edited;
mod pool;
mod work_queue;

pub(crate) use self::chunks::{Split, StopOnPanic, default_chunk, in_chunks};
pub(crate) use self::edited::is_edited;
pub(crate) use self::pool::{Lease, Pool};
pub(crate) use self::work_queue::{FirstError, WorkQueue, for_each_item, for_each_worker};
