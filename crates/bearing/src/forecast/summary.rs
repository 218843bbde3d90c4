//! Expected values and their intervals from simulated years.

use super::question::{ForecastError, ForecastQuestion};
use super::year::{ForecastQuantity, YEAR, Year, YearAndRecord};
use crate::calibration::{Calibration, CourseShape};
use crate::moments::{mean, variance};
use crate::warning::named;
use statrs::distribution::{ContinuousCDF as _, StudentsT};

/// The forecast of one quantity.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ForecastLevel {
    /// The quantity.
    pub quantity: ForecastQuantity,
    /// The mean over all years.
    pub expected: f64,
    /// The interval of that mean, which allows for the errors of the parameters.
    pub expected_interval: [f64; 2],
    /// The interval for a single year, which allows for the weather and the errors of the
    /// parameters. It contains that of the mean.
    pub year_interval: [f64; 2],
}

/// The |z| that is exceeded in one year out of `years`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ReturnLevel {
    /// The return period, in years.
    pub years: f64,
    /// Its value over all years and draws.
    pub expected: f64,
    /// Its interval, which allows for the errors of the parameters.
    pub interval: [f64; 2],
}

/// The forecast.
#[derive(Clone, Debug, PartialEq)]
pub struct Forecast {
    /// The question.
    pub question: ForecastQuestion,
    /// The years, one list for each draw of the parameters. Each quantity is scaled so that its mean
    /// is that of other years, with the most likely parameters.
    pub years: Vec<Vec<Year>>,
    /// One for each quantity that can be known; forces need K_BP.
    pub levels: Vec<ForecastLevel>,
    /// Return levels of the largest |z| of a year.
    pub return_levels: Vec<ReturnLevel>,
    /// The slips of the record.
    pub showed: Showed,
    /// The range of the number of slips in nearly all simulated records of the same time.
    pub usual: [f64; 2],
    /// Number of unphysical posterior samples, which were drawn again.
    pub redrawn: u64,
}

/// The slips of a record.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Showed {
    /// Number of slips, from their jumps.
    pub slips: f64,
    /// Their sum, in metres.
    pub path: f64,
    /// The time in which they were detected, at most a year, in seconds.
    pub duration: f64,
    /// Whether friction in the record is that of the forecast on average, so that both have the same
    /// number of slips.
    pub is_comparable: bool,
}

impl Showed {
    /// The slips of the record of a calibration; of a record longer than a year, per year.
    pub fn of(calibration: &Calibration) -> Self {
        let Calibration {
            record,
            response,
            slips,
            ..
        } = calibration;
        let observed: f64 = record.shares().iter().sum();
        let duration = observed.min(YEAR);
        let share = duration / observed;
        let moved: f64 = slips
            .iter()
            .map(|slip| slip.jump.abs() / response.sensor.moving)
            .sum();
        let path = share * moved * response.sensor.dilatation();
        Showed {
            slips: share * libm::round(moved / response.motion.jump),
            path,
            duration,
            is_comparable: !matches!(calibration.course.shape, CourseShape::Trend(_)),
        }
    }
}

/// The share of simulated records below the usual range, and above it.
const UNUSUAL: f64 = 1e-3;

/// If the record differs from simulated ones by more than this factor in its number of slips, the
/// model does not describe it.
const ANOTHER: f64 = 1.25;

/// The return periods, in years.
const RETURN_PERIODS: [f64; 2] = [10.0, 50.0];

/// Euler's constant.
const EULER: f64 = 0.577_215_664_901_532_9;

impl Forecast {
    /// Summarise years: first those with the most likely parameters, then those of each draw. An
    /// incomplete draw of a stopped forecast is left out. `None` if the forecast was stopped before
    /// two draws were simulated.
    pub(super) fn of(
        draws: &[Vec<YearAndRecord>],
        question: &ForecastQuestion,
        showed: &Showed,
        knows_forces: bool,
    ) -> Result<Option<Forecast>, ForecastError> {
        let Some((likeliest, draws)) = draws.split_first() else {
            return Ok(None);
        };
        let whole: Vec<&Vec<YearAndRecord>> = draws
            .iter()
            .filter(|years| years.len() as u64 == question.years)
            .collect();
        if whole.len() < 2 {
            return Ok(None);
        }
        let of =
            |years: &Vec<YearAndRecord>| years.iter().map(|one| one.year).collect::<Vec<Year>>();
        let years = whole.iter().copied().map(of).collect();
        let years = centred(&of(likeliest), years);
        let mut within: Vec<f64> = whole
            .iter()
            .copied()
            .flatten()
            .map(|one| one.within)
            .collect();
        within.sort_by(f64::total_cmp);
        let usual = [UNUSUAL, 1.0 - UNUSUAL].map(|level| quantile(&within, level));
        let Showed {
            slips,
            path,
            duration,
            is_comparable,
        } = *showed;
        let is_another = slips > ANOTHER * usual[1] || ANOTHER * slips < usual[0];
        if is_comparable && is_another {
            return Err(ForecastError::NotTheRecord {
                slips,
                path,
                days: duration / 86_400.0,
                range: usual,
            });
        }
        let known =
            |quantity: &ForecastQuantity| knows_forces || *quantity != ForecastQuantity::Force;
        let levels = ForecastQuantity::ALL
            .into_iter()
            .filter(known)
            .map(|quantity| level(&years, quantity, question))
            .collect();
        let return_levels = RETURN_PERIODS
            .map(|period| return_level(&years, period, question))
            .to_vec();
        let question = *question;
        Ok(Some(Forecast {
            question,
            years,
            levels,
            return_levels,
            showed: *showed,
            usual,
            redrawn: 0,
        }))
    }

    /// Reasons to be careful with the result.
    pub fn warnings(&self) -> Vec<(String, String)> {
        let Forecast {
            showed:
                Showed {
                    slips,
                    duration,
                    is_comparable,
                    ..
                },
            usual: [low, high],
            ..
        } = self;
        let another = (*is_comparable && (slips < low || slips > high)).then(|| {
            format!(
                "the record shows {slips:.0} slips in {:.0} days, but nearly all simulated \
                 records of the same days show between {low:.0} and {high:.0}: the model does not \
                 describe this weather or this bearing, so do not use the intervals",
                duration / 86_400.0
            )
        });
        let redrawn = (self.redrawn > 0).then(|| {
            format!(
                "{} sampled parameter sets were unphysical, for example with a negative A or G, and were drawn again: the record \
                 hardly constrains the bearing; measure for longer",
                self.redrawn
            )
        });
        let another = another.map(|text| named("record_unlike_forecast", text));
        let redrawn = redrawn.map(|text| named("draws_redrawn", text));
        another.into_iter().chain(redrawn).collect()
    }

    /// The forecast of a quantity, if it can be known.
    pub fn level(&self, quantity: ForecastQuantity) -> Option<&ForecastLevel> {
        self.levels.iter().find(|level| level.quantity == quantity)
    }
}

/// The years of all draws, with each quantity scaled to the mean that it has with the most likely
/// parameters. The mean over the draws themselves would be too high by some percent, because the
/// number of slips grows faster than the variance of the weather.
fn centred(likeliest: &[Year], mut years: Vec<Vec<Year>>) -> Vec<Vec<Year>> {
    for quantity in ForecastQuantity::ALL {
        let mean_of = |years: &mut dyn Iterator<Item = &Year>| {
            mean(
                &years
                    .map(|year| year[quantity as usize])
                    .collect::<Vec<_>>(),
            )
        };
        let factor = mean_of(&mut likeliest.iter()) / mean_of(&mut years.iter().flatten());
        if factor > 0.0 && factor.is_finite() {
            let most = if quantity.is_unbounded() {
                f64::INFINITY
            } else {
                1.0
            };
            for year in years.iter_mut().flatten() {
                let scaled = factor * year[quantity as usize];
                year[quantity as usize] = scaled.min(most);
            }
        }
    }
    years
}

fn level(
    years: &[Vec<Year>],
    quantity: ForecastQuantity,
    question: &ForecastQuestion,
) -> ForecastLevel {
    let of = |year: &Year| year[quantity as usize];
    let draws: Vec<Vec<f64>> = years
        .iter()
        .map(|years| years.iter().map(of).collect())
        .collect();
    let mut all: Vec<f64> = draws.iter().flatten().copied().collect();
    all.sort_by(f64::total_cmp);
    let means: Vec<f64> = draws.iter().map(|years| mean(years)).collect();
    let within = draws
        .iter()
        .map(|years| variance(years) / years.len() as f64);
    let expected = mean(&all);
    let expected_interval =
        if expected > 0.0 && means.iter().all(|mean| *mean > 0.0) && quantity.is_unbounded() {
            // A count or a length is a product of uncertain factors, so its logarithm is closer to
            // normal, and the interval stays above zero.
            let relative = within
                .zip(&means)
                .map(|(variance, mean)| variance / (mean * mean))
                .sum::<f64>()
                / draws.len() as f64;
            let logarithms: Vec<f64> = means.iter().map(|mean| libm::log(*mean)).collect();
            let factor = libm::exp(half_width(&logarithms, relative, question.level));
            [expected / factor, expected * factor]
        } else {
            let half = half_width(
                &means,
                within.sum::<f64>() / draws.len() as f64,
                question.level,
            );
            let most = if quantity.is_unbounded() {
                f64::INFINITY
            } else {
                1.0
            };
            [(expected - half).max(0.0), (expected + half).min(most)]
        };
    // A year scatters at least as much as the mean, which few draws may not show.
    let [low, high] = expected_interval;
    ForecastLevel {
        quantity,
        expected,
        expected_interval,
        year_interval: [
            quantile(&all, 0.5 - 0.5 * question.level).min(low),
            quantile(&all, 0.5 + 0.5 * question.level).max(high),
        ],
    }
}

/// Half of the width of the interval of the true mean. Its variance is that of the means of draws,
/// minus the part due to the finite number of years of each draw, plus the error of the mean over
/// all years.
fn half_width(means: &[f64], within: f64, level: f64) -> f64 {
    let n = means.len() as f64;
    let variance = (variance(means) - within).max(0.0) + within / n;
    StudentsT::new(0.0, 1.0, n - 1.0).map_or(f64::NAN, |t| t.inverse_cdf(0.5 + 0.5 * level))
        * variance.sqrt()
}

/// The largest value of a year has nearly a Gumbel distribution, which gives a return level for
/// each draw from few years, and thus the interval. The expected return level is the quantile of
/// all years, without this assumption.
fn return_level(years: &[Vec<Year>], period: f64, question: &ForecastQuestion) -> ReturnLevel {
    let greatest = |year: &Year| year[ForecastQuantity::Greatest as usize];
    let mut all: Vec<f64> = years.iter().flatten().map(greatest).collect();
    all.sort_by(f64::total_cmp);
    let expected = quantile(&all, 1.0 - 1.0 / period);
    let reduced = -libm::log(-libm::log1p(-1.0 / period));
    // The method of moments: the scale is sd sqrt(6)/pi, and the location is the mean minus Euler's
    // constant times the scale. The variance of the result is that of a combination of mean and sd,
    // with the kurtosis 5.4 and the skewness 1.14 of the Gumbel distribution.
    let factor = (reduced - EULER) * 6f64.sqrt() / std::f64::consts::PI;
    let share = 1.0 + 1.14 * factor + 1.1 * factor * factor;
    let (mut levels, mut within) = (Vec::new(), 0.0);
    for some in years {
        let values: Vec<f64> = some.iter().map(greatest).collect();
        let variance = variance(&values);
        levels.push(mean(&values) + factor * variance.sqrt());
        within += share * variance / values.len() as f64 / years.len() as f64;
    }
    let half = half_width(&levels, within, question.level);
    ReturnLevel {
        years: period,
        expected,
        interval: [(expected - half).max(0.0), expected + half],
    }
}

/// A quantile of ascending values, interpolated between the two nearest.
fn quantile(values: &[f64], level: f64) -> f64 {
    let place = level * (values.len() as f64 - 1.0);
    let below = place as usize;
    let above = (below + 1).min(values.len() - 1);
    values[below] + (place - below as f64) * (values[above] - values[below])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::calibration::{MeasuredRecord, Motion, Response, SeenSlip, Sensor};
    use stickslip::noise::Stream;

    const QUESTION: ForecastQuestion = ForecastQuestion {
        draws: 50,
        years: 40,
        seed: 1,
        level: 0.9,
        share: 0.9,
    };

    /// The forecast of these years, whose slips are also those of the time of a record with `slips`.
    fn of(
        draws: Vec<Vec<Year>>,
        question: &ForecastQuestion,
        slips: f64,
    ) -> Result<Option<Forecast>, ForecastError> {
        let one = |year: Year| YearAndRecord {
            year,
            within: year[ForecastQuantity::Slips as usize],
        };
        let draws: Vec<Vec<YearAndRecord>> = draws
            .into_iter()
            .map(|years| years.into_iter().map(one).collect())
            .collect();
        Forecast::of(
            &draws,
            question,
            &Showed {
                slips,
                path: 0.01,
                duration: YEAR,
                is_comparable: true,
            },
            false,
        )
    }

    /// The means of draws scatter with sd 1 around 50, and years with sd 3 around each mean. The
    /// interval of the expected value is +-1.68 (Student, 49 degrees of freedom) and not sqrt(1 +
    /// 9/40) times that; a single year is within +-1.645 sqrt(10). The largest value of a year is
    /// 10 - log(-log U), with a Gumbel distribution: 12.25 is exceeded once in ten years, and 13.90
    /// once in fifty. The results are averages over 200 forecasts, whose standard errors are below
    /// 1.5 %.
    #[test]
    fn intervals_hold_what_they_are_about() {
        let mut random = Stream::new(2, 0);
        let (mut expected, mut year, mut levels, mut widths) = (0.0, 0.0, [0.0; 2], [0.0; 2]);
        let times = 200;
        for _ in 0..times {
            let years = (0..QUESTION.draws).map(|_| {
                let shift = random.normal();
                let year = |random: &mut Stream| {
                    let gumbel = 10.0 - libm::log(-libm::log(random.uniform())) + 0.5 * shift;
                    [
                        50.0 + shift + 3.0 * random.normal(),
                        0.0,
                        0.0,
                        gumbel,
                        0.0,
                        0.0,
                    ]
                };
                (0..QUESTION.years).map(|_| year(&mut random)).collect()
            });
            let years = std::iter::once(vec![[50.0, 0.0, 0.0, 0.0, 0.0, 0.0]; 40]).chain(years);
            let forecast = of(years.collect(), &QUESTION, 0.0)
                .expect("as the record")
                .expect("enough");
            assert_eq!(forecast.level(ForecastQuantity::Force), None);
            let level = forecast
                .level(ForecastQuantity::SlidingPath)
                .expect("known");
            let half = |interval: [f64; 2]| 0.5 * (interval[1] - interval[0]) / f64::from(times);
            expected += half(level.expected_interval);
            year += half(level.year_interval);
            for i in 0..2 {
                levels[i] += forecast.return_levels[i].expected / f64::from(times);
                widths[i] += half(forecast.return_levels[i].interval);
            }
        }
        println!("{expected:.3} {year:.3} {levels:.3?} {widths:.3?}");
        assert!((expected / 1.685 - 1.0).abs() < 0.06, "{expected}");
        assert!((year / (1.645 * 10f64.sqrt()) - 1.0).abs() < 0.06, "{year}");
        // Since the parameters scatter by 0.5, the quantiles of all years are a little higher than
        // 12.25 and 13.90.
        assert!(
            (levels[0] - 12.4).abs() < 0.15 && (levels[1] - 14.05).abs() < 0.25,
            "{levels:?}"
        );
        // The expected width is 1.68 * 0.5. It is smaller for the longer return period, because the
        // part that is subtracted for the few years of a draw sometimes exceeds the whole variance.
        assert!(
            widths.iter().all(|width| (0.7..0.98).contains(width)),
            "{widths:?}"
        );
    }
    /// The largest value of a year has a Gumbel distribution, of which the location or the scale
    /// differs from draw to draw, with a standard deviation of 0.2 or of 0.1. The value that is
    /// exceeded once in P years is location + scale y, where y = -log(-log(1 - 1/P)) is 2.2504 for
    /// ten years and 3.9019 for fifty. So over the draws it has the standard deviation of the
    /// location, and y times that of the scale. Half of the interval of 90 % is 1.6449 times that,
    /// because there are enough draws for Student's t to be normal.
    ///
    /// Null: the half-width is that. Sample size: 40 000 draws of 400 years in ten forecasts, which
    /// leave it uncertain by 1 %, and by 2 % where the years of a draw scatter more than the draws.
    /// Bound: 5 %. Without Euler's constant the scale would make the interval 25 % and 14 % too
    /// wide; without the skewness, what the few years of a draw leave uncertain would make it up to
    /// 14 % too wide.
    #[test]
    fn return_levels_have_the_error_of_location_and_scale() {
        let question = ForecastQuestion {
            draws: 4000,
            years: 400,
            ..QUESTION
        };
        let mut random = Stream::new(5, 0);
        let y = [2.250_367, 3.901_939];
        for (of_location, of_scale) in [(0.2, 0.0), (0.0, 0.1)] {
            let mut halves = [0.0; 2];
            for _ in 0..10 {
                let mut draw = || {
                    let [location, scale] = [
                        of_location * random.normal(),
                        1.0 + of_scale * random.normal(),
                    ];
                    let mut year = || {
                        let mut year = [0.0; ForecastQuantity::ALL.len()];
                        let gumbel = -libm::log(-libm::log(random.uniform()));
                        year[ForecastQuantity::Greatest as usize] =
                            10.0 + location + scale * gumbel;
                        year
                    };
                    (0..question.years).map(|_| year()).collect::<Vec<Year>>()
                };
                let years: Vec<Vec<Year>> = (0..question.draws).map(|_| draw()).collect();
                for (half, period) in halves.iter_mut().zip(RETURN_PERIODS) {
                    let [low, high] = return_level(&years, period, &question).interval;
                    *half += 0.5 * (high - low) / 10.0;
                }
            }
            for (half, y) in halves.iter().zip(y) {
                let expected = 1.6449 * f64::hypot(of_location, y * of_scale);
                println!("{of_location} {of_scale}: {half:.4}, expected {expected:.4}");
                assert!(
                    (half / expected - 1.0).abs() < 0.05,
                    "{half}, expected {expected}"
                );
            }
        }
    }

    /// Whatever the years, the mean is that of the years and, with the most likely parameters, that of
    /// theirs; and it lies in its interval, which lies in that of a single year. The draws of the force
    /// differ by more than the years of a draw, as where friction limits it.
    #[test]
    fn one_mean_lies_in_its_range_and_that_in_a_years() {
        let mut random = Stream::new(7, 0);
        let likeliest = vec![[41.0, 73.0, 8.0, 10.0, 0.02, 5e5]; 20];
        for (of_draw, of_year) in [(0.2, 0.1), (0.03, 1e-4), (0.0, 0.3), (1e-9, 1e-12)] {
            let draws = (0..QUESTION.draws).map(|_| {
                let shift = of_draw * random.normal();
                let year = |random: &mut Stream| {
                    let factor = libm::exp(0.1 + shift + of_year * random.normal());
                    likeliest[0].map(|x| factor * x)
                };
                (0..QUESTION.years).map(|_| year(&mut random)).collect()
            });
            let draws: Vec<Vec<Year>> = std::iter::once(likeliest.clone()).chain(draws).collect();
            let found = of(draws, &QUESTION, 80.0).expect("usual").expect("whole");
            for level in &found.levels {
                let years = found.years.iter().flatten();
                let values: Vec<f64> = years.map(|year| year[level.quantity as usize]).collect();
                let is_mean = |x: f64| (x / mean(&values) - 1.0).abs() < 1e-12;
                assert!(is_mean(level.expected), "{level:?}");
                assert!(is_mean(likeliest[0][level.quantity as usize]), "{level:?}");
                let ([low, high], [least, most]) = (level.expected_interval, level.year_interval);
                assert!(least <= low && low <= level.expected, "{level:?}");
                assert!(level.expected <= high && high <= most, "{level:?}");
            }
        }
    }

    /// A stop leaves the last draw without some of its years, and a forecast that was stopped before
    /// two draws has no result.
    #[test]
    fn a_draw_without_some_of_its_years_is_left_out() {
        let question = ForecastQuestion {
            draws: 3,
            years: 2,
            ..QUESTION
        };
        let of = |years: &[usize]| {
            of(
                years.iter().map(|n| vec![[1.0; 6]; *n]).collect(),
                &question,
                1.0,
            )
            .expect("sound")
        };
        assert_eq!(of(&[20, 2, 2, 1]).expect("two draws").years.len(), 2);
        assert_eq!((of(&[]), of(&[20, 2, 1])), (None, None));
    }

    /// Forty years of fifty draws have 20 to 29 slips. A record with as many is usual, with 32 it is
    /// said, and with 40 or 12 there is no forecast, only what the record showed.
    #[test]
    fn a_record_unlike_its_forecast_is_said_or_refused() {
        let draw = || {
            (0..40)
                .map(|i| [0.0, 20.0 + f64::from(i % 10), 0.0, 0.0, 0.0, 0.0])
                .collect::<Vec<Year>>()
        };
        let draws: Vec<Vec<Year>> = (0..51).map(|_| draw()).collect();
        let said = |slips: f64| {
            of(draws.clone(), &QUESTION, slips).map(|found| found.expect("whole").warnings().len())
        };
        assert_eq!(
            [20.0, 29.0, 32.0, 17.0].map(said),
            [Ok(0), Ok(0), Ok(1), Ok(1)]
        );
        for slips in [40.0, 12.0] {
            let error = said(slips).expect_err("another record").to_string();
            assert!(
                error.starts_with(&format!(
                    "the record shows {slips} slips in 365 days, a sliding path of 10.0 mm"
                )),
                "{error}"
            );
        }
    }

    /// Two years of hours with three slips, one of them double: of four slips two belong to a year. A
    /// jump of the sensor is (1 - kappa) times that of the body.
    #[test]
    fn a_record_shows_its_slips_by_the_year() {
        let hours = 2.0 * YEAR / 3600.0;
        let times: Vec<f64> = (0..hours as usize).map(|i| 3600.0 * i as f64).collect();
        let slip = |jump: f64| SeenSlip {
            time: 0.0,
            temperature: 0.0,
            jump,
            is_usual: true,
        };
        // beta = 1e-3 m/K, kappa = 1/4 and G = 2 K: slips of 2 mm, seen as 1.5 mm.
        let calibration = Calibration {
            record: MeasuredRecord {
                temperatures: times.clone(),
                readings: times.clone(),
                times,
                ..MeasuredRecord::default()
            },
            response: Response {
                motion: Motion {
                    reach: 5.0,
                    jump: 2.0,
                    start: 0.0,
                },
                sensor: Sensor::sheared(0.0, 1e-3, 0.25),
            },
            slips: vec![slip(1.5e-3), slip(-1.5e-3), slip(3e-3)],
            ..Calibration::default()
        };
        let showed = Showed::of(&calibration);
        assert_eq!(showed.duration, YEAR);
        assert!((showed.slips - 2.0).abs() < 1e-3, "{showed:?}");
        assert!((showed.path - 4e-3).abs() < 1e-6, "{showed:?}");
    }

    /// The largest values of two years of two draws, 1 and 3, and 12 and 16: means of 2 and 14, and
    /// variances of 2 and 8. Gumbel's law of these moments exceeds mean + 1.30455 sd once in ten years,
    /// so the draws are 13.8449 apart. Of this, the years of a draw explain a variance of 2.5 * 4.35928,
    /// and the mean of both draws half of that. Student's t of one degree of freedom is 6.31375.
    #[test]
    fn a_return_level_is_that_of_gumbels_law() {
        let of = |greatest: f64| [0.0, 0.0, 0.0, greatest, 0.0, 0.0];
        let years = [vec![of(1.0), of(3.0)], vec![of(12.0), of(16.0)]];
        let found = return_level(&years, 10.0, &QUESTION);
        let within = 2.5 * 4.359_227;
        let variance = 13.844_914_f64.powi(2) / 2.0 - within + within / 2.0;
        let half = found.interval[1] - found.expected;
        assert!(
            (half / (6.313_752 * variance.sqrt()) - 1.0).abs() < 1e-5,
            "{half}"
        );
    }
}
