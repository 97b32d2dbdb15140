//! The sizes and arrays of a model file: their types, and the macros that the generated `table.rs` invokes.

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

/// Layout of an array in the file or in `mjData`: `rows * columns` elements of `element` bytes each.
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

element!(f64, f32, i32, u8);

macro_rules! extent {
    ($times:literal) => {
        Extent { size: None, times: $times }
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

use mujoco_sys::mjContact;

include!("table.rs");

#[cfg(test)]
mod tests {
    use std::fmt::Write as _;

    const FIELDS: &str = include_str!("../../../mujoco-sys/fields/v2_2_2.tsv");

    /// Generates the contents of `table.rs` from the table of fields of `mujoco-sys`.
    fn expected() -> String {
        let rows: Vec<Vec<&str>> = FIELDS.lines().skip(1).map(|line| line.split('\t').collect()).collect();
        let select = |owner: &str, kind: &str| -> Vec<&Vec<&str>> {
            rows.iter().filter(|row| row[0] == owner && row[1] == kind).collect()
        };
        let mut text = String::from(
            "// @generated from mujoco-sys/fields/v2_2_2.tsv by the test `the_table_matches_the_field_list`, which also compares\n\
             // them. To regenerate: `MJB_TABLE=write cargo test the_table_matches_the_field_list`. The order is that of the file.\n\n\
             sizes! {\n",
        );
        for names in select("Model", "size").chunks(8) {
            let names: Vec<&str> = names.iter().map(|row| row[3]).collect();
            writeln!(text, "    {}", names.join(" ")).unwrap();
        }
        text.push_str("}\n");
        for (list, owner) in [("model_arrays", "Model"), ("data_arrays", "Data")] {
            writeln!(text, "\n{list}! {{").unwrap();
            for row in select(owner, "array") {
                let element = match row[2] {
                    "mjtNum" => "f64",
                    "float" => "f32",
                    "int" => "i32",
                    "mjtByte" | "char" => "u8",
                    other => other,
                };
                let (rows, columns) = (row[4].replace('*', " * "), row[5].replace('*', " * "));
                writeln!(text, "    {}: {element}, [{rows}] [{columns}];", row[3]).unwrap();
            }
            text.push_str("}\n");
        }
        text
    }

    #[test]
    fn the_table_matches_the_field_list() {
        if std::env::var_os("MJB_TABLE").is_some_and(|value| value == "write") {
            std::fs::write(concat!(env!("CARGO_MANIFEST_DIR"), "/src/model/mjb/table.rs"), expected()).unwrap();
        } else {
            assert!(
                include_str!("table.rs") == expected(),
                "table.rs is out of date; its header contains the command that regenerates it"
            );
        }
    }
}
