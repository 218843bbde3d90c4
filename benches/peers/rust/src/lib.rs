//! The scene that every Rust peer runs, its command line, its threads, and the JSON line that it
//! prints.
//!
//! The scheme, in the symbols of the paper with m = K = 1:
//!
//! ```text
//! b_n     = beta (cos(w t_n) + rho e_n) - X_n
//! S_n     = V_n + h b_n
//! X_{n+1} = X_n + h V_n,   V_{n+1} = 0 if |S_n| <= h f_s, else S_n - h f_d sign(S_n)
//! e_{n+1} = decay e_n + increment_sd xi_n,  the exact transition of de = -e dt + dW
//! ```
//!
//! How sticks are counted: a stick begins at t_{n+1} if V_{n+1} = 0 and |b_{n+1}| <= f_s, and ends
//! at t_n, the last instant with V_n = 0. The stick at t = 0 is an initial condition and is not
//! counted, nor is a stick that has not ended at the end.

pub mod scalar;

use std::ops::{AddAssign, Range};
use std::time::Instant;

pub const BETA: f64 = 6.0;
pub const W: f64 = 0.25;
pub const RHO: f64 = 0.25;
pub const F_S: f64 = 1.2;
pub const F_D: f64 = 1.0;
pub const X0: f64 = 6.0;
pub const H: f64 = 1e-3;

/// Sums over paths. Stick time is in steps. A turn is a zero of the velocity within a slip.
#[derive(Clone, Copy, Default)]
pub struct Totals {
    pub sticks: f64,
    pub stick_steps: f64,
    pub turns: f64,
    pub x: f64,
    pub x2: f64,
}

impl AddAssign for Totals {
    fn add_assign(&mut self, o: Self) {
        self.sticks += o.sticks;
        self.stick_steps += o.stick_steps;
        self.turns += o.turns;
        self.x += o.x;
        self.x2 += o.x2;
    }
}

unsafe extern "C" {
    /// Processor time of the process in microseconds (POSIX).
    fn clock() -> std::ffi::c_long;
}

/// Distributes the paths over the threads, measures the time of `paths(steps, range)`, and prints
/// the JSON line.
pub fn measure(paths_of: impl Fn(usize, Range<usize>) -> Totals + Sync) {
    let words: Vec<f64> = std::env::args().skip(1).map(|word| word.parse().expect("a number")).collect();
    let word = |at: usize, default: f64| words.get(at).copied().unwrap_or(default);
    let (paths, steps, threads) = (word(0, 1e4) as usize, (word(1, 12.0) / H).round() as usize, word(2, 1.0) as usize);

    let (wall, cpu) = (Instant::now(), unsafe { clock() });
    let mut total = Totals::default();
    std::thread::scope(|scope| {
        let start = |part| paths * part / threads;
        let run = |part| {
            let paths_of = &paths_of;
            scope.spawn(move || paths_of(steps, start(part)..start(part + 1)))
        };
        let handles: Vec<_> = (0..threads).map(run).collect();
        handles.into_iter().for_each(|handle| total += handle.join().expect("a thread"));
    });
    let (seconds, cpu_seconds) = (wall.elapsed().as_secs_f64(), (unsafe { clock() } - cpu) as f64 * 1e-6);

    let n = paths as f64;
    let mean = total.x / n;
    println!(
        r#"{{"seconds": {seconds}, "cpu_seconds": {cpu_seconds}, "setup_seconds": 0, "paths": {paths}, "steps": {steps}, "threads": {threads}, "sticks_per_path": {}, "stick_duration_mean": {}, "turns_per_path": {}, "displacement_end_mean": {mean}, "displacement_end_sd": {}}}"#,
        total.sticks / n,
        total.stick_steps / total.sticks * H,
        total.turns / n,
        (total.x2 / n - mean * mean).sqrt(),
    );
}
