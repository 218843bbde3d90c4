//! One walk over everything that a data set holds, in the order in which it is written. A walk
//! writes to a destination or reads from a source, so that each variable is named once.

use super::form::AttributeValue;
use super::layout::{Described, WithInterval};
use super::{Attribute, ColumnView, Destination, Element, Source, read_attribute, read_or_empty, read_scalar};
use crate::sums::Ends;

/// What is done with each part of a data set. A walk that writes leaves the values as they are, and
/// one that reads replaces them.
pub(crate) trait Walk {
    /// The error of the walk.
    type Error;

    /// An attribute of the data set.
    fn attribute<T: AttributeValue>(&mut self, name: &str, value: &mut T) -> Result<(), Self::Error>;

    /// An attribute that is not read back, because it is constant or follows from other things.
    fn derived_attribute(&mut self, name: &str, value: impl Into<Attribute>) -> Result<(), Self::Error>;

    /// A variable. Reading fails if it is absent although its dimensions are there.
    fn variable<T: Element>(&mut self, variable: &Described, values: &mut Vec<T>) -> Result<(), Self::Error>;

    /// A variable with one value.
    fn scalar<T: Element>(&mut self, variable: &Described, value: &mut T) -> Result<(), Self::Error>;

    /// A variable that is not read back.
    fn derived<'a>(&mut self, variable: &Described, values: impl Into<ColumnView<'a>>) -> Result<(), Self::Error>;

    /// The value of something that may be absent, if it is there. It is read if `first`, its first
    /// variable, is there.
    fn present<'a, T: Default>(&mut self, first: &Described, value: &'a mut Option<T>) -> Option<&'a mut T>;

    /// Fail because what was read is wrong. A walk that writes has read nothing and does not fail.
    fn refuse(&mut self, cause: String) -> Result<(), Self::Error>;

    /// Fail unless what was read is right.
    fn check(&mut self, is_right: bool, cause: impl FnOnce() -> String) -> Result<(), Self::Error> {
        if is_right { Ok(()) } else { self.refuse(cause()) }
    }

    /// A variable that must have so many values.
    fn along<T: Element>(
        &mut self,
        variable: &Described,
        values: &mut Vec<T>,
        length: usize,
    ) -> Result<(), Self::Error> {
        self.variable(variable, values)?;
        self.check(values.len() == length, || format!("{} has {} values, not {length}", variable.name, values.len()))
    }

    /// The same; the refusal does not say how many there are.
    fn sized<T: Element>(
        &mut self,
        variable: &Described,
        values: &mut Vec<T>,
        length: usize,
    ) -> Result<(), Self::Error> {
        self.variable(variable, values)?;
        self.check(values.len() == length, || format!("{} has another size", variable.name))
    }

    /// The values of a curve with the ends of their intervals.
    fn curve<T: Element>(
        &mut self,
        WithInterval { value, low, high }: &WithInterval,
        values: &mut Vec<T>,
        ends: &mut Ends,
    ) -> Result<(), Self::Error> {
        self.variable(value, values)?;
        self.variable(low, &mut ends.low)?;
        self.variable(high, &mut ends.high)
    }

    /// A number with the ends of its interval.
    fn number<T: Element>(
        &mut self,
        of: &WithInterval,
        number: &mut T,
        ends: &mut [f64; 2],
    ) -> Result<(), Self::Error> {
        self.scalar(&of.value, number)?;
        self.scalar(&of.low, &mut ends[0])?;
        self.scalar(&of.high, &mut ends[1])
    }
}

/// Writes.
impl<D: Destination> Walk for D {
    type Error = D::Error;

    fn attribute<T: AttributeValue>(&mut self, name: &str, value: &mut T) -> Result<(), D::Error> {
        value.attribute().map_or(Ok(()), |attribute| self.set_attribute(name, attribute))
    }

    fn derived_attribute(&mut self, name: &str, value: impl Into<Attribute>) -> Result<(), D::Error> {
        self.set_attribute(name, value)
    }

    fn variable<T: Element>(&mut self, variable: &Described, values: &mut Vec<T>) -> Result<(), D::Error> {
        self.write_variable(variable, &*values)
    }

    fn scalar<T: Element>(&mut self, variable: &Described, value: &mut T) -> Result<(), D::Error> {
        self.write_variable(variable, std::slice::from_ref(&*value))
    }

    fn derived<'a>(&mut self, variable: &Described, values: impl Into<ColumnView<'a>>) -> Result<(), D::Error> {
        self.write_variable(variable, values)
    }

    fn present<'a, T: Default>(&mut self, _: &Described, value: &'a mut Option<T>) -> Option<&'a mut T> {
        value.as_mut()
    }

    fn refuse(&mut self, _: String) -> Result<(), D::Error> {
        Ok(())
    }
}

/// A walk that reads from a source.
pub(crate) struct Reading<'a, S>(pub &'a S);

impl<S: Source> Walk for Reading<'_, S> {
    type Error = S::Error;

    fn attribute<T: AttributeValue>(&mut self, name: &str, value: &mut T) -> Result<(), S::Error> {
        *value = read_attribute(self.0, name)?;
        Ok(())
    }

    fn derived_attribute(&mut self, _: &str, _: impl Into<Attribute>) -> Result<(), S::Error> {
        Ok(())
    }

    fn variable<T: Element>(&mut self, variable: &Described, values: &mut Vec<T>) -> Result<(), S::Error> {
        *values = read_or_empty(self.0, variable)?;
        Ok(())
    }

    fn scalar<T: Element>(&mut self, variable: &Described, value: &mut T) -> Result<(), S::Error> {
        *value = read_scalar(self.0, variable)?;
        Ok(())
    }

    fn derived<'a>(&mut self, _: &Described, _: impl Into<ColumnView<'a>>) -> Result<(), S::Error> {
        Ok(())
    }

    fn present<'a, T: Default>(&mut self, first: &Described, value: &'a mut Option<T>) -> Option<&'a mut T> {
        *value = self.0.has(first.name).then(T::default);
        value.as_mut()
    }

    fn refuse(&mut self, cause: String) -> Result<(), S::Error> {
        Err(cause.into())
    }
}
