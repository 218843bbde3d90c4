//! Columns that distinguish several series in one file, as the name of a sensor does.

use super::error::quoted;
use super::header::Header;
use super::outliers::median;
use super::rows::CsvRows;

/// The columns that are not wanted and have few distinct cells.
pub(super) struct Labels {
    columns: Vec<LabelColumn>,
}

/// A column with its distinct cells, and the places of the rows where its cell changes, each with
/// the index of the new cell.
struct LabelColumn {
    field: usize,
    cells: Vec<Vec<u8>>,
    changes: Vec<(u32, usize)>,
}

/// A sample: time, value and the place of its row.
type Sample = (f64, f64, u32);

/// The most series in one file, and the number of samples that are inspected.
const MOST_LABELS: usize = 20;
const INSPECTED: usize = 500;

/// Half a day, in seconds.
const HALF_A_DAY: f64 = 43_200.0;

impl Labels {
    pub fn of(header: &Header) -> Self {
        let is_label = |field: &usize| {
            !header.times.contains(field)
                && !header.values.contains(field)
                && !header.is_of_time(*field)
        };
        let column = |field| LabelColumn {
            field,
            cells: Vec::new(),
            changes: Vec::new(),
        };
        Labels {
            columns: (0..header.names.len())
                .filter(is_label)
                .map(column)
                .collect(),
        }
    }

    /// Take the cells of the current row.
    pub fn take(&mut self, rows: &CsvRows<'_>) {
        self.columns
            .retain_mut(|column| column.take(rows.cell(column.field), rows.place()));
    }

    /// The column that distinguishes interleaved series among these samples, with its cells.
    pub fn separating(&self, samples: &[Sample], in_seconds: bool) -> Option<(usize, String)> {
        let mut columns = self
            .columns
            .iter()
            .filter(|column| column.cells.len() > 1)
            .peekable();
        columns.peek()?;
        let mut samples = samples.to_vec();
        samples.sort_by(|a, b| a.0.total_cmp(&b.0));
        samples.truncate(INSPECTED);
        let column = columns.find(|column| column.separates(&samples, in_seconds))?;
        let mut cells: Vec<String> = column
            .cells
            .iter()
            .map(|cell| format!("`{}`", quoted(cell)))
            .collect();
        cells.sort();
        Some((column.field, cells.join(", ")))
    }
}

impl LabelColumn {
    /// Take the next cell; false if there are too many distinct ones.
    fn take(&mut self, cell: &[u8], place: u32) -> bool {
        let last = self.changes.last().map(|(_, label)| *label);
        if last.is_some_and(|label| self.cells[label] == cell) {
            return true;
        }
        let known = self.cells.iter().position(|known| known == cell);
        let label = known.unwrap_or_else(|| {
            self.cells.push(cell.to_vec());
            self.cells.len() - 1
        });
        self.changes.push((place, label));
        self.cells.len() <= MOST_LABELS
    }

    fn label(&self, place: u32) -> usize {
        let next = self.changes.partition_point(|(from, _)| *from <= place);
        self.changes[next.saturating_sub(1)].1
    }

    /// Whether the cells of samples in order of time alternate, each at regular times, and either
    /// the times between the samples of different cells are uneven, or samples of the same cell are
    /// closer in value than neighbours. Parts of a day or a week alternate as well, but evenly, and
    /// their values may repeat after a day.
    fn separates(&self, samples: &[Sample], in_seconds: bool) -> bool {
        let mut last = vec![None; self.cells.len()];
        let (mut steps, mut cycles, mut changes) = (Vec::new(), Vec::new(), 0);
        let mut before: Option<(Sample, usize)> = None;
        let apart = |a: &Sample, b: &Sample| (a.0 - b.0, (a.1 - b.1).abs());
        for sample in samples {
            let label = self.label(sample.2);
            if let Some((before, other)) = before.replace((*sample, label)) {
                steps.push(apart(sample, &before));
                changes += usize::from(label != other);
            }
            let same = last[label].replace(*sample);
            cycles.extend(same.map(|same| apart(sample, &same)));
        }
        let series = last.iter().flatten().count();
        if series < 2 || samples.len() < 4 * series || 10 * changes < 6 * steps.len() {
            return false;
        }
        let times = |apart: &[(f64, f64)]| apart.iter().map(|apart| apart.0).collect::<Vec<f64>>();
        let values = |apart: &[(f64, f64)]| {
            median(&mut apart.iter().map(|apart| apart.1).collect::<Vec<f64>>())
        };
        let cycle = median(&mut times(&cycles));
        let is_cycle = |apart: &&(f64, f64)| (apart.0 - cycle).abs() <= 0.01 * cycle;
        let mut sorted = times(&steps);
        sorted.sort_by(f64::total_cmp);
        let is_uneven = cycle > 2.0 * series as f64 * sorted[sorted.len() / 10];
        let is_short = in_seconds && cycle < HALF_A_DAY;
        2 * cycles.iter().filter(is_cycle).count() > cycles.len()
            && (is_uneven || is_short && values(&cycles) < 0.5 * values(&steps))
    }
}
