//! A scene: its numbers, its text as a user would write it, its forces as plain functions, and the
//! same scene as seen otherwise (mirrored, in other units, from a later start).

use super::features::{Choice, FEATURES, scenes};
use rand_distr::{Distribution as _, StandardUniform};
use rand_pcg::Pcg64Dxsm;
use rand_pcg::rand_core::SeedableRng as _;
use std::panic::{AssertUnwindSafe, catch_unwind};
use stickslip::model::{NamedSeries, Series};
use stickslip::scenario::Scenario;
use stickslip::scheme::Kind;

/// The time step of the schemes that have one.
pub const STEP: f64 = 0.01;

/// Samples: times and values.
pub type Samples = Option<(Vec<f64>, Vec<f64>)>;

/// A force g and a load L, by the kinds of the table, with their numbers.
#[derive(Clone, Debug)]
pub struct Law {
    pub force: &'static str,
    pub load: &'static str,
    pub input: &'static str,
    a: f64,
    b: f64,
}

/// How the text of a law writes its variables, in units or from a start of a scene seen otherwise.
#[derive(Clone, Debug)]
pub struct Written {
    pub x: String,
    pub v: String,
    pub t: String,
    pub e: String,
    pub s: String,
    /// A factor of g.
    pub factor: f64,
}

/// One noise: rho, theta, sigma and v(0), or a stationary start.
pub type OneNoise = ([f64; 3], Option<f64>);

/// A scene.
#[derive(Clone, Debug)]
pub struct Scene {
    pub name: String,
    pub choice: Choice,
    pub scheme: Kind,
    pub mass: f64,
    pub stiffness: f64,
    pub damping: f64,
    /// beta, or c.
    pub drive: f64,
    pub is_dilatation: bool,
    /// f_s and f_d, forwards and backwards.
    pub friction: [[f64; 2]; 2],
    pub law: Law,
    pub written: Written,
    /// Further terms of the force and of the load, as text.
    pub more: [Option<String>; 2],
    pub offset: f64,
    pub trend: f64,
    /// Amplitude, frequency and phase.
    pub harmonics: Vec<[f64; 3]>,
    pub series: Samples,
    pub noises: Vec<OneNoise>,
    /// D and theta.
    pub white: Option<[f64; 2]>,
    pub is_pinned: bool,
    pub input: Samples,
    pub x0: f64,
    pub v0: f64,
    pub end: f64,
    pub after: f64,
    pub output_step: f64,
    pub step: f64,
    pub tolerance: f64,
    /// The time between the instants at which x is compared. At an instant inside a macro step the
    /// state is drawn by the number of the instant, so that runs of one path need the same ones.
    pub period: f64,
    pub is_antithetic: bool,
    pub paths: u64,
    pub seed: u64,
}

/// Random numbers of one scene.
struct Draws(Pcg64Dxsm);

impl Draws {
    fn between(&mut self, low: f64, high: f64) -> f64 {
        let uniform: f64 = StandardUniform.sample(&mut self.0);
        low + (high - low) * uniform
    }

    fn sign(&mut self) -> f64 {
        if self.between(0.0, 1.0) < 0.5 {
            -1.0
        } else {
            1.0
        }
    }

    /// Samples to beyond `end`, at distances between these, of a curve of this size and some jitter.
    fn samples(&mut self, end: f64, [low, high]: [f64; 2], [size, jitter]: [f64; 2]) -> Samples {
        let (rate, phase) = (self.between(0.6, 1.2), self.between(0.0, 6.0));
        let (mut times, mut values, mut t) = (Vec::new(), Vec::new(), 0.0);
        while t < end + high {
            times.push(t);
            values.push(size * (rate * t + phase).sin() + jitter * self.between(-1.0, 1.0));
            t += self.between(low, high);
        }
        Some((times, values))
    }
}

impl Scene {
    fn new(number: usize, choice: Choice) -> Self {
        let mut draws = Draws(Pcg64Dxsm::seed_from_u64(1000 + number as u64));
        let kinds = (0..FEATURES.len())
            .filter(|i| choice[*i] > 0)
            .map(|i| format!("{} {}", FEATURES[i].0, FEATURES[i].1[choice[i]]));
        let name = format!("scene {number}: {}", kinds.collect::<Vec<_>>().join(", "));
        let mut scene = Scene {
            name,
            choice,
            scheme: Kind::EventDriven,
            mass: draws.between(0.7, 1.4),
            stiffness: draws.between(0.8, 1.6),
            damping: 0.0,
            drive: draws.between(0.8, 1.3) * draws.sign(),
            is_dilatation: false,
            friction: [[0.0; 2]; 2],
            law: Law {
                force: "",
                load: "",
                input: "",
                a: draws.between(0.8, 1.2),
                b: draws.between(0.8, 1.2),
            },
            written: Written {
                x: "x".into(),
                v: "xdot".into(),
                t: "t".into(),
                e: "direction".into(),
                s: "s".into(),
                factor: 1.0,
            },
            more: [None, None],
            offset: 0.0,
            trend: 0.0,
            harmonics: Vec::new(),
            series: None,
            noises: Vec::new(),
            white: None,
            is_pinned: false,
            input: None,
            x0: 0.0,
            v0: 0.0,
            end: 12.0,
            after: 0.0,
            output_step: 4.0,
            step: STEP,
            tolerance: 1e-3,
            period: 1.7,
            is_antithetic: false,
            paths: 1,
            seed: number as u64 + 1,
        };
        scene.choose_body(&mut draws);
        scene.choose_temperature(&mut draws);
        scene.choose_time();
        scene.choose_start(&mut draws);
        scene
    }

    /// The kind of a feature.
    pub fn kind(&self, feature: &str) -> &'static str {
        let i = FEATURES
            .iter()
            .position(|(name, _)| *name == feature)
            .unwrap_or_else(|| panic!("{feature} is in the table"));
        FEATURES[i].1[self.choice[i]]
    }

    fn choose_body(&mut self, draws: &mut Draws) {
        if self.kind("spring") == "none" {
            self.stiffness = 0.0;
        }
        self.is_dilatation = self.kind("drive") == "dilatation";
        let critical = (self.mass * self.stiffness.max(0.25)).sqrt();
        self.damping = critical
            * match self.kind("damping") {
                "none" => 0.0,
                "weak" => draws.between(0.05, 0.15),
                "critical" => 1.0,
                "strong" => draws.between(4.0, 40.0),
                _ => -draws.between(0.01, 0.04),
            };
        let f_s = draws.between(1.0, 1.3);
        let f_d = match self.kind("friction") {
            "equal" => f_s,
            "narrow" => 0.985 * f_s,
            _ => f_s * draws.between(0.7, 0.85),
        };
        let other = match self.kind("load") {
            "sides" => draws.between(1.1, 1.4),
            _ => 1.0,
        };
        self.friction = [[f_s, f_d], [other * f_s, other * f_d]];
        self.law.force = self.kind("force");
        self.law.load = self.kind("load");
        self.law.input = self.kind("input");
        if self.law.input != "none" {
            self.input = draws.samples(self.end, [0.4, 1.1], [0.8, 0.2]);
        }
    }

    fn choose_temperature(&mut self, draws: &mut Draws) {
        // Temperatures are in units of that whose force is 1.
        let unit = 1.0 / self.gain().abs();
        let amplitudes: &[f64] = match self.kind("harmonics") {
            "none" => &[],
            "one" => &[2.4],
            _ => &[1.8, 0.9],
        };
        for (i, amplitude) in amplitudes.iter().enumerate() {
            let w = draws.between(0.5, 0.9) * (1 + 2 * i) as f64;
            let phase = draws.between(-3.0, 3.0);
            self.harmonics.push([unit * amplitude, w, phase]);
        }
        match self.kind("line") {
            "none" => {}
            "offset" => self.offset = unit * draws.between(0.3, 0.8) * draws.sign(),
            _ => {
                self.offset = unit * draws.between(-0.3, 0.3);
                self.trend = unit * draws.between(0.15, 0.4) * draws.sign();
            }
        }
        self.series = match self.kind("series") {
            "none" => None,
            "close" => draws.samples(self.end, [0.002, 0.006], [1.4 * unit, 0.02 * unit]),
            _ => draws.samples(self.end, [0.3, 1.2], [1.4 * unit, 0.5 * unit]),
        };
        let mut noise = |rho: f64, theta: f64, start: Option<f64>| {
            let rho = rho * unit * draws.between(0.8, 1.2);
            ([rho, theta, draws.between(0.9, 1.1)], start)
        };
        let start = self
            .seed
            .is_multiple_of(2)
            .then_some(if self.seed.is_multiple_of(4) {
                0.6
            } else {
                0.0
            });
        self.noises = match self.kind("noise") {
            "one" => vec![noise(0.4, 1.0, start)],
            "two" => vec![noise(0.3, 2.0, start), noise(0.3, 0.1, Some(0.4))],
            "pinned" => vec![noise(0.4, 1.0, Some(0.0))],
            _ => Vec::new(),
        };
        self.is_pinned = self.kind("noise") == "pinned";
        self.white = (self.kind("noise") == "white")
            .then(|| [0.02 * unit * unit, draws.between(15.0, 25.0)]);
        self.is_antithetic = self.kind("pairs") == "antithetic";
        self.paths = 1 + u64::from(self.is_antithetic);
    }

    fn choose_time(&mut self) {
        self.output_step = match self.kind("rows") {
            "fine" => 0.02,
            _ => 4.0,
        };
        if self.kind("burn-in") == "some" {
            self.after = 3.113;
        }
        if self.kind("end") == "off the grid" {
            self.end = 11.737;
        }
    }

    fn choose_start(&mut self, draws: &mut Draws) {
        let pull = self.gain() * self.temperature(0.0);
        let balanced = if self.stiffness > 0.0 {
            pull / self.stiffness
        } else {
            0.2
        };
        let way = draws.between(1.6, 2.2) * draws.sign();
        self.x0 = match self.kind("start") {
            "outside" if self.stiffness > 0.0 => balanced + way / self.stiffness,
            _ => balanced + 0.1 * way,
        };
        if self.kind("start") == "moving" {
            self.v0 = way;
        }
    }

    /// c = K beta, the force per temperature.
    pub fn gain(&self) -> f64 {
        if self.is_dilatation {
            self.stiffness * self.drive
        } else {
            self.drive
        }
    }

    /// T without noise.
    pub fn temperature(&self, t: f64) -> f64 {
        let harmonics = self
            .harmonics
            .iter()
            .map(|[a, w, phase]| a * (w * t + phase).cos());
        self.offset + self.trend * t + harmonics.sum::<f64>() + at(&self.series, t)
    }

    /// The mean of T over all paths.
    pub fn mean_temperature(&self, t: f64) -> f64 {
        let relaxing = self.noises.iter().map(|([rho, theta, _], start)| {
            let start = if self.is_pinned {
                0.0
            } else {
                start.unwrap_or(0.0)
            };
            rho * start * (-theta * t).exp()
        });
        self.temperature(t) + relaxing.sum::<f64>()
    }

    /// Whether g is linear, and so part of the spring and of the damping.
    pub fn is_linear(&self) -> bool {
        self.law.force == "linear" && self.law.input != "in force" && self.more[0].is_none()
    }

    /// K and alpha with a linear g.
    pub fn body(&self) -> [f64; 2] {
        if self.is_linear() {
            let [p, q] = self.law.linear();
            [self.stiffness + p, self.damping + 0.5 * q]
        } else {
            [self.stiffness, self.damping]
        }
    }

    /// g of a body that moves, or is to move, in this direction, unless it is part of the spring.
    pub fn own(&self, e: f64, x: f64, v: f64, t: f64) -> f64 {
        if self.is_linear() {
            return 0.0;
        }
        self.law.force(e, x, v, t, at(&self.input, t))
    }

    /// The load.
    pub fn load(&self, e: f64, x: f64, v: f64, t: f64) -> f64 {
        debug_assert!(self.more[1].is_none());
        self.law.load(e, x, v, t, at(&self.input, t))
    }

    /// Whether friction has a load or a direction, or g has a direction.
    pub fn has_sides(&self) -> bool {
        self.law.load != "none" || self.law.input == "in load" || self.law.force == "of direction"
    }

    /// Whether a scheme sees forces that are not linear, or friction that is not constant.
    pub fn is_general(&self) -> bool {
        self.has_sides()
            || self.law.input == "in force"
            || !["none", "linear"].contains(&self.law.force)
            || self.more.iter().any(Option::is_some)
    }

    /// The scene in a scheme, less what the scheme cannot do; none if too little is left.
    ///
    /// - The schemes with a step have one noise, which is not pinned. Their time is in whole steps.
    /// - `quasi-static` has a spring, no negative damping, no initial velocity, no nonlinear force,
    ///   and constant friction.
    pub fn in_scheme(&self, scheme: Kind) -> Option<Scene> {
        let mut scene = Scene {
            scheme,
            ..self.clone()
        };
        scene.name = format!("{} ({})", self.name, scheme.name());
        if scheme.has_step() {
            scene.noises.truncate(1);
            scene.is_pinned = false;
            scene.end = (scene.end / scene.step).round() * scene.step;
        }
        if scheme == Kind::QuasiStatic {
            if self.stiffness == 0.0 || self.damping < 0.0 {
                return None;
            }
            scene = scene.with_constant_friction();
            scene.v0 = 0.0;
        }
        Some(scene)
    }

    /// The scene in each scheme that suits it.
    pub fn in_each_scheme(&self) -> impl Iterator<Item = Scene> {
        Kind::ALL.iter().filter_map(|kind| self.in_scheme(*kind))
    }

    /// The scene without inputs, load and nonlinear force.
    pub fn with_constant_friction(&self) -> Scene {
        let mut scene = self.clone();
        scene.friction[1] = scene.friction[0];
        (scene.law.load, scene.law.input, scene.input) = ("none", "none", None);
        if scene.law.force != "linear" {
            scene.law.force = "none";
        }
        scene
    }

    /// The scene without noise.
    pub fn without_noise(&self) -> Scene {
        Scene {
            noises: Vec::new(),
            white: None,
            is_pinned: false,
            name: format!("{}, without noise", self.name),
            ..self.clone()
        }
    }

    pub fn is_random(&self) -> bool {
        !self.noises.is_empty() || self.white.is_some()
    }

    /// The scenario.
    #[track_caller]
    pub fn scenario(&self) -> Scenario {
        let named = |name: &str, samples: &Samples| {
            let (times, values) = samples.clone()?;
            let series = Series::new(times, values).expect("a series").into();
            let name = name.into();
            Some(NamedSeries { name, series })
        };
        let input = named("input.s", &self.input);
        let inputs: Vec<NamedSeries> = named("temperature.series", &self.series)
            .into_iter()
            .chain(input)
            .collect();
        Scenario::parse_measured("test", &self.toml(), &[], &inputs)
            .unwrap_or_else(|error| panic!("{}: {error}\n{}", self.name, self.toml()))
    }
}

/// The value of samples at a time, 0 without any.
pub fn at(samples: &Samples, t: f64) -> f64 {
    let Some((times, values)) = samples else {
        return 0.0;
    };
    let after = times
        .partition_point(|time| *time <= t)
        .clamp(1, times.len() - 1);
    let part = (t - times[after - 1]) / (times[after] - times[after - 1]);
    (1.0 - part) * values[after - 1] + part * values[after]
}

impl Law {
    /// -dg/dx and -dg/dx' of the linear force.
    fn linear(&self) -> [f64; 2] {
        [0.3 * self.a, 0.1 * self.b]
    }

    fn force(&self, e: f64, x: f64, v: f64, t: f64, s: f64) -> f64 {
        let (a, b) = (self.a, self.b);
        let g = match self.force {
            "none" => 0.0,
            "of x" => -0.1 * a * x.powi(3) + 0.2 * b * (2.0 * x).sin(),
            "of x'" => -0.1 * a * v.powi(3) - 0.3 * b * (2.0 * v).tanh(),
            "of t" => a * (1.7 * t + b).sin() + 0.1 * (60.0 * t).sin(),
            "of direction" => -0.2 * a * e * (1.0 + 0.5 * (b * t).sin()),
            "linear" => -(self.linear()[0] * x) - self.linear()[1] * v,
            other => panic!("{other}"),
        };
        if self.input == "in force" { g + s } else { g }
    }

    fn load(&self, e: f64, x: f64, v: f64, t: f64, s: f64) -> f64 {
        let (a, b) = (self.a, self.b);
        let load = match self.load {
            "none" | "sides" => 1.0,
            "of x" => 1.0 + 0.3 * a * (2.0 * x + b).sin(),
            "of x'" => (1.0 + 0.1 * b * e) * (1.0 - 0.3 * a * (v * v).tanh()),
            "of t" => 1.0 + 0.3 * a * (0.7 * t + b).cos(),
            other => panic!("{other}"),
        };
        if self.input == "in load" {
            load * (1.0 + 0.2 * s)
        } else {
            load
        }
    }
}

impl Scene {
    /// g as text, if there is any.
    fn force_text(&self) -> Option<String> {
        let Law { a, b, .. } = self.law;
        let Written {
            x,
            v,
            t,
            e,
            s,
            factor,
        } = &self.written;
        let [p, q] = self.law.linear();
        let own = match self.law.force {
            "none" => None,
            "of x" => Some(format!("-0.1*{a:?}*{x}^3 + 0.2*{b:?}*sin(2*{x})")),
            "of x'" => Some(format!("-0.1*{a:?}*{v}^3 - 0.3*{b:?}*tanh(2*{v})")),
            "of t" => Some(format!("{a:?}*sin(1.7*{t} + {b:?}) + 0.1*sin(60*{t})")),
            "of direction" => Some(format!("-0.2*{a:?}*{e}*(1 + 0.5*sin({b:?}*{t}))")),
            _ => Some(format!("-({p:?}*{x}) - {q:?}*{v}")),
        };
        let input = (self.law.input == "in force").then(|| s.clone());
        let terms: Vec<String> = own
            .into_iter()
            .chain(input)
            .chain(self.more[0].clone())
            .collect();
        if terms.is_empty() {
            return None;
        }
        let sum = terms.join(" + ");
        Some(if *factor == 1.0 {
            sum
        } else {
            format!("{factor:?}*({sum})")
        })
    }

    /// The load as text, if there is any.
    fn load_text(&self) -> Option<String> {
        let Law { a, b, .. } = self.law;
        let Written { x, v, t, e, s, .. } = &self.written;
        let own = match self.law.load {
            "none" | "sides" => None,
            "of x" => Some(format!("(1 + 0.3*{a:?}*sin(2*{x} + {b:?}))")),
            "of x'" => Some(format!("(1 + 0.1*{b:?}*{e})*(1 - 0.3*{a:?}*tanh({v}^2))")),
            _ => Some(format!("(1 + 0.3*{a:?}*cos(0.7*{t} + {b:?}))")),
        };
        let input = (self.law.input == "in load").then(|| format!("(1 + 0.2*{s})"));
        let factors: Vec<String> = own
            .into_iter()
            .chain(input)
            .chain(self.more[1].clone())
            .collect();
        (!factors.is_empty()).then(|| factors.join("*"))
    }

    /// The scenario as a user would write it, without the samples.
    pub fn toml(&self) -> String {
        let drive = if self.is_dilatation {
            "dilatation"
        } else {
            "force_per_temperature"
        };
        let [[s0, d0], [s1, d1]] = self.friction;
        let load = self
            .load_text()
            .map(|load| format!("friction.load = \"{load}\"\n"));
        let force = self
            .force_text()
            .map(|text| format!("force.expression = \"{text}\"\n"));
        let harmonics: Vec<String> = (self.harmonics.iter())
            .map(|[a, w, phase]| {
                format!("{{ amplitude = {a:?}, angular_frequency = {w:?}, phase = {phase:?} }}")
            })
            .collect();
        let noise = |([rho, theta, sigma], start): &OneNoise| {
            let start = start.map_or("\"stationary\"".into(), |v| format!("{v:?}"));
            let pinned = if self.is_pinned {
                ", pinned = true"
            } else {
                ""
            };
            format!(
                "{{ intensity = {rho:?}, relaxation_rate = {theta:?}, diffusion = {sigma:?}, initial = {start}{pinned} }}"
            )
        };
        let noises: Vec<String> = match self.white {
            Some([strength, theta]) => vec![format!(
                "{{ kind = \"white\", strength = {strength:?}, relaxation_rate = {theta:?} }}"
            )],
            None => self.noises.iter().map(noise).collect(),
        };
        let noises = match &noises[..] {
            [] => String::new(),
            [one] => format!("temperature.noise = {one}\n"),
            two => format!("temperature.noise = [{}]\n", two.join(", ")),
        };
        let step = if self.scheme.has_step() {
            format!("time.step = {:?}\n", self.step)
        } else {
            format!("scheme.tolerance = {:?}\n", self.tolerance)
        };
        format!(
            "oscillator = {{ mass = {:?}, stiffness = {:?}, damping = {:?}, {drive} = {:?} }}
friction.static = {{ forward = {s0:?}, backward = {s1:?} }}
friction.dynamic = {{ forward = {d0:?}, backward = {d1:?} }}
{}{}temperature.offset = {:?}
temperature.trend = {:?}
temperature.harmonics = [{}]
{noises}initial = {{ displacement = {:?}, velocity = {:?} }}
time.end = {:?}
time.output_step = {:?}
{step}scheme.kind = \"{}\"
statistics = {{ after = {:?}, period = {:?} }}
ensemble = {{ paths = {}, seed = {}, antithetic = {} }}
",
            self.mass,
            self.stiffness,
            self.damping,
            self.drive,
            load.unwrap_or_default(),
            force.unwrap_or_default(),
            self.offset,
            self.trend,
            harmonics.join(", "),
            self.x0,
            self.v0,
            self.end,
            self.output_step,
            self.scheme.name(),
            self.after,
            self.period,
            self.paths,
            self.seed,
            self.is_antithetic,
        )
    }
}

/// All scenes.
pub fn all() -> Vec<Scene> {
    let scenes = scenes().into_iter().enumerate();
    scenes
        .map(|(number, choice)| Scene::new(number, choice))
        .collect()
}

/// Ask a question of every scene. Those that fail are printed, by name and as TOML.
pub fn ask(question: impl Fn(&Scene)) {
    let mut failed = Vec::new();
    for scene in all() {
        if catch_unwind(AssertUnwindSafe(|| question(&scene))).is_err() {
            println!("FAILED {}\n{}", scene.name, scene.toml());
            for (name, samples) in [
                ("temperature.series", &scene.series),
                ("input.s", &scene.input),
            ] {
                if let Some((times, values)) = samples {
                    println!("{name}: {times:?}\n{values:?}");
                }
            }
            failed.push(scene.name);
        }
    }
    assert!(
        failed.is_empty(),
        "{} scenes failed:\n{}",
        failed.len(),
        failed.join("\n")
    );
}
