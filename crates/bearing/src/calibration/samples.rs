//! The record, in the forms that the methods need.

pub use stickslip_data::{median, spread};

use super::zero::Zero;
use std::ops::Range;
use stickslip_data::{BearingData, Start, resolution};

/// A record of a thermometer and a displacement sensor, in order of time.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MeasuredRecord {
    /// Times, in seconds.
    pub times: Vec<f64>,
    /// Temperatures in kelvin or degrees Celsius; none is missing.
    pub temperatures: Vec<f64>,
    /// Readings of the sensor; NaN where there is none.
    pub readings: Vec<f64>,
    /// The indices of interpolated temperatures, in ascending order.
    pub interpolated: Vec<usize>,
    /// The averaging times of temperatures and readings, centred on their times, in seconds; 0 for
    /// instantaneous values.
    pub averaged: [f64; 2],
    /// The instant from which the times count, if it is known.
    pub start: Option<Start>,
    /// What was repaired and assumed when the record was read, in sentences.
    pub repairs: Vec<String>,
    /// The option that leaves out an outlier that was kept, if there is one.
    pub mark: Option<String>,
}

/// Seconds of an hour.
pub const HOUR: f64 = 3600.0;

/// A pause longer than this many sampling intervals is a gap, unless samples are lost at random.
const GAP: f64 = 3.5;

/// One in this many repeated values may change sooner.
const RARELY: usize = 50;

/// The change of a repeated value, in divisions of the thermometer.
const DIVISIONS: f64 = 2.5;

/// Samples with a longer interval, relative to the usual one, follow a lost sample.
const AFTER_LOST: f64 = 1.5;

impl From<&BearingData> for MeasuredRecord {
    fn from(
        BearingData {
            temperature,
            displacement,
            start,
            repairs,
        }: &BearingData,
    ) -> Self {
        let averaged = [temperature.averaged, displacement.averaged];
        let [air, sensor] =
            [temperature, displacement].map(|column| [&column.times[..], &column.values[..]]);
        let most = 0.5 * averaged[0].max(averaged[1]);
        let start = start.and_then(|start| start.after(-most));
        let mark = displacement.mark.clone();
        MeasuredRecord {
            start,
            repairs: repairs.clone(),
            mark: mark.or_else(|| temperature.mark.clone()),
            ..MeasuredRecord::of_means(air, sensor, averaged)
        }
    }
}

impl MeasuredRecord {
    /// The same as [`MeasuredRecord::of`] from temperatures and displacements that are means over
    /// this many seconds before their times; 0 for instantaneous values. A mean is assigned to the
    /// middle of its interval, and all times are shifted by half of the longer one, so that they
    /// are not negative.
    pub fn of_means(
        temperatures: [&[f64]; 2],
        readings: [&[f64]; 2],
        averaged: [f64; 2],
    ) -> MeasuredRecord {
        let most = 0.5 * averaged[0].max(averaged[1]);
        let middles = |times: &[f64], over: f64| {
            times
                .iter()
                .map(|t| t + (most - 0.5 * over))
                .collect::<Vec<f64>>()
        };
        let times = [
            middles(temperatures[0], averaged[0]),
            middles(readings[0], averaged[1]),
        ];
        let both = MeasuredRecord::of([&times[0], temperatures[1]], [&times[1], readings[1]]);
        MeasuredRecord { averaged, ..both }
    }

    /// A record from temperatures and displacements, each as times and values in order of time. It
    /// has a sample at each time of the temperatures. A displacement at another time gets the
    /// temperature interpolated between its neighbours, unless they are separated by a gap.
    pub fn of([times, temperatures]: [&[f64]; 2], [when, readings]: [&[f64]; 2]) -> MeasuredRecord {
        let gap = longest_pause(times);
        let mut record = MeasuredRecord::default();
        let mut interpolated = Vec::new();
        let mut next = 0;
        for i in 0..times.len() {
            while next < when.len() && when[next] < times[i] {
                if i > 0 && times[i] - times[i - 1] <= gap {
                    let share = (when[next] - times[i - 1]) / (times[i] - times[i - 1]);
                    let between =
                        temperatures[i - 1] + share * (temperatures[i] - temperatures[i - 1]);
                    interpolated.push(record.times.len());
                    record.push(when[next], between, readings[next]);
                }
                next += 1;
            }
            let is_both = next < when.len() && when[next] == times[i];
            record.push(
                times[i],
                temperatures[i],
                if is_both { readings[next] } else { f64::NAN },
            );
            next += usize::from(is_both);
        }
        record.interpolated = interpolated;
        record
    }

    /// If the thermometer repeats each value until it measures again: the same record with only the first
    /// of equal temperatures, and the usual time between measurements, in seconds.
    ///
    /// Values then change by many divisions at once, and never twice within a shorter time. A smooth
    /// temperature of coarse resolution changes by one division.
    pub fn without_repeated(&self) -> Option<(MeasuredRecord, f64)> {
        let [times, temperatures] = self.thermometer();
        let every = interval(&times);
        let is_next = |i: &usize| times[*i] - times[i - 1] < AFTER_LOST * every;
        let new = (1..times.len()).filter(|i| temperatures[*i] != temperatures[i - 1]);
        let new: Vec<usize> = new.filter(is_next).collect();
        let mut apart: Vec<f64> = new
            .windows(2)
            .map(|pair| times[pair[1]] - times[pair[0]])
            .collect();
        apart.sort_by(f64::total_cmp);
        let shortest = *apart.get(apart.len() / RARELY)?;
        let change = |i: &usize| (temperatures[*i] - temperatures[i - 1]).abs();
        let change = median(&mut new.iter().map(change).collect::<Vec<_>>());
        if shortest < AFTER_LOST * every || change < DIVISIONS * resolution(&temperatures) {
            return None;
        }
        let kept = |values: &[f64]| new.iter().map(|i| values[*i]).collect::<Vec<f64>>();
        let seen = self.samples();
        let both = MeasuredRecord::of(
            [&kept(&times), &kept(&temperatures)],
            [&seen.times, &seen.readings],
        );
        let record = MeasuredRecord {
            averaged: self.averaged,
            start: self.start,
            repairs: self.repairs.clone(),
            mark: self.mark.clone(),
            ..both
        };
        Some((record, median(&mut apart)))
    }

    fn push(&mut self, time: f64, temperature: f64, reading: f64) {
        self.times.push(time);
        self.temperatures.push(temperature);
        self.readings.push(reading);
    }

    /// The thermometer's own samples: times and temperatures.
    pub fn thermometer(&self) -> [Vec<f64>; 2] {
        let is_own = |i: &usize| self.interpolated.binary_search(i).is_err();
        let own: Vec<usize> = (0..self.times.len()).filter(is_own).collect();
        [&self.times, &self.temperatures].map(|values| own.iter().map(|i| values[*i]).collect())
    }

    /// The same record with readings corrected for the movement of the zero.
    pub fn without(&self, zero: &Zero) -> MeasuredRecord {
        let readings = self
            .times
            .iter()
            .zip(&self.readings)
            .map(|(time, reading)| reading - zero.at(*time))
            .collect();
        MeasuredRecord {
            readings,
            ..self.clone()
        }
    }

    /// The same record without the readings at these places.
    pub fn without_readings(&self, at: &[usize]) -> MeasuredRecord {
        let mut record = self.clone();
        at.iter().for_each(|i| record.readings[*i] = f64::NAN);
        record
    }

    /// The same record with readings of a sensor that does not itself expand by this many metres per
    /// kelvin; its temperature is that of the thermometer, from the first one on.
    pub fn without_expansion(mut self, per_kelvin: f64) -> MeasuredRecord {
        let first = self.temperatures.first().copied().unwrap_or(0.0);
        let both = self.readings.iter_mut().zip(&self.temperatures);
        both.for_each(|(reading, temperature)| *reading -= per_kelvin * (temperature - first));
        self
    }

    /// The same record with temperatures that are interpolated between these.
    pub fn with_temperatures(&self, times: &[f64], temperatures: &[f64]) -> MeasuredRecord {
        let at = |time: &f64| {
            let after = times
                .partition_point(|t| t < time)
                .clamp(1, times.len() - 1);
            let share = (time - times[after - 1]) / (times[after] - times[after - 1]);
            temperatures[after - 1]
                + share.clamp(0.0, 1.0) * (temperatures[after] - temperatures[after - 1])
        };
        MeasuredRecord {
            temperatures: self.times.iter().map(at).collect(),
            ..self.clone()
        }
    }

    /// The samples that have a reading.
    pub fn samples(&self) -> Samples {
        let seen: Vec<usize> = (0..self.times.len())
            .filter(|i| self.readings[*i].is_finite())
            .collect();
        let pick = |values: &[f64]| seen.iter().map(|i| values[*i]).collect::<Vec<f64>>();
        let times = pick(&self.times);
        let starts = starts(&times);
        Samples {
            temperatures: pick(&self.temperatures),
            readings: pick(&self.readings),
            times,
            starts,
        }
    }

    /// The same record with the temperature of the steel, which follows that of the air with this
    /// lag, in seconds.
    ///
    /// dS/dt = (T - S)/lag, with T linear from sample to sample, for which the solution is exact.
    /// At the start and after each gap, S is T.
    pub fn lagged(&self, lag: f64) -> MeasuredRecord {
        let mut steel = self.temperatures.clone();
        if lag > 0.0 {
            let starts = starts(&self.times);
            for stretch in stretches(&starts, self.times.len()) {
                for i in stretch.start + 1..stretch.end {
                    let h = self.times[i] - self.times[i - 1];
                    let rise = lag * (self.temperatures[i] - self.temperatures[i - 1]) / h;
                    let behind = steel[i - 1] - self.temperatures[i - 1] + rise;
                    steel[i] = self.temperatures[i] - rise + behind * libm::exp(-h / lag);
                }
            }
        }
        MeasuredRecord {
            temperatures: steel,
            ..self.clone()
        }
    }

    /// The same record with the temperature that a thermometer follows with this time constant, in
    /// seconds: T + lag dT/dt, with dT/dt from the neighbours of each sample.
    pub fn sharpened(&self, lag: f64) -> MeasuredRecord {
        let [times, shown] = self.thermometer();
        let mut followed = shown.clone();
        for i in 1..times.len().saturating_sub(1) {
            followed[i] += lag * (shown[i + 1] - shown[i - 1]) / (times[i + 1] - times[i - 1]);
        }
        self.with_temperatures(&times, &followed)
    }

    /// The same record with the temperature of this many seconds earlier, interpolated between
    /// samples, as if the clock of the sensor were ahead of that of the thermometer.
    pub fn shifted(&self, seconds: f64) -> MeasuredRecord {
        let later: Vec<f64> = self.times.iter().map(|time| time + seconds).collect();
        self.with_temperatures(&later, &self.temperatures)
    }

    /// The time that each sample represents, in seconds: half of the distance to each of its
    /// neighbours, or half a typical interval towards a gap. It is zero for a sample without a
    /// reading.
    pub fn shares(&self) -> Vec<f64> {
        let samples = self.samples();
        let interval = samples.interval();
        let mut seen = vec![interval; samples.times.len()];
        for stretch in samples.stretches() {
            for i in stretch.start + 1..stretch.end {
                let half = 0.5 * (samples.times[i] - samples.times[i - 1] - interval);
                seen[i - 1] += half;
                seen[i] += half;
            }
        }
        let mut seen = seen.into_iter();
        let share = |reading: &f64| {
            if reading.is_finite() {
                seen.next().unwrap_or(0.0)
            } else {
                0.0
            }
        };
        self.readings.iter().map(share).collect()
    }

    /// The resolution of the thermometer, in kelvin: the median distance of neighbouring values.
    pub fn resolution(&self) -> f64 {
        resolution(&self.temperatures)
    }
}

/// Samples in order of time, each with a temperature and a reading.
#[derive(Clone, Debug, PartialEq)]
pub struct Samples {
    /// Times, in seconds.
    pub times: Vec<f64>,
    /// Temperatures, in kelvin.
    pub temperatures: Vec<f64>,
    /// Readings of the sensor.
    pub readings: Vec<f64>,
    /// The index at which each segment without a gap begins; the first is 0.
    pub starts: Vec<usize>,
}

impl Samples {
    /// The segments without a gap.
    pub fn stretches(&self) -> impl Iterator<Item = Range<usize>> {
        stretches(&self.starts, self.times.len())
    }

    /// This many seconds in intervals between samples.
    pub fn intervals(&self, seconds: f64) -> usize {
        (seconds / self.interval()).round() as usize
    }

    /// The indices of pairs of samples that are this many intervals apart, without a gap between
    /// them.
    pub fn pairs(&self, step: usize) -> impl Iterator<Item = [usize; 2]> {
        let later = self
            .stretches()
            .flat_map(move |stretch| stretch.start + step..stretch.end);
        later.map(move |i| [i - step, i])
    }

    /// The median time between samples, in seconds.
    pub fn interval(&self) -> f64 {
        interval(&self.times)
    }
}

/// The median time between samples, in seconds.
pub fn interval(times: &[f64]) -> f64 {
    median(
        &mut times
            .windows(2)
            .map(|pair| pair[1] - pair[0])
            .collect::<Vec<_>>(),
    )
}

/// The longest time between samples that is not a gap, in seconds.
///
/// A radio loses samples at random. If it loses a share q of n samples, it loses k of them in a row n q^k
/// times; what is expected less than half a time is a gap.
fn longest_pause(times: &[f64]) -> f64 {
    let interval = interval(times);
    let steps = || times.windows(2).map(|pair| pair[1] - pair[0]);
    let n = steps().count() as f64;
    let lost = steps().filter(|step| *step > AFTER_LOST * interval).count() as f64 / n;
    let in_a_row = libm::log(2.0 * n) / -libm::log(lost);
    interval * GAP.max(1.5 + in_a_row)
}

/// The index at which each segment without a gap begins.
pub fn starts(times: &[f64]) -> Vec<usize> {
    let longest = longest_pause(times);
    (0..times.len())
        .filter(|i| *i == 0 || times[*i] - times[*i - 1] > longest)
        .collect()
}

/// The segments that begin at these indices, of samples up to this end.
pub fn stretches(starts: &[usize], end: usize) -> impl Iterator<Item = Range<usize>> {
    let ends = starts.iter().skip(1).copied().chain([end]);
    starts.iter().zip(ends).map(|(start, end)| *start..end)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn record(times: &[f64], readings: &[f64]) -> MeasuredRecord {
        let (times, temperatures) = (times.to_vec(), times.to_vec());
        MeasuredRecord {
            times,
            temperatures,
            readings: readings.to_vec(),
            ..MeasuredRecord::default()
        }
    }

    /// After a gap the steel begins at the temperature of the air, and elsewhere it follows a step of
    /// the air within one interval by the exact solution.
    #[test]
    fn a_lag_begins_anew_after_a_gap() {
        let times = [0.0, 1.0, 2.0, 3.0, 4.0, 11.0, 12.0];
        let air = MeasuredRecord {
            temperatures: vec![0.0, 0.0, 1.0, 1.0, 1.0, 5.0, 5.0],
            ..record(&times, &[0.0; 7])
        };
        let steel = air.lagged(2.0).temperatures;
        let (decay, rise) = ((-0.5_f64).exp(), 2.0 * (1.0 - (-0.5_f64).exp()));
        let wanted = [
            0.0,
            0.0,
            1.0 - rise,
            1.0 - rise * decay,
            1.0 - rise * decay * decay,
            5.0,
            5.0,
        ];
        for (found, wanted) in steel.iter().zip(wanted) {
            assert!((found - wanted).abs() < 1e-12, "{steel:?}");
        }
    }

    /// Temperatures that are means over the ten minutes before their stamps belong five minutes
    /// earlier, so readings at an instant lie 300 s later on the common time axis, where the first
    /// mean is at its stamp.
    #[test]
    fn means_lie_in_the_middle_of_their_windows() {
        let stamps = [0.0, 600.0, 1200.0, 1800.0];
        let of =
            |averaged| MeasuredRecord::of_means([&stamps, &stamps], [&stamps, &[7.0; 4]], averaged);
        let seen = of([600.0, 0.0]);
        assert_eq!(seen.thermometer(), [stamps.to_vec(), stamps.to_vec()]);
        assert_eq!(
            seen.samples().times,
            stamps[..3].iter().map(|t| t + 300.0).collect::<Vec<_>>()
        );
        assert_eq!(seen.samples().temperatures, [300.0, 900.0, 1500.0]);
        let seen = of([0.0, 600.0]);
        assert_eq!(seen.thermometer()[0], stamps.map(|t| t + 300.0));
        assert_eq!(seen.samples().times, stamps[1..]);
        let seen = of([600.0, 600.0]);
        assert_eq!(
            [seen.thermometer()[0].clone(), seen.samples().times],
            [stamps; 2]
        );
    }

    #[test]
    fn a_gap_ends_a_stretch_and_stands_for_no_time() {
        let times = [0.0, 1.0, 2.0, 3.0, 4.0, 11.0, 12.0, 14.0];
        let record = record(&times, &[0.0, 0.0, 0.0, 0.0, 0.0, 0.0, f64::NAN, 0.0]);
        assert_eq!(
            record.samples().stretches().collect::<Vec<_>>(),
            [0..5, 5..7]
        );
        assert_eq!(record.shares(), [1.0, 1.0, 1.0, 1.0, 1.0, 2.0, 0.0, 2.0]);
    }

    #[test]
    fn two_columns_become_one_record() {
        let both = MeasuredRecord::of(
            [&[0.0, 10.0, 20.0, 100.0], &[1.0, 2.0, 3.0, 4.0]],
            [&[0.0, 15.0, 60.0, 100.0], &[5.0, 6.0, 7.0, 8.0]],
        );
        assert_eq!(both.times, [0.0, 10.0, 15.0, 20.0, 100.0]);
        assert_eq!(both.temperatures, [1.0, 2.0, 2.5, 3.0, 4.0]);
        assert_eq!(both.interpolated, [2]);
        assert_eq!(
            both.thermometer(),
            [vec![0.0, 10.0, 20.0, 100.0], vec![1.0, 2.0, 3.0, 4.0]]
        );
        assert!(both.readings[1].is_nan() && both.readings[3].is_nan());
        assert_eq!(
            [both.readings[0], both.readings[2], both.readings[4]],
            [5.0, 6.0, 8.0]
        );
    }

    /// Compared with small explicit steps of the differential equation.
    #[test]
    fn steel_follows_air_exactly() {
        let times = [0.0, 600.0, 1300.0, 1800.0];
        let temperatures = vec![3.0, 5.0, 1.0, 1.0];
        let record = MeasuredRecord {
            times: times.to_vec(),
            temperatures,
            readings: vec![0.0; 4],
            ..MeasuredRecord::default()
        };
        let (lag, h) = (900.0, 0.01);
        let (mut steel, mut expected) = (3.0, vec![3.0]);
        for i in 1..4 {
            let n = ((times[i] - times[i - 1]) / h).round() as usize;
            let air = |k: f64| {
                record.temperatures[i - 1]
                    + (record.temperatures[i] - record.temperatures[i - 1]) * k / n as f64
            };
            for k in 0..n {
                steel += h / lag * (air(k as f64 + 0.5) - steel);
            }
            expected.push(steel);
        }
        let far = record
            .lagged(lag)
            .temperatures
            .iter()
            .zip(expected)
            .map(|(a, b)| (a - b).abs())
            .fold(0.0, f64::max);
        assert!(far < 1e-4, "{far}");
    }

    /// Samples every ten minutes, of which a radio loses 30 % at random, have no gap; a pause of two hours
    /// is one, and so is one of 40 minutes where nothing is lost. Null hypothesis: losses are independent.
    /// A pause beyond the limit is then expected 0.2 times among 10 000 samples; the seed is fixed.
    #[test]
    fn samples_lost_at_random_leave_no_gap() {
        let mut random = stickslip::noise::Stream::new(4, 0);
        let all: Vec<f64> = (0..10_000).map(|i| 600.0 * f64::from(i)).collect();
        let kept = |range: Range<usize>, times: &[f64]| -> Vec<f64> {
            let outside = times.iter().enumerate().filter(|(i, _)| !range.contains(i));
            outside.map(|(_, time)| *time).collect()
        };
        let mut some = all.clone();
        some.retain(|_| random.uniform() >= 0.3);
        let longest = some
            .windows(2)
            .map(|pair| pair[1] - pair[0])
            .fold(0.0, f64::max);
        assert!(longest > 3000.0, "{longest}");
        assert_eq!(starts(&some).len(), 1);
        assert_eq!(starts(&kept(5000..5012, &some)).len(), 2);
        assert_eq!(
            (starts(&all).len(), starts(&kept(5000..5003, &all)).len()),
            (1, 2)
        );
    }

    /// A thermometer that measures every half hour, and of which ten minutes are stored, leaves one sample
    /// in three; one that measures every time leaves all, and so does a smooth temperature that is stored
    /// in whole kelvins.
    #[test]
    fn repeated_values_are_stored_once() {
        let mut random = stickslip::noise::Stream::new(6, 0);
        let times: Vec<f64> = (0..3000).map(|i| 600.0 * f64::from(i)).collect();
        let mut walk = 10.0;
        let mut air = |_: &f64| {
            walk += 0.3 * random.normal();
            (10.0_f64 * walk).round() / 10.0
        };
        let air: Vec<f64> = times.iter().map(&mut air).collect();
        let of = |value: &dyn Fn(usize) -> f64| {
            let temperatures: Vec<f64> = (0..times.len()).map(value).collect();
            let record = MeasuredRecord::of([&times, &temperatures], [&times, &air]);
            record.without_repeated()
        };
        let (record, every) = of(&|i| air[i - i % 3]).expect("repeated");
        let [kept, temperatures] = record.thermometer();
        assert_eq!(every, 1800.0);
        assert!(
            kept.len() > 900 && kept.iter().all(|time| time % 1800.0 == 0.0),
            "{}",
            kept.len()
        );
        let is_own = |(time, t): (&f64, &f64)| *t == air[(time / 600.0) as usize];
        assert!(kept.iter().zip(&temperatures).all(is_own));
        assert!(record.samples().times.len() > times.len() - 20);
        assert_eq!(of(&|i| air[i]), None);
        assert_eq!(of(&|i| (10.0 * libm::sin(0.01 * i as f64)).round()), None);
    }

    /// A sensor that expands by 5 um/K shows this in addition.
    #[test]
    fn the_expansion_of_a_sensor_is_subtracted() {
        let shown = MeasuredRecord {
            temperatures: vec![20.0, 22.0, 17.0],
            readings: vec![1e-3, 1e-3 + 10e-6, 1e-3 - 15e-6],
            ..MeasuredRecord::default()
        };
        let freed = shown.without_expansion(5e-6).readings;
        assert!(freed.iter().all(|z| (z - 1e-3).abs() < 1e-15), "{freed:?}");
    }
}
