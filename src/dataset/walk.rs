//! One walk over the contents of a data set, in the order of writing. A walk writes a data set or
//! reads one back, so that each variable is named once.

use super::form::AttributeValue;
use super::layout::{Described, WithInterval};
use super::{
    Attribute, Dataset, Element, Source, read_attribute, read_or_empty, read_sized, read_variable,
};
use crate::stats::{Dimension, Units};
use crate::sums::Ends;

/// A walk that writes leaves the values as they are, and one that reads replaces them.
pub enum Walk<'a> {
    /// It writes this data set.
    Writing(&'a mut Dataset),
    /// It reads from here.
    Reading(&'a dyn Source),
}

/// The error of a walk that reads. A walk that writes does not fail.
pub type Walked = Result<(), String>;

impl Walk<'_> {
    /// An attribute of the data set.
    pub fn attribute<T: AttributeValue>(&mut self, name: &str, value: &mut T) -> Walked {
        match self {
            Walk::Writing(to) => value
                .attribute()
                .into_iter()
                .for_each(|value| to.set_attribute(name, value)),
            Walk::Reading(from) => *value = read_attribute(*from, name)?,
        }
        Ok(())
    }

    /// An attribute that is not read back, because it is constant or follows from other things.
    pub fn derived_attribute(&mut self, name: &str, value: impl Into<Attribute>) {
        if let Walk::Writing(to) = self {
            to.set_attribute(name, value);
        }
    }

    /// A variable. Reading fails if it is absent although its dimensions exist.
    pub fn variable<T: Element>(&mut self, variable: &Described, values: &mut Vec<T>) -> Walked {
        match self {
            Walk::Writing(to) => to.write(variable, &*values),
            Walk::Reading(from) => *values = read_or_empty(*from, variable)?,
        }
        Ok(())
    }

    /// A variable that must have this number of values.
    pub fn sized<T: Element>(
        &mut self,
        variable: &Described,
        values: &mut Vec<T>,
        length: usize,
    ) -> Walked {
        match self {
            Walk::Writing(to) => to.write(variable, &*values),
            Walk::Reading(from) => *values = read_sized(*from, variable, length)?,
        }
        Ok(())
    }

    /// A variable with one value.
    pub fn scalar<T: Element>(&mut self, variable: &Described, value: &mut T) -> Walked {
        match self {
            Walk::Writing(to) => to.write(variable, std::slice::from_ref(&*value)),
            Walk::Reading(from) => match read_variable(*from, variable)?.as_slice() {
                [one] => *value = T::clone(one),
                values => {
                    return Err(format!(
                        "{} has {} values, not one",
                        variable.name,
                        values.len()
                    ));
                }
            },
        }
        Ok(())
    }

    /// A variable that is not read back.
    pub fn derived<T: Element>(&mut self, variable: &Described, values: &[T]) {
        if let Walk::Writing(to) = self {
            to.write(variable, values);
        }
    }

    /// Units of these dimensions, as texts, which are not read back.
    pub fn units(&mut self, variable: &Described, dimensions: impl Iterator<Item = Dimension>) {
        if let Walk::Writing(to) = self {
            to.write_units(variable, dimensions);
        }
    }

    /// An optional value. It is read if `first`, its first variable, is present.
    pub fn present<'a, T: Default>(
        &mut self,
        first: &Described,
        value: &'a mut Option<T>,
    ) -> Option<&'a mut T> {
        if let Walk::Reading(from) = self {
            *value = from.has(first.name).then(T::default);
        }
        value.as_mut()
    }

    /// Fail unless the data read are valid.
    pub fn check(&self, is_right: bool, cause: impl FnOnce() -> String) -> Walked {
        if is_right || matches!(self, Walk::Writing(_)) {
            Ok(())
        } else {
            Err(cause())
        }
    }

    /// The values of a curve with their intervals.
    pub(super) fn curve(
        &mut self,
        of: &WithInterval,
        values: &mut Vec<f64>,
        ends: &mut Ends,
    ) -> Walked {
        self.variable(&of.value, values)?;
        let mut interval = [&ends.low[..], &ends.high].concat();
        self.variable(&of.interval, &mut interval)?;
        let high = interval.split_off(interval.len() / 2);
        *ends = Ends {
            low: interval,
            high,
        };
        Ok(())
    }

    /// A number with its interval.
    pub(super) fn number(
        &mut self,
        of: &WithInterval,
        number: &mut f64,
        ends: &mut [f64; 2],
    ) -> Walked {
        self.scalar(&of.value, number)?;
        let mut interval = ends.to_vec();
        self.sized(&of.interval, &mut interval, ends.len())?;
        ends.copy_from_slice(&interval);
        Ok(())
    }
}

impl Dataset {
    /// A data set with everything that a walk goes over.
    pub fn written(units: &Units, walk: impl FnOnce(&mut Walk) -> Walked) -> Self {
        let mut dataset = Dataset::new(units);
        dataset.write_by(walk);
        dataset
    }

    /// Add what a walk writes; writing does not fail.
    pub fn write_by(&mut self, walk: impl FnOnce(&mut Walk) -> Walked) {
        let done = walk(&mut Walk::Writing(self));
        debug_assert_eq!(done, Ok(()));
    }
}
