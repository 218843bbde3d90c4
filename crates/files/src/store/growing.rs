//! Variables that grow together along one dimension, written in whole chunks.
//!
//! A block of 256 paths is far smaller than a chunk. If it were appended directly, the same chunk
//! would be rewritten many times, so rows wait in memory until they fill one.

use super::read_back::Sum;
use super::variable::{Growth, OpenFile};
use crate::dataset::rows::RowAxis;
use crate::dataset::{Column, Dataset, Entry, layout};
use hdf5::{H5Type, Result};
use ndarray::{ArrayView1, ArrayView2, s};

/// One growing variable.
#[derive(Debug)]
struct GrowingVariable {
    /// The variable, with the values that wait to be written.
    entry: Entry,
    dataset: hdf5::Dataset,
    /// Number of values in a row.
    width: usize,
    /// All values, written or waiting.
    sum: Sum,
}

/// A growing dimension with all its variables.
#[derive(Debug)]
pub(super) struct GrowingTable {
    pub along: RowAxis,
    /// The dataset of the dimension itself, where no variable is its coordinate.
    bare_dimension: Option<hdf5::Dataset>,
    columns: Vec<GrowingVariable>,
    /// Number of rows in a chunk.
    chunk: usize,
    /// Number of rows in the file.
    written: usize,
    /// Number of rows that wait in memory.
    pending: usize,
}

/// The variables of a data set along this dimension.
fn of_table(along: RowAxis, dataset: &Dataset) -> impl Iterator<Item = &Entry> {
    dataset
        .entries
        .iter()
        .filter(move |entry| RowAxis::of(entry) == Some(along))
}

impl GrowingTable {
    /// Create the variables of an empty data set that grow along a dimension; none if there are
    /// none. The first variable is the coordinate of the dimension; only the dimension of events
    /// has no coordinate and gets a bare dimension instead.
    pub(super) fn define(
        place: &mut OpenFile,
        along: RowAxis,
        empty: &Dataset,
        growth: Growth,
    ) -> Result<Option<GrowingTable>> {
        if of_table(along, empty).next().is_none() {
            return Ok(None);
        }
        let bare_dimension = (along == RowAxis::Event)
            .then(|| place.define_bare(layout::EVENT.name, growth))
            .transpose()?;
        let define = |entry: &Entry| -> Result<GrowingVariable> {
            let dataset = place.define_growing(entry, growth)?;
            let width = dataset.shape().iter().skip(1).product();
            Ok(GrowingVariable {
                entry: entry.clone(),
                dataset,
                width,
                sum: Sum::of(entry.column.values().kind()),
            })
        };
        let columns = of_table(along, empty).map(define).collect::<Result<_>>()?;
        Ok(Some(GrowingTable {
            along,
            bare_dimension,
            columns,
            chunk: growth.rows,
            written: 0,
            pending: 0,
        }))
    }

    /// Add rows, with the variables in the order given to `define`, and write every chunk that is
    /// now full.
    pub(super) fn push(&mut self, rows: &Dataset) -> Result<()> {
        let new: Vec<&Entry> = of_table(self.along, rows).collect();
        let Some(first) = new.first() else {
            return Ok(());
        };
        if !self
            .columns
            .iter()
            .map(|column| &column.entry.name)
            .eq(new.iter().map(|entry| &entry.name))
        {
            return Err("a block has different variables from the file".into());
        }
        let more = first.column.len() / self.columns[0].width;
        for (
            column,
            Entry {
                name,
                column: values,
                ..
            },
        ) in self.columns.iter_mut().zip(new)
        {
            let expected = more * column.width;
            if values.len() != expected {
                return Err(format!("{name} has {} values, not {expected}", values.len()).into());
            }
            column.entry.column.extend(values.values());
            column.sum.add(values.values());
        }
        self.pending += more;
        let full = (self.written + self.pending) / self.chunk * self.chunk;
        self.write_to(full)
    }

    /// Write all rows that wait, including a last incomplete chunk. Returns the variables, without
    /// values, and the sums of all their values.
    pub(super) fn write_all(&mut self) -> Result<impl Iterator<Item = (Entry, Sum)>> {
        self.write_to(self.written + self.pending)?;
        Ok(self
            .columns
            .iter()
            .map(|column| (column.entry.clone(), column.sum)))
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
    fn write(&mut self, start: usize, end: usize) -> Result<()> {
        let (dataset, width) = (&self.dataset, self.width);
        match &mut self.entry.column {
            Column::F64(values) => write_rows(dataset, width, values, start, end),
            Column::U64(values) => write_rows(dataset, width, values, start, end),
            Column::U32(values) => write_rows(dataset, width, values, start, end),
            Column::I8(values) => write_rows(dataset, width, values, start, end),
            Column::U8(values) => write_rows(dataset, width, values, start, end),
            Column::Text(_) => Err("text is not stored per path".into()),
        }
    }
}

/// Write the first waiting rows to rows `start..end` of the file, and remove them from the waiting
/// ones.
fn write_rows<T: H5Type>(
    dataset: &hdf5::Dataset,
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
        dataset.write_slice(
            ArrayView2::from_shape((rows, width), values)?,
            s![start..end, ..],
        )?;
    }
    waiting.drain(..rows * width);
    Ok(())
}
