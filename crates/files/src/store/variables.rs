//! A netCDF variable in HDF5: a dataset with attributes, and a coordinate attached to each of its
//! axes.

use super::errors::cause;
use super::scale::{attach_scale, make_scale};
use super::written::Written;
use crate::saved::checksum;
use hdf5::types::{FixedAscii, FixedUnicode, IntSize, TypeDescriptor, VarLenAscii, VarLenUnicode};
use hdf5::{
    Container, Dataset, DatasetBuilderEmpty, Error, Extent, File, H5Type, Location, Result,
};
use ndarray::{ArrayView1, ArrayView2, IxDyn, s};
use std::collections::BTreeMap;
use std::ops::Range;
use std::path::Path;
use std::str::FromStr;
use stickslip::dataset::layout::{BARE_DIMENSION, Described};
use stickslip::dataset::rows::RowAxis;
use stickslip::dataset::{self, Attribute, Column, ColumnView, ElementType, Entry, Source};

/// How a growing variable is cut into chunks.
#[derive(Clone, Copy, Debug)]
pub(super) struct Growth {
    /// Number of rows in a chunk.
    pub rows: usize,
    /// Number of values of one row in a chunk; 1 if a row is a single value.
    pub columns: usize,
}

/// An HDF5 file that netCDF variables are written to.
#[derive(Debug)]
pub(super) struct OpenFile {
    /// The coordinates that variables have been attached to. They are kept open, because most
    /// variables share a few. They come first, so that they are closed before the file.
    coordinates: BTreeMap<String, Dataset>,
    /// The file; all variables are in its root group.
    pub file: File,
    /// Everything that was written so far.
    pub written: Written,
}

impl OpenFile {
    /// A place for variables in a file.
    pub fn new(file: File) -> Self {
        OpenFile {
            coordinates: BTreeMap::new(),
            file,
            written: Written::default(),
        }
    }

    /// Write a data set, without the rows of single paths. Attributes that are there already get
    /// the new values.
    pub fn write(&mut self, dataset: dataset::Dataset) -> Result<()> {
        for (name, value) in dataset.attributes {
            let is_there = self.written.dataset.attribute(&name).is_some();
            write_attribute(&self.file, &name, &value, is_there)?;
            self.written.dataset.set_attribute(&name, value);
        }
        for entry in dataset
            .entries
            .into_iter()
            .filter(|entry| RowAxis::of(entry).is_none())
        {
            let shape = match entry.is_coordinate() {
                true => vec![entry.column.len()],
                false => self.lengths(&entry.axes)?,
            };
            if shape.iter().product::<usize>() != entry.column.len() {
                return Err(format!(
                    "{} has {} values for shape {shape:?}",
                    entry.name,
                    entry.column.len()
                )
                .into());
            }
            let made = self.create(&entry, |builder| builder.shape(shape))?;
            write_values(&made, entry.column.values(), None)?;
            self.written.dataset.entries.push(entry);
        }
        Ok(())
    }

    /// Create a variable that grows along its first axis, without rows.
    pub fn define_growing(&mut self, entry: &Entry, growth: Growth) -> Result<Dataset> {
        let others = self.lengths(&entry.axes[1..])?;
        let mut chunk = vec![growth.columns; entry.axes.len()];
        chunk[0] = growth.rows;
        let shape: Vec<Extent> = [Extent::resizable(0)]
            .into_iter()
            .chain(others.into_iter().map(Extent::fixed))
            .collect();
        // The data are not compressed: random values shrink by a third at most, and deflate writes
        // 30 MB/s, which is less than two threads produce.
        self.create(entry, |builder| builder.chunk(chunk).shape(shape))
    }

    /// Create a dimension that grows and has no variable.
    pub fn define_bare(&mut self, name: &str, growth: Growth) -> Result<Dataset> {
        let builder = self.file.new_dataset::<u32>().chunk([growth.rows]);
        let made = builder.shape([Extent::resizable(0)]).create(name)?;
        make_scale(&made, BARE_DIMENSION)?;
        Ok(made)
    }

    /// The lengths of axes, which must be in the file.
    fn lengths(&mut self, axes: &[String]) -> Result<Vec<usize>> {
        axes.iter()
            .map(|axis| Ok(self.coordinate(axis)?.size()))
            .collect()
    }

    fn coordinate(&mut self, axis: &str) -> Result<Dataset> {
        if let Some(open) = self.coordinates.get(axis) {
            return Ok(open.clone());
        }
        if !self.file.link_exists(axis) {
            return Err(format!("{axis} is not in the file").into());
        }
        let opened = self.file.dataset(axis)?;
        self.coordinates.insert(axis.to_owned(), opened.clone());
        Ok(opened)
    }

    /// Create a variable with its attributes, and attach the coordinates of its axes.
    fn create(
        &mut self,
        entry: &Entry,
        shaped: impl FnOnce(DatasetBuilderEmpty) -> hdf5::DatasetBuilderEmptyShape,
    ) -> Result<Dataset> {
        let is_coordinate = entry.is_coordinate();
        let builder = match entry.column.values() {
            // The CF conventions allow no missing values in a coordinate.
            ColumnView::F64(_) if is_coordinate => self.file.new_dataset::<f64>(),
            ColumnView::F64(_) => self.file.new_dataset::<f64>().fill_value(f64::NAN),
            ColumnView::U64(_) => self.file.new_dataset::<u64>(),
            ColumnView::U32(_) => self.file.new_dataset::<u32>(),
            ColumnView::I8(_) => self.file.new_dataset::<i8>(),
            ColumnView::U8(_) => self.file.new_dataset::<u8>(),
            ColumnView::Text(_) => self.file.new_dataset::<VarLenUnicode>(),
        };
        let made = shaped(builder).create(entry.name.as_str())?;
        for (name, value) in &entry.attributes {
            write_attribute(&made, name, value, false)?;
        }
        if is_coordinate {
            make_scale(&made, &entry.name)?;
            return Ok(made);
        }
        if let ColumnView::F64(_) = entry.column.values() {
            write_scalar(&made, "_FillValue", &f64::NAN, false)?;
        }
        for (index, axis) in entry.axes.iter().enumerate() {
            attach_scale(&made, index, &self.coordinate(axis)?)?;
        }
        Ok(made)
    }
}

/// Write all values of a variable, or the next rows of one that grows.
pub(super) fn write_values(
    to: &Dataset,
    values: ColumnView,
    rows: Option<&Range<usize>>,
) -> Result<()> {
    fn write<T: H5Type>(to: &Dataset, values: &[T], rows: Option<&Range<usize>>) -> Result<()> {
        let Some(Range { start, end }) = rows.cloned() else {
            return to.write_raw(values);
        };
        if to.ndim() == 1 {
            to.resize(end)?;
            return to.write_slice(ArrayView1::from(values), s![start..end]);
        }
        let width = values.len() / (end - start);
        to.resize((end, width))?;
        to.write_slice(
            ArrayView2::from_shape((end - start, width), values)?,
            s![start..end, ..],
        )
    }
    match values {
        ColumnView::F64(values) => write(to, values, rows),
        ColumnView::U64(values) => write(to, values, rows),
        ColumnView::U32(values) => write(to, values, rows),
        ColumnView::I8(values) => write(to, values, rows),
        ColumnView::U8(values) => write(to, values, rows),
        ColumnView::Text(texts) => {
            let texts = texts.iter().map(|words| text(words));
            write(to, &texts.collect::<Result<Vec<_>>>()?, rows)
        }
    }
}

/// Attributes by which HDF5 and netCDF-4 attach coordinates to variables.
const OF_LIBRARY: [&str; 8] = [
    "CLASS",
    "NAME",
    "DIMENSION_LIST",
    "REFERENCE_LIST",
    "_Netcdf4Dimid",
    "_Netcdf4Coordinates",
    "_NCProperties",
    "_nc3_strict",
];

/// The contents of a file.
pub(super) struct Contents(pub File);

impl std::ops::Deref for Contents {
    type Target = File;

    fn deref(&self) -> &File {
        &self.0
    }
}

/// Reads variables whose type and shape are those with which they are written.
impl Source for Contents {
    fn names(&self) -> Read<Vec<String>> {
        said(self.member_names())
    }

    fn has(&self, name: &str) -> bool {
        self.link_exists(name)
    }

    fn column(&self, variable: &Described, kind: ElementType) -> Read<Option<Column>> {
        let read = || {
            let dataset = shaped(self, variable)?;
            let length = dataset.shape().first().copied().unwrap_or(1);
            some_rows(variable.name, &dataset, kind, &(0..length))
        };
        said(self.link_exists(variable.name).then(read).transpose())
    }

    fn rows(&self, name: &str, kind: ElementType, rows: &Range<usize>) -> Read<Column> {
        let read = || {
            let dataset = self.dataset(name)?;
            match dataset.shape().first() {
                Some(&length) if length >= rows.end => some_rows(name, &dataset, kind, rows),
                _ => Err(format!("{name} is too short").into()),
            }
        };
        said(read())
    }

    fn length(&self, name: &str) -> Read<Option<usize>> {
        let length = |dataset: Dataset| dataset.shape().first().copied().unwrap_or(0);
        said(
            self.link_exists(name)
                .then(|| self.dataset(name).map(length))
                .transpose(),
        )
    }

    fn attribute(&self, variable: Option<&str>, name: &str) -> Read<Option<Attribute>> {
        of_location(self, variable, |location| read_attribute(location, name))
    }

    fn attributes(&self, variable: Option<&str>) -> Read<Vec<(String, Attribute)>> {
        of_location(self, variable, |location| {
            let own = location
                .attr_names()?
                .into_iter()
                .filter(|name| !OF_LIBRARY.contains(&name.as_str()));
            own.filter_map(|name| {
                Some(
                    read_attribute(location, &name)
                        .transpose()?
                        .map(|value| (name, value)),
                )
            })
            .collect()
        })
    }

    fn is_laid_out_anew(&self) -> bool {
        !matches!(checksum::is_there(Path::new(&self.filename())), Ok(true))
    }
}

type Read<T> = std::result::Result<T, String>;

/// The message of HDF5, in one line.
fn said<T>(read: Result<T>) -> Read<T> {
    read.map_err(|error| cause(&error))
}

/// Reads from the file, or from one of its variables.
fn of_location<T>(
    file: &File,
    variable: Option<&str>,
    read: impl FnOnce(&Location) -> Result<T>,
) -> Read<T> {
    said(match variable {
        None => read(file),
        Some(variable) => file.dataset(variable).and_then(|dataset| read(&dataset)),
    })
}

/// Write an attribute, or change its value if it exists.
fn write_scalar<T: H5Type>(
    location: &Location,
    name: &str,
    value: &T,
    is_there: bool,
) -> Result<()> {
    let attribute = if is_there {
        location.attr(name)?
    } else {
        location.new_attr::<T>().create(name)?
    };
    attribute.write_scalar(value)
}

fn write_attribute(
    location: &Location,
    name: &str,
    value: &Attribute,
    is_there: bool,
) -> Result<()> {
    match value {
        Attribute::Text(value) => write_scalar(location, name, &text(value)?, is_there),
        Attribute::Real(value) => write_scalar(location, name, value, is_there),
        Attribute::Count(value) => write_scalar(location, name, value, is_there),
        Attribute::Flags(values) => location
            .new_attr_builder()
            .with_data(values)
            .create(name)
            .map(drop),
    }
}

/// Read an attribute; none if there is no such attribute. Other programs write a number as an array
/// of one number, and a text with a fixed length.
fn read_attribute(location: &Location, name: &str) -> Result<Option<Attribute>> {
    let Ok(attribute) = location.attr(name) else {
        return Ok(None);
    };
    let kind = attribute.dtype()?.to_descriptor()?;
    if let TypeDescriptor::Integer(IntSize::U1) = kind {
        return Ok(Some(Attribute::Flags(attribute.read_raw()?)));
    }
    if attribute.size() != 1 {
        return Err(format!("{name} has {} values", attribute.size()).into());
    }
    Ok(Some(match kind {
        TypeDescriptor::Integer(_) => {
            let value = attribute.read_raw::<i64>()?[0];
            Attribute::Count(
                value
                    .try_into()
                    .map_err(|_| Error::from(format!("{name} is {value}")))?,
            )
        }
        TypeDescriptor::Unsigned(_) => Attribute::Count(attribute.read_raw::<u64>()?[0]),
        TypeDescriptor::Float(_) => Attribute::Real(attribute.read_raw::<f64>()?[0]),
        _ => Attribute::Text(read_texts(&attribute)?.swap_remove(0)),
    }))
}

/// The texts of an attribute or a variable, of variable or of fixed length.
fn read_texts(of: &Container) -> Result<Vec<String>> {
    /// The longest text with a fixed length is a scenario of 1 MiB.
    const LONGEST: usize = 1 << 20;
    macro_rules! fixed {
        ($Text:ident, $bytes:expr) => {
            match $bytes {
                ..=64 => read_as::<$Text<64>>(of),
                ..=1024 => read_as::<$Text<1024>>(of),
                ..=16384 => read_as::<$Text<16384>>(of),
                ..=LONGEST => read_as::<$Text<LONGEST>>(of),
                bytes => Err(format!("a text of {bytes} bytes").into()),
            }
        };
    }
    match of.dtype()?.to_descriptor()? {
        TypeDescriptor::VarLenUnicode => read_as::<VarLenUnicode>(of),
        TypeDescriptor::VarLenAscii => read_as::<VarLenAscii>(of),
        TypeDescriptor::FixedUnicode(bytes) => fixed!(FixedUnicode, bytes),
        TypeDescriptor::FixedAscii(bytes) => fixed!(FixedAscii, bytes),
        other => Err(format!("a text is of type {other}").into()),
    }
}

/// The texts, as values of this type.
fn read_as<T: H5Type + AsRef<str>>(of: &Container) -> Result<Vec<String>> {
    of.read_raw::<T>()?
        .iter()
        .map(|text| readable(text.as_ref()))
        .collect()
}

/// The text of a file as UTF-8. The file may contain any bytes, so this is checked.
fn readable(text: &str) -> Result<String> {
    std::str::from_utf8(text.as_bytes())
        .map(str::to_owned)
        .map_err(|_| Error::from("a text is not UTF-8"))
}

/// Text in the form that HDF5 stores.
fn text(value: &str) -> Result<VarLenUnicode> {
    VarLenUnicode::from_str(value).map_err(|_| Error::from("a text holds a NUL character"))
}

/// Read some rows of a variable as values of this type, row by row.
fn some_rows(
    name: &str,
    dataset: &Dataset,
    kind: ElementType,
    rows: &Range<usize>,
) -> Result<Column> {
    Ok(match kind {
        ElementType::F64 => Column::F64(slice(name, dataset, rows)?),
        ElementType::U64 => Column::U64(slice(name, dataset, rows)?),
        ElementType::U32 => Column::U32(slice(name, dataset, rows)?),
        ElementType::I8 => Column::I8(slice(name, dataset, rows)?),
        ElementType::U8 => Column::U8(slice(name, dataset, rows)?),
        ElementType::Text => Column::Text(read_texts(dataset)?),
    })
}

fn slice<T: H5Type + Clone>(name: &str, dataset: &Dataset, rows: &Range<usize>) -> Result<Vec<T>> {
    if !dataset.dtype()?.is::<T>() {
        return Err(format!("{name} has a different type from when it was written").into());
    }
    let some = rows.clone();
    match dataset.shape()[..] {
        // A variable that is read as a whole needs no selection, which is much faster.
        [] => dataset.read_raw(),
        [length, ..] if *rows == (0..length) => dataset.read_raw(),
        [_] => Ok(dataset.read_slice_1d::<T, _>(s![some])?.to_vec()),
        [_, _] => Ok(dataset
            .read_slice_2d::<T, _>(s![some, ..])?
            .into_iter()
            .collect()),
        _ => Ok(dataset
            .read_slice::<T, _, IxDyn>(s![some, .., ..])?
            .into_iter()
            .collect()),
    }
}

/// A variable that must be there, with the lengths of its axes.
fn shaped(file: &File, variable: &Described) -> Result<Dataset> {
    let name = variable.name;
    if !file.link_exists(name) {
        return Err(format!("{name} is missing").into());
    }
    let dataset = file.dataset(name)?;
    let shape = dataset.shape();
    let axes = variable.axes.iter();
    if let Some(axis) = axes.clone().find(|axis| !file.link_exists(axis)) {
        return Err(format!("{axis} is missing, the coordinate of {name}").into());
    }
    let has_length = |(axis, length): (&&str, &usize)| {
        file.dataset(axis).is_ok_and(|axis| axis.size() == *length)
    };
    if shape.len() != variable.axes.len() || !axes.zip(&shape).all(has_length) {
        return Err(format!("the shape of {name} differs from its axes").into());
    }
    // A variable larger than its file is damaged, unless another program compressed it, by at most
    // a factor of a thousand.
    let bytes = (dataset.size() as u64).saturating_mul(dataset.dtype()?.size() as u64);
    let most = if dataset.filters().is_empty() {
        1
    } else {
        1032
    };
    if bytes > file.size().saturating_mul(most) {
        return Err(format!("{name} is larger than the file").into());
    }
    Ok(dataset)
}
