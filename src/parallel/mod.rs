//! Work in several threads, and the simulations that it runs in.

mod chunks;
mod edited;
mod idle;
mod work_queue;

pub(crate) use self::chunks::{Split, StopOnPanic, default_chunk, in_chunks, split_rows};
pub(crate) use self::edited::is_edited;
pub(crate) use self::idle::Idle;
pub(crate) use self::work_queue::{WorkQueue, for_each_item, for_each_worker};
