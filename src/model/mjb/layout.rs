//! The sizes and arrays of a model file: their types, and the macros that the table invokes, which
//! the build script generates from the field table of `mujoco-sys`.

use std::marker::PhantomData;

/// Index in the file of one of the model's sizes (`nq`, `nbody`, …).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Size(pub(super) usize);

impl Size {
    pub(super) fn name(self) -> &'static str {
        SIZE_NAMES[self.0]
    }
}

/// Number of rows or columns of an array: a constant, a size, or a size times a constant.
#[derive(Clone, Copy, Debug)]
pub(super) struct Extent {
    pub(super) size: Option<Size>,
    pub(super) times: usize,
}

/// Layout of an array in the file or in `mjData`: `rows * columns` elements of `element` bytes
/// each.
#[derive(Clone, Copy, Debug)]
pub(super) struct Array {
    pub(super) name: &'static str,
    pub(super) element: usize,
    pub(super) rows: Extent,
    pub(super) columns: Extent,
}

/// Index in the file of one of the model's arrays, with the type of its elements.
#[derive(Debug)]
pub(super) struct Field<T> {
    pub(super) index: usize,
    element: PhantomData<T>,
}

impl<T> Field<T> {
    const fn new(index: usize) -> Self {
        Self { index, element: PhantomData }
    }

    pub(super) fn name(self) -> &'static str {
        MODEL_ARRAYS[self.index].name
    }

    pub(super) fn array(self) -> &'static Array {
        &MODEL_ARRAYS[self.index]
    }
}

// Derived implementations would require `T: Clone`.
impl<T> Clone for Field<T> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<T> Copy for Field<T> {}

/// Type of array elements.
pub(super) trait Element: Copy {
    const BYTES: usize;
    /// Decodes `BYTES` bytes in native byte order, because the engine writes images of its memory.
    fn read(bytes: &[u8]) -> Self;
}

macro_rules! element {
    ($($type:ty),*) => {$(
        impl Element for $type {
            const BYTES: usize = size_of::<$type>();
            fn read(bytes: &[u8]) -> Self {
                let mut array = [0; Self::BYTES];
                array.copy_from_slice(bytes);
                Self::from_ne_bytes(array)
            }
        }
    )*};
}

element!(f64, f32, i64, i32, u8);

macro_rules! extent {
    ($times:literal) => {
        Extent { size: None, times: $times }
    };
    (mjNTEXROLE) => {
        Extent { size: None, times: mujoco_sys::mjNTEXROLE as usize }
    };
    ($size:ident) => {
        Extent { size: Some(size::$size), times: 1 }
    };
    ($size:ident * $times:literal) => {
        Extent { size: Some(size::$size), times: $times }
    };
}

macro_rules! sizes {
    ($($name:ident)*) => {
        pub(super) const SIZE_NAMES: &[&str] = &[$(stringify!($name)),*];
        pub(super) const SIZES: usize = SIZE_NAMES.len();

        /// The sizes by name.
        #[allow(non_upper_case_globals, non_camel_case_types, dead_code, reason = "the engine's own names, all of them")]
        pub(super) mod size {
            use super::Size;
            enum Index { $($name),* }
            $(pub(in super::super) const $name: Size = Size(Index::$name as usize);)*
        }
    };
}

macro_rules! arrays {
    ($list:ident; $($name:ident: $element:ty, [$($rows:tt)*] [$($columns:tt)*];)*) => {
        pub(super) const $list: &[Array] = &[$(Array {
            name: stringify!($name),
            element: size_of::<$element>(),
            rows: extent!($($rows)*),
            columns: extent!($($columns)*),
        }),*];
    };
}

macro_rules! model_arrays {
    ($($name:ident: $element:ty, $rows:tt $columns:tt;)*) => {
        arrays! { MODEL_ARRAYS; $($name: $element, $rows $columns;)* }

        /// The model's arrays by name.
        #[allow(non_upper_case_globals, non_camel_case_types, dead_code, reason = "the engine's own names, all of them")]
        pub(super) mod field {
            use super::Field;
            enum Index { $($name),* }
            $(pub(in super::super) const $name: Field<$element> = Field::new(Index::$name as usize);)*
        }
    };
}

macro_rules! data_arrays {
    ($($name:ident: $element:ty, $rows:tt $columns:tt;)*) => {
        arrays! { DATA_ARRAYS; $($name: $element, $rows $columns;)* }
    };
}

include!(concat!(env!("OUT_DIR"), "/binary_table.rs"));
