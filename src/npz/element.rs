//! Types of the values of an array.

use std::io::{self, Write};

/// Number of values that are converted to bytes at a time.
const BLOCK: usize = 8192;

/// Type of the values of an [`Array`](super::Array): `f64`, `f32`, `i64`, `i32`, `u8` or `bool`.
pub trait Element: private::Element {}

pub(super) mod private {
    pub trait Element: Sized {
        fn values(values: &[Self]) -> super::Values<'_>;
    }
}

/// Declares each type with its variant of [`Values`], its code in NumPy and its bytes in a file.
macro_rules! elements {
    ($($variant:ident($type:ty) = $descr:literal, $bytes:expr;)*) => {
        /// Values of an array.
        #[derive(Clone, Copy, Debug)]
        pub enum Values<'a> {
            $($variant(&'a [$type])),*
        }

        impl Values<'_> {
            pub(super) fn len(self) -> usize {
                match self {
                    $(Self::$variant(values) => values.len()),*
                }
            }

            /// Returns NumPy's code of the type.
            pub(super) fn descr(self) -> &'static str {
                match self {
                    $(Self::$variant(_) => $descr),*
                }
            }

            pub(super) fn write(self, out: &mut impl Write) -> io::Result<()> {
                match self {
                    $(Self::$variant(values) => write_blocks(out, values, $bytes)),*
                }
            }
        }

        $(
            impl Element for $type {}

            impl private::Element for $type {
                fn values(values: &[Self]) -> Values<'_> {
                    Values::$variant(values)
                }
            }
        )*
    };
}

elements! {
    F64(f64) = "<f8", |value| value.to_le_bytes();
    F32(f32) = "<f4", |value| value.to_le_bytes();
    I64(i64) = "<i8", |value| value.to_le_bytes();
    I32(i32) = "<i4", |value| value.to_le_bytes();
    U8(u8) = "|u1", |value| [value];
    Bool(bool) = "|b1", |value| [u8::from(value)];
}

fn write_blocks<T: Copy, const N: usize>(
    out: &mut impl Write,
    values: &[T],
    bytes: impl Fn(T) -> [u8; N],
) -> io::Result<()> {
    let mut block = Vec::with_capacity(N * values.len().min(BLOCK));
    for values in values.chunks(BLOCK) {
        block.clear();
        block.extend(values.iter().flat_map(|&value| bytes(value)));
        out.write_all(&block)?;
    }
    Ok(())
}
