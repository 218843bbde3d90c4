//! The points of a sweep, and which of them are compared.

use super::axis::{AxisValue, MOST_POINTS, SweepAxis};
use crate::config::Override;
use stickslip_text::numbers::tidy;

/// The points of a sweep.
#[derive(Clone, Debug, PartialEq)]
pub enum Design {
    /// All combinations of the values of the axes; the last axis varies fastest.
    Grid(Vec<SweepAxis>),
    /// The first values of all axes together, then the second values, and so on.
    Zip(Vec<SweepAxis>),
    /// The scenario itself, and for each key one point with a smaller and one with a larger value.
    Star {
        /// The keys with their values in the scenario, all keys different and no value zero.
        keys: Vec<(String, f64)>,
        /// The change of a value, relative to it.
        relative_step: f64,
    },
}

/// The value of a key at a point.
#[derive(Clone, Debug, PartialEq)]
pub struct Setting {
    /// The dotted key.
    pub key: String,
    /// Its value.
    pub value: AxisValue,
}

impl Setting {
    /// The change of the scenario; messages call it `shown` with the value behind.
    pub fn change(&self, shown: &str) -> Override {
        match &self.value {
            AxisValue::Number(number) => Override::number(shown, &self.key, *number),
            AxisValue::File(file) => Override::text(shown, &self.key, file),
        }
    }
}

/// Why axes cannot be combined into a design.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum DesignError {
    /// Two dimensions have the same name, or one has a reserved name.
    #[error(
        "a dimension cannot be called `{0}`: the name is reserved, or used by another dimension"
    )]
    Name(String),
    /// A key is varied twice.
    #[error("`{0}` is varied twice")]
    Key(String),
    /// Zipped axes have different numbers of values.
    #[error("`{0}` has {1} values and `{2}` has {3}, but zipped keys need equal numbers")]
    Lengths(String, usize, String, usize),
    /// There are more than [`MOST_POINTS`] points.
    #[error("the sweep has {0} points; at most {MOST_POINTS} are supported")]
    Points(f64),
}

/// Why a key cannot be part of a star.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum StarError {
    /// The scenario has no number at this key.
    #[error("the scenario has no number for it")]
    NoNumber,
    /// The value is 0, so a relative change does not change it.
    #[error("it is 0, so it has no relative change")]
    Zero,
    /// The key is named twice.
    #[error("it is listed twice")]
    Twice,
}

/// Reserved names of the file of a sweep, which no axis may have.
pub const RESERVED: [&str; 41] = [
    "cycle_number",
    "section_state",
    "cycle",
    "section",
    "statistic",
    "statistic_long_name",
    "statistic_unit",
    "group",
    "along",
    "point",
    "point_key",
    "point_value",
    "key",
    "key_value",
    "estimate",
    "standard_error",
    "interval_low",
    "interval_high",
    "bias",
    "bias_uncertainty",
    "bias_order",
    "estimate_corrected",
    "estimate_corrected_low",
    "estimate_corrected_high",
    "estimate_without",
    "point_status",
    "point_completed_paths",
    "point_diverged_paths",
    "point_seed",
    "point_end",
    "point_seconds",
    "difference",
    "difference_error",
    "difference_low",
    "difference_high",
    "difference_gain",
    "elasticity",
    "elasticity_error",
    "elasticity_low",
    "elasticity_high",
    "elasticity_gain",
];

/// Relative steps that are accepted. With smaller ones the difference is lost in rounding, and with
/// larger ones it does not approximate a derivative.
pub const RELATIVE_STEPS: std::ops::RangeInclusive<f64> = 1e-6..=0.5;

impl Design {
    /// A grid of all combinations of axes, or, with `is_zipped`, their values in parallel.
    pub fn of(axes: Vec<SweepAxis>, is_zipped: bool) -> Result<Design, DesignError> {
        for (i, axis) in axes.iter().enumerate() {
            if RESERVED.contains(&axis.name.as_str())
                || axes[..i].iter().any(|other| other.name == axis.name)
            {
                return Err(DesignError::Name(axis.name.clone()));
            }
            if axes[..i].iter().any(|other| other.key == axis.key) {
                return Err(DesignError::Key(axis.key.clone()));
            }
        }
        if let (true, [first, others @ ..]) = (is_zipped, axes.as_slice()) {
            let n = first.values.len();
            if let Some(other) = others.iter().find(|other| other.values.len() != n) {
                let (a, b) = (first.name.clone(), other.name.clone());
                return Err(DesignError::Lengths(a, n, b, other.values.len()));
            }
        }
        let lengths = axes.iter().map(|axis| axis.values.len() as f64);
        let points = if is_zipped {
            lengths.fold(0.0, f64::max)
        } else {
            lengths.product()
        };
        match is_zipped {
            _ if points > MOST_POINTS as f64 => Err(DesignError::Points(points)),
            true => Ok(Design::Zip(axes)),
            false => Ok(Design::Grid(axes)),
        }
    }

    /// A star around the values that `number_at` gives for these keys. An error is returned with
    /// its key.
    pub fn star(
        keys: &[String],
        relative_step: f64,
        number_at: impl Fn(&str) -> Option<f64>,
    ) -> Result<Design, (String, StarError)> {
        let mut named: Vec<(String, f64)> = Vec::new();
        for key in keys {
            let wrong = |error: StarError| Err((key.clone(), error));
            match number_at(key) {
                None => return wrong(StarError::NoNumber),
                Some(0.0) => return wrong(StarError::Zero),
                Some(_) if named.iter().any(|(other, _)| other == key) => {
                    return wrong(StarError::Twice);
                }
                Some(value) => named.push((key.clone(), value)),
            }
        }
        Ok(Design::Star {
            keys: named,
            relative_step,
        })
    }

    /// The axes; none for a star.
    pub fn axes(&self) -> &[SweepAxis] {
        match self {
            Design::Grid(axes) | Design::Zip(axes) => axes,
            Design::Star { .. } => &[],
        }
    }

    /// The names that a user may use for an axis: its name and its key, or the keys of a star.
    pub fn names(&self) -> Vec<&str> {
        match self {
            Design::Star { keys, .. } => keys.iter().map(|(key, _)| key.as_str()).collect(),
            _ => self
                .axes()
                .iter()
                .flat_map(|axis| [axis.name.as_str(), &axis.key])
                .collect(),
        }
    }

    /// Length of each dimension, slowest first. A star and a zip have one dimension.
    pub fn shape(&self) -> Vec<usize> {
        match self {
            Design::Grid(axes) => axes.iter().map(|axis| axis.values.len()).collect(),
            Design::Zip(axes) => vec![axes.first().map_or(0, |axis| axis.values.len())],
            Design::Star { keys, .. } => vec![1 + 2 * keys.len()],
        }
    }

    /// Number of points.
    pub fn points(&self) -> usize {
        self.shape().into_iter().product()
    }

    /// The settings of a point; none at the centre of a star.
    pub fn settings(&self, point: usize) -> Vec<Setting> {
        let setting = |axis: &SweepAxis, i: usize| Setting {
            key: axis.key.clone(),
            value: axis.values.at(i),
        };
        match self {
            Design::Grid(axes) => {
                let places = self.places(point);
                axes.iter()
                    .zip(places)
                    .map(|(axis, i)| setting(axis, i))
                    .collect()
            }
            Design::Zip(axes) => axes.iter().map(|axis| setting(axis, point)).collect(),
            Design::Star {
                keys,
                relative_step,
            } => {
                let moved = |(key, value): &(String, f64), side: f64| Setting {
                    key: key.clone(),
                    value: AxisValue::Number(tidy(value * (1.0 + side * relative_step))),
                };
                match point.checked_sub(1) {
                    None => Vec::new(),
                    Some(i) => vec![moved(&keys[i / 2], if i % 2 == 0 { -1.0 } else { 1.0 })],
                }
            }
        }
    }

    /// The index of a point along each dimension.
    fn places(&self, point: usize) -> Vec<usize> {
        let mut left = point;
        let mut places: Vec<usize> = Vec::new();
        for length in self.shape().into_iter().rev() {
            places.push(left % length);
            left /= length;
        }
        places.reverse();
        places
    }

    /// The name of each dimension along which neighbours are compared. A star has none.
    pub fn along(&self) -> Vec<&str> {
        match self {
            Design::Grid(axes) => axes.iter().map(|axis| axis.name.as_str()).collect(),
            Design::Zip(_) => vec!["point"],
            Design::Star { .. } => Vec::new(),
        }
    }

    /// The next point along a dimension, if there is one.
    pub fn next(&self, point: usize, dimension: usize) -> Option<usize> {
        let shape = self.shape();
        let stride: usize = shape[dimension + 1..].iter().product();
        (self.places(point)[dimension] + 1 < shape[dimension]).then_some(point + stride)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn axis(name: &str, values: &[f64]) -> SweepAxis {
        SweepAxis {
            name: name.into(),
            key: format!("key.{name}"),
            values: values.to_vec().into(),
        }
    }

    fn values(design: &Design) -> Vec<Vec<f64>> {
        let number = |setting: Setting| match setting.value {
            AxisValue::Number(number) => number,
            AxisValue::File(file) => panic!("{file} is a file"),
        };
        (0..design.points())
            .map(|p| design.settings(p).into_iter().map(number).collect())
            .collect()
    }

    #[test]
    fn crossed_axes_make_every_pair_and_neighbours_differ_in_one() {
        let design = Design::of(
            vec![axis("a", &[1.0, 2.0]), axis("b", &[5.0, 6.0, 7.0])],
            false,
        )
        .expect("a grid");
        let pairs = [
            [1.0, 5.0],
            [1.0, 6.0],
            [1.0, 7.0],
            [2.0, 5.0],
            [2.0, 6.0],
            [2.0, 7.0],
        ];
        assert_eq!(values(&design), pairs);
        let next = |dimension| {
            (0..6)
                .map(|p| design.next(p, dimension))
                .collect::<Vec<_>>()
        };
        assert_eq!(next(0), [Some(3), Some(4), Some(5), None, None, None]);
        assert_eq!(next(1), [Some(1), Some(2), None, Some(4), Some(5), None]);
    }

    #[test]
    fn zipped_axes_go_together() {
        let design =
            Design::of(vec![axis("a", &[1.0, 2.0]), axis("b", &[5.0, 6.0])], true).expect("a zip");
        assert_eq!(values(&design), [[1.0, 5.0], [2.0, 6.0]]);
        assert_eq!((design.next(0, 0), design.next(1, 0)), (Some(1), None));
    }

    #[test]
    fn a_star_has_a_step_below_and_above_for_each_key() {
        let design = Design::Star {
            keys: vec![("a".into(), 2.0), ("b".into(), -0.3)],
            relative_step: 0.05,
        };
        assert_eq!(
            values(&design),
            [vec![], vec![1.9], vec![2.1], vec![-0.285], vec![-0.315]]
        );
    }

    #[test]
    fn axes_that_do_not_go_together_are_refused() {
        let (a, b) = (axis("a", &[1.0, 2.0]), axis("b", &[1.0]));
        let refused = |axes, is_zipped| Design::of(axes, is_zipped).expect_err("refused");
        assert_eq!(
            refused(vec![a.clone(), b.clone()], true),
            DesignError::Lengths("a".into(), 2, "b".into(), 1)
        );
        assert_eq!(
            refused(vec![a.clone(), a.clone()], false),
            DesignError::Name("a".into())
        );
        assert_eq!(
            refused(vec![axis("group", &[1.0])], false),
            DesignError::Name("group".into())
        );
        let twice = SweepAxis {
            key: a.key.clone(),
            ..b
        };
        assert_eq!(
            refused(vec![a, twice], false),
            DesignError::Key("key.a".into())
        );
        let long = axis("c", &(0..1000).map(f64::from).collect::<Vec<_>>());
        let many = vec![
            long.clone(),
            SweepAxis {
                name: "d".into(),
                key: "d".into(),
                ..long
            },
        ];
        assert_eq!(refused(many, false), DesignError::Points(1e6));
    }
}
