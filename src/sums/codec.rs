//! Sums and counts as bytes. A value that is read back has the bits of the value that was written,
//! except that all NaN are one: their sign depends on how the compiler arranges an operation.
//!
//! In this format a count is a variable-length integer, seven bits per byte. A real number is the
//! eight bytes of its bits. Both have the lowest bits first. A list is its length followed by its
//! entries. Reading fills a value that already exists and is empty ([`Codec::read`]), so that the
//! bytes are checked against the scenario. A list whose length differs from that of the existing
//! one is an error, and no memory is allocated for it.

/// The bytes are invalid.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("the data are truncated, or are not the sums of this scenario")]
pub struct Damaged;

/// Bytes that are read from the front.
#[derive(Clone, Debug)]
pub struct Reader<'a>(&'a [u8]);

impl<'a> Reader<'a> {
    /// A reader that starts at the first of these bytes.
    pub fn new(bytes: &'a [u8]) -> Self {
        Reader(bytes)
    }

    /// The next `n` bytes, or [`Damaged`] if fewer are left.
    pub fn take(&mut self, n: usize) -> Result<&'a [u8], Damaged> {
        let (taken, rest) = self.0.split_at_checked(n).ok_or(Damaged)?;
        self.0 = rest;
        Ok(taken)
    }

    /// The next value, of a type that fixes how many numbers it holds.
    pub fn value<T: Codec + Default>(&mut self) -> Result<T, Damaged> {
        let mut value = T::default();
        value.read(self).map(|()| value)
    }

    /// Number of bytes that are left.
    pub fn left(&self) -> usize {
        self.0.len()
    }

    /// The next count as the length of a list, or [`Damaged`] if it exceeds the number of remaining
    /// bytes, which no list can.
    pub fn length(&mut self) -> Result<usize, Damaged> {
        usize::try_from(self.value::<u64>()?)
            .ok()
            .filter(|length| *length <= self.left())
            .ok_or(Damaged)
    }
}

/// A value that can be written and read back without loss.
pub trait Codec {
    /// Append the value to `out`.
    fn write(&self, out: &mut Vec<u8>);

    /// Replace the value by the next one in the bytes. Where the scenario fixes the length of a
    /// list, the list in `self` must already have that length.
    fn read(&mut self, from: &mut Reader<'_>) -> Result<(), Damaged>;
}

impl Codec for u64 {
    fn write(&self, out: &mut Vec<u8>) {
        let mut rest = *self;
        while rest >= 0x80 {
            out.push(rest as u8 | 0x80);
            rest >>= 7;
        }
        out.push(rest as u8);
    }

    fn read(&mut self, from: &mut Reader<'_>) -> Result<(), Damaged> {
        *self = 0;
        for shift in (0..u64::BITS).step_by(7) {
            let byte = u64::from(from.take(1)?[0]);
            let bits = byte & 0x7f;
            if bits << shift >> shift != bits {
                return Err(Damaged);
            }
            *self |= bits << shift;
            if byte < 0x80 {
                return Ok(());
            }
        }
        Err(Damaged)
    }
}

impl Codec for f64 {
    fn write(&self, out: &mut Vec<u8>) {
        let one = if self.is_nan() { f64::NAN } else { *self };
        out.extend_from_slice(&one.to_bits().to_le_bytes());
    }

    fn read(&mut self, from: &mut Reader<'_>) -> Result<(), Damaged> {
        let bytes = from.take(8)?.try_into().map_err(|_| Damaged)?;
        *self = f64::from_bits(u64::from_le_bytes(bytes));
        Ok(())
    }
}

impl<T: Codec, const N: usize> Codec for [T; N] {
    fn write(&self, out: &mut Vec<u8>) {
        self.iter().for_each(|entry| entry.write(out));
    }

    fn read(&mut self, from: &mut Reader<'_>) -> Result<(), Damaged> {
        self.iter_mut().try_for_each(|entry| entry.read(from))
    }
}

/// A list whose length is fixed by the scenario.
impl<T: Codec> Codec for Vec<T> {
    fn write(&self, out: &mut Vec<u8>) {
        (self.len() as u64).write(out);
        self.iter().for_each(|entry| entry.write(out));
    }

    fn read(&mut self, from: &mut Reader<'_>) -> Result<(), Damaged> {
        if from.length()? != self.len() {
            return Err(Damaged);
        }
        self.iter_mut().try_for_each(|entry| entry.read(from))
    }
}

/// An optional part, depending on the scenario.
impl<T: Codec> Codec for Option<Box<T>> {
    fn write(&self, out: &mut Vec<u8>) {
        self.iter().for_each(|value| value.write(out));
    }

    fn read(&mut self, from: &mut Reader<'_>) -> Result<(), Damaged> {
        self.iter_mut().try_for_each(|value| value.read(from))
    }
}

/// Implement [`Codec`] for a struct, field by field in the given order.
macro_rules! codec_of_fields {
    ($type:ty { $($field:ident),* $(,)? } $(, $const:ident)?) => {
        impl $(<const $const: usize>)? $crate::sums::codec::Codec for $type {
            fn write(&self, out: &mut Vec<u8>) {
                $(self.$field.write(out);)*
            }

            fn read(
                &mut self,
                from: &mut $crate::sums::codec::Reader<'_>,
            ) -> Result<(), $crate::sums::codec::Damaged> {
                $(self.$field.read(from)?;)*
                Ok(())
            }
        }
    };
}
pub(crate) use codec_of_fields;

/// Implement [`Codec`] and [`super::Merge`] for a struct of sums, field by field in the given order.
macro_rules! sums_of_fields {
    ($type:ty { $($field:ident),* $(,)? } $(, $const:ident)?) => {
        $crate::sums::codec::codec_of_fields!($type { $($field),* } $(, $const)?);

        impl $(<const $const: usize>)? $crate::sums::Merge for $type {
            fn merge(&mut self, other: &Self) {
                $($crate::sums::Merge::merge(&mut self.$field, &other.$field);)*
            }
        }
    };
}
pub(crate) use sums_of_fields;

/// Declares sums, which are merged, written and read field by field.
macro_rules! sums {
    ($(#[$of_type:meta])* $type_visibility:vis struct $type:ident {
        $($(#[$of_field:meta])* $visibility:vis $field:ident: $of:ty,)*
    }) => {
        $(#[$of_type])*
        $type_visibility struct $type {
            $($(#[$of_field])* $visibility $field: $of,)*
        }

        $crate::sums::codec::sums_of_fields!($type { $($field),* });
    };
}
pub(crate) use sums;

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn read_back<T: Codec + Clone>(value: &T, mut blank: T) -> Result<T, Damaged> {
        let mut bytes = Vec::new();
        value.write(&mut bytes);
        let mut reader = Reader::new(&bytes);
        blank.read(&mut reader)?;
        assert_eq!(reader.left(), 0);
        Ok(blank)
    }

    proptest! {
        #[test]
        fn counts_and_reals_come_back_with_their_bits(n in any::<u64>(), bits in any::<u64>()) {
            prop_assert_eq!(read_back(&n, 0), Ok(n));
            let x = f64::from_bits(bits);
            let expected = if x.is_nan() { f64::NAN.to_bits() } else { bits };
            prop_assert_eq!(read_back(&x, 0.0).map(f64::to_bits), Ok(expected));
            prop_assert_eq!(read_back(&-f64::NAN, 0.0).map(f64::to_bits), Ok(f64::NAN.to_bits()));
        }

        #[test]
        fn bytes_cut_short_are_damage(n in any::<u64>(), x in any::<f64>(), cut in 0.0..1.0f64) {
            let mut bytes = Vec::new();
            (n, x).0.write(&mut bytes);
            x.write(&mut bytes);
            bytes.truncate((cut * bytes.len() as f64) as usize);
            let mut reader = Reader::new(&bytes);
            let (mut a, mut b) = (0_u64, 0.0_f64);
            prop_assert_eq!(a.read(&mut reader).and_then(|()| b.read(&mut reader)), Err(Damaged));
        }
    }

    #[test]
    fn a_list_of_another_length_is_damage() {
        assert_eq!(read_back(&vec![1_u64, 2], vec![0, 0]), Ok(vec![1, 2]));
        assert_eq!(read_back(&vec![1_u64, 2], vec![0]), Err(Damaged));
        assert_eq!(read_back(&vec![1_u64, 2], vec![0; 3]), Err(Damaged));
    }

    #[test]
    fn an_integer_beyond_64_bits_is_damage() {
        let mut n = 0_u64;
        assert_eq!(n.read(&mut Reader::new(&[0xff; 10])), Err(Damaged));
        assert_eq!(
            n.read(&mut Reader::new(&[
                0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0x02
            ])),
            Err(Damaged)
        );
        assert_eq!(
            n.read(&mut Reader::new(&[
                0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0x01
            ])),
            Ok(())
        );
        assert_eq!(n, u64::MAX);
    }
}
