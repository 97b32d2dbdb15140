//! Lists of fields. The accessors are those of the engine in use: the lists of 2.2.2 are committed,
//! and the build script generates those of other versions. The settings are the same with every
//! engine.

#[cfg(not(engine_since = "2.3.0"))]
#[macro_use]
#[path = "accessors.rs"]
mod accessors;
#[macro_use]
#[path = "settings.rs"]
mod settings;

#[cfg(engine_since = "2.3.0")]
#[macro_use]
#[allow(unused_macros, reason = "each test uses only some of the lists")]
mod accessors {
    include!(concat!(env!("OUT_DIR"), "/accessors.rs"));
}
