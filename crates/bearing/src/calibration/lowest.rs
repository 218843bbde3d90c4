//! The minimum of a function of one number.

/// The minimum within an interval, by this number of golden sections.
pub fn golden_section_minimum(
    mut low: f64,
    mut high: f64,
    sections: u32,
    mut f: impl FnMut(f64) -> f64,
) -> f64 {
    const GOLDEN_SECTION: f64 = 0.618_033_988_749_894_9;
    let mut inner = [
        high - GOLDEN_SECTION * (high - low),
        low + GOLDEN_SECTION * (high - low),
    ];
    let mut values = inner.map(&mut f);
    for _ in 0..sections {
        if values[0] <= values[1] {
            high = inner[1];
            inner = [high - GOLDEN_SECTION * (high - low), inner[0]];
            values = [f(inner[0]), values[0]];
        } else {
            low = inner[0];
            inner = [inner[1], low + GOLDEN_SECTION * (high - low)];
            values = [values[1], f(inner[1])];
        }
    }
    if values[0] <= values[1] {
        inner[0]
    } else {
        inner[1]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn golden_sections_find_a_minimum() {
        for at in [-0.9, 0.1, 2.3] {
            let found = golden_section_minimum(-1.0, 3.0, 40, |x| (x - at).powi(2));
            assert!((found - at).abs() < 1e-6, "{found} for {at}");
        }
    }
}
