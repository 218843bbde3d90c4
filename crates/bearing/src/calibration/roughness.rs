//! The roughness of a temperature between its samples.
//!
//! Between two samples a rough temperature is a Brownian bridge, whose variance grows by the
//! roughness per unit of time. This holds for the noise of a scenario, for every time between
//! samples that is short compared with its correlation time.

use super::samples::{starts, stretches};

/// The shift of a level in kelvin for which samples with this interval cross the shifted level as
/// often as the continuous temperature crosses the level itself: 0.5826 standard deviations of the
/// increment from one sample to the next; 0.5826 is -zeta(1/2)/sqrt(2 pi) (Broadie, Glasserman and
/// Kou, *Mathematical Finance* 7, 1997).
pub fn overlooked(roughness: f64, interval: f64) -> f64 {
    let overlooked = 0.582_597_157_9 * (roughness * interval).sqrt();
    if overlooked.is_finite() {
        overlooked
    } else {
        0.0
    }
}

/// The roughness of samples at these times, from the distance of each sample from the straight line
/// between its two neighbours, and from that between the samples two before and two after it.
///
/// For a diffusion, the mean square of that distance grows with the time between the samples, g =
/// ab/(a + b) for samples a before and b after. The thermometer's own noise adds a constant. A
/// smooth component adds a part that grows at least as g^3. Two mean squares determine only one of
/// these parts, so the one that leaves less roughness is subtracted.
pub fn shown_roughness(t: &[f64], x: &[f64]) -> f64 {
    let starts = starts(t);
    let mean_square = |step: usize| {
        let mut sums = [0.0; 3];
        for stretch in stretches(&starts, t.len()) {
            for i in stretch.start + step..stretch.end.saturating_sub(step) {
                let [before, after] = [t[i] - t[i - step], t[i + step] - t[i]];
                let share = before / (before + after);
                let off = x[i] - x[i - step] - share * (x[i + step] - x[i - step]);
                sums = [sums[0] + off * off, sums[1] + share * after, sums[2] + 1.0];
            }
        }
        [sums[0] / sums[2], sums[1] / sums[2]]
    };
    let ([one, g], [two, h]) = (mean_square(1), mean_square(2));
    let less_noise = (two - one) / (h - g);
    let [cube_g, cube_h] = [g, h].map(|g| g * g * g);
    let less_smooth = (one * cube_h - two * cube_g) / (g * cube_h - h * cube_g);
    let roughness = less_noise.min(less_smooth).max(0.0);
    if roughness.is_finite() {
        roughness
    } else {
        0.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::calibration::MeasuredRecord;
    use stickslip::noise::{Stream, Transition};

    const STEP: f64 = 600.0;

    fn times(count: usize) -> Vec<f64> {
        (0..count).map(|i| STEP * i as f64).collect()
    }

    /// A process of 1.8 K and 8 hours gains 2 * 1.8^2/28800 = 2.25e-4 K^2 a second. Thirty thousand
    /// samples determine that to 1.5 %, and to 4 % with 0.2 K of noise of the thermometer, a
    /// little more than half of what the temperature gains in a step. The bounds are three and a
    /// half times as wide. A daily cycle and the steel of a bearing an hour behind are smooth: the
    /// cycle adds no roughness, and the steel has a twentieth of it at most.
    #[test]
    fn roughness_is_that_of_the_process() {
        let (theta, sd) = (1.0 / 28_800.0, 1.8);
        let truth = 2.0 * theta * sd * sd;
        let mut random = Stream::new(8, 0);
        let transition = Transition::new(theta, sd * (2.0 * theta).sqrt(), STEP);
        let mut v = 0.0;
        let weather: Vec<f64> = (0..30_000)
            .map(|_| {
                v = transition.next(v, random.normal());
                v
            })
            .collect();
        let cycle = |i: usize| 8.0 * libm::sin(std::f64::consts::TAU * i as f64 / 144.0);
        let shown = |noise: f64, amplitude: f64, random: &mut Stream| {
            let seen = weather
                .iter()
                .enumerate()
                .map(|(i, v)| v + noise * random.normal() + amplitude * cycle(i) / 8.0);
            shown_roughness(&times(30_000), &seen.collect::<Vec<f64>>()) / truth
        };
        let [plain, noisy, cyclic] = [
            shown(0.0, 0.0, &mut random),
            shown(0.2, 0.0, &mut random),
            shown(0.0, 8.0, &mut random),
        ];
        println!("{plain:.3} {noisy:.3} {cyclic:.3}");
        assert!(
            (plain - 1.0).abs() < 0.05 && (noisy - 1.0).abs() < 0.14 && (cyclic - 1.0).abs() < 0.05
        );
        let air = MeasuredRecord {
            readings: vec![0.0; 30_000],
            temperatures: weather,
            times: times(30_000),
            ..MeasuredRecord::default()
        };
        let steel = shown_roughness(&air.times, &air.lagged(3600.0).temperatures) / truth;
        println!("{steel:.4}");
        assert!(steel < 0.05, "{steel}");
        let waves: Vec<f64> = (0..3000).map(cycle).collect();
        assert!(shown_roughness(&times(3000), &waves) < 1e-3 * truth);
        // 0.5826 times the square root of 2.25e-4 K^2/s times 600 s is 0.2141 K.
        assert!((overlooked(truth, STEP) - 0.2141).abs() < 1e-4);
    }
}
