//! Variables that grow together along one dimension, written in whole chunks.
//!
//! A block of 256 paths is far smaller than a chunk. If it were appended directly, the same chunk
//! would be rewritten many times, so rows wait in memory until they fill one.

use super::ledger::{Ledger, Sum};
use super::variable::{Growth, OpenFile, Storable};
use crate::dataset::layout::{self, Variable};
use crate::dataset::rows::{RowAxis, RowTable};
use crate::dataset::{Column, ColumnView};
use hdf5::{Dataset, Result};
use ndarray::{ArrayView1, ArrayView2, s};

/// One growing variable.
#[derive(Debug)]
struct GrowingVariable {
    name: &'static str,
    dataset: Dataset,
    /// Number of values in a row.
    width: usize,
    /// Values that wait to be written.
    pending: Column,
    /// All values, written or waiting.
    sum: Sum,
}

/// A growing dimension with all its variables.
#[derive(Debug)]
pub(super) struct GrowingTable {
    /// The dataset of the dimension itself, where no variable is its coordinate.
    bare_dimension: Option<Dataset>,
    columns: Vec<GrowingVariable>,
    /// Number of rows in a chunk.
    chunk: usize,
    /// Number of rows in the file.
    written: usize,
    /// Number of rows that wait in memory.
    pending: usize,
}

impl GrowingTable {
    /// Create the variables with no rows. The first variable is the coordinate of the dimension;
    /// only the dimension of events has no coordinate and gets a bare dimension instead.
    pub(super) fn define(place: &mut OpenFile, table: &RowTable, growth: Growth) -> Result<GrowingTable> {
        let bare_dimension = match table.along {
            RowAxis::Event => Some(place.define_growing::<u32>(&layout::EVENT, growth)?),
            RowAxis::Path | RowAxis::Trajectory => None,
        };
        let mut define =
            |(variable, values): &(&Variable, ColumnView)| GrowingVariable::define(place, variable, *values, growth);
        let columns = table.variables.iter().map(&mut define).collect::<Result<_>>()?;
        Ok(GrowingTable { bare_dimension, columns, chunk: growth.rows, written: 0, pending: 0 })
    }

    /// Add rows, with the variables in the order given to `define`, and write every chunk that is
    /// now full.
    pub(super) fn push(&mut self, RowTable { rows, variables, .. }: &RowTable) -> Result<()> {
        if !self.columns.iter().map(|column| column.name).eq(variables.iter().map(|(variable, _)| variable.name)) {
            return Err("a block holds other variables than the file records".into());
        }
        for (column, (variable, values)) in self.columns.iter_mut().zip(*variables) {
            let expected = rows * column.width;
            if values.len() != expected {
                return Err(format!("{} has {} values, not {expected}", variable.name, values.len()).into());
            }
            column.pending.extend(*values);
            column.sum.add(*values);
        }
        self.pending += rows;
        let full = (self.written + self.pending) / self.chunk * self.chunk;
        self.write_to(full)
    }

    /// Write all rows that wait, including a last incomplete chunk, and note in `ledger` what was
    /// written in all.
    pub(super) fn write_all(&mut self, ledger: &mut Ledger) -> Result<()> {
        self.write_to(self.written + self.pending)?;
        for column in &self.columns {
            ledger.variable(column.name, column.sum);
        }
        Ok(())
    }

    fn write_to(&mut self, end: usize) -> Result<()> {
        if end <= self.written {
            return Ok(());
        }
        if let Some(dimension) = &self.bare_dimension {
            dimension.resize(end)?;
        }
        for column in &mut self.columns {
            column.write(self.written, end)?;
        }
        self.pending -= end - self.written;
        self.written = end;
        Ok(())
    }
}

impl GrowingVariable {
    fn define(
        place: &mut OpenFile,
        variable: &Variable,
        values: ColumnView,
        growth: Growth,
    ) -> Result<GrowingVariable> {
        let dataset = match values {
            ColumnView::F64(_) => place.define_growing::<f64>(variable, growth)?,
            ColumnView::U64(_) => place.define_growing::<u64>(variable, growth)?,
            ColumnView::U32(_) => place.define_growing::<u32>(variable, growth)?,
            ColumnView::I8(_) => place.define_growing::<i8>(variable, growth)?,
            ColumnView::U8(_) => place.define_growing::<u8>(variable, growth)?,
            ColumnView::Text(_) => return Err("no text is kept of single paths".into()),
        };
        let width = dataset.shape().iter().skip(1).product();
        let (pending, sum) = (values.empty_column(), Sum::of(values.kind()));
        Ok(GrowingVariable { name: variable.name, dataset, width, pending, sum })
    }

    fn write(&mut self, start: usize, end: usize) -> Result<()> {
        let (dataset, width) = (&self.dataset, self.width);
        match &mut self.pending {
            Column::F64(values) => write_rows(dataset, width, values, start, end),
            Column::U64(values) => write_rows(dataset, width, values, start, end),
            Column::U32(values) => write_rows(dataset, width, values, start, end),
            Column::I8(values) => write_rows(dataset, width, values, start, end),
            Column::U8(values) => write_rows(dataset, width, values, start, end),
            Column::Text(_) => Err("no text is kept of single paths".into()),
        }
    }
}

/// Write the first waiting rows to rows `start..end` of the file, and remove them from the waiting
/// ones.
fn write_rows<T: Storable>(
    dataset: &Dataset,
    width: usize,
    waiting: &mut Vec<T>,
    start: usize,
    end: usize,
) -> Result<()> {
    let rows = end - start;
    let values = &waiting[..rows * width];
    if dataset.ndim() == 1 {
        dataset.resize(end)?;
        dataset.write_slice(ArrayView1::from(values), s![start..end])?;
    } else {
        dataset.resize((end, width))?;
        dataset.write_slice(ArrayView2::from_shape((rows, width), values)?, s![start..end, ..])?;
    }
    waiting.drain(..rows * width);
    Ok(())
}
