//! How far a run has come: a bar on a terminal, plain lines elsewhere, nothing if quiet.

use super::failure::note;
use super::numbers::{duration, grouped, significant};
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::io::{self, IsTerminal as _};
use std::time::{Duration, Instant};

/// Told of every finished block of paths.
pub enum Progress {
    /// On a terminal.
    Bar(ProgressBar),
    /// In a log.
    Lines(Lines, Instant),
    /// With `--quiet`.
    Silent,
}

impl Progress {
    /// For a run of this many paths, on standard error.
    pub fn new(paths: u64, quiet: bool) -> Self {
        if quiet {
            Progress::Silent
        } else if io::stderr().is_terminal() {
            let bar = ProgressBar::with_draw_target(Some(paths), ProgressDrawTarget::stderr());
            bar.set_style(style("{bar:32} {human_pos}/{human_len} paths  {per_sec}  {eta} left"));
            Progress::Bar(bar)
        } else {
            Progress::Lines(Lines::new(paths), Instant::now())
        }
    }

    /// The run is over: the bar goes, the lines stay.
    pub fn finish(&self) {
        if let Progress::Bar(bar) = self {
            bar.finish_and_clear();
        }
    }
}

impl stick_slip::engine::Progress for Progress {
    // Once a block, not once a path: each call takes a lock.
    fn paths(&mut self, done: u64, expected: u64) {
        match self {
            Progress::Bar(bar) => {
                bar.set_position(done);
                bar.set_length(expected);
            }
            Progress::Lines(lines, start) => {
                lines.paths = expected;
                if let Some(line) = lines.at(done, start.elapsed()) {
                    note(&line);
                }
            }
            Progress::Silent => {}
        }
    }

    fn estimating_bias(&mut self) {
        let what = "estimating the bias of the step";
        match self {
            Progress::Bar(bar) => {
                bar.set_style(style("{bar:32} {human_pos}/{human_len} paths, {msg}"));
                bar.set_message(what);
            }
            Progress::Lines(_, start) if start.elapsed() >= PATIENCE => note(what),
            Progress::Lines(..) | Progress::Silent => {}
        }
    }
}

fn style(template: &str) -> ProgressStyle {
    ProgressStyle::with_template(template).unwrap_or(ProgressStyle::default_bar())
}

/// What a measurement is at, on a terminal; nothing elsewhere.
pub struct Measuring(ProgressBar);

impl Measuring {
    /// For a measurement of about this time, on standard error.
    pub fn new(budget: Duration, quiet: bool) -> Self {
        let target = if quiet { ProgressDrawTarget::hidden() } else { ProgressDrawTarget::stderr() };
        let line = ProgressBar::with_draw_target(None, target);
        line.set_style(style(&format!("{{elapsed}} of about {} s: {{msg}}", budget.as_secs())));
        line.enable_steady_tick(TICK);
        Measuring(line)
    }

    /// This is measured next.
    pub fn begin(&self, what: &str) {
        self.0.set_message(what.to_string());
    }

    /// The measurement is over: the line goes.
    pub fn finish(&self) {
        self.0.finish_and_clear();
    }
}

/// How often the time of a measurement is shown.
const TICK: Duration = Duration::from_millis(250);
/// Longest silence of a log, and least distance of its lines.
const PERIOD: Duration = Duration::from_secs(10);
/// A run that finishes sooner needs no lines.
const PATIENCE: Duration = Duration::from_secs(2);

/// Decides when a log deserves a line: at every tenth of the run, and every ten seconds.
pub struct Lines {
    paths: u64,
    tenths: u64,
    last: Duration,
}

impl Lines {
    fn new(paths: u64) -> Self {
        Lines { paths, tenths: 0, last: Duration::ZERO }
    }

    /// The line to print now, if any.
    fn at(&mut self, done: u64, elapsed: Duration) -> Option<String> {
        // 128 bits: ten times the paths may not fit in 64.
        let tenths = (u128::from(done) * 10 / u128::from(self.paths.max(1))) as u64;
        let due = elapsed >= PATIENCE && (tenths > self.tenths || elapsed >= self.last + PERIOD);
        if !due || done >= self.paths {
            return None;
        }
        (self.tenths, self.last) = (tenths, elapsed);
        let rate = done as f64 / elapsed.as_secs_f64();
        let left = if rate > 0.0 { duration((self.paths - done) as f64 / rate) } else { "unknown time".into() };
        let (done, paths) = (grouped(done), grouped(self.paths));
        Some(format!("{done} of {paths} paths, {} paths/s, {left} left", significant(rate, 3)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_short_run_prints_no_lines() {
        let mut lines = Lines::new(100);
        assert!((1..=100).all(|done| lines.at(done, Duration::from_millis(10 * done)).is_none()));
    }

    #[test]
    fn a_long_run_prints_every_tenth() {
        let mut lines = Lines::new(1000);
        let printed = (1..=1000).filter(|done| lines.at(*done, Duration::from_millis(20 * done)).is_some()).count();
        assert_eq!(printed, 9);
    }

    #[test]
    fn a_slow_run_prints_every_ten_seconds() {
        let mut lines = Lines::new(1_000_000);
        let printed = (1..=60).filter(|s| lines.at(*s, Duration::from_secs(*s)).is_some()).count();
        assert_eq!(printed, 6);
    }

    #[test]
    fn a_line_tells_rate_and_time_left() {
        let line = Lines::new(10_000).at(2_500, Duration::from_secs(5));
        assert_eq!(line.as_deref(), Some("2 500 of 10 000 paths, 500 paths/s, 15.0 s left"));
    }
}
