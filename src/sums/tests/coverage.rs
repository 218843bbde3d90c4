//! How often intervals cover what is known.

/// How often intervals covered the truth.
#[derive(Default)]
pub struct Coverage {
    held: u32,
    of: u32,
}

impl Coverage {
    pub fn count(&mut self, holds: bool) {
        self.held += u32::from(holds);
        self.of += 1;
    }

    pub fn share(&self) -> f64 {
        f64::from(self.held) / f64::from(self.of)
    }

    /// Null: the true coverage is 95 %, up to 1 % of second-order bias (skewness at a few hundred
    /// paths). The share of n ensembles is then within four binomial standard deviations of that
    /// range, with a false-alarm rate of 6e-5. A standard error that is wrong by a factor of two
    /// gives a coverage of 67 % or 99.99 %.
    pub fn assert_95_percent(&self, what: &str) {
        let margin = 4.0 * (0.05 * 0.95 / f64::from(self.of)).sqrt() + 0.01;
        println!("{what}: {:.4} +- {margin:.4}", self.share());
        assert!(
            (self.share() - 0.95).abs() < margin,
            "{what}: coverage {} +- {margin}",
            self.share()
        );
    }
}
