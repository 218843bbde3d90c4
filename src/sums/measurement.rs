//! A number, and the points of a curve, with their 95 % intervals.

/// A number with its 95 % interval, for which the path is the independent unit. A value that does
/// not exist is NaN.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Measurement {
    /// The estimate.
    pub estimate: f64,
    /// Standard error of the estimate.
    pub standard_error: f64,
    /// Lower end of the 95 % interval.
    pub low: f64,
    /// Upper end of the 95 % interval.
    pub high: f64,
}

/// Ends of the 95 % interval of each point of a curve, for which the path is the independent unit.
///
/// An end that the data do not bound is infinite, or is the end of the range of the quantity. With
/// fewer than two paths there is no interval, and both ends are NaN.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Ends {
    /// The lower end at each point.
    pub low: Vec<f64>,
    /// The upper end at each point.
    pub high: Vec<f64>,
}

impl Ends {
    /// The two ends at one point; NaN where there is no such point.
    pub fn at(&self, point: usize) -> [f64; 2] {
        [&self.low, &self.high].map(|ends| ends.get(point).copied().unwrap_or(f64::NAN))
    }
}

impl FromIterator<[f64; 2]> for Ends {
    fn from_iter<I: IntoIterator<Item = [f64; 2]>>(ends: I) -> Self {
        let (low, high) = ends.into_iter().map(|[low, high]| (low, high)).unzip();
        Ends { low, high }
    }
}
