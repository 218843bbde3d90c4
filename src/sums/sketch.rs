//! The distribution of a quantity in bounded memory. Its contents are a function of the values
//! alone.
//!
//! Up to `Shape::values` values, besides those at the centre, are kept one by one. More than these
//! are counted in bins on a lattice that adapts itself to the values ([`Bins`]). Merging is exact,
//! whatever the order and the grouping; quantiles of parts are never averaged.

use super::bins::{Bins, Shape};
use super::codec::{Codec, Damaged, Reader};
use super::dyadic::{List, Ruler, coarsen, counted, union};
use super::merge::Merge;
use super::ordered::{Binned, Kept, Ordered};
use std::borrow::Cow;

/// Values of one quantity.
#[derive(Clone, Debug)]
pub(crate) struct Sketch {
    shape: Shape,
    /// Number of values at the centre, without those that the bins count.
    at_centre: u64,
    /// Values that are not in the bins, in the order in which they came. As long as there are no
    /// bins, these are all values that are not counted in `at_centre`.
    pending: Vec<f64>,
    bins: Option<Box<Bins>>,
}

/// Added values are counted at once if there is at least one of them per this many bins. Fewer
/// values wait for others, because counting may read all bins.
const WORTHWHILE: usize = 16;

impl Sketch {
    /// A sketch of no values.
    pub fn empty(shape: Shape) -> Self {
        Sketch {
            shape,
            at_centre: 0,
            pending: Vec::new(),
            bins: None,
        }
    }

    /// Add one value. A value that is not finite is left out.
    #[inline]
    pub fn push(&mut self, value: f64) {
        self.pending.push(value);
        if self.pending.len() > self.shape.values {
            self.count_pending();
        }
    }

    /// Add these values. Values that are not finite are left out.
    pub fn extend(&mut self, values: &[f64]) {
        self.extend_by_parts(&[values]);
    }

    /// Add the values of all these parts. Values that are not finite are left out.
    pub fn extend_by_parts(&mut self, parts: &[&[f64]]) {
        let number: usize = parts.iter().map(|part| part.len()).sum();
        match &mut self.bins {
            Some(bins) if WORTHWHILE * number >= self.shape.bins => {
                return count(bins, parts, &self.shape);
            }
            Some(_) => parts
                .iter()
                .for_each(|part| self.pending.extend_from_slice(part)),
            None => {
                let (before, centre) = (self.pending.len(), self.shape.centre);
                for part in parts {
                    // Mostly no value is at the centre, and then the part is copied as a whole.
                    if part.contains(&centre) {
                        self.pending
                            .extend(part.iter().filter(|value| **value != centre));
                    } else {
                        self.pending.extend_from_slice(part);
                    }
                }
                self.at_centre += (number + before - self.pending.len()) as u64;
            }
        }
        if self.pending.len() > self.shape.values {
            self.count_pending();
        }
    }

    /// The values in order.
    pub fn ordered(&self) -> Ordered {
        let normalised = self.normalised();
        match &normalised.bins {
            None => {
                let Sketch {
                    shape,
                    at_centre,
                    pending,
                    ..
                } = normalised.into_owned();
                Ordered::Kept(Kept::of(pending, shape.centre, at_centre))
            }
            Some(bins) => Ordered::Binned(Binned::of(bins, self.shape)),
        }
    }

    /// The finest level at which the values can be counted.
    pub fn finest_level(&self) -> i32 {
        self.normalised()
            .bins
            .as_ref()
            .map_or(i32::MIN, |bins| bins.level)
    }

    /// The counts at a level that is not finer than [`Sketch::finest_level`].
    pub fn counts(&self, level: i32) -> List {
        let Sketch {
            shape,
            at_centre,
            pending,
            bins,
        } = &*self.normalised();
        if let Some(bins) = bins {
            return coarsen(&bins.list(), level.saturating_sub(bins.level).max(0) as u32);
        }
        let ruler = Ruler::new(shape.centre, level);
        let values = placed(&[pending], shape);
        let indices = values
            .as_ref()
            .unwrap_or(pending)
            .iter()
            .map(|value| ruler.index(*value) as i64);
        let centre = [(0, *at_centre)];
        union(
            &centre[..usize::from(*at_centre > 0)],
            &counted(indices.collect()),
        )
    }

    /// The same values in their only form, except for the order of those that are kept one by one.
    pub fn normalised(&self) -> Cow<'_, Sketch> {
        let is_waiting = !self.pending.is_empty() || self.at_centre > 0;
        if !is_waiting && self.bins.as_ref().is_some_and(|bins| bins.is_normalised()) {
            return Cow::Borrowed(self);
        }
        let mut normalised = self.clone();
        normalised.settle();
        Cow::Owned(normalised)
    }

    /// Counts the waiting values. This does not change results; it makes later requests cheaper,
    /// which sort the values.
    pub fn settle(&mut self) {
        self.count_pending();
        self.pending.sort_unstable_by(f64::total_cmp);
        if let Some(bins) = &mut self.bins {
            bins.count_at_centre(std::mem::take(&mut self.at_centre), &self.shape);
            bins.normalise(self.shape.bins, false);
        }
    }

    fn count_pending(&mut self) {
        let mut pending = std::mem::take(&mut self.pending);
        if let Some(bins) = &mut self.bins {
            count(bins, &[&pending], &self.shape);
            pending.clear();
            self.pending = pending;
            return;
        }
        let all = pending.len();
        pending.retain(|value| *value != self.shape.centre);
        self.at_centre += (all - pending.len()) as u64;
        pending.retain(|value| (value - self.shape.centre).is_finite());
        if pending.len() > self.shape.values {
            let places = placed(&[&pending], &self.shape);
            self.bins = Some(Box::new(Bins::of(
                places.as_deref().unwrap_or(&pending),
                &self.shape,
            )));
        } else {
            self.pending = pending;
        }
    }
}

/// The places of values, if they are counted on a scale.
fn placed(parts: &[&[f64]], shape: &Shape) -> Option<Vec<f64>> {
    shape.scale.map(|scale| {
        parts
            .iter()
            .copied()
            .flatten()
            .map(|value| scale.place(*value))
            .collect()
    })
}

/// Count values in bins.
fn count(bins: &mut Bins, parts: &[&[f64]], shape: &Shape) {
    match placed(parts, shape) {
        Some(places) => bins.count(&[&places], shape),
        None => bins.count(parts, shape),
    }
}

impl Merge for Sketch {
    fn merge(&mut self, other: &Sketch) {
        match (&mut self.bins, &other.bins) {
            (Some(mine), Some(theirs)) => mine.merge(theirs, &self.shape),
            (None, Some(theirs)) => self.bins = Some(theirs.clone()),
            (_, None) => {}
        }
        self.at_centre += other.at_centre;
        self.extend(&other.pending);
    }
}

/// Two sketches are equal if they contain the same values, up to their resolution.
impl PartialEq for Sketch {
    fn eq(&self, other: &Self) -> bool {
        self.shape == other.shape && self.ordered() == other.ordered()
    }
}

/// The bytes begin with whether there are bins. If so, the bins follow. If not, the number of
/// values at the centre follows, and then the other values in ascending order.
impl Codec for Sketch {
    fn write(&self, out: &mut Vec<u8>) {
        let normalised = self.normalised();
        u64::from(normalised.bins.is_some()).write(out);
        match &normalised.bins {
            None => {
                let Sketch {
                    mut pending,
                    at_centre,
                    ..
                } = normalised.into_owned();
                pending.sort_unstable_by(f64::total_cmp);
                at_centre.write(out);
                pending.write(out);
            }
            Some(bins) => bins.write(out),
        }
    }

    fn read(&mut self, from: &mut Reader<'_>) -> Result<(), Damaged> {
        *self = Sketch::empty(self.shape);
        match from.value::<u64>()? {
            0 => {
                self.at_centre = from.value()?;
                let length = from.clone().length()?;
                if length > self.shape.values {
                    return Err(Damaged);
                }
                self.pending = vec![0.0; length];
                self.pending.read(from)?;
                let is_valid = |value: &f64| {
                    *value != self.shape.centre && (value - self.shape.centre).is_finite()
                };
                if self.pending.iter().all(is_valid) && self.pending.is_sorted() {
                    Ok(())
                } else {
                    Err(Damaged)
                }
            }
            1 => {
                self.bins = Some(Box::new(Bins::read(from, &self.shape)?));
                Ok(())
            }
            _ => Err(Damaged),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sums::log_scale::LogScale;
    use proptest::prelude::*;
    use rand_distr::{Distribution, LogNormal, Normal, StandardNormal, StudentT, Uniform};
    use rand_pcg::Pcg64Dxsm;
    use rand_pcg::rand_core::{Rng, SeedableRng};

    const SHAPE: Shape = Shape {
        centre: 0.0,
        scale: None,
        values: 2048,
        bins: 1024,
    };

    fn of(values: &[f64], shape: Shape) -> Sketch {
        let mut sketch = Sketch::empty(shape);
        sketch.extend(values);
        sketch
    }

    fn through_bytes(sketch: &Sketch) -> Sketch {
        let (mut bytes, mut back) = (Vec::new(), Sketch::empty(sketch.shape));
        sketch.write(&mut bytes);
        let mut reader = Reader::new(&bytes);
        back.read(&mut reader).expect("as written");
        assert_eq!(reader.left(), 0);
        back
    }

    /// What a sketch of these values holds, by the definition at the head of the module: without
    /// arrays, without order, in integers.
    fn by_definition(values: &[f64], shape: &Shape) -> Ordered {
        let mut finite: Vec<f64> = values
            .iter()
            .map(|v| v + 0.0)
            .filter(|v| (v - shape.centre).is_finite())
            .collect();
        finite.sort_by(f64::total_cmp);
        let others: Vec<f64> = finite
            .iter()
            .copied()
            .filter(|value| *value != shape.centre)
            .collect();
        if others.len() <= shape.values {
            let at_centre = (finite.len() - others.len()) as u64;
            return Ordered::Kept(Kept::of(others, shape.centre, at_centre));
        }
        let places: Vec<f64> = finite.iter().map(|value| shape.place(*value)).collect();
        let farthest = places
            .iter()
            .fold(0.0_f64, |farthest, u| farthest.max(u.abs()));
        let [smallest, largest] =
            [finite[0], finite[finite.len() - 1]].map(|end| match shape.scale {
                Some(_) => shape.value(shape.place(end)),
                None => end,
            });
        let mut level = crate::sums::dyadic::finest(farthest);
        loop {
            let width = crate::sums::dyadic::width(level);
            let mut bins = std::collections::BTreeMap::<i64, u64>::new();
            for &u in &places {
                let magnitude = ((u.abs() / width).ceil() as i64).max(i64::from(u != 0.0));
                *bins
                    .entry(if u < 0.0 { -magnitude } else { magnitude })
                    .or_default() += 1;
            }
            if bins.len() <= shape.bins {
                let all = bins.values().scan(0, |all, count| {
                    *all += count;
                    Some(*all)
                });
                let up_to = bins.keys().copied().zip(all).collect();
                return Ordered::Binned(Binned {
                    shape: *shape,
                    level,
                    smallest,
                    largest,
                    up_to,
                });
            }
            level += 1;
        }
    }

    /// Values as ensembles may have them: continuous laws, atoms, lattices, clusters, outliers, and
    /// values that are not sensible.
    fn some_values() -> impl Strategy<Value = Vec<f64>> {
        let value = prop_oneof![
            8 => -1.0..3.0f64,
            3 => Just(6.0),
            2 => (-30i32..30).prop_map(|i| f64::from(i) / 4.0),
            2 => 1e6..1.000_001e6f64,
            1 => -1e12..1e12f64,
            1 => -1e-12..1e-12f64,
            1 => prop_oneof![Just(0.0), Just(-0.0), Just(f64::NAN), Just(f64::INFINITY), Just(1e300), Just(5e-324)],
        ];
        let mixed = prop::collection::vec(value, 0..400);
        prop_oneof![
            mixed,
            prop::collection::vec(-1.0..3.0f64, 0..400),
            prop::collection::vec(5.99..6.01f64, 0..400)
        ]
    }

    proptest! {
        #[test]
        fn any_grouping_in_any_order_holds_the_same(
            values in some_values(),
            cuts in prop::collection::vec(0.0..1.0f64, 0..6),
            (bins, more) in (3usize..120, 0usize..100),
            (centre, scale) in prop_oneof![
                Just((0.0, None)),
                Just((6.0, None)),
                (-6..6i32).prop_map(|power| (0.0, Some(LogScale::new(10f64.powi(power))))),
            ],
            order in any::<u64>(),
            by_bytes in any::<bool>(),
        ) {
            let shape = Shape { centre, scale, values: bins + more, bins };
            let mut rng = Pcg64Dxsm::seed_from_u64(order);
            let mut shuffled = values.clone();
            (1..shuffled.len()).for_each(|i| shuffled.swap(i, rng.next_u64() as usize % (i + 1)));
            let mut ends: Vec<usize> = cuts.iter().map(|cut| (cut * values.len() as f64) as usize).collect();
            ends.extend([0, values.len()]);
            ends.sort_unstable();
            let mut parts: Vec<Sketch> = ends.windows(2).map(|cut| of(&shuffled[cut[0]..cut[1]], shape)).collect();
            while parts.len() > 1 {
                let part = parts.swap_remove(rng.next_u64() as usize % parts.len());
                let other = rng.next_u64() as usize % parts.len();
                parts[other].merge(&if by_bytes { through_bytes(&part) } else { part });
            }
            let expected = by_definition(&values, &shape);
            prop_assert_eq!(&parts[0].ordered(), &expected);
            let mut paths = Sketch::empty(shape);
            values.iter().for_each(|&value| paths.push(value));
            prop_assert_eq!(&paths.ordered(), &expected);
            prop_assert_eq!(&through_bytes(&paths).ordered(), &expected);
        }

        #[test]
        fn damaged_bytes_are_refused_or_read_as_some_sketch(
            values in prop::collection::vec(-5.0..5.0f64, 0..80),
            place in 0.0..1.0f64,
            byte in any::<u8>(),
        ) {
            let shape = Shape { values: 20, bins: 15, ..SHAPE };
            let mut bytes = Vec::new();
            of(&values, shape).write(&mut bytes);
            let place = (place * bytes.len() as f64) as usize;
            bytes[place] = byte;
            let mut back = Sketch::empty(shape);
            if back.read(&mut Reader::new(&bytes)).is_ok() {
                back.merge(&of(&values, shape));
                prop_assert!(back.ordered().quantile(0.5).is_finite() || values.is_empty());
            }
        }
    }

    /// The quantile of order p by Hyndman and Fan's definition 7, from the sorted values.
    fn exact(sorted: &[f64], p: f64) -> f64 {
        let rank = p * (sorted.len() - 1) as f64;
        let (below, above) = (sorted[rank.floor() as usize], sorted[rank.ceil() as usize]);
        below + (above - below) * rank.fract()
    }

    /// The largest error of any percentile, in standard deviations of the sample.
    fn worst(values: &[f64], shape: Shape) -> f64 {
        let mut sketch = Sketch::empty(shape);
        values
            .chunks(256)
            .for_each(|block| sketch.merge(&of(block, shape)));
        let ordered = sketch.ordered();
        let mut sorted = values.to_vec();
        sorted.sort_by(f64::total_cmp);
        let n = values.len() as f64;
        let mean = values.iter().sum::<f64>() / n;
        let sd = (values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / n).sqrt();
        let error = |p: f64| (ordered.quantile(p) - exact(&sorted, p)).abs() / sd;
        (0..=100)
            .map(|percent| error(f64::from(percent) / 100.0))
            .fold(0.0, f64::max)
    }

    /// Draws a value.
    type Law = Box<dyn FnMut(&mut Pcg64Dxsm) -> f64>;

    /// Laws that are hard to represent in bins, each with a name.
    fn laws() -> Vec<(&'static str, Law)> {
        let normal = |rng: &mut Pcg64Dxsm| -> f64 { StandardNormal.sample(rng) };
        let uniform = |rng: &mut Pcg64Dxsm| -> f64 { Uniform::new(0.0, 1.0).unwrap().sample(rng) };
        vec![
            ("standard normal", Box::new(normal)),
            (
                "normal, its mean 1e6 sd from the centre",
                Box::new(move |rng| 1e3 + 1e-3 * normal(rng)),
            ),
            (
                "normal, its mean 1e11 sd from the centre",
                Box::new(move |rng| -1e3 + 1e-8 * normal(rng)),
            ),
            (
                "two narrow clusters",
                Box::new(move |rng| {
                    (if uniform(rng) < 0.3 { -6.0 } else { 6.0 }) + 1e-6 * normal(rng)
                }),
            ),
            (
                "an atom at the centre and a density about it",
                Box::new(move |rng| if uniform(rng) < 0.4 { 0.0 } else { normal(rng) }),
            ),
            (
                "atoms on a lattice",
                Box::new(move |rng| 0.1 * (uniform(rng) * 60.0).floor()),
            ),
            (
                "a fine lattice",
                Box::new(move |rng| (4000.0 * normal(rng)).round() / 4000.0),
            ),
            (
                "half atoms, half density",
                Box::new(move |rng| {
                    if uniform(rng) < 0.5 {
                        (uniform(rng) * 9.0).floor() / 3.0
                    } else {
                        3.0 * uniform(rng)
                    }
                }),
            ),
            (
                "outliers at 1e3 sd",
                Box::new(move |rng| normal(rng) * if uniform(rng) < 1e-5 { 1e3 } else { 1.0 }),
            ),
            (
                "Student's t with 2 degrees of freedom",
                Box::new(|rng| StudentT::new(2.0).unwrap().sample(rng)),
            ),
            (
                "lognormal over eight decades",
                Box::new(|rng| LogNormal::new(0.0, 2.0).unwrap().sample(rng)),
            ),
            ("one value", Box::new(|_| 0.1)),
        ]
    }

    #[test]
    fn quantiles_are_those_of_sorted_values_to_an_sd_over_50() {
        // There is no sampling error, since both quantiles are of the same sample. Up to 2048
        // values are not binned.
        let mut rng = Pcg64Dxsm::seed_from_u64(7);
        for (name, mut law) in laws() {
            for (n, bound) in [
                (100, 0.0),
                (2048, 0.0),
                (3000, 0.02),
                (30_000, 0.02),
                (1_000_000, 0.02),
            ] {
                let values: Vec<f64> = (0..n).map(|_| law(&mut rng)).collect();
                let error = worst(&values, SHAPE);
                println!("{name}: {n} values, {error:.5} sd");
                assert!(
                    error <= bound || name == "one value",
                    "{name}: {n} values, {error} sd"
                );
            }
        }
    }

    /// A bin may hold more values than its slot can count, all of which come at once.
    #[test]
    fn many_values_at_once_are_the_same_as_a_few_at_a_time() {
        let values: Vec<f64> = (0..300_000)
            .map(|i| if i % 3 == 0 { f64::from(i) } else { 7.0 })
            .collect();
        let (mut paths, mut parts) = (Sketch::empty(SHAPE), Sketch::empty(SHAPE));
        values.iter().for_each(|&value| paths.push(value));
        parts.extend_by_parts(&[&values[..1], &values[1..200_001], &[], &values[200_001..]]);
        assert_eq!(of(&values, SHAPE), paths);
        assert_eq!(parts, paths);
        assert_eq!(paths.ordered().count(), 300_000);
    }

    #[test]
    fn the_smallest_sketches_still_hold_smooth_laws() {
        // With 10 000 rows of the output grid a sketch has 256 bins, which are 0.04 to 0.08 sd
        // wide. Where the density is smooth, placing values by rank within a bin is off by w^2
        // |f'|/(8 f) = 0.002 sd.
        let mut rng = Pcg64Dxsm::seed_from_u64(8);
        let values: Vec<f64> = (0..200_000)
            .map(|_| Normal::new(5.0, 0.1).unwrap().sample(&mut rng))
            .collect();
        let error = worst(
            &values,
            Shape {
                values: 256,
                bins: 256,
                ..SHAPE
            },
        );
        assert!(error <= 0.02, "{error}");
    }

    #[test]
    fn an_atom_at_the_centre_is_exact_in_any_number_of_values() {
        let mut rng = Pcg64Dxsm::seed_from_u64(9);
        let shape = Shape {
            centre: 6.0,
            ..SHAPE
        };
        let mut sketch = Sketch::empty(shape);
        for i in 0..100_000 {
            let off: f64 = StandardNormal.sample(&mut rng);
            sketch.push(if i % 5 < 2 { 6.0 } else { 6.0 + off });
        }
        // The atom holds the shares from 0.3 to 0.7.
        let ordered = sketch.ordered();
        assert_eq!([0.31, 0.5, 0.69].map(|p| ordered.quantile(p)), [6.0; 3]);
        assert!(ordered.quantile(0.29) < 6.0 && ordered.quantile(0.71) > 6.0);
    }
}
