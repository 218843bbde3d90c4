//! A netCDF variable in HDF5: a dataset with attributes, and a coordinate attached to each of its
//! axes.

use super::ledger::{Ledger, Sum};
use super::scale::{attach_scale, make_scale};
use crate::dataset::layout::{BARE_DIMENSION, Described};
use crate::dataset::{Attribute, Column, ColumnView, Destination, ElementType, Source, attributes_of};
use crate::stats::Units;
use hdf5::types::{FixedAscii, FixedUnicode, IntSize, TypeDescriptor, VarLenAscii, VarLenUnicode};
use hdf5::{Container, Dataset, Error, Extent, File, H5Type, Location, Result};
use std::cell::RefCell;
use std::collections::BTreeMap;
use std::str::FromStr;

/// How a growing variable is cut into chunks.
#[derive(Clone, Copy, Debug)]
pub(super) struct Growth {
    /// Number of rows in a chunk.
    pub rows: usize,
    /// Number of values of one row in a chunk; 1 if a row is a single value.
    pub columns: usize,
}

/// An HDF5 file as a destination for netCDF variables.
#[derive(Debug)]
pub(super) struct OpenFile {
    /// The coordinates that variables have been attached to. They are kept open, because most
    /// variables share a few. They come first, so that they are closed before the file.
    coordinates: RefCell<BTreeMap<String, Dataset>>,
    /// The file; all variables are in its root group.
    pub file: File,
    /// Labels of the units.
    pub units: Units,
    /// Everything that was written so far.
    pub ledger: Ledger,
}

impl OpenFile {
    /// A place for variables in a file.
    pub fn new(file: File, units: Units) -> Self {
        OpenFile { coordinates: RefCell::default(), file, units, ledger: Ledger::default() }
    }

    /// The coordinate of an axis; `None` if it is not in the file.
    fn coordinate(&self, axis: &str) -> Result<Option<Dataset>> {
        if let Some(open) = self.coordinates.borrow().get(axis) {
            return Ok(Some(open.clone()));
        }
        if !self.file.link_exists(axis) {
            return Ok(None);
        }
        let opened = self.file.dataset(axis)?;
        self.coordinates.borrow_mut().insert(axis.to_owned(), opened.clone());
        Ok(Some(opened))
    }

    /// The same for an axis that must be there.
    fn known_coordinate(&self, axis: &str) -> Result<Dataset> {
        self.coordinate(axis)?.ok_or_else(|| format!("{axis} is not in the file").into())
    }

    /// Write a variable whose size is known. An empty variable is left out together with its
    /// dimension, because readers take a dimension of length zero for an unlimited one.
    fn write<T: Storable>(&mut self, variable: &Described, values: &[T]) -> Result<()> {
        if values.is_empty() {
            return Ok(());
        }
        let shape = if variable.is_coordinate() {
            vec![values.len()]
        } else {
            self.shape_along_axes(variable)?.ok_or_else(|| format!("{} has values but no coordinate", variable.name))?
        };
        if shape.iter().product::<usize>() != values.len() {
            return Err(format!("{} has {} values for shape {shape:?}", variable.name, values.len()).into());
        }
        let dataset = T::builder(&self.file, variable).shape(shape).create(variable.name)?;
        self.describe::<T>(&dataset, variable)?;
        dataset.write_raw(values)
    }

    /// Create a variable that grows along its first axis, without rows.
    pub(super) fn define_growing<T: Storable>(&mut self, variable: &Described, growth: Growth) -> Result<Dataset> {
        let mut shape = vec![Extent::resizable(0)];
        let mut chunk = vec![growth.rows];
        if variable.axes.len() > 1 {
            for axis in &variable.axes[1..] {
                shape.push(Extent::fixed(self.known_coordinate(axis)?.size()));
            }
            chunk.push(growth.columns);
        }
        // The data are not compressed: random values shrink by a third at most, and deflate writes
        // 30 MB/s, which is less than two threads produce.
        let builder = T::builder(&self.file, variable).chunk(chunk);
        let dataset = builder.shape(shape).create(variable.name)?;
        self.describe::<T>(&dataset, variable)?;
        Ok(dataset)
    }

    /// The lengths of the axes; `None` if one of the axes is not in the file.
    fn shape_along_axes(&self, variable: &Described) -> Result<Option<Vec<usize>>> {
        let mut shape = Vec::new();
        for axis in variable.axes {
            let Some(coordinate) = self.coordinate(axis)? else { return Ok(None) };
            shape.push(coordinate.size());
        }
        Ok(Some(shape))
    }

    /// Write the attributes of a variable, and attach the coordinates of its axes.
    fn describe<T: Storable>(&mut self, dataset: &Dataset, variable: &Described) -> Result<()> {
        if variable.is_bare_dimension() {
            return make_scale(dataset, BARE_DIMENSION);
        }
        for (name, value) in attributes_of(variable, &self.units) {
            new_attribute(dataset, name, &value)?;
            self.ledger.attribute(variable.name, name, value);
        }
        if variable.is_coordinate() {
            return make_scale(dataset, variable.name);
        }
        T::mark_missing(dataset)?;
        for (index, axis) in variable.axes.iter().enumerate() {
            attach_scale(dataset, index, &self.known_coordinate(axis)?)?;
        }
        Ok(())
    }
}

impl Destination for OpenFile {
    type Error = Error;

    fn units(&self) -> &Units {
        &self.units
    }

    fn write_variable<'a>(&mut self, variable: &Described, values: impl Into<ColumnView<'a>>) -> Result<()> {
        let values = values.into();
        let mut sum = Sum::of(values.kind());
        sum.add(values);
        if values.len() > 0 {
            self.ledger.variable(variable.name, sum);
        }
        match values {
            ColumnView::F64(values) => self.write(variable, values),
            ColumnView::U64(values) => self.write(variable, values),
            ColumnView::U32(values) => self.write(variable, values),
            ColumnView::I8(values) => self.write(variable, values),
            ColumnView::U8(values) => self.write(variable, values),
            ColumnView::Text(texts) => {
                self.write(variable, &texts.iter().map(|name| text(name)).collect::<Result<Vec<_>>>()?)
            }
        }
    }

    fn set_attribute(&mut self, name: &str, value: impl Into<Attribute>) -> Result<()> {
        let value = value.into();
        match self.file.attr_names()?.iter().any(|there| there == name) {
            true => replace_attribute(&self.file, name, &value)?,
            false => new_attribute(&self.file, name, &value)?,
        }
        self.ledger.attribute("", name, value);
        Ok(())
    }
}

impl Source for File {
    type Error = Error;

    fn column(&self, variable: &Described, kind: ElementType) -> Result<Option<Column>> {
        if !self.link_exists(variable.name) {
            return Ok(None);
        }
        Ok(Some(match kind {
            ElementType::F64 => Column::F64(read_variable(self, variable)?),
            ElementType::U64 => Column::U64(read_variable(self, variable)?),
            ElementType::U32 => Column::U32(read_variable(self, variable)?),
            ElementType::I8 => Column::I8(read_variable(self, variable)?),
            ElementType::U8 => Column::U8(read_variable(self, variable)?),
            ElementType::Text => Column::Text(read_texts(&*shaped(self, variable)?)?),
        }))
    }

    fn has(&self, name: &str) -> bool {
        self.link_exists(name)
    }

    fn attribute(&self, variable: Option<&str>, name: &str) -> Result<Option<Attribute>> {
        match variable {
            None => read_attribute(self, name),
            Some(variable) => read_attribute(&*self.dataset(variable)?, name),
        }
    }
}

/// A type of values that can be stored.
pub(super) trait Storable: H5Type + Clone {
    /// Start a dataset of this type.
    fn builder(file: &File, _variable: &Described) -> hdf5::DatasetBuilderEmpty {
        file.new_dataset::<Self>()
    }

    /// Mark the value that means "missing", if the type has one.
    fn mark_missing(_dataset: &Dataset) -> Result<()> {
        Ok(())
    }
}

impl Storable for u64 {}
impl Storable for u32 {}
impl Storable for i8 {}
impl Storable for u8 {}
impl Storable for VarLenUnicode {}
impl Storable for f64 {
    fn builder(file: &File, variable: &Described) -> hdf5::DatasetBuilderEmpty {
        let builder = file.new_dataset::<f64>();
        // The CF conventions allow no missing values in a coordinate.
        if variable.is_coordinate() { builder } else { builder.fill_value(f64::NAN) }
    }

    fn mark_missing(dataset: &Dataset) -> Result<()> {
        write_scalar(dataset, "_FillValue", &f64::NAN)
    }
}

/// Write a new attribute.
fn write_scalar<T: H5Type>(location: &Location, name: &str, value: &T) -> Result<()> {
    location.new_attr::<T>().create(name)?.write_scalar(value)
}

/// Write a new attribute.
fn new_attribute(location: &Location, name: &str, value: &Attribute) -> Result<()> {
    match value {
        Attribute::Text(value) => write_scalar(location, name, &text(value)?),
        Attribute::Real(value) => write_scalar(location, name, value),
        Attribute::Count(value) => write_scalar(location, name, value),
        Attribute::Flags(values) => location.new_attr_builder().with_data(values).create(name).map(drop),
    }
}

/// Write another value to an attribute that exists.
fn replace_attribute(location: &Location, name: &str, value: &Attribute) -> Result<()> {
    let attribute = location.attr(name)?;
    match value {
        Attribute::Text(value) => attribute.write_scalar(&text(value)?),
        Attribute::Real(value) => attribute.write_scalar(value),
        Attribute::Count(value) => attribute.write_scalar(value),
        Attribute::Flags(values) => attribute.write_raw(values),
    }
}

/// Read an attribute; none if there is no such attribute. Other programs write a number as an array
/// of one number, and a text with a fixed length.
pub(super) fn read_attribute(location: &Location, name: &str) -> Result<Option<Attribute>> {
    let Ok(attribute) = location.attr(name) else { return Ok(None) };
    let one =
        |values: usize| if values == 1 { Ok(()) } else { Err(Error::from(format!("{name} has {values} values"))) };
    let read = match attribute.dtype()?.to_descriptor()? {
        TypeDescriptor::Integer(IntSize::U1) => Attribute::Flags(attribute.read_raw()?),
        kind @ (TypeDescriptor::Integer(_) | TypeDescriptor::Unsigned(_)) => {
            one(attribute.size())?;
            match kind {
                TypeDescriptor::Integer(_) => {
                    let value = attribute.read_raw::<i64>()?[0];
                    Attribute::Count(value.try_into().map_err(|_| Error::from(format!("{name} is {value}")))?)
                }
                _ => Attribute::Count(attribute.read_raw::<u64>()?[0]),
            }
        }
        TypeDescriptor::Float(_) => {
            one(attribute.size())?;
            Attribute::Real(attribute.read_raw::<f64>()?[0])
        }
        _ => {
            let mut texts = read_texts(&attribute)?;
            one(texts.len())?;
            Attribute::Text(texts.swap_remove(0))
        }
    };
    Ok(Some(read))
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
    of.read_raw::<T>()?.iter().map(|text| readable(text.as_ref())).collect()
}

/// The text of a file as UTF-8. The file may hold any bytes, so this is checked.
pub(super) fn readable(text: &str) -> Result<String> {
    std::str::from_utf8(text.as_bytes()).map(str::to_owned).map_err(|_| Error::from("a text is not UTF-8"))
}

/// Text in the form that HDF5 stores.
fn text(value: &str) -> Result<VarLenUnicode> {
    VarLenUnicode::from_str(value).map_err(|_| Error::from("a text holds a NUL character"))
}

/// Read a variable, which must be there. Its type and its shape are checked before anything is
/// read.
pub(super) fn read_variable<T: H5Type>(file: &File, variable: &Described) -> Result<Vec<T>> {
    let dataset = shaped(file, variable)?;
    if !dataset.dtype()?.is::<T>() {
        return Err(format!("{} has another type than it was written with", variable.name).into());
    }
    dataset.read_raw()
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
    let has_length = |(axis, length): (&&str, &usize)| file.dataset(axis).is_ok_and(|axis| axis.size() == *length);
    if shape.len() != variable.axes.len() || !axes.zip(&shape).all(has_length) {
        return Err(format!("{name} has another shape than its axes").into());
    }
    // A variable that claims to be larger than its file is damaged, unless another program
    // compressed it, and then by a factor of a thousand at most.
    let bytes = (dataset.size() as u64).saturating_mul(dataset.dtype()?.size() as u64);
    let most = if dataset.filters().is_empty() { 1 } else { 1032 };
    if bytes > file.size().saturating_mul(most) {
        return Err(format!("{name} is larger than the file").into());
    }
    Ok(dataset)
}
