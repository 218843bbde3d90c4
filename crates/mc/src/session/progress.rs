//! Shows the progress of a run: a bar on a terminal, lines elsewhere, nothing with `--quiet`.

use crate::output::failure::note;
use crate::output::numbers::{Digits, duration, grouped, percent, significant};
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::io::{self, IsTerminal as _};
use std::sync::atomic::AtomicBool;
use std::sync::{Arc, Mutex, PoisonError};
use std::thread;
use std::time::{Duration, Instant};
use stickslip::ensemble::{BLOCK_SIZE, Plan, check_threads};
use stickslip::scheme::Unresolved;
use stickslip::stats::{Estimate, Statistic};
use stickslip::study::path_cost::TimeLimit;
use stickslip::study::trade::Limits;

/// Shows the progress of a run. The engine calls it after every finished block of paths.
pub struct Progress {
    place: ShownAs,
    watched: Option<Watched>,
    /// How many paths have ended, and since when.
    ended: Arc<Mutex<(u64, Instant)>>,
}

/// Where the progress is shown.
enum ShownAs {
    /// On a terminal.
    Bar(ProgressBar),
    /// In a log.
    Lines(Lines, Instant),
    /// With `--quiet`.
    Nowhere,
}

impl Progress {
    /// For a run of this many paths, on standard error. Also shows the running estimate of a
    /// statistic if one is given and, with a plan and the number of the first path, which path
    /// takes long.
    pub fn new(
        paths: u64,
        quiet: bool,
        watched: Option<Statistic>,
        plan: Option<(Plan, u64)>,
    ) -> Self {
        let watched = watched.filter(|_| !quiet).map(Watched::new);
        let place = if quiet {
            ShownAs::Nowhere
        } else if io::stderr().is_terminal() {
            let bar = ProgressBar::with_draw_target(Some(paths), ProgressDrawTarget::stderr());
            let template = "{bar:32} {human_pos}/{human_len} paths  {per_sec}  {eta} left";
            let line = if watched.is_some() { "\n{msg}" } else { "" };
            bar.set_style(style(&format!("{template}{line}")));
            ShownAs::Bar(bar)
        } else {
            ShownAs::Lines(Lines::new(paths), Instant::now())
        };
        let ended = Arc::new(Mutex::new((0, Instant::now())));
        if !quiet {
            tell_long_paths(&ended, plan);
        }
        Progress {
            place,
            watched,
            ended,
        }
    }

    /// The run is over: removes the bar. Lines stay.
    pub fn finish(self) {
        if let ShownAs::Bar(bar) = &self.place {
            bar.finish_and_clear();
        }
    }
}

impl stickslip::engine::Progress for Progress {
    // This is called once for each block and not for each path, because every call takes a lock.
    fn paths(&mut self, done: u64, expected: u64) {
        *self.ended.lock().unwrap_or_else(PoisonError::into_inner) = (done, Instant::now());
        match &mut self.place {
            ShownAs::Bar(bar) => {
                bar.set_position(done);
                bar.set_length(expected);
            }
            ShownAs::Lines(lines, start) => {
                lines.paths = expected;
                if let Some(line) = lines.at(done, start.elapsed()) {
                    let known = self.watched.as_ref().and_then(Watched::words);
                    note(&known.map_or(line.clone(), |known| format!("{line}; {known}")));
                }
            }
            ShownAs::Nowhere => {}
        }
    }

    fn watches(&mut self) -> Option<Statistic> {
        self.watched
            .as_mut()
            .filter(|watched| watched.last.elapsed() >= LOOK)
            .map(|watched| {
                watched.last = Instant::now();
                watched.statistic
            })
    }

    fn estimate(&mut self, estimate: &Estimate) {
        let Some(watched) = &mut self.watched else {
            return;
        };
        watched.latest = Some(*estimate);
        if let (ShownAs::Bar(bar), Some(words)) = (&self.place, watched.words()) {
            bar.set_message(words);
        }
    }

    fn estimating_bias(&mut self) {
        let what = "estimating the bias of the step";
        match &self.place {
            ShownAs::Bar(bar) => {
                bar.set_style(style("{bar:32} {human_pos}/{human_len} paths, {msg}"));
                bar.set_message(what);
            }
            ShownAs::Lines(_, start) if start.elapsed() >= SILENT_UNTIL => note(what),
            ShownAs::Lines(..) | ShownAs::Nowhere => {}
        }
    }
}

/// Reports from time to time, until the progress is dropped, that a block of paths takes long, and
/// which path causes this.
fn tell_long_paths(ended: &Arc<Mutex<(u64, Instant)>>, plan: Option<(Plan, u64)>) {
    let ended = Arc::downgrade(ended);
    let tell = move || {
        let mut next = LONG;
        loop {
            thread::sleep(TICK);
            let Some(ended) = ended.upgrade() else { return };
            let (done, since) = *ended.lock().unwrap_or_else(PoisonError::into_inner);
            if since.elapsed() < LONG {
                next = LONG;
            } else if since.elapsed() >= next {
                next *= 2;
                let time = duration(since.elapsed().as_secs_f64());
                let which = plan
                    .as_ref()
                    .and_then(|(plan, first)| long_path(plan, first + done))
                    .unwrap_or_default();
                note(&format!(
                    "after {} paths, the next {BLOCK_SIZE} have taken {time} so far{which}",
                    grouped(done)
                ));
            }
        }
    };
    // Without a thread the run is merely silent.
    let _ = thread::Builder::new().spawn(tell);
}

/// The first path of this block that takes long by itself, and its state, in words.
fn long_path(plan: &Plan, first: u64) -> Option<String> {
    (first..plan.paths.min(first + BLOCK_SIZE)).find_map(|path| {
        let reached = plan.why_lost(path, TimeLimit::of(LONG_PATH))?;
        let is_long = matches!(reached.why, Unresolved::Stopped | Unresolved::TooLong);
        let (t, x) = (
            significant(reached.time, 4),
            significant(reached.displacement, 4),
        );
        is_long.then(|| format!("; path {path} reached t = {t}, x = {x} in one second"))
    })
}

/// The running estimate of a statistic.
struct Watched {
    statistic: Statistic,
    last: Instant,
    latest: Option<Estimate>,
}

/// The shortest time between two updates of the estimate.
const LOOK: Duration = Duration::from_millis(500);

impl Watched {
    fn new(statistic: Statistic) -> Self {
        Watched {
            statistic,
            last: Instant::now(),
            latest: None,
        }
    }

    /// The estimate and its relative error as text; none before the first estimate.
    fn words(&self) -> Option<String> {
        let e = self.latest.filter(|e| e.estimate.is_finite())?;
        let digits = Digits::of(e.estimate, e.standard_error);
        let error = (e.standard_error / e.estimate).abs();
        let error = if error.is_finite() {
            percent_of(error)
        } else {
            "unknown".into()
        };
        Some(format!(
            "{} {}, error {error}",
            self.statistic.name(),
            digits.show(e.estimate)
        ))
    }
}

/// A share in percent, with two significant digits.
fn percent_of(share: f64) -> String {
    percent(significant(share, 2).parse().unwrap_or(share))
}

fn style(template: &str) -> ProgressStyle {
    ProgressStyle::with_template(template).unwrap_or(ProgressStyle::default_bar())
}

/// Measures something that takes about this time; on a terminal, shows what is being measured and
/// for how long.
pub fn measuring<T>(
    budget: Duration,
    quiet: bool,
    stop: &AtomicBool,
    measure: impl FnOnce(Limits<'_>) -> T,
) -> T {
    let template = format!("{{elapsed}} of about {} s: {{msg}}", budget.as_secs());
    working(&template, quiet, |begins| {
        measure(Limits {
            time: None,
            stop: Some(stop),
            begins: Some(begins),
        })
    })
}

/// Does some work; on a terminal, shows what is being done, as reported by the work, and for how
/// long.
pub fn waiting<T>(work: impl FnOnce(Begins<'_>) -> T) -> T {
    working("{spinner} {elapsed}  {msg}", false, work)
}

/// Does some work; on a terminal, shows this name and the elapsed time.
pub fn during<T>(what: &str, work: impl FnOnce() -> T) -> T {
    waiting(|begins| {
        begins(what);
        work()
    })
}

/// Called with a description of each stage as it begins.
type Begins<'a> = &'a (dyn Fn(&str) + Sync);

fn working<T>(template: &str, quiet: bool, work: impl FnOnce(Begins<'_>) -> T) -> T {
    let target = if quiet {
        ProgressDrawTarget::hidden()
    } else {
        ProgressDrawTarget::stderr()
    };
    let line = ProgressBar::with_draw_target(None, target);
    line.set_style(style(template));
    // The crate panics if the system cannot start a thread. The line is then not updated.
    if check_threads(2).is_ok() {
        line.enable_steady_tick(TICK);
    }
    let done = work(&|what: &str| line.set_message(what.to_string()));
    line.finish_and_clear();
    done
}

/// The time between two updates of the elapsed time.
const TICK: Duration = Duration::from_millis(250);
/// The time after which a block of paths that has not ended is reported.
const LONG: Duration = Duration::from_secs(20);
/// The CPU time after which an unfinished path is the one that takes long.
const LONG_PATH: Duration = Duration::from_secs(1);
/// The time between two lines of a log.
const PERIOD: Duration = Duration::from_secs(30);
/// A run that takes less than this prints no lines.
const SILENT_UNTIL: Duration = Duration::from_secs(2);

/// Decides when a line is due in a log: every thirty seconds.
struct Lines {
    paths: u64,
    last: Duration,
}

impl Lines {
    fn new(paths: u64) -> Self {
        Lines {
            paths,
            last: Duration::ZERO,
        }
    }

    /// The line to print now; none if no line is due.
    fn at(&mut self, done: u64, elapsed: Duration) -> Option<String> {
        if elapsed < self.last + PERIOD || done >= self.paths {
            return None;
        }
        self.last = elapsed;
        let rate = done as f64 / elapsed.as_secs_f64();
        let left = if rate > 0.0 {
            duration((self.paths - done) as f64 / rate)
        } else {
            "unknown time".into()
        };
        let (done, paths) = (grouped(done), grouped(self.paths));
        Some(format!(
            "{done} of {paths} paths, {} paths/s, {left} left",
            significant(rate, 3)
        ))
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
    fn a_long_run_prints_every_thirty_seconds() {
        let mut lines = Lines::new(1_000_000);
        let printed: Vec<u64> = (1..=100)
            .filter(|s| lines.at(*s, Duration::from_secs(*s)).is_some())
            .collect();
        assert_eq!(printed, [30, 60, 90]);
    }

    fn estimate(estimate: f64, standard_error: f64) -> Estimate {
        let (low, high) = (estimate - standard_error, estimate + standard_error);
        Estimate {
            statistic: Statistic::StickDurationMean,
            estimate,
            standard_error,
            low,
            high,
            bias: None,
        }
    }

    #[test]
    fn a_watched_statistic_is_told_with_its_relative_error() {
        let mut watched = Watched::new(Statistic::StickDurationMean);
        assert_eq!(watched.words(), None);
        watched.latest = Some(estimate(f64::NAN, f64::NAN));
        assert_eq!(watched.words(), None);
        watched.latest = Some(estimate(0.5398, 0.0014));
        assert_eq!(
            watched.words().as_deref(),
            Some("stick_duration_mean 0.5398, error 0.26 %")
        );
    }

    #[test]
    fn a_line_tells_rate_and_time_left() {
        let line = Lines::new(10_000).at(2_500, Duration::from_secs(50));
        assert_eq!(
            line.as_deref(),
            Some("2 500 of 10 000 paths, 50 paths/s, 2 min 30 s left")
        );
    }
}
