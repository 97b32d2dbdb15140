//! Tables as Parquet files.

use std::error::Error;
use std::fs::{self, File};
use std::path::Path;
use std::sync::Arc;

use parquet::data_type::{ByteArray, ByteArrayType, DoubleType, FloatType, Int64Type};
use parquet::file::metadata::KeyValue;
use parquet::file::properties::WriterProperties;
use parquet::file::writer::SerializedFileWriter;
use parquet::schema::parser::parse_message_type;

/// Values of a column.
pub(crate) enum Column {
    Integers(Vec<i64>),
    Floats(Vec<f32>),
    Doubles(Vec<f64>),
    Texts(Vec<String>),
    /// Numbers of all rows, and how many a row has.
    Vectors(Vec<f32>, usize),
    /// Lists of one text.
    TextLists(Vec<String>),
}

impl Column {
    /// Returns the column in the language of Parquet's schemas.
    fn schema(&self, name: &str) -> String {
        let list =
            |element| format!("required group {name} (list) {{ repeated group list {{ required {element}; }} }}");
        match self {
            Self::Integers(_) => format!("required int64 {name};"),
            Self::Floats(_) => format!("required float {name};"),
            Self::Doubles(_) => format!("required double {name};"),
            Self::Texts(_) => format!("required binary {name} (string);"),
            Self::Vectors(..) => list("float element"),
            Self::TextLists(_) => list("binary element (string)"),
        }
    }
}

/// Writes a table with an entry of metadata.
pub(crate) fn write_table(
    path: &Path,
    columns: &[(&str, Column)],
    metadata: Option<(&str, String)>,
) -> Result<(), Box<dyn Error>> {
    fs::create_dir_all(path.parent().ok_or("a table has a folder")?)?;
    let schema: String = columns.iter().map(|(name, column)| column.schema(name)).collect();
    let schema = Arc::new(parse_message_type(&format!("message schema {{ {schema} }}"))?);
    let metadata = metadata.map(|(key, value)| vec![KeyValue::new(key.to_owned(), value)]);
    let properties = WriterProperties::builder().set_key_value_metadata(metadata).build();
    let mut writer = SerializedFileWriter::new(File::create(path)?, schema, Arc::new(properties))?;
    let mut rows = writer.next_row_group()?;
    for (_, column) in columns {
        let mut out = rows.next_column()?.ok_or("the schema has all columns")?;
        let texts = |texts: &[String]| texts.iter().map(|text| ByteArray::from(&**text)).collect::<Vec<_>>();
        // The first element of a list begins a row, and has the repetition level zero.
        let levels = |count: usize, width: usize| {
            let repetitions = (0..count).map(|index| i16::from(!index.is_multiple_of(width))).collect::<Vec<_>>();
            (vec![1; count], repetitions)
        };
        match column {
            Column::Integers(values) => out.typed::<Int64Type>().write_batch(values, None, None)?,
            Column::Floats(values) => out.typed::<FloatType>().write_batch(values, None, None)?,
            Column::Doubles(values) => out.typed::<DoubleType>().write_batch(values, None, None)?,
            Column::Texts(values) => out.typed::<ByteArrayType>().write_batch(&texts(values), None, None)?,
            Column::Vectors(values, width) => {
                let (definitions, repetitions) = levels(values.len(), *width);
                out.typed::<FloatType>().write_batch(values, Some(&definitions), Some(&repetitions))?
            }
            Column::TextLists(values) => {
                let (definitions, repetitions) = levels(values.len(), 1);
                out.typed::<ByteArrayType>().write_batch(&texts(values), Some(&definitions), Some(&repetitions))?
            }
        };
        out.close()?;
    }
    rows.close()?;
    writer.close()?;
    Ok(())
}
