//! Wrong samples: a few in a row that differ strongly from those around them.

use super::samples::MeasuredRecord;
use crate::data::spikes;

/// Number of samples that were taken out.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Spikes {
    /// Number of readings of the displacement sensor.
    pub readings: usize,
    /// Number of temperatures.
    pub temperatures: usize,
}

/// A record without spikes, and their number. A reading is then missing, and a temperature is
/// interpolated between its neighbours.
pub fn without_spikes(record: &MeasuredRecord) -> (MeasuredRecord, Spikes) {
    let seen: Vec<usize> = (0..record.times.len()).filter(|i| record.readings[*i].is_finite()).collect();
    let readings: Vec<f64> = seen.iter().map(|i| record.readings[*i]).collect();
    let mut clean = record.clone();
    let mut counts = Spikes::default();
    for (place, is_spike) in seen.iter().zip(spikes(&readings, 0.0)) {
        if is_spike {
            clean.readings[*place] = f64::NAN;
            counts.readings += 1;
        }
    }
    let is_spike = spikes(&record.temperatures, record.resolution());
    let mut good: Option<usize> = None;
    for i in 0..is_spike.len() {
        if is_spike[i] {
            counts.temperatures += 1;
            continue;
        }
        let (t, x) = (&record.times, &record.temperatures);
        for k in good.map_or(0, |good| good + 1)..i {
            let share = good.map_or(1.0, |good| (t[k] - t[good]) / (t[i] - t[good]));
            clean.temperatures[k] = x[good.unwrap_or(i)] * (1.0 - share) + x[i] * share;
            clean.interpolated.push(k);
        }
        good = Some(i);
    }
    clean.interpolated.sort_unstable();
    clean.interpolated.dedup();
    (clean, counts)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_spike_goes_and_a_step_stays() {
        let wave = |i: usize| (i as f64 * 0.9).sin() * 0.1 + if i >= 30 { 5.0 } else { 0.0 };
        let times: Vec<f64> = (0..60).map(|i| i as f64).collect();
        let mut readings: Vec<f64> = (0..60).map(wave).collect();
        let mut temperatures = readings.clone();
        (readings[10], readings[45], readings[46]) = (9.0, -3.0, -3.1);
        temperatures[20] = 40.0;
        let (clean, counts) =
            without_spikes(&MeasuredRecord { times, temperatures, readings, ..MeasuredRecord::default() });
        assert_eq!(counts, Spikes { readings: 3, temperatures: 1 });
        let missing: Vec<usize> = (0..60).filter(|i| clean.readings[*i].is_nan()).collect();
        assert_eq!(missing, [10, 45, 46]);
        assert_eq!(clean.interpolated, [20]);
        assert!((clean.temperatures[20] - 0.5 * (wave(19) + wave(21))).abs() < 1e-12);
    }
}
