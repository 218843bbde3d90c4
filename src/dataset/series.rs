//! The samples of a measured temperature and of inputs. They are part of a data set so that it is
//! complete without the files of the measurements.

use super::layout;
use super::{Dataset, Source, read_or_empty, texts};
use crate::engine::Provenance;
use crate::model::{NamedSeries, Series};
use crate::scenario::{INPUT, TEMPERATURE_SERIES};

/// Write the samples, and the time stamp of t = 0 if the temperatures have time stamps.
pub(super) fn write(to: &mut Dataset, header: &Provenance) {
    let (temperature, inputs): (Vec<_>, Vec<_>) = header
        .samples
        .iter()
        .partition(|samples| samples.name == TEMPERATURE_SERIES);
    for NamedSeries { series, .. } in temperature {
        let stamp = header
            .series_start
            .as_deref()
            .map(|stamp| [("start", stamp)]);
        let time = layout::SERIES_TIME.with(stamp.as_ref().map_or(&[], |stamp| stamp));
        to.write(&time, series.times());
        to.write(&layout::SERIES_TEMPERATURE, series.values());
    }
    if inputs.is_empty() {
        return;
    }
    let all = |of: fn(&Series) -> &[f64]| {
        inputs
            .iter()
            .flat_map(|input| of(&input.series))
            .copied()
            .collect::<Vec<_>>()
    };
    to.write(
        &layout::INPUT,
        &texts(
            inputs
                .iter()
                .map(|input| input.name.strip_prefix(INPUT).unwrap_or(&input.name)),
        ),
    );
    let number = |(i, input): (usize, &&NamedSeries)| vec![i as u32; input.series.times().len()];
    to.write(
        &layout::INPUT_SAMPLE,
        &inputs
            .iter()
            .enumerate()
            .flat_map(number)
            .collect::<Vec<u32>>(),
    );
    to.write(&layout::INPUT_TIME, &all(Series::times));
    to.write(&layout::INPUT_VALUE, &all(Series::values));
}

/// The samples in a data set, each by its table.
pub fn read(from: &dyn Source) -> Result<Vec<NamedSeries>, String> {
    let mut found = Vec::new();
    let mut add = |name: String, times: &[f64], values: &[f64]| {
        let series =
            Series::new(times.to_vec(), values.to_vec()).map_err(|error| error.to_string())?;
        found.push(NamedSeries {
            name,
            series: series.into(),
        });
        Ok::<(), String>(())
    };
    let times: Vec<f64> = read_or_empty(from, &layout::SERIES_TIME)?;
    if !times.is_empty() {
        let values: Vec<f64> = read_or_empty(from, &layout::SERIES_TEMPERATURE)?;
        add(TEMPERATURE_SERIES.into(), &times, &values)?;
    }
    let (names, numbers): (Vec<String>, Vec<u32>) = (
        read_or_empty(from, &layout::INPUT)?,
        read_or_empty(from, &layout::INPUT_SAMPLE)?,
    );
    let [times, values]: [Vec<f64>; 2] = [
        read_or_empty(from, &layout::INPUT_TIME)?,
        read_or_empty(from, &layout::INPUT_VALUE)?,
    ];
    for (i, name) in names.iter().enumerate() {
        let of = |all: &[f64]| -> Vec<f64> {
            all.iter()
                .zip(&numbers)
                .filter(|(_, number)| **number as usize == i)
                .map(|(x, _)| *x)
                .collect()
        };
        let prefix = if name.starts_with(TEMPERATURE_SERIES) {
            ""
        } else {
            INPUT
        };
        add(format!("{prefix}{name}"), &of(&times), &of(&values))?;
    }
    Ok(found)
}

impl Dataset {
    /// The samples of a measured temperature and of inputs, each by its table. Fails if they are not
    /// valid series.
    pub fn samples(&self) -> Result<Vec<NamedSeries>, String> {
        read(self)
    }
}
