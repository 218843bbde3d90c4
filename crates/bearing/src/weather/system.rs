//! The weather as a linear system driven by white noise: the processes, their smoothing, and the
//! samples.
//!
//! ```text
//! du_j = -theta_j u_j dt + sqrt(2 theta_j v_j) dW_j        the processes
//! ds_i/dt = (what is before it - s_i)/tau_i                what follows them, one after the other
//! dm/dt = (the last of these)/w, with m = 0 at t - w       the mean over the time w before a sample
//! ```
//!
//! Its transition over a time h and the covariance that it gains are those of a step short enough
//! for a few terms of their series, doubled as often as h takes. All terms that doubling adds are
//! positive, so nothing cancels.

/// Largest number of states.
pub const STATES: usize = 4;

/// A number for each state.
pub type States = [f64; STATES];

/// A matrix of the states.
pub type Square = [States; STATES];

/// The evolution of the states over some time: x(t + h) = carry x(t) + a normal with this
/// covariance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Passage {
    pub carry: Square,
    pub gained: Square,
}

/// The states and their equations.
#[derive(Clone, Debug)]
pub struct System {
    drift: Square,
    noise: States,
    /// Number of states.
    pub states: usize,
    /// The weights of the states in an observation.
    pub seen: States,
    /// w; 0 if samples are instantaneous.
    window: f64,
}

impl System {
    /// Processes with their rates and variances, followers with their time constants, and the time
    /// over which a sample is a mean.
    pub fn new(processes: &[(f64, f64)], followers: &[f64], window: f64) -> Self {
        let (mut drift, [mut noise, mut seen]) = ([[0.0; STATES]; STATES], [[0.0; STATES]; 2]);
        for (j, (theta, variance)) in processes.iter().enumerate() {
            drift[j][j] = -theta;
            noise[j] = 2.0 * theta * variance;
            seen[j] = 1.0;
        }
        let mut states = processes.len();
        for tau in followers.iter().filter(|tau| **tau > 0.0) {
            drift[states] = seen.map(|seen| seen / tau);
            drift[states][states] = -1.0 / tau;
            seen = unit(states);
            states += 1;
        }
        if window > 0.0 {
            drift[states] = seen.map(|seen| seen / window);
            seen = unit(states);
            states += 1;
        }
        System {
            drift,
            noise,
            states,
            seen,
            window,
        }
    }

    /// The stationary covariance of the states at a sample.
    pub fn stationary(&self) -> Square {
        let settled = self.settled();
        if self.window == 0.0 {
            return settled;
        }
        let mean = self.flow(self.window);
        add(&carried(&mean.carry, &settled), &mean.gained)
    }

    /// The same without the mean.
    pub fn settled(&self) -> Square {
        let mut passing = System {
            window: 0.0,
            ..self.clone()
        };
        if self.window > 0.0 {
            passing.drift[self.states - 1] = [0.0; STATES];
        }
        let mut passage = passing.short(1.0 / 16.0 / passing.size());
        for _ in 0..MOST_DOUBLINGS {
            passage = passage.then(&passage);
            if (0..STATES).all(|i| {
                passing.drift[i][i] == 0.0 || passage.carry[i].iter().all(|x| x.abs() < 1e-17)
            }) {
                break;
            }
        }
        passage.gained
    }

    /// From one sample to the next, a time h later.
    pub fn passage(&self, h: f64) -> Passage {
        if self.window == 0.0 {
            return self.flow(h);
        }
        let w = self.window.min(h);
        let mut before = self.flow(h - w);
        let mean = self.states - 1;
        (before.carry[mean], before.gained[mean]) = Default::default();
        before.gained.iter_mut().for_each(|row| row[mean] = 0.0);
        before.then(&self.flow(w))
    }

    /// Over a time h without a sample.
    pub fn flow(&self, h: f64) -> Passage {
        let doublings =
            libm::ceil(libm::log2(16.0 * h * self.size())).clamp(0.0, f64::from(MOST_DOUBLINGS));
        let short = self.short(h / libm::exp2(doublings));
        (0..doublings as u32).fold(short, |passage, _| passage.then(&passage))
    }

    /// The largest sum of a row of the drift.
    fn size(&self) -> f64 {
        self.drift
            .iter()
            .map(|row| row.iter().map(|x| x.abs()).sum())
            .fold(f64::MIN_POSITIVE, f64::max)
    }

    /// The flow over a time that is short compared with all rates.
    fn short(&self, h: f64) -> Passage {
        let mut carry: Square = std::array::from_fn(unit);
        let mut gained: Square = std::array::from_fn(|i| unit(i).map(|x| h * x * self.noise[i]));
        let [mut power, mut term] = [carry, gained];
        for k in 1..TERMS {
            let by = |share: f64, of: &Square| of.map(|row| row.map(|x| share * x));
            power = by(h / k as f64, &product(&self.drift, &power));
            let grown = product(&self.drift, &term);
            term = by(h / (k + 1) as f64, &add(&grown, &transposed(&grown)));
            (carry, gained) = (add(&carry, &power), add(&gained, &term));
        }
        Passage { carry, gained }
    }
}

/// Terms of the series of a short flow, whose size is below 1/16.
const TERMS: usize = 11;

/// More doublings than any rate in double precision needs.
const MOST_DOUBLINGS: u32 = 200;

impl Passage {
    /// This one, and the other after it.
    fn then(&self, other: &Passage) -> Passage {
        let carry = product(&other.carry, &self.carry);
        Passage {
            carry,
            gained: add(&carried(&other.carry, &self.gained), &other.gained),
        }
    }
}

fn unit(i: usize) -> States {
    std::array::from_fn(|j| f64::from(u8::from(i == j)))
}

/// The scalar product of two state vectors.
pub fn dot(a: &States, b: &States) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// A matrix times the states.
pub fn times(a: &Square, x: &States) -> States {
    std::array::from_fn(|i| dot(&a[i], x))
}

/// The covariance after a sample with this gain and these weights.
pub fn updated(covariance: &Square, gain: &States, shown: &States) -> Square {
    std::array::from_fn(|i| std::array::from_fn(|j| covariance[i][j] - gain[i] * shown[j]))
}

pub fn add(a: &Square, b: &Square) -> Square {
    std::array::from_fn(|i| std::array::from_fn(|j| a[i][j] + b[i][j]))
}

fn transposed(a: &Square) -> Square {
    std::array::from_fn(|i| std::array::from_fn(|j| a[j][i]))
}

/// Written as loops, because sums of iterators took two fifths of the time of a calibration.
pub fn product(a: &Square, b: &Square) -> Square {
    let mut product = [[0.0; STATES]; STATES];
    for (row, factors) in product.iter_mut().zip(a) {
        for (factor, other) in factors.iter().zip(b) {
            for (sum, x) in row.iter_mut().zip(other) {
                *sum += factor * x;
            }
        }
    }
    product
}

/// The covariance of the carried states.
pub fn carried(carry: &Square, covariance: &Square) -> Square {
    product(&product(carry, covariance), &transposed(carry))
}

/// A lower triangle L with A = L L^T. A state determined by others has a zero diagonal.
pub fn root(a: &Square) -> Square {
    let mut root = [[0.0; STATES]; STATES];
    for i in 0..STATES {
        for j in 0..=i {
            let rest = a[i][j] - (0..j).map(|k| root[i][k] * root[j][k]).sum::<f64>();
            root[i][j] = match i == j {
                true if rest > 1e-14 * a[i][i] => rest.sqrt(),
                false if root[j][j] > 0.0 => rest / root[j][j],
                _ => 0.0,
            };
        }
    }
    root
}
