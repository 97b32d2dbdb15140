//! Macro for re-exports with the names by which the search of the documentation finds them.

/// Re-exports items of private modules, each with the names by which the search of the
/// documentation finds it: its C name, or the C name of the argument that it replaces.
///
/// The aliases are at the re-exports because rustdoc 1.95 drops aliases of the items themselves
/// (<https://github.com/rust-lang/rust/issues/152939>).
macro_rules! with_aliases {
    ($(pub use $($path:ident)::+::{$($item:ident = $($alias:literal)+),+ $(,)?};)+) => {
        $(with_aliases!(@each [$($path)::+] $($item = [$($alias)+])+);)+
    };
    (@each [$($path:tt)+] $item:ident = [$($alias:literal)+] $($rest:tt)*) => {
        $(#[doc(alias = $alias)])+
        pub use $($path)+::$item;
        with_aliases!(@each [$($path)+] $($rest)*);
    };
    (@each [$($path:tt)+]) => {};
}

pub(crate) use with_aliases;
