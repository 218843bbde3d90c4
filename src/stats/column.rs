//! Columns of values, and the descriptions of variables: name, axes, unit and meaning.

use super::{Dimension, Units};
use crate::sums::{Damaged, Reader};
use std::fmt::Debug;

/// The unit of a variable; `label` gives its text.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Unit {
    /// The variable has no `units` attribute: flags, names, and numbers of different dimensions in
    /// one array.
    None,
    /// A product of units of the scenario.
    Of(Dimension),
    /// Seconds, whatever the unit of time of the scenario.
    Seconds,
}

/// Products of units by the names of their dimensions.
macro_rules! units {
    ($($dimension:ident)*) => {
        impl Unit {
            $(#[doc = concat!("The unit of [`Dimension::", stringify!($dimension), "`].")]
            pub const $dimension: Unit = Unit::Of(Dimension::$dimension);)*
        }
    };
}

units! { ONE TIME LENGTH FORCE TEMPERATURE VELOCITY AREA WORK }

impl Unit {
    /// The `units` attribute, if there is one.
    pub fn label(self, units: &Units) -> Option<String> {
        match self {
            Unit::None => None,
            Unit::Of(dimension) => Some(dimension.udunits(units)),
            Unit::Seconds => Some("s".to_owned()),
        }
    }
}

/// A variable whose description is constant.
pub type Variable = Described<'static>;

/// The description of one variable of a data set.
#[derive(Clone, Copy, Debug)]
pub struct Described<'a> {
    /// Name of the variable. A variable with the name of its only axis is the coordinate of that
    /// dimension.
    pub name: &'a str,
    /// Names of the dimensions, the slowest first.
    pub axes: &'a [&'a str],
    /// Unit of the values.
    pub unit: Unit,
    /// Meaning of the variable, in words that fit the axis of a plot.
    pub long_name: &'a str,
    /// Further CF attributes: name and text.
    pub attributes: &'a [(&'a str, &'a str)],
    /// The values that flags may have. The attribute `flag_meanings` names them.
    pub flags: &'a [i8],
}

impl<'a> Described<'a> {
    /// The same variable with these attributes.
    pub const fn with(mut self, attributes: &'a [(&'a str, &'a str)]) -> Described<'a> {
        self.attributes = attributes;
        self
    }

    /// The same variable along these axes, with these attributes.
    pub fn along<'b>(
        &self,
        axes: &'b [&'b str],
        attributes: &'b [(&'b str, &'b str)],
    ) -> Described<'b>
    where
        'a: 'b,
    {
        Described {
            axes,
            attributes,
            ..*self
        }
    }

    /// The same variable as one of flags, with these values and these attributes that name them.
    pub const fn flags(
        mut self,
        values: &'a [i8],
        meanings: &'a [(&'a str, &'a str)],
    ) -> Described<'a> {
        self.flags = values;
        self.with(meanings)
    }
}

/// A variable without further attributes.
pub const fn variable<'a>(
    name: &'a str,
    axes: &'a [&'a str],
    unit: Unit,
    long_name: &'a str,
) -> Described<'a> {
    Described {
        name,
        axes,
        unit,
        long_name,
        attributes: &[],
        flags: &[],
    }
}

/// The phrase with which netCDF-4 marks a dimension that has no variable. The ten characters at its
/// end hold a length that no reader uses.
pub const BARE_DIMENSION: &str = "This is a netCDF dimension but not a netCDF variable.         0";

/// Declares the types that the values of a variable may have: the enum `Kind` of their names, and
/// the values themselves, borrowed as `ColumnView` and owned as `Column`.
macro_rules! kinds {
    ($($kind:ident($type:ty), missing $missing:expr, same $same:expr, $meaning:literal;)*) => {
        /// Types of values.
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        pub enum ElementType {
            $(#[doc = $meaning] $kind,)*
        }

        /// Values of a variable, row by row, the last axis fastest.
        #[derive(Clone, Copy, Debug)]
        pub enum ColumnView<'a> {
            $(#[doc = $meaning] $kind(&'a [$type]),)*
        }

        /// Owned values of a variable, row by row, the last axis fastest.
        #[derive(Clone, Debug, PartialEq)]
        pub enum Column {
            $(#[doc = $meaning] $kind(Vec<$type>),)*
        }

        impl ColumnView<'_> {
            /// The first value that differs from a computed one.
            pub fn first_difference(self, computed: ColumnView) -> Option<FirstDifference> {
                match (self, computed) {
                    $((ColumnView::$kind(stored), ColumnView::$kind(computed)) => first(stored, computed, $same),)*
                    _ => Some((None, "of another type".into(), "there".into())),
                }
            }

            /// Number of values.
            pub fn len(&self) -> usize {
                match self {
                    $(ColumnView::$kind(values) => values.len(),)*
                }
            }

            /// Whether there are no values.
            pub fn is_empty(&self) -> bool {
                self.len() == 0
            }

            /// The type of the values.
            pub fn kind(&self) -> ElementType {
                match self {
                    $(ColumnView::$kind(_) => ElementType::$kind,)*
                }
            }

            /// A column with these values.
            pub fn to_column(self) -> Column {
                match self {
                    $(ColumnView::$kind(values) => Column::$kind(values.to_vec()),)*
                }
            }
        }

        impl Column {
            /// The values, borrowed.
            pub fn values(&self) -> ColumnView<'_> {
                match self {
                    $(Column::$kind(values) => ColumnView::$kind(values),)*
                }
            }

            /// Some of the values; none if there are fewer.
            pub fn slice(&self, range: std::ops::Range<usize>) -> Option<Column> {
                match self {
                    $(Column::$kind(values) => Some(Column::$kind(values.get(range)?.to_vec())),)*
                }
            }

            /// Add values of the type of this column.
            pub fn extend(&mut self, values: ColumnView) {
                match (self, values) {
                    $((Column::$kind(column), ColumnView::$kind(values)) => column.extend_from_slice(values),)*
                    (column, values) => unreachable!("{values:?} for a column of {column:?}"),
                }
            }
        }

        $(/// The values of a column of this type. A column of another type is returned.
        impl<'a> TryFrom<&'a Column> for &'a [$type] {
            type Error = &'a Column;

            fn try_from(column: &'a Column) -> Result<Self, &'a Column> {
                match column {
                    Column::$kind(values) => Ok(values),
                    other => Err(other),
                }
            }
        }

        impl Element for $type {
            const KIND: ElementType = ElementType::$kind;
            const MISSING: Self = $missing;

            fn values(values: &[Self]) -> ColumnView<'_> {
                ColumnView::$kind(values)
            }

            fn of(column: Column) -> Option<Vec<Self>> {
                match column {
                    Column::$kind(values) => Some(values),
                    _ => None,
                }
            }
        })*
    };
}

kinds! {
    F64(f64), missing f64::NAN, same is_same_real, "Real numbers.";
    U64(u64), missing 0, same u64::eq, "Counts and seeds.";
    U32(u32), missing 0, same u32::eq, "Small counts.";
    I8(i8), missing 0, same i8::eq, "Flags.";
    U8(u8), missing 0, same u8::eq, "Bytes.";
    Text(String), missing String::new(), same String::eq, "Names.";
}

/// A type that the values of a variable may have.
pub trait Element: Clone {
    /// Which type this is.
    const KIND: ElementType;
    /// The value that means "missing".
    const MISSING: Self;
    /// These values, tagged with their type.
    fn values(values: &[Self]) -> ColumnView<'_>;
    /// The values of a column; none if the column has another type.
    fn of(column: Column) -> Option<Vec<Self>>;
}

impl Column {
    /// Number of values.
    pub fn len(&self) -> usize {
        self.values().len()
    }

    /// Whether the column has no values.
    pub fn is_empty(&self) -> bool {
        self.values().is_empty()
    }
}

impl ColumnView<'_> {
    /// Append the bytes of the values to `out`. Texts end with a zero.
    pub fn write(self, out: &mut Vec<u8>) {
        match self {
            ColumnView::F64(values) => values
                .iter()
                .for_each(|value| out.extend(value.to_le_bytes())),
            ColumnView::U64(values) => values
                .iter()
                .for_each(|value| out.extend(value.to_le_bytes())),
            ColumnView::U32(values) => values
                .iter()
                .for_each(|value| out.extend(value.to_le_bytes())),
            ColumnView::I8(values) => values
                .iter()
                .for_each(|value| out.extend(value.to_le_bytes())),
            ColumnView::U8(values) => out.extend(values),
            ColumnView::Text(texts) => texts
                .iter()
                .for_each(|text| out.extend(text.bytes().chain([0]))),
        }
    }
}

/// The index of a difference, and the stored and the computed value as text.
pub type FirstDifference = (Option<usize>, String, String);

/// Reals are compared bit for bit, except that all NaN are equal, since NaN means a missing value.
fn is_same_real(a: &f64, b: &f64) -> bool {
    a.to_bits() == b.to_bits() || a.is_nan() && b.is_nan()
}

fn first<T: Debug>(
    stored: &[T],
    computed: &[T],
    is_same: impl Fn(&T, &T) -> bool,
) -> Option<FirstDifference> {
    if stored.len() != computed.len() {
        return Some((
            None,
            format!("one of {} values", stored.len()),
            format!("one of {}", computed.len()),
        ));
    }
    // `{:?}` gives enough digits to distinguish any two reals.
    let at = stored
        .iter()
        .zip(computed)
        .position(|(stored, computed)| !is_same(stored, computed))?;
    Some((
        Some(at),
        format!("{:?}", stored[at]),
        format!("{:?}", computed[at]),
    ))
}

impl ElementType {
    /// The number of bytes of a value. Texts have no fixed number.
    pub(crate) const fn size(self) -> usize {
        match self {
            ElementType::F64 | ElementType::U64 => 8,
            ElementType::U32 => 4,
            ElementType::I8 | ElementType::U8 => 1,
            ElementType::Text => 0,
        }
    }

    /// Read this number of values of this type that [`ColumnView::write`] wrote.
    pub fn read(self, length: usize, from: &mut Reader<'_>) -> Result<Column, Damaged> {
        let bytes = from.take(length.checked_mul(self.size()).ok_or(Damaged)?)?;
        Ok(match self {
            ElementType::F64 => Column::F64(numbers(bytes, f64::from_le_bytes)),
            ElementType::U64 => Column::U64(numbers(bytes, u64::from_le_bytes)),
            ElementType::U32 => Column::U32(numbers(bytes, u32::from_le_bytes)),
            ElementType::I8 => Column::I8(numbers(bytes, i8::from_le_bytes)),
            ElementType::U8 => Column::U8(bytes.to_vec()),
            ElementType::Text => return Err(Damaged),
        })
    }
}

fn numbers<T, const N: usize>(bytes: &[u8], of: fn([u8; N]) -> T) -> Vec<T> {
    bytes.as_chunks().0.iter().map(|bytes| of(*bytes)).collect()
}

/// A table of columns. Some of them have one value for each path and the others one for each row,
/// which is a path, an event or a time. The macro `columns` declares such tables.
pub trait Columns: Default {
    /// The values of a row.
    type Row;
    /// A row without data.
    const MISSING: Self::Row;
    /// Every column in the order of the table, with the type of its values.
    const VARIABLES: &'static [(Variable, ElementType)];

    /// The values of every column.
    fn views(&self) -> Vec<ColumnView<'_>>;

    /// Add a row.
    fn push(&mut self, row: Self::Row);

    /// Replace a row.
    fn set(&mut self, at: usize, row: Self::Row);

    /// Add the rows of another table.
    fn append(&mut self, other: &Self);

    /// The table with the columns that `read` returns, in its order. A column of another type is an
    /// error.
    fn read(
        read: impl FnMut(&Variable, ElementType) -> Result<Column, String>,
    ) -> Result<Self, String>;

    /// The columns with their values.
    fn columns(&self) -> impl Iterator<Item = (&'static Variable, ColumnView<'_>)> {
        Self::VARIABLES
            .iter()
            .map(|(variable, _)| variable)
            .zip(self.views())
    }

    /// The number of bytes of one value of every column along these axes.
    fn bytes_along(axes: &[&str]) -> usize {
        Self::VARIABLES
            .iter()
            .filter(|(variable, _)| variable.axes == axes)
            .map(|(_, kind)| kind.size())
            .sum()
    }
}

/// Take the values of a column out of it, if they have this type.
pub fn values_of<T: Element>(variable: &Described, column: Column) -> Result<Vec<T>, String> {
    T::of(column).ok_or_else(|| {
        format!(
            "{} has another type than it was written with",
            variable.name
        )
    })
}

/// Declares a table and its row: first the columns with one value for each path, then those with
/// one for each row. Each has its meaning for readers of the code, its name, its type, and its
/// description for readers of a data set.
macro_rules! columns {
    (
        $(#[$table_doc:meta])*
        $table:ident { $($(#[$head_doc:meta])* $head:ident: $head_type:ty = $head_variable:expr;)* }
        $(#[$row_doc:meta])*
        $row:ident { $($(#[$cell_doc:meta])* $cell:ident: $cell_type:ty = $cell_variable:expr;)* }
    ) => {
        $(#[$table_doc])*
        #[derive(Clone, Debug, Default, PartialEq)]
        pub struct $table {
            $($(#[$head_doc])* pub $head: Vec<$head_type>,)*
            $($(#[$cell_doc])* pub $cell: Vec<$cell_type>,)*
        }

        $(#[$row_doc])*
        pub struct $row {
            $(pub $cell: $cell_type,)*
        }

        impl $table {
            /// Whether another table has the same values. All NaN are equal, since NaN means a
            /// missing value.
            pub fn is_same(&self, other: &Self) -> bool {
                self.views().into_iter().zip(other.views()).all(|(own, other)| own.first_difference(other).is_none())
            }
        }

        impl Columns for $table {
            type Row = $row;
            const MISSING: $row = $row { $($cell: <$cell_type>::MISSING,)* };
            const VARIABLES: &'static [(Variable, ElementType)] = &[
                $(($head_variable, <$head_type>::KIND),)*
                $(($cell_variable, <$cell_type>::KIND),)*
            ];

            fn views(&self) -> Vec<ColumnView<'_>> {
                vec![$(Element::values(&self.$head),)* $(Element::values(&self.$cell),)*]
            }

            fn push(&mut self, row: $row) {
                $(self.$cell.push(row.$cell);)*
            }

            fn set(&mut self, at: usize, row: $row) {
                $(self.$cell[at] = row.$cell;)*
            }

            fn append(&mut self, other: &Self) {
                $(self.$head.extend_from_slice(&other.$head);)*
                $(self.$cell.extend_from_slice(&other.$cell);)*
            }

            fn read(
                mut read: impl FnMut(&Variable, ElementType) -> Result<Column, String>,
            ) -> Result<Self, String> {
                Ok($table {
                    $($head: values_of(&$head_variable, read(&$head_variable, <$head_type>::KIND)?)?,)*
                    $($cell: values_of(&$cell_variable, read(&$cell_variable, <$cell_type>::KIND)?)?,)*
                })
            }
        }
    };
}
pub(super) use columns;
