//! One random scenario as TOML text, as a user would write it.

use rand_distr::{Distribution, StandardUniform};
use rand_pcg::Pcg64Dxsm;
use rand_pcg::rand_core::SeedableRng;
use std::fmt::Write as _;

/// The distribution of the parameters.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Family {
    /// Each parameter by itself, log-uniform over 24 decades, with special values mixed in. Most
    /// such scenes are absurd, which is intended.
    Apart,
    /// Dimensionless numbers around values where sticks and slips occur, with random units.
    Together,
    /// The same, often without a spring or with negative damping, on a line, and with a random
    /// expression as a force.
    Own,
}

impl Family {
    pub fn name(self) -> &'static str {
        match self {
            Family::Apart => "apart",
            Family::Together => "together",
            Family::Own => "own",
        }
    }
}

/// The random numbers of one scenario.
struct Draws(Pcg64Dxsm);

impl Draws {
    fn uniform(&mut self) -> f64 {
        StandardUniform.sample(&mut self.0)
    }

    fn chance(&mut self, p: f64) -> bool {
        self.uniform() < p
    }

    fn decades(&mut self, low: f64, high: f64) -> f64 {
        10f64.powf(low + (high - low) * self.uniform())
    }

    fn of<const N: usize>(&mut self, values: [f64; N]) -> f64 {
        values[(self.uniform() * N as f64) as usize]
    }

    fn sign(&mut self) -> f64 {
        if self.chance(0.5) { 1.0 } else { -1.0 }
    }

    /// A number from 1e-12 to 1e12, or sometimes a special value such as zero or the largest
    /// double.
    fn parameter(&mut self) -> f64 {
        const SPECIAL: f64 = 0.04;
        match self.chance(SPECIAL) {
            true => self.of([0.0, 5e-324, 1e-310, 1e-300, 1e-150, 1e150, 1e300, f64::MAX]),
            false => self.decades(-12.0, 12.0),
        }
    }
}

/// The parameters of a scenario.
#[derive(Default)]
struct Parts {
    mass: f64,
    stiffness: f64,
    damping: f64,
    dilatation: f64,
    static_force: f64,
    dynamic_force: f64,
    /// Amplitude, angular frequency and phase of each harmonic.
    harmonics: Vec<(f64, f64, f64)>,
    /// Intensity, relaxation rate, diffusion and v(0); without v(0) the start is stationary.
    noise: Option<(f64, f64, f64, Option<f64>)>,
    displacement: f64,
    step: f64,
    steps: f64,
    paths: u64,
    /// The constant and the trend of the temperature.
    line: (f64, f64),
    /// A force of the user's own.
    expression: Option<String>,
}

/// The most steps of a path.
const MOST_STEPS: f64 = 1000.0;

/// The scenario with this number.
pub fn scenario(family: Family, number: u64) -> String {
    let seed = match family {
        Family::Apart => number << 1,
        Family::Together => number << 1 | 1,
        Family::Own => !number,
    };
    let mut draws = Draws(Pcg64Dxsm::seed_from_u64(seed));
    match family {
        Family::Apart => apart(&mut draws),
        Family::Together => together(&mut draws),
        Family::Own => own(&mut draws),
    }
    .text(number)
}

fn steps(draws: &mut Draws) -> (f64, u64) {
    let steps = if draws.chance(0.02) {
        0.0
    } else {
        draws.decades(0.0, MOST_STEPS.log10()).floor()
    };
    (
        steps,
        if draws.chance(0.3) {
            1
        } else {
            2 + (draws.uniform() * 4.0) as u64
        },
    )
}

fn apart(draws: &mut Draws) -> Parts {
    let static_force = draws.parameter();
    let ratio = if draws.chance(0.7) {
        draws.uniform()
    } else {
        draws.of([0.0, 1.0, 1e-12, 1.0 - 1e-12])
    };
    let (mass, stiffness) = (draws.parameter(), draws.parameter());
    let mut harmonics = Vec::new();
    while draws.chance(0.5) && harmonics.len() < 3 {
        let resonant = draws.chance(0.05);
        let frequency = if resonant {
            (stiffness / mass).sqrt()
        } else {
            draws.parameter()
        };
        harmonics.push((
            draws.sign() * draws.parameter(),
            frequency,
            7.0 * draws.uniform(),
        ));
    }
    let noise = draws.chance(0.7).then(|| {
        let start = draws.chance(0.7).then(|| {
            if draws.chance(0.5) {
                0.0
            } else {
                draws.sign() * draws.parameter()
            }
        });
        (
            draws.parameter(),
            draws.parameter(),
            draws.parameter(),
            start,
        )
    });
    let (steps, paths) = steps(draws);
    Parts {
        mass,
        stiffness,
        damping: if draws.chance(0.5) {
            0.0
        } else {
            draws.parameter()
        },
        dilatation: draws.sign() * draws.parameter(),
        static_force,
        dynamic_force: ratio * static_force,
        harmonics,
        noise,
        displacement: if draws.chance(0.2) {
            0.0
        } else {
            draws.sign() * draws.parameter()
        },
        step: draws.parameter(),
        steps,
        paths,
        ..Parts::default()
    }
}

fn together(draws: &mut Draws) -> Parts {
    // The parameters are in units of m, K and f_s: times in units of 1/w0, lengths in units of
    // f_s/K, and temperatures in units of that whose force is f_s.
    let ratio = if draws.chance(0.6) {
        draws.uniform()
    } else {
        draws.of([0.0, 1.0, 0.99, 0.8])
    };
    let mut harmonics = Vec::new();
    while draws.chance(0.6) && harmonics.len() < 3 {
        let frequency = if draws.chance(0.1) {
            1.0
        } else {
            draws.decades(-3.0, 2.0)
        };
        harmonics.push((
            draws.sign() * draws.decades(-1.0, 3.0),
            frequency,
            7.0 * draws.uniform(),
        ));
    }
    let relaxed: f64 = harmonics.iter().map(|(a, _, phase)| a * phase.cos()).sum();
    let noise = draws.chance(0.7).then(|| {
        let (theta, sd) = (draws.decades(-3.0, 3.0), draws.decades(-3.0, 2.0));
        let start = draws.chance(0.7).then(|| {
            if draws.chance(0.8) {
                0.0
            } else {
                draws.sign() * draws.decades(0.0, 3.0)
            }
        });
        (1.0, theta, sd * (2.0 * theta).sqrt(), start)
    });
    let (steps, paths) = steps(draws);
    // The random units.
    let [m, k, force, degree] = [(); 4].map(|()| draws.decades(-4.0, 4.0));
    let (time, length) = ((m / k).sqrt(), force / k);
    let noise = noise.map(|(rho, theta, sigma, start)| {
        let unit = draws.decades(-3.0, 3.0);
        (
            rho * degree / unit,
            theta / time,
            sigma * unit / time.sqrt(),
            start.map(|v| v * unit),
        )
    });
    Parts {
        mass: m,
        stiffness: k,
        damping: if draws.chance(0.5) {
            0.0
        } else {
            draws.decades(-3.0, 2.0) * m / time
        },
        dilatation: draws.sign() * length / degree,
        static_force: force,
        dynamic_force: ratio * force,
        harmonics: harmonics
            .into_iter()
            .map(|(a, w, phase)| (a * degree, w / time, phase))
            .collect(),
        noise,
        displacement: length
            * match () {
                () if draws.chance(0.5) => relaxed,
                () if draws.chance(0.5) => draws.sign() * draws.decades(-1.0, 3.0),
                () => 0.0,
            },
        step: draws.decades(-4.0, 0.5) * time,
        steps,
        paths,
        ..Parts::default()
    }
}

fn own(draws: &mut Draws) -> Parts {
    let parts = together(draws);
    let time = (parts.mass / parts.stiffness).sqrt();
    let (length, force) = (parts.static_force / parts.stiffness, parts.static_force);
    let degree = length / parts.dilatation.abs();
    let units = [length, length / time, time];
    let size = draws.decades(-2.0, 1.0) * force;
    let expression = draws
        .chance(0.9)
        .then(|| format!("{size:e}*({})", expression(draws, 4, units)));
    Parts {
        damping: if draws.chance(0.2) {
            -0.05 * parts.mass / time
        } else {
            parts.damping
        },
        line: if draws.chance(0.3) {
            (
                degree * draws.uniform(),
                degree / time * draws.decades(-3.0, 0.0),
            )
        } else {
            (0.0, 0.0)
        },
        stiffness: if draws.chance(0.1) {
            0.0
        } else {
            parts.stiffness
        },
        expression,
        ..parts
    }
}

/// A random expression of at most this depth, in which x, xdot and t occur in these units.
fn expression(draws: &mut Draws, depth: u32, units: [f64; 3]) -> String {
    let inner = |draws: &mut Draws| expression(draws, depth - 1, units);
    if depth == 0 || draws.chance(0.2) {
        let [x, v, t] = units;
        return match (draws.uniform() * 7.0) as u32 {
            0 | 1 => format!("(x/{x:e})"),
            2 | 3 => format!("(xdot/{v:e})"),
            4 => format!("(t/{t:e})"),
            5 => format!("{:e}", draws.sign() * draws.decades(-3.0, 3.0)),
            _ => ["pi", "a", "b"][(draws.uniform() * 3.0) as usize].to_string(),
        };
    }
    if draws.chance(0.4) {
        let function = [
            "abs", "sign", "sqrt", "exp", "log", "sin", "cos", "tan", "atan", "tanh",
        ];
        return format!(
            "{}({})",
            function[(draws.uniform() * 10.0) as usize],
            inner(draws)
        );
    }
    let (left, right) = (inner(draws), inner(draws));
    match (draws.uniform() * 7.0) as u32 {
        0 => format!("({left} + {right})"),
        1 => format!("({left} - {right})"),
        2 => format!("{left}*{right}"),
        3 => format!("({left})/({right})"),
        4 => format!("max({left}, {right})"),
        5 => format!("min({left}, {right})"),
        _ => format!(
            "({left})^{}",
            ["2", "3", "0.5", "-1"][(draws.uniform() * 4.0) as usize]
        ),
    }
}

impl Parts {
    fn text(&self, number: u64) -> String {
        let harmonics: Vec<String> = (self.harmonics.iter())
            .map(|(a, w, phase)| {
                format!("{{ amplitude = {a:e}, angular_frequency = {w:e}, phase = {phase:e} }}")
            })
            .collect();
        let mut text = format!(
            "[oscillator]\nmass = {:e}\nstiffness = {:e}\ndamping = {:e}\ndilatation = {:e}\n\
             [friction]\nstatic = {:e}\ndynamic = {:e}\n[temperature]\noffset = {:e}\ntrend = {:e}\nharmonics = [{}]\n",
            self.mass,
            self.stiffness,
            self.damping,
            self.dilatation,
            self.static_force,
            self.dynamic_force,
            self.line.0,
            self.line.1,
            harmonics.join(", ")
        );
        if let Some((rho, theta, sigma, start)) = self.noise {
            let start = start.map_or("\"stationary\"".to_string(), |v| format!("{v:e}"));
            let _ = writeln!(
                text,
                "[temperature.noise]\nintensity = {rho:e}\nrelaxation_rate = {theta:e}\ndiffusion = {sigma:e}\ninitial = {start}"
            );
        }
        if let Some(expression) = &self.expression {
            // Each parameter must occur.
            let _ = writeln!(
                text,
                "[force]\nexpression = \"{expression} + 0*a + 0*b\"\n[parameters]\na = 0.3\nb = -2"
            );
        }
        let _ = writeln!(
            text,
            "[initial]\ndisplacement = {:e}\n[time]\nend = {:e}\nstep = {:e}\noutput_step = {:e}\n\
             [ensemble]\npaths = {}\nseed = {number}",
            self.displacement,
            self.steps * self.step,
            self.step,
            self.step,
            self.paths
        );
        text
    }
}
