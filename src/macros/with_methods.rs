//! Macro for the `with_…` methods of options structs.

/// Implements the `with_…` methods of an options struct. Each sets the field that has the name of
/// its argument, to the argument or to the expression after `=`.
macro_rules! with_methods {
    ($options:ident { $($method:ident($field:ident: $argument:ty) $(= $value:expr)?),* $(,)? }) => {
        impl $options {
            $(
                #[doc = concat!("Sets [`", stringify!($field), "`](Self#structfield.", stringify!($field), ").")]
                #[must_use]
                pub fn $method(mut self, $field: $argument) -> Self {
                    self.$field = with_methods!(@value $field $($value)?);
                    self
                }
            )*
        }
    };
    (@value $field:ident) => { $field };
    (@value $field:ident $value:expr) => { $value };
}

pub(crate) use with_methods;
