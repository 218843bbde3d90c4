//! Duration, step and output grid, read and checked together: which of them must be whole multiples depends on the scheme.

use super::check::largest_force;
use super::error::Fault;
use super::fields::{Fields, Read};
use super::keys;
use super::parse::about;
use super::source::Sources;
use super::{SchemeKind, Time};
use crate::model::Model;
use crate::scheme::{divergence_bound, monitoring_shift};

/// Most rows of the output grid: bands hold every path's value at every row of a block.
pub const MAX_ROWS: usize = 10_000;

/// Most steps of a path: beyond 2^53, t_n = n h is no longer distinct for every n.
pub const MAX_STEPS: f64 = 9_007_199_254_740_992.0;

/// Read `[time]`.
pub(super) fn time(
    sources: &Sources<'_>,
    root: &Fields<'_>,
    model: &Model,
    scheme: SchemeKind,
) -> Result<Time, Box<Fault>> {
    let table = root.table("time")?;
    let mut end = table.number(keys::END)?;
    // 0.0, never -0.0.
    end.value = end.value.abs();
    // Friction takes the body nowhere, however large it is.
    let mut free = model.clone();
    free.friction.static_force = 0.0;
    let (farthest, w0) = (divergence_bound(&free, end.value), model.oscillator.natural_frequency());
    if !keys::can_be_computed_with(&[farthest, farthest * w0]) {
        let speed = farthest * w0;
        let problem = format!(
            "lets |x| grow towards {farthest:e} and |x'| towards {speed:e}; above {:e} is too large to compute with",
            keys::LARGEST
        );
        let remedy = "choose units in which displacements, times and forces are closer to 1, or lower `time.end`";
        return Err(about(sources, &[&end], problem, remedy.into()));
    }
    let grid = Grid { sources, table, end };
    if scheme.is_time_stepping() { grid.stepped(model, scheme) } else { grid.free(scheme) }
}

/// The table, its end already read.
struct Grid<'a> {
    sources: &'a Sources<'a>,
    table: Fields<'a>,
    end: Read<f64>,
}

impl Grid<'_> {
    /// For a scheme without steps. A step in the file is left alone, so that one file serves every scheme; asking for one on
    /// the command line is a misunderstanding.
    fn free(&self, scheme: SchemeKind) -> Result<Time, Box<Fault>> {
        if let Some(step) =
            self.table.number_if_present(keys::STEP)?.filter(|step| self.sources.is_override(step.place))
        {
            let problem = format!("is given, but the {} scheme has no time step", scheme.name());
            let remedy = "leave it out (`scheme.tolerance` sets the accuracy), or choose a scheme that has one: \
                          `--scheme discrete-vi` or `--scheme corrected-vi`";
            return Err(about(self.sources, &[&step], problem, remedy.into()));
        }
        let end = self.end.value;
        let output_step = match self.table.number_if_present(keys::OUTPUT_STEP)? {
            None => Some(end / DEFAULT_ROWS).filter(|spacing| spacing.is_normal()).unwrap_or(1.0),
            Some(output) => {
                self.refuse_many_rows(&output, end / (MAX_ROWS - 1) as f64)?;
                output.value
            }
        };
        Ok(Time { end, step: None, output_step })
    }

    /// For a scheme with steps.
    fn stepped(&self, model: &Model, scheme: SchemeKind) -> Result<Time, Box<Fault>> {
        let Grid { sources, table, end } = self;
        let step = table.number(keys::STEP)?;
        let (t_end, h) = (end.value, step.value);

        let ratio = t_end / h;
        if ratio > MAX_STEPS {
            let problem = format!("makes t_end / h = {ratio:.3e} steps, and at most 2^53 = 9.0e15 can be counted");
            let remedy =
                format!("raise `time.step` to {:?} or more, or lower `time.end`", tidy(t_end / MAX_STEPS * 1.001));
            return Err(about(sources, &[&step, end], problem, remedy));
        }
        let steps = whole_multiple(t_end, h).ok_or_else(|| {
            let (below, above) = (ratio.floor(), ratio.ceil());
            let problem = format!("`time.end` = {t_end:?} is not a whole number of steps `time.step` = {h:?}");
            let list = |f: &dyn Fn(f64) -> f64, counts: [f64; 2]| {
                let values = counts.iter().filter(|n| **n > 0.0).map(|n| format!("{:?}", tidy(f(*n))));
                values.collect::<Vec<_>>().join(" or ")
            };
            let remedy = format!(
                "the nearest steps are {}; the nearest ends are {}",
                list(&|n| t_end / n, [above, below]),
                list(&|n| n * h, [below, above]),
            );
            about(sources, &[&step, end], problem, remedy)
        })?;

        if !step_is_usable(model, h) {
            let problem =
                format!("gives h/m = {:e} or a threshold h f_s/m that a double cannot hold", h / model.oscillator.mass);
            let remedy = "choose units in which mass, forces and step are closer to 1";
            return Err(about(sources, &[&step], problem, remedy.into()));
        }
        if scheme == SchemeKind::CorrectedVi {
            self.refuse_large_shift(model, &step)?;
        }
        let output_step = match table.number_if_present(keys::OUTPUT_STEP)? {
            None => default_output_step(t_end, h, steps),
            Some(output) => {
                self.refuse_between_steps(&output, &step)?;
                self.refuse_many_rows(&output, (t_end / h / (MAX_ROWS - 1) as f64).ceil() * h)?;
                output.value
            }
        };
        Ok(Time { end: t_end, step: Some(h), output_step })
    }

    /// The correction of the stick exit is the first term of an expansion: it must be small against f_s.
    fn refuse_large_shift(&self, model: &Model, step: &Read<f64>) -> Result<(), Box<Fault>> {
        let (f_s, shift) = (model.friction.static_force, monitoring_shift(model, step.value));
        if shift == 0.0 || shift < LARGEST_SHIFT * f_s {
            return Ok(());
        }
        let problem = format!(
            "makes the corrected-vi scheme lower the threshold f_s = `friction.static` = {f_s:?} by its shift 0.5826 K \
             beta rho sigma sqrt(h) = {:?}, half of it or more",
            tidy(shift)
        );
        let limit = (LARGEST_SHIFT * f_s / monitoring_shift(model, 1.0)).powi(2);
        let remedy = if limit > 0.0 {
            format!("choose `time.step` below {:?}, or `--scheme event-driven`", tidy(limit))
        } else {
            "without friction there is no stick to correct: choose `--scheme discrete-vi` or `--scheme event-driven`"
                .into()
        };
        Err(about(self.sources, &[step], problem, remedy))
    }

    /// The rows of the output grid are instants the scheme passes through.
    fn refuse_between_steps(&self, output: &Read<f64>, step: &Read<f64>) -> Result<(), Box<Fault>> {
        let (spacing, h) = (output.value, step.value);
        if whole_multiple(spacing, h).is_some() {
            return Ok(());
        }
        let ratio = spacing / h;
        let problem = format!("`time.output_step` = {spacing:?} is not a whole number of steps `time.step` = {h:?}");
        let nearest = [ratio.floor(), ratio.ceil()].map(|n| tidy(n.max(1.0) * h));
        let values = if nearest[0] == nearest[1] { &nearest[..1] } else { &nearest[..] };
        let values: Vec<String> = values.iter().map(|x| format!("{x:?}")).collect();
        let remedy = format!("the nearest output steps are {}", values.join(" or "));
        Err(about(self.sources, &[output, step], problem, remedy))
    }

    fn refuse_many_rows(&self, output: &Read<f64>, least: f64) -> Result<(), Box<Fault>> {
        let rows = (self.end.value / output.value * (1.0 + WHOLE)).floor() + 1.0;
        if rows <= MAX_ROWS as f64 {
            return Ok(());
        }
        let problem = format!("makes an output grid of {rows} rows, and at most {MAX_ROWS} are kept");
        let remedy = format!("write `time.output_step` = {:?} or more, or lower `time.end`", tidy(least));
        Err(about(self.sources, &[output, &self.end], problem, remedy))
    }
}

/// The corrected scheme is refused from this share of f_s on: beyond it the corridor that is left has little to do with the one asked for.
const LARGEST_SHIFT: f64 = 0.5;

/// h/m and the thresholds it makes of the friction forces: finite, and not so small that digits are lost.
fn step_is_usable(model: &Model, h: f64) -> bool {
    let h_over_m = h / model.oscillator.mass;
    let usable = |x: f64| x == 0.0 || x.is_normal();
    let thresholds = [model.friction.static_force, model.friction.dynamic_force];
    h.is_normal()
        && h_over_m.is_normal()
        && thresholds.iter().all(|f| usable(*f) && (*f == 0.0 || (h_over_m * f).is_normal()))
        && (h_over_m * largest_force(model)).is_finite()
}

/// How far, relative to it, a duration may be from a whole number of steps: rounding of decimal fractions, no more.
const WHOLE: f64 = 1e-9;

/// n, if `total` is n `part`.
fn whole_multiple(total: f64, part: f64) -> Option<f64> {
    let ratio = total / part;
    let n = ratio.round();
    ((ratio - n).abs() <= WHOLE * n && (n > 0.0 || total == 0.0)).then_some(n)
}

/// Rows of a default output grid, the first one not counted.
const DEFAULT_ROWS: f64 = 120.0;

/// About 120 rows: the count from 60 to 240 nearest to it that divides the steps, else whatever is near it.
fn default_output_step(end: f64, h: f64, steps: f64) -> f64 {
    if steps <= DEFAULT_ROWS {
        return h;
    }
    let distance = |rows: &f64| (rows / DEFAULT_ROWS).ln().abs();
    let divisor = (60..=240).map(f64::from).filter(|rows| steps % rows == 0.0);
    match divisor.min_by(|a, b| distance(a).total_cmp(&distance(b))) {
        // end / rows rather than a multiple of h: 60 / 120 is 0.5, 50 * 0.01 need not be.
        Some(rows) => end / rows,
        None => (steps / DEFAULT_ROWS).round() * h,
    }
}

/// To twelve digits, if that is all there is to it: 0.9 rather than 0.8999999999999999.
fn tidy(x: f64) -> f64 {
    format!("{x:.11e}").parse().unwrap_or(x)
}
