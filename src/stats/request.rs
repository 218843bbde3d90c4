//! The requests of a run: records of single paths, and measures in addition to those of every run.

use super::Statistic;
use super::catalogue::Extra;

/// The records of a run in addition to the statistics of the ensemble.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Record {
    /// Whether scalars of every path are kept.
    pub paths: bool,
    /// Whether the events of every path are kept.
    pub events: bool,
    /// How many paths, from the first on, are kept on the output grid.
    pub trajectories: u64,
    /// Whether the laws of slips, jumps and times from slip to slip are reported.
    pub laws: bool,
    /// Whether the densities of x and x' are reported.
    pub density: bool,
    /// Whether autocovariance and spectrum of x and x' are reported.
    pub spectrum: bool,
    /// Whether the energy that each force gives to the body is reported.
    pub energy: bool,
    /// Displacements from the start whose passages are reported, with the largest ones.
    pub levels: PassageLevels,
}

/// Distances from the initial displacement whose first passages are reported, up to
/// [`PassageLevels::MOST`].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PassageLevels([Option<f64>; PassageLevels::MOST]);

impl PassageLevels {
    /// The largest number of levels.
    pub const MOST: usize = 8;
    /// No levels.
    pub const NONE: PassageLevels = PassageLevels([None; PassageLevels::MOST]);

    /// These levels, of which those beyond the largest number are left out.
    pub fn of(levels: &[f64]) -> Self {
        let mut all = PassageLevels::NONE;
        all.0
            .iter_mut()
            .zip(levels)
            .for_each(|(slot, level)| *slot = Some(*level));
        all
    }

    /// The levels, in order.
    pub fn iter(&self) -> impl Iterator<Item = f64> {
        self.0.iter().copied().flatten()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.0[0].is_none()
    }
}

impl Default for Record {
    /// Nothing is recorded in addition to the statistics of the ensemble.
    fn default() -> Self {
        Record::NOTHING
    }
}

impl Record {
    /// Nothing is kept of single paths.
    pub const NOTHING: Record = Record {
        paths: false,
        events: false,
        trajectories: 0,
        laws: false,
        density: false,
        spectrum: false,
        energy: false,
        levels: PassageLevels::NONE,
    };

    /// Whether this is requested.
    pub(super) fn asks_for(&self, extra: Extra) -> bool {
        match extra {
            Extra::Laws => self.laws,
            Extra::Energy => self.energy,
            Extra::Levels => !self.levels.is_empty(),
        }
    }

    /// Whether the motion of paths between their events is followed.
    pub(super) fn has_motion(&self) -> bool {
        self.asks_for(Extra::Energy) || self.asks_for(Extra::Levels)
    }

    /// The key of a requested curve, if any. A sweep does not store curves.
    pub fn curve(&self) -> Option<&'static str> {
        let curves = [
            (self.density, "record.density"),
            (self.spectrum, "record.spectrum"),
        ];
        curves
            .into_iter()
            .find_map(|(is_asked, key)| is_asked.then_some(key))
    }

    /// The same with the request that this statistic needs; none if that needs values, the levels
    /// (`statistics.levels`).
    pub fn asking_for(self, statistic: Statistic) -> Option<Record> {
        match statistic.row().asked_by {
            None => Some(self),
            Some(Extra::Laws) => Some(Record { laws: true, ..self }),
            Some(Extra::Energy) => Some(Record {
                energy: true,
                ..self
            }),
            Some(Extra::Levels) => Some(self).filter(|record| !record.levels.is_empty()),
        }
    }

    /// The same statistics, without records of single paths or the output grid.
    pub fn of_no_path(&self) -> Record {
        Record {
            laws: self.laws,
            energy: self.energy,
            levels: self.levels,
            ..Record::NOTHING
        }
    }
}

impl Statistic {
    /// Whether a run that records this reports the statistic.
    pub fn is_asked_by(self, record: &Record) -> bool {
        self.row()
            .asked_by
            .is_none_or(|extra| record.asks_for(extra))
    }

    /// The statistics that a run reports that records this, in the order of tables and files.
    pub fn asked_by(record: &Record) -> Vec<Statistic> {
        Statistic::ALL
            .into_iter()
            .filter(|statistic| statistic.is_asked_by(record))
            .collect()
    }
}
