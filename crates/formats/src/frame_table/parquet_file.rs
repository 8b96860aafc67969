//! Writing the table as a Parquet file.

use std::{path::Path, sync::Arc};

use parquet::{
    basic::{Compression, LogicalType, Repetition, Type as PhysicalType},
    data_type::{BoolType, ByteArray, ByteArrayType, DataType, DoubleType, Int64Type},
    errors::ParquetError,
    file::{
        properties::WriterProperties,
        writer::{SerializedColumnWriter, SerializedFileWriter},
    },
    schema::types::{Type, TypePtr},
};
use reality_sim_core::sequence::{one_line, write_atomically};

use super::{table::FrameTable, values::Values};
use crate::model_error::ModelError;

impl FrameTable {
    /// Writes the table as a Parquet file with one group of rows. Fails if the file cannot be written.
    pub fn write_parquet(&self, path: &Path) -> Result<(), ModelError> {
        let fail = |error: ParquetError| {
            ModelError::of_table(path, format!("cannot be written ({}): report this", one_line(&error)))
        };
        let bytes = self.parquet().map_err(fail)?;
        Ok(write_atomically(path, &bytes)?)
    }

    fn parquet(&self) -> Result<Vec<u8>, ParquetError> {
        let properties = WriterProperties::builder().set_compression(Compression::SNAPPY).build();
        let mut bytes = Vec::new();
        let mut writer = SerializedFileWriter::new(&mut bytes, self.schema()?, Arc::new(properties))?;
        let mut group = writer.next_row_group()?;
        for column in &self.columns {
            let Some(column_writer) = group.next_column()? else { break };
            write_column(column_writer, &column.values)?;
        }
        group.close()?;
        writer.close()?;
        Ok(bytes)
    }

    fn schema(&self) -> Result<TypePtr, ParquetError> {
        let field = |(name, values): (&str, &Values)| {
            let (kind, logical) = match values {
                Values::Numbers(_) => (PhysicalType::DOUBLE, None),
                Values::Counts(_) => (PhysicalType::INT64, None),
                Values::Flags(_) => (PhysicalType::BOOLEAN, None),
                Values::Texts(_) => (PhysicalType::BYTE_ARRAY, Some(LogicalType::String)),
            };
            let builder = Type::primitive_type_builder(name, kind).with_repetition(Repetition::OPTIONAL);
            builder.with_logical_type(logical).build().map(Arc::new)
        };
        let fields = self.columns.iter().map(|column| field((&column.name, &column.values)));
        let fields = fields.collect::<Result<Vec<_>, _>>()?;
        Type::group_type_builder("frames").with_fields(fields).build().map(Arc::new)
    }
}

fn write_column(mut writer: SerializedColumnWriter<'_>, values: &Values) -> Result<(), ParquetError> {
    match values {
        Values::Numbers(values) => write_values::<DoubleType, _>(&mut writer, values, |value| *value)?,
        Values::Counts(values) => write_values::<Int64Type, _>(&mut writer, values, |value| *value)?,
        Values::Flags(values) => write_values::<BoolType, _>(&mut writer, values, |value| *value)?,
        Values::Texts(values) => {
            write_values::<ByteArrayType, _>(&mut writer, values, |text| ByteArray::from(text.as_str()))?;
        }
    }
    writer.close()
}

/// Writes the values that are there, and for every row whether there is one.
fn write_values<Kind: DataType, Value>(
    writer: &mut SerializedColumnWriter<'_>,
    values: &[Option<Value>],
    stored: impl Fn(&Value) -> Kind::T,
) -> Result<(), ParquetError> {
    let levels: Vec<i16> = values.iter().map(|value| i16::from(value.is_some())).collect();
    let there: Vec<Kind::T> = values.iter().flatten().map(stored).collect();
    writer.typed::<Kind>().write_batch(&there, Some(&levels), None).map(drop)
}
