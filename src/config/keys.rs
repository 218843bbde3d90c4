//! Every key of a scenario: its table, its symbol, its meaning and its range.

use crate::scenario::MAX_PHASE;
use crate::scheme::TOLERANCES;
use Allowed::{Any, NonNegative, Phase, Positive, StaticThreshold, Threshold, Tolerance};

/// The range of numbers that a key accepts. NaN is never accepted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Allowed {
    /// The value is not a number.
    None,
    Any,
    Positive,
    NonNegative,
    /// A friction threshold, at least 0. It has no upper limit, because a threshold that is never
    /// reached does not enter the computation.
    Threshold,
    /// A friction threshold that may be infinite if it is never reached.
    StaticThreshold,
    /// A phase in radians, small enough to keep its precision.
    Phase,
    Tolerance,
}

impl Allowed {
    pub fn holds(self, x: f64) -> bool {
        match self {
            Allowed::None => false,
            Any => true,
            Positive => x > 0.0,
            NonNegative | Threshold | StaticThreshold => x >= 0.0,
            Phase => x.abs() <= MAX_PHASE,
            Tolerance => TOLERANCES.contains(&x),
        }
    }

    /// A number within the range, used in place of an invalid one so that reading can continue.
    pub fn stand_in(self) -> f64 {
        match self {
            Tolerance => *TOLERANCES.end(),
            _ => 1.0,
        }
    }

    pub fn words(self) -> &'static str {
        match self {
            Allowed::None => "no number",
            Any => "a finite number",
            Positive => "a finite number above 0",
            NonNegative | Threshold => "a finite number, 0 or above",
            StaticThreshold => "a number, 0 or above, or inf for a threshold that is never reached",
            Phase => "a phase from -1e13 to 1e13, the limit of double precision",
            Tolerance => "a number from 1e-9 to 0.1",
        }
    }
}

/// A key of a scenario. Keys without a numeric value have no range.
#[derive(Clone, Copy, Debug)]
pub(super) struct Key {
    pub name: &'static str,
    pub symbol: &'static str,
    pub meaning: &'static str,
    pub range: Allowed,
    /// The unit, in words; empty for a number without one.
    pub unit: &'static str,
    /// The default; empty if the key is required.
    pub default: &'static str,
    /// The permitted values, if the range does not give them.
    pub allowed: &'static str,
    /// What may be written instead of a required key.
    pub instead: &'static str,
}

impl Key {
    const fn unit(self, unit: &'static str) -> Key {
        Key { unit, ..self }
    }

    const fn default(self, default: &'static str) -> Key {
        Key { default, ..self }
    }

    const fn allowed(self, allowed: &'static str) -> Key {
        Key { allowed, ..self }
    }

    /// Whether its value is a time in the unit of the scenario.
    pub fn is_time(&self) -> bool {
        self.unit == "time"
    }

    const fn instead(self, instead: &'static str) -> Key {
        Key { instead, ..self }
    }
}

/// A key with a numeric value.
const fn number(
    name: &'static str,
    symbol: &'static str,
    meaning: &'static str,
    range: Allowed,
) -> Key {
    Key {
        symbol,
        range,
        ..other(name, meaning)
    }
}

/// A key whose value is a text, a flag or a whole number.
const fn other(name: &'static str, meaning: &'static str) -> Key {
    Key {
        name,
        symbol: "",
        meaning,
        range: Allowed::None,
        unit: "",
        default: "",
        allowed: "",
        instead: "",
    }
}

/// A key whose value is a table, or several.
const fn table(name: &'static str) -> Key {
    other(name, "")
}

/// Any key of the table of parameters.
pub(super) const PARAMETER: Key = number("", "", "a parameter", Any);

/// From one list: a constant for each key, and the tables with their keys. A key without a value
/// belongs to another table.
macro_rules! keys {
    ($($table:literal { $($KEY:ident $(= $key:expr)?;)+ })+) => {
        $($($(pub(super) const $KEY: Key = $key;)?)+)+

        /// The tables and the keys of each, in the order in which a resolved scenario is written.
        pub(super) const TABLES: &[(&str, &[Key])] = &[$(($table, &[$($KEY),+])),+];
    };
}

keys! {
    "" {
        TITLE = other("title", "title of the scenario, in one line")
            .default("the file name").allowed("one line");
        OSCILLATOR = table("oscillator");
        FRICTION = table("friction");
        TEMPERATURE = table("temperature");
        SENSOR = table("displacement");
        INPUT = table("input");
        FORCE = table("force");
        PARAMETERS = other("parameters", "names of numbers for all keys and expressions")
            .default("none")
            .allowed("a table of at most 64 numbers");
        INITIAL = table("initial");
        BEARING = table("bearing");
        TIME = table("time");
        SCHEME = table("scheme");
        STATISTICS = table("statistics");
        ENSEMBLE = table("ensemble");
        RECORD = table("record");
        UNITS = table("units");
    }
    "oscillator" {
        MASS = number("mass", "m", "mass", Positive)
            .unit("mass");
        STIFFNESS = number("stiffness", "K", "stiffness of the spring; 0 for none", NonNegative)
            .unit("force / length");
        DAMPING = number("damping", "alpha", "damping force 2 alpha x'; a negative alpha drives the body", Any)
            .unit("force time / length").default("0");
        DILATATION = number("dilatation", "beta", "rest position beta T", Any)
            .unit("length / temperature").default("required, or the next key");
        FORCE_PER_TEMPERATURE = number(
            "force_per_temperature", "c", "force c T on the body, instead of a dilatation", Any)
            .unit("force / temperature").default("K beta");
    }
    "friction" {
        STATIC = number("static", "f_s", "the body sticks while |b| <= f_s", StaticThreshold)
            .unit("force");
        DYNAMIC = number("dynamic", "f_d", "|F| in motion, at most f_s", Threshold)
            .unit("force");
        LOAD = other("load", "expression that multiplies f_s and f_d, at least 0")
            .default("none").allowed("an expression");
    }
    "temperature" {
        TEMPERATURE_OFFSET = number("offset", "", "a constant", Any)
            .unit("temperature").default("0");
        TREND = number("trend", "", "slope of a linear trend (belt, pulled spring)", Any)
            .unit("temperature / time").default("0");
        HARMONICS = table("harmonics");
        SERIES = table("series");
        NOISE = table("noise");
    }
    "temperature.harmonics" {
        AMPLITUDE = number("amplitude", "a", "amplitude of the harmonic", Any)
            .unit("temperature");
        ANGULAR_FREQUENCY = number(
            "angular_frequency", "w", "angular frequency of the forcing, not of the oscillator", NonNegative)
            .unit("1 / time");
        PHASE = number("phase", "phi", "phase at t = 0, in radians", Phase)
            .unit("radians").default("0");
    }
    "temperature.series" {
        FILE = other("file", "path of the data file, relative to the scenario")
            .allowed("a path");
        SERIES_TIME = other("time", "time column")
            .default("found by its name").allowed("a name or a number; date and time with a comma");
        VALUE = other("value", "value column")
            .default("found by its name").allowed("a name or a number");
        UNIT = other("unit", "of the values")
            .default("from the file").allowed("a unit");
        ZONE = other("zone", "time zone of stamps without one")
            .default("none").allowed("such as Europe/Berlin or +01:00");
        DATES = other("dates", "order of year, month and day")
            .default("inferred").allowed("`\"ymd\"`, `\"dmy\"`, `\"mdy\"`");
        SKIP = other("skip", "lines before the header")
            .unit("lines").default("inferred").allowed("0 to 1000000");
        MISSING = other("missing", "markers of missing values")
            .default("none").allowed("texts");
        SKIP_BAD = other("skip_bad", "leave out lines that cannot be read")
            .default("`false`").allowed("`true`, `false`");
        DECIMAL = other("decimal", "decimal separator")
            .default("inferred").allowed("`\".\"`, `\",\"`");
        AVERAGED = number("averaged", "", "averaging time of each value, ending at its stamp", Allowed::NonNegative)
            .unit("s").default("from the column name").allowed("0 or above, or a text such as `\"10min\"`");
        OUTLIERS = other("outliers", "leave out values beyond this many standard deviations")
            .default("none").allowed("1 to 1000000");
        MAX_GAP = number("max_gap", "", "longest gap between two samples", Positive)
            .unit("s").default("`\"6h\"` if times are in seconds").allowed("above 0, or a text such as `\"6h\"`");
        START = other("start", "date of t = 0, from the samples")
            .default("from the samples").allowed("a stamp");
        HASH = other("hash", "of the samples")
            .default("from the samples").allowed("16 digits");
        PROCESS = other("process", "a law, from which each path draws the values, instead of a file")
            .default("none").allowed("[a process](noise.md)");
        SAMPLE_STEP;
        REUSE;
        ENVELOPE;
        LOW;
        HIGH;
        RATE_UP;
        RATE_DOWN;
        RATE;
        SIZE;
        SIZE_SD;
        SIZES;
        SHAPE;
        DURATION;
        OF_FILTER;
        DAMPING_RATIO;
        OF_PROCESS;
        RELAXATION_RATE;
        DIFFUSION;
        INITIAL_NOISE;
    }
    "displacement" {
        SERIES;
    }
    "displacement.series" {
        FILE;
        SERIES_TIME;
        VALUE;
        UNIT;
        ZONE;
        DATES;
        SKIP;
        MISSING;
        SKIP_BAD;
        OUTLIERS;
        DECIMAL;
        AVERAGED;
    }
    "temperature.noise" {
        NOISE_KIND = other("kind", "\"ornstein-uhlenbeck\", or \"white\"")
            .default("`\"ornstein-uhlenbeck\"`").allowed("`\"ornstein-uhlenbeck\"`, `\"white\"`");
        STRENGTH = number("strength", "D", "of white noise sqrt(2 D) xi(t)", Positive)
            .unit("temperature^2 time").default("required if white");
        INTENSITY = number("intensity", "rho", "weight of v in T", NonNegative)
            .unit("temperature").default("required unless white");
        RELAXATION_RATE = number("relaxation_rate", "theta", "dv = -theta v dt + sigma dW", Positive)
            .unit("1 / time").default("1");
        DIFFUSION = number("diffusion", "sigma", "dv = -theta v dt + sigma dW", NonNegative)
            .unit("1 / time^(1/2)").default("1");
        INITIAL_NOISE = number("initial", "v(0)", "initial value of the noise", Any)
            .unit("that of v").default("0").allowed("any, or `\"stationary\"`");
        PINNED = other("pinned", "v is zero at every sample of the series")
            .default("`false`").allowed("`true`, `false`");
    }
    "input" {
        FILE;
        SERIES_TIME;
        COLUMN = other("column", "value column")
            .default("found by its name").allowed("a name or a number");
        SAMPLE_STEP = number("step", "", "time between the values of a process, or of a file without times (s)", Positive)
            .unit("time").default("none");
        UNIT;
        ZONE;
        DATES;
        SKIP;
        DECIMAL;
        START;
        HASH;
        INTERPOLATION = other("interpolation", "between the rows of a file; constant holds each value")
            .default("`\"linear\"`").allowed("`\"linear\"`, `\"constant\"`");
        PROCESS;
        REUSE = other("reuse", "whether paths take the realisations of a file again after the last")
            .default("`false`").allowed("`true`, `false`");
        ENVELOPE = other("envelope", "expression of t by which the samples of a process are multiplied")
            .default("none").allowed("an expression");
        LOW = number("low", "", "lower value of a telegraph", Any)
            .unit("of the values").default("-1");
        HIGH = number("high", "", "upper value of a telegraph", Any)
            .unit("of the values").default("1");
        RATE_UP = number("rate_up", "", "rate of a telegraph from low to high", Positive)
            .unit("1 / time").default("required by a telegraph");
        RATE_DOWN = number("rate_down", "", "rate of a telegraph from high to low", Positive)
            .unit("1 / time").default("rate_up");
        RATE = number("rate", "lambda", "pulses of shot noise per time", Positive)
            .unit("1 / time").default("required by shot noise");
        SIZE = number("size", "J", "mean area of a pulse, an impulse for a force", Any)
            .unit("of the values, times time").default("required by shot noise");
        SIZE_SD = number("size_sd", "", "standard deviation of normal areas", NonNegative)
            .unit("that of size").default("0");
        SIZES = other("sizes", "law of the areas")
            .default("`\"fixed\"`").allowed("`\"fixed\"`, `\"exponential\"`, `\"normal\"`");
        SHAPE = other("shape", "shape of a pulse")
            .default("`\"kick\"`").allowed("`\"kick\"`, `\"rectangle\"`, `\"decay\"`");
        DURATION = number("duration", "", "length of a rectangle, or time constant of a decay", Positive)
            .unit("time").default("required unless a kick");
        OF_FILTER = number("angular_frequency", "w", "of the ground, for Kanai-Tajimi", Positive)
            .unit("1 / time").default("required by Kanai-Tajimi");
        DAMPING_RATIO = number("damping_ratio", "zeta", "of the ground, for Kanai-Tajimi", Positive)
            .default("required by Kanai-Tajimi");
        OF_PROCESS = number("intensity", "", "S0 of Kanai-Tajimi (values^2 time), or rho of Ornstein-Uhlenbeck", NonNegative)
            .unit("of the process").default("required by these");
        RELAXATION_RATE;
        DIFFUSION;
        INITIAL_NOISE;
    }
    "force" {
        EXPRESSION = other("expression", "g(x, xdot, t), added to b")
            .unit("force").allowed("an expression");
    }
    "initial" {
        DISPLACEMENT = number("displacement", "x0", "x(0)", Any)
            .unit("length").allowed("any, or `\"balanced\"`");
        VELOCITY = number("velocity", "x'(0)", "velocity at t = 0", Any)
            .unit("length / time").default("0");
    }
    "bearing" {
        BEARING_STIFFNESS = number("stiffness", "K_BP", "shear stiffness of the bearing", Positive)
            .unit("force / length").default("a rigid bearing");
        OFFSET = number("offset", "z0", "sensor reading at x = 0", Any)
            .unit("length").default("0");
    }
    "time" {
        END = number("end", "t_end", "duration", NonNegative)
            .unit("time").default("the earliest last sample").allowed("0 to the earliest last sample, in whole steps");
        STEP = number("step", "h", "time step", Positive)
            .unit("time").default("required by schemes with a step")
            .instead("`scheme.kind = \"event-driven\"`, which has no step");
        OUTPUT_STEP = number("output_step", "", "spacing of the output grid", Positive)
            .unit("time").default("about 120 rows").allowed("whole steps; at most 100000 rows");
    }
    "scheme" {
        KIND = other("kind", "the scheme")
            .default("`\"discrete-vi\"`").allowed("[a scheme](scenario.md#time-and-scheme)");
        TOLERANCE = number("tolerance", "", "permitted relative discretisation error", Tolerance)
            .default("1e-3");
    }
    "statistics" {
        AFTER = number("after", "", "start of the counted time", NonNegative)
            .unit("time").default("0").allowed("from 0 to below `time.end`");
        LEVELS = number("levels", "", "distances from the start for first-passage times", Positive)
            .unit("length").default("none").allowed("at most 8 numbers above 0");
        COMPARED = number("period", "P", "period at which displacements are compared", Positive)
            .unit("time").default("the forcing period, or a tenth of the counted time");
    }
    "ensemble" {
        PATHS = other("paths", "number of paths")
            .default("10000").allowed("1 to 2^40");
        SEED = other("seed", "seed of the random numbers")
            .default("1").allowed("0 to 2^64 - 1");
        ANTITHETIC = other("antithetic", "paths 2k and 2k + 1 use mirrored noise")
            .default("`false`").allowed("`true`, `false`");
    }
    "record" {
        RECORD_PATHS = other("paths", "scalar results of every path")
            .default("`true`").allowed("`true`, `false`");
        EVENTS = other("events", "events of every path")
            .default("`false`").allowed("`true`, `false`");
        TRAJECTORIES = other("trajectories", "number of leading paths to record on the output grid")
            .default("0").allowed("0 to 1000000");
        LAWS = other("laws", "distributions of slips, jumps and times from slip to slip")
            .default("`false`").allowed("`true`, `false`");
        DENSITY = other("density", "densities of x and x' over time")
            .default("`false`").allowed("`true`, `false`");
        ENERGY = other("energy", "work of every force")
            .default("`false`").allowed("`true`, `false`");
        SPECTRUM = other("spectrum", "autocovariance and spectrum of x and x'")
            .default("`false`").allowed("`true`, `false`");
    }
    "units" {
        TIME_LABEL = other("time", "label")
            .default("none").allowed("one line");
        LENGTH_LABEL = other("length", "label")
            .default("none").allowed("one line");
        FORCE_LABEL = other("force", "label")
            .default("none").allowed("one line");
        TEMPERATURE_LABEL = other("temperature", "label")
            .default("none").allowed("one line");
    }
}

/// The key with a dotted name, if its value is a number. The index of a harmonic is ignored.
pub(super) fn of_name(dotted: &str) -> Option<Key> {
    let is_name = |segment: &&str| !segment.bytes().all(|byte| byte.is_ascii_digit());
    let plain = dotted
        .split('.')
        .map(str::trim)
        .filter(is_name)
        .collect::<Vec<_>>()
        .join(".");
    let (table, name) = plain.rsplit_once('.')?;
    let (_, keys) = TABLES.iter().find(|(home, _)| *home == table)?;
    keys.iter()
        .find(|key| key.name == name && key.range != Allowed::None)
        .copied()
}

/// The names of the keys of a table.
pub(super) fn of_table(table: &str) -> Vec<&'static str> {
    TABLES
        .iter()
        .find(|(name, _)| *name == table)
        .map_or(Vec::new(), |(_, keys)| names(keys))
}

/// The names of these keys.
pub(super) fn names(keys: &[Key]) -> Vec<&'static str> {
    keys.iter().map(|key| key.name).collect()
}
