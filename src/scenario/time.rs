//! Duration and output grid, both of which must be whole multiples of the step if the scheme has
//! one.

use super::limits::{MAX_ROWS, MAX_STEPS};
use crate::scheme::{CheckError, Scheme};
use stickslip_text::numbers::{round_up, tidy};

/// Duration and output grid of a run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Time {
    /// t_end >= 0, a whole multiple of the step if the scheme has one.
    pub end: f64,
    /// Spacing of the output grid, a whole multiple of the step if the scheme has one.
    pub output_step: f64,
}

/// Check that `end` is a whole number of steps, and not too many to count, if the scheme has steps.
pub(crate) fn check_end(scheme: Scheme, end: f64) -> Option<CheckError> {
    let h = scheme.step()?;
    let about = [("time.step", h), ("time.end", end)];
    let ratio = end / h;
    if ratio > MAX_STEPS {
        let problem =
            format!("gives t_end / h = {ratio:.3e} steps; at most 2^53 = 9.0e15 are supported");
        let remedy = format!(
            "raise `time.step` to {:?} or more, or lower `time.end`",
            round_up(end / MAX_STEPS)
        );
        return Some(CheckError::new(&about, problem, remedy));
    }
    if whole_multiple(end, h).is_some() {
        return None;
    }
    let (below, above) = (ratio.floor(), ratio.ceil());
    let problem =
        format!("`time.end` = {end:?} is not a whole number of steps `time.step` = {h:?}");
    let list = |f: &dyn Fn(f64) -> f64, counts: [f64; 2]| {
        let values = counts
            .iter()
            .filter(|n| **n > 0.0)
            .map(|n| format!("{:?}", tidy(f(*n))));
        values.collect::<Vec<_>>().join(" or ")
    };
    let remedy = format!(
        "the nearest steps are {}; the nearest ends are {}",
        list(&|n| end / n, [above, below]),
        list(&|n| n * h, [below, above]),
    );
    Some(CheckError::new(&about, problem, remedy))
}

/// Number of rows of a default output grid, without the row at t = 0.
const DEFAULT_ROWS: f64 = 120.0;

impl Time {
    /// A duration with an output grid of about 120 rows. `end` must be a whole number of steps if
    /// the scheme has steps.
    pub(crate) fn with_default_rows(end: f64, scheme: Scheme) -> Self {
        let output_step = match scheme.step() {
            Some(h) => default_output_step(end, h),
            None => Some(end / DEFAULT_ROWS)
                .filter(|spacing| spacing.is_normal())
                .unwrap_or(1.0),
        };
        Time { end, output_step }
    }

    /// Check that the output grid falls on steps of the scheme, if it has steps, and has at most
    /// [`MAX_ROWS`] rows.
    pub(crate) fn check_rows(&self, scheme: Scheme) -> Option<CheckError> {
        let Time { end, output_step } = *self;
        if let Some(check_error) = scheme
            .step()
            .and_then(|h| check_between_steps(output_step, h))
        {
            return Some(check_error);
        }
        let rows = (end / output_step * (1.0 + WHOLE)).floor() + 1.0;
        if rows <= MAX_ROWS as f64 {
            return None;
        }
        let most = (MAX_ROWS - 1) as f64;
        let least = scheme.step().map_or(round_up(end / most), |h| {
            tidy(round_up((end / h / most).ceil()) * h)
        });
        let problem =
            format!("gives an output grid of {rows} rows; at most {MAX_ROWS} are supported");
        let remedy = format!("write `time.output_step` = {least:?} or more, or lower `time.end`");
        Some(CheckError::new(
            &[("time.output_step", output_step), ("time.end", end)],
            problem,
            remedy,
        ))
    }
}

fn check_between_steps(output_step: f64, h: f64) -> Option<CheckError> {
    if whole_multiple(output_step, h).is_some() {
        return None;
    }
    let ratio = output_step / h;
    let problem = format!(
        "`time.output_step` = {output_step:?} is not a whole number of steps `time.step` = {h:?}"
    );
    let nearest = [ratio.floor(), ratio.ceil()].map(|n| tidy(n.max(1.0) * h));
    let values = if nearest[0] == nearest[1] {
        &nearest[..1]
    } else {
        &nearest[..]
    };
    let values: Vec<String> = values.iter().map(|x| format!("{x:?}")).collect();
    let remedy = format!("the nearest output steps are {}", values.join(" or "));
    Some(CheckError::new(
        &[("time.output_step", output_step), ("time.step", h)],
        problem,
        remedy,
    ))
}

/// Largest relative distance of a duration from a whole number of steps. It only allows for the
/// rounding of decimal fractions.
const WHOLE: f64 = 1e-9;

/// n, if `total` is n times `part` up to rounding.
fn whole_multiple(total: f64, part: f64) -> Option<f64> {
    let ratio = total / part;
    let n = ratio.round();
    ((ratio - n).abs() <= WHOLE * n && (n > 0.0 || total == 0.0)).then_some(n)
}

/// The spacing of about 120 rows. Of the row counts from 60 to 240 that divide the number of steps
/// it takes the one nearest to 120; if none divides it, the nearest whole number of steps.
fn default_output_step(end: f64, h: f64) -> f64 {
    let steps = (end / h).round();
    if steps <= DEFAULT_ROWS {
        return h;
    }
    let distance = |rows: &f64| (rows / DEFAULT_ROWS).ln().abs();
    let divisor = (60..=240).map(f64::from).filter(|rows| steps % rows == 0.0);
    match divisor.min_by(|a, b| distance(a).total_cmp(&distance(b))) {
        // end / rows is rounded once, so that 60 / 120 is exactly 0.5; a product such as
        // `50 * 0.01` need not be.
        Some(rows) => end / rows,
        None => (steps / DEFAULT_ROWS).round() * h,
    }
}
