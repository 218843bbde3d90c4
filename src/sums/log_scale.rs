//! Places of positive numbers on a scale that is even below some s and logarithmic above it, so
//! that bins of equal width on it serve laws over many decades.
//!
//! The bits of a positive floating-point number, exponent and mantissa, rise with it, by 2^52 in
//! each octave and evenly within one. The place of d is therefore
//!
//! ```text
//! u(d) = (bits(d + s) - bits(s))/2^52
//! ```

/// The bits of one octave.
const OCTAVE: f64 = (1u64 << 52) as f64;

/// The scale ends this many octaves above s. Its end is the place of all greater numbers.
pub(crate) const OCTAVES: u64 = 128;

/// The scale of some s, a power of two, so that octaves of d + s begin at whole places.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct LogScale {
    even_below: f64,
    limit: f64,
}

impl LogScale {
    /// A scale that is even below about this number.
    pub fn new(even_below: f64) -> Self {
        // The number stays far from both ends of the number range.
        let (smallest, largest) = (2f64.powi(-800), 2f64.powi(800));
        let even_below = if even_below > 0.0 {
            even_below.clamp(smallest, largest)
        } else {
            1.0
        };
        let even_below = f64::from_bits(even_below.to_bits() & (0x7ff << 52));
        LogScale {
            even_below,
            limit: f64::from_bits(even_below.to_bits() + (OCTAVES << 52)),
        }
    }

    /// The place of a number; it rises with the number. Numbers that are not positive have the
    /// place zero, and those that are not finite have none.
    #[inline]
    pub fn place(&self, number: f64) -> f64 {
        if !number.is_finite() {
            return f64::NAN;
        }
        let shifted = (number.max(0.0) + self.even_below).min(self.limit);
        (shifted.to_bits() - self.even_below.to_bits()) as f64 / OCTAVE
    }

    /// The number at a place.
    pub fn number(&self, place: f64) -> f64 {
        f64::from_bits(self.even_below.to_bits() + (place * OCTAVE) as u64) - self.even_below
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        /// d + s is rounded once, and beyond 2 places u is rounded, too, to 53 bits.
        #[test]
        fn the_number_at_the_place_of_a_number_is_that_number(
            number in prop_oneof![0.0..1e3f64, 0.0..1e-6f64, 0.0..1e10f64],
            scale in prop_oneof![Just(1e-8), Just(0.3), Just(7.0)],
            more in 1.0..2.0f64,
        ) {
            let scale = LogScale::new(scale);
            let place = scale.place(number);
            let ulp = 128.0 * f64::EPSILON * (number + scale.even_below);
            prop_assert!((scale.number(place) - number).abs() <= ulp);
            prop_assert!(scale.place(more * number) >= place);
            prop_assert!((scale.place(2.0 * number + scale.even_below) - place - 1.0).abs() < 1e-12);
        }
    }

    #[test]
    fn absurd_numbers_have_places_within_the_scale() {
        for of in [0.0, f64::NAN, 1e-320, 1e308] {
            let scale = LogScale::new(of);
            assert_eq!(
                (
                    scale.place(0.0),
                    scale.place(-1.0),
                    scale.place(scale.even_below)
                ),
                (0.0, 0.0, 1.0),
                "{of}"
            );
            assert!(
                scale.place(f64::MAX) <= OCTAVES as f64 && scale.number(OCTAVES as f64).is_finite(),
                "{of}"
            );
        }
        assert!(LogScale::new(1.0).place(f64::INFINITY).is_nan());
    }
}
