//! Variables that grow together along one dimension, written in whole chunks.
//!
//! A block of 256 paths is far smaller than a chunk. Appending it directly would rewrite the same chunk over and
//! over, so rows wait in memory until they fill one.

use super::layout::Variable;
use super::variable::{Element, Growth, Place};
use hdf5::{Dataset, Result};
use ndarray::{ArrayView1, ArrayView2, s};

/// Rows of one variable, one after the other.
#[derive(Clone, Copy, Debug)]
pub(super) enum Values<'a> {
    F64(&'a [f64]),
    U64(&'a [u64]),
    U32(&'a [u32]),
    I8(&'a [i8]),
}

/// What waits to be written.
#[derive(Debug)]
enum Pending {
    F64(Vec<f64>),
    U64(Vec<u64>),
    U32(Vec<u32>),
    I8(Vec<i8>),
}

/// One growing variable.
#[derive(Debug)]
struct Column {
    name: &'static str,
    dataset: Dataset,
    /// Values in a row.
    width: usize,
    pending: Pending,
}

/// A growing dimension with all its variables.
#[derive(Debug)]
pub(super) struct Table {
    /// The dimension itself, where it is not a variable.
    bare_dimension: Option<Dataset>,
    columns: Vec<Column>,
    /// Rows in a chunk.
    chunk: usize,
    /// Rows in the file.
    written: usize,
    /// Rows in memory.
    pending: usize,
}

impl Table {
    /// Make the variables, which are empty for now; the first one carries the dimension.
    pub(super) fn define(place: &Place, variables: &[(&Variable, Values)], growth: Growth) -> Result<Table> {
        let columns = variables.iter().map(|(variable, values)| Column::define(place, variable, *values, growth));
        Ok(Table {
            bare_dimension: None,
            columns: columns.collect::<Result<_>>()?,
            chunk: growth.rows,
            written: 0,
            pending: 0,
        })
    }

    /// The same along a dimension that is not a variable itself.
    pub(super) fn define_along(
        place: &Place,
        dimension: &Variable,
        variables: &[(&Variable, Values)],
        growth: Growth,
    ) -> Result<Table> {
        let bare_dimension = Some(place.define_growing::<u32>(dimension, growth)?);
        Ok(Table { bare_dimension, ..Table::define(place, variables, growth)? })
    }

    /// Add rows, in the order of the variables given to `define`, and write every chunk that has become full.
    pub(super) fn push(&mut self, rows: usize, values: &[(&Variable, Values)]) -> Result<()> {
        if !self.columns.iter().map(|column| column.name).eq(values.iter().map(|(variable, _)| variable.name)) {
            return Err("a block holds other variables than the file records".into());
        }
        for (column, (variable, values)) in self.columns.iter_mut().zip(values) {
            let expected = rows * column.width;
            if values.len() != expected {
                return Err(format!("{} has {} values, not {expected}", variable.name, values.len()).into());
            }
            column.pending.extend(*values);
        }
        self.pending += rows;
        let full = (self.written + self.pending) / self.chunk * self.chunk;
        self.write_to(full)
    }

    /// Write everything, a last incomplete chunk included.
    pub(super) fn write_all(&mut self) -> Result<()> {
        self.write_to(self.written + self.pending)
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

impl Column {
    fn define(place: &Place, variable: &Variable, values: Values, growth: Growth) -> Result<Column> {
        let (dataset, pending) = match values {
            Values::F64(_) => (place.define_growing::<f64>(variable, growth)?, Pending::F64(Vec::new())),
            Values::U64(_) => (place.define_growing::<u64>(variable, growth)?, Pending::U64(Vec::new())),
            Values::U32(_) => (place.define_growing::<u32>(variable, growth)?, Pending::U32(Vec::new())),
            Values::I8(_) => (place.define_growing::<i8>(variable, growth)?, Pending::I8(Vec::new())),
        };
        let width = dataset.shape().iter().skip(1).product();
        Ok(Column { name: variable.name, dataset, width, pending })
    }

    fn write(&mut self, start: usize, end: usize) -> Result<()> {
        match &mut self.pending {
            Pending::F64(values) => write_rows(&self.dataset, self.width, values, start, end),
            Pending::U64(values) => write_rows(&self.dataset, self.width, values, start, end),
            Pending::U32(values) => write_rows(&self.dataset, self.width, values, start, end),
            Pending::I8(values) => write_rows(&self.dataset, self.width, values, start, end),
        }
    }
}

/// Move the first rows that wait into rows `start..end` of the file.
fn write_rows<T: Element>(
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

impl Values<'_> {
    fn len(&self) -> usize {
        match self {
            Values::F64(values) => values.len(),
            Values::U64(values) => values.len(),
            Values::U32(values) => values.len(),
            Values::I8(values) => values.len(),
        }
    }
}

impl Pending {
    /// The kinds agree: `push` has compared the names, and a variable has one kind.
    fn extend(&mut self, values: Values) {
        match (self, values) {
            (Pending::F64(pending), Values::F64(values)) => pending.extend_from_slice(values),
            (Pending::U64(pending), Values::U64(values)) => pending.extend_from_slice(values),
            (Pending::U32(pending), Values::U32(values)) => pending.extend_from_slice(values),
            (Pending::I8(pending), Values::I8(values)) => pending.extend_from_slice(values),
            (pending, values) => unreachable!("{values:?} for a column of {pending:?}"),
        }
    }
}
