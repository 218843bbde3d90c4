//! The exact transition of an oscillator driven by Ornstein-Uhlenbeck noise and harmonics, over any
//! time step. The system
//!
//! ```text
//! x' = v,   v' = -w0^2 x - 2 gamma v + (n + f(t))/m,   dn = -theta n dt + s dW
//! ```
//!
//! is linear with Gaussian noise. So the state after a step h is its mean plus a Gaussian vector of
//! covariance Q(h) = s^2 int_0^h g(r) g(r)^T dr. Here g = (g_x, g_v, g_n) is the response of (x, v,
//! n) to a unit of n at r = 0. The responses satisfy
//!
//! ```text
//! S'' + 2 gamma S' + w0^2 S = 0,                     S(0) = 0, S'(0) = 1
//! g_x'' + 2 gamma g_x' + w0^2 g_x = e^{-theta r}/m,  g_x(0) = g_x'(0) = 0
//! g_v = g_x',   g_n = e^{-theta r}
//! G_w'' + 2 gamma G_w' + w0^2 G_w = e^{i w r}/m,     G_w(0) = G_w'(0) = 0
//! ```
//!
//! S is the response of x to a unit of v, and G_w its response to a harmonic; w = 0 is the constant
//! force of friction.
//!
//! The entries of Q differ by many orders of magnitude (h, h^3, h^5 on its diagonal), and the usual
//! matrix exponentials (Van Loan 1978) lose the small ones. Here every entry is a power series in h
//! that starts at its own leading term. The series are used where (fastest rate) h <= 1/2, so that
//! nothing cancels. Longer steps are composed by doubling,
//!
//! ```text
//! Phi(2h) = Phi(h)^2,   Q(2h) = Q(h) + Phi(h) Q(h) Phi(h)^T,
//! G(2h) = Phi(h) G(h) + e^{i w h} G(h),
//! ```
//!
//! which adds positive matrices. No eigenvalue is computed, so critical damping and resonance need
//! no special case.

use crate::lanes::Lanes;
use crate::noise::increment_variance;

/// Terms of each series. In units of the fastest rate L, coefficient k of the squared responses is
/// below 2^k/k!. So with L h <= 1/2 the first neglected term is below 1/18! = 2e-16 of the first
/// term.
const TERMS: usize = 18;

/// The series are used up to (fastest rate) h = 1/2.
const SERIES_RADIUS: f64 = 0.5;

/// A limit of the doublings, more than any finite step of a finite rate needs.
const DOUBLINGS: u32 = 2100;

type Series = [f64; TERMS];

/// 1/m, gamma, w0, theta, s and the forcing frequencies, with the power series of all responses.
#[derive(Clone, Debug)]
pub struct DrivenOscillator {
    per_mass: f64,
    two_gamma: f64,
    w0_squared: f64,
    relaxation_rate: f64,
    diffusion: f64,
    frequencies: Vec<f64>,
    fastest: f64,
    /// S/h, m g_x/h^2, m int e^{-theta r} g_x/h^3, m^2 int g_v^2/h^3, m^2 int g_x^2/h^5, m G_0/h^2,
    /// e^{-theta h} and (1 - e^{-2 theta h})/(2 theta h).
    responses: SideBySide<8>,
    /// For each harmonic, m G_w / h^2 and e^{i w h}, real and imaginary parts.
    harmonic: Vec<SideBySide<4>>,
}

/// Several series side by side: for each power, the coefficients of all of them.
type SideBySide<const N: usize> = [[f64; N]; TERMS];

/// The response of (x, v) to a harmonic force Re[P e^{i w r}]: x += Re[P x], v += Re[P v].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HarmonicResponse<L = f64> {
    /// Real and imaginary part of G_w(h).
    pub x: (L, L),
    /// Real and imaginary part of G_w'(h).
    pub v: (L, L),
    /// cos(w h), sin(w h).
    pub turn: (L, L),
}

impl<L: Lanes> HarmonicResponse<L> {
    /// The response over a step of zero length.
    #[inline(always)]
    pub fn none() -> Self {
        let (zero, one) = (L::splat(0.0), L::splat(1.0));
        HarmonicResponse {
            x: (zero, zero),
            v: (zero, zero),
            turn: (one, zero),
        }
    }
}

/// The transition of (x, v, n) over one step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SlipTransition<L = f64> {
    /// h.
    pub length: L,
    /// The coefficients of x, v, n and a constant force in the mean of x after the step.
    pub x: [L; 4],
    /// The coefficients of x, v, n and a constant force in the mean of v after the step.
    pub v: [L; 4],
    /// The coefficient of n in the mean of n after the step.
    pub n: L,
    /// Covariances nn, nv, nx, vv, vx, xx.
    pub covariance: [L; 6],
    /// The law of v and x given n. Of v: its slope on n, and the sd of the rest. Of x: its slope on
    /// n, its slope on a unit of the rest of v, and the sd of what then remains.
    pub given_noise: [L; 5],
}

impl DrivenOscillator {
    /// An oscillator from m, gamma = alpha/m, w0, theta, s and the frequencies of the forcing.
    pub fn new(
        mass: f64,
        damping_rate: f64,
        natural_frequency: f64,
        relaxation_rate: f64,
        diffusion: f64,
        frequencies: &[f64],
    ) -> Self {
        let (g, w0) = (damping_rate, natural_frequency);
        // The roots of the free oscillator: |l1|, |l2| <= |gamma| + sqrt(gamma^2 - w0^2) if it does
        // not oscillate, w0 otherwise.
        let free = if g.abs() > w0 {
            g.abs() + ((g - w0) * (g + w0)).sqrt()
        } else {
            w0
        };
        let fastest = frequencies
            .iter()
            .copied()
            .fold(free.max(relaxation_rate), f64::max);
        // Everything below is in units of 1/fastest.
        let damping = 2.0 * g / fastest;
        let stiffness = (w0 / fastest) * (w0 / fastest);
        let theta = relaxation_rate / fastest;
        let answer = |re: &dyn Fn(usize) -> f64| response(damping, stiffness, re);
        let zero = |_: usize| 0.0;
        let (g_x, constant) = (
            answer(&|k| (-theta).powi(k as i32)),
            answer(&|k| if k == 0 { 1.0 } else { 0.0 }),
        );
        let impulse = free_response(damping, stiffness);
        let decay: Series = std::array::from_fn(|k| (-theta).powi(k as i32) / factorial(k));
        let spread: Series =
            std::array::from_fn(|k| (-2.0 * theta).powi(k as i32) / factorial(k + 1));
        let slope: Series = std::array::from_fn(|k| (k + 2) as f64 * g_x[k]);
        let [cov_nx, cov_vv, cov_xx] = [(&decay, &g_x, 2), (&slope, &slope, 2), (&g_x, &g_x, 4)]
            .map(|(a, b, n)| integral_of_product(a, b, n));
        let of_harmonic = |w: f64| {
            // (i w)^k = w^k (1, i, -1, -i, ...)
            let re = |k: usize| [1.0, 0.0, -1.0, 0.0][k % 4] * w.powi(k as i32);
            let im = |k: usize| [0.0, 1.0, 0.0, -1.0][k % 4] * w.powi(k as i32);
            let turn =
                |part: &dyn Fn(usize) -> f64| std::array::from_fn(|k| part(k) / factorial(k));
            side_by_side([
                answer(&re),
                if w == 0.0 { answer(&zero) } else { answer(&im) },
                turn(&re),
                turn(&im),
            ])
        };
        DrivenOscillator {
            per_mass: 1.0 / mass,
            two_gamma: 2.0 * g,
            w0_squared: w0 * w0,
            relaxation_rate,
            diffusion,
            frequencies: frequencies.to_vec(),
            fastest,
            responses: side_by_side([
                impulse, g_x, cov_nx, cov_vv, cov_xx, constant, decay, spread,
            ]),
            harmonic: frequencies
                .iter()
                .map(|w| of_harmonic(w / fastest))
                .collect(),
        }
    }

    /// The largest of w0, the damping rate, theta and the forcing frequencies.
    pub fn fastest_rate(&self) -> f64 {
        self.fastest
    }

    /// Whether the transition over h is a sum of series, without doubling.
    pub fn has_series_for(&self, h: f64) -> bool {
        self.fastest * h <= SERIES_RADIUS
    }

    /// The transition over h. `harmonics` receives one response per frequency.
    #[inline(always)]
    pub fn transition(&self, h: f64, harmonics: &mut [HarmonicResponse]) -> SlipTransition {
        // The step is halved until the series can be used.
        let (mut base, mut doublings) = (h, 0);
        while self.fastest * base > SERIES_RADIUS && doublings < DOUBLINGS {
            base *= 0.5;
            doublings += 1;
        }
        let mut step = self.series(base);
        for (harmonic, response) in harmonics.iter_mut().enumerate() {
            *response = self.response(&step, harmonic);
        }
        for _ in 0..doublings {
            step = self.doubled(&step, harmonics);
        }
        step.given_noise = given_noise(&step.covariance);
        step
    }

    /// The transition over (fastest rate) h <= 1/2, by the series. `given_noise` is left at zero.
    #[inline(always)]
    pub fn series<L: Lanes>(&self, h: L) -> SlipTransition<L> {
        let r = h * self.fastest;
        let (w2, g2, theta, per_mass) = (
            self.w0_squared,
            self.two_gamma,
            self.relaxation_rate,
            self.per_mass,
        );
        let [
            impulse,
            g_x,
            cov_nx,
            cov_vv,
            cov_xx,
            constant,
            remembered,
            spread,
        ] = sums(&self.responses, r);
        let (h2, one) = (h * h, L::splat(1.0));
        let impulse = h * impulse;
        let constant = h2 * constant; // int S
        let g_x = h2 * g_x * per_mass;
        let s2 = self.diffusion * self.diffusion;
        let h3 = h2 * h * s2;
        let cov_nx = h3 * cov_nx * per_mass;
        let cov_vv = h3 * cov_vv * (per_mass * per_mass);
        let cov_xx = h3 * h2 * cov_xx * (per_mass * per_mass);
        SlipTransition {
            length: h,
            x: [one - constant * w2, impulse, g_x, constant * per_mass],
            v: [
                impulse * -w2,
                one - constant * w2 - impulse * g2,
                impulse * per_mass - g_x * theta,
                impulse * per_mass,
            ],
            n: remembered,
            covariance: [
                h * s2 * spread,
                // int g_n g_v = [g_n g_x] + theta int g_n g_x, by parts.
                remembered * s2 * g_x + cov_nx * theta,
                cov_nx,
                cov_vv,
                g_x * g_x * (0.5 * s2),
                cov_xx,
            ],
            given_noise: [L::splat(0.0); 5],
        }
    }

    /// The response to a harmonic over a step of [`series`](Self::series).
    #[inline(always)]
    pub fn response<L: Lanes>(
        &self,
        step: &SlipTransition<L>,
        harmonic: usize,
    ) -> HarmonicResponse<L> {
        let (h2, impulse, per_mass) = (step.length * step.length, step.x[1], self.per_mass);
        let [x_re, x_im, cos, sin] = sums(&self.harmonic[harmonic], step.length * self.fastest);
        let (x, w) = (
            (h2 * x_re * per_mass, h2 * x_im * per_mass),
            self.frequencies[harmonic],
        );
        // G' = i w G + S/m.
        let v = (impulse * per_mass - x.1 * w, x.0 * w);
        HarmonicResponse {
            x,
            v,
            turn: (cos, sin),
        }
    }

    fn doubled(&self, step: &SlipTransition, harmonics: &mut [HarmonicResponse]) -> SlipTransition {
        let ([a, b, c, d], [e, f, g, k], n) = (step.x, step.v, step.n);
        for response in harmonics {
            let (x, v, (cos, sin)) = (response.x, response.v, response.turn);
            let turned = |(re, im): (f64, f64)| (re * cos - im * sin, re * sin + im * cos);
            let (tx, tv) = (turned(x), turned(v));
            response.x = (a * x.0 + b * v.0 + tx.0, a * x.1 + b * v.1 + tx.1);
            response.v = (e * x.0 + f * v.0 + tv.0, e * x.1 + f * v.1 + tv.1);
            response.turn = turned((cos, sin));
        }
        let [nn, nv, nx, vv, vx, xx] = step.covariance;
        let g_x = a * c + b * g + c * n;
        // Rows of Phi Q, needed for Phi Q Phi^T.
        let (qx, qv) = (
            [
                a * xx + b * vx + c * nx,
                a * vx + b * vv + c * nv,
                a * nx + b * nv + c * nn,
            ],
            [
                e * xx + f * vx + g * nx,
                e * vx + f * vv + g * nv,
                e * nx + f * nv + g * nn,
            ],
        );
        let length = 2.0 * step.length;
        SlipTransition {
            length,
            x: [a * a + b * e, a * b + b * f, g_x, a * d + b * k + d],
            v: [
                e * a + f * e,
                e * b + f * f,
                e * c + f * g + g * n,
                e * d + f * k + k,
            ],
            n: n * n,
            covariance: [
                increment_variance(self.relaxation_rate, self.diffusion, length),
                nv + qv[2] * n,
                nx + qx[2] * n,
                vv + e * qv[0] + f * qv[1] + g * qv[2],
                // int g_x g_x' exactly.
                0.5 * self.diffusion * self.diffusion * g_x * g_x,
                xx + a * qx[0] + b * qx[1] + c * qx[2],
            ],
            given_noise: [0.0; 5],
        }
    }
}

/// The same transition in every lane.
#[inline(always)]
pub fn splat<L: Lanes>(step: &SlipTransition) -> SlipTransition<L> {
    SlipTransition {
        length: L::splat(step.length),
        x: splat_all(step.x),
        v: splat_all(step.v),
        n: L::splat(step.n),
        covariance: splat_all(step.covariance),
        given_noise: splat_all(step.given_noise),
    }
}

/// Each of these numbers in every lane.
#[inline(always)]
fn splat_all<L: Lanes, const N: usize>(numbers: [f64; N]) -> [L; N] {
    let mut all = [L::splat(0.0); N];
    for (lanes, number) in all.iter_mut().zip(numbers) {
        *lanes = L::splat(number);
    }
    all
}

/// The series y / h^2 of the solution of y'' + damping y' + stiffness y = sum_k f_k r^k/k!, y(0) =
/// y'(0) = 0, in units of the fastest rate: (k+2)! y_{k+2} = f_k - damping (k+1)! y_{k+1} -
/// stiffness k! y_k.
fn response(damping: f64, stiffness: f64, force: &dyn Fn(usize) -> f64) -> Series {
    let (mut before, mut last) = (0.0, 0.0);
    std::array::from_fn(|k| {
        let next = force(k) - damping * last - stiffness * before;
        (before, last) = (last, next);
        next / factorial(k + 2)
    })
}

/// The series S / h likewise, without force and with S'(0) = 1.
fn free_response(damping: f64, stiffness: f64) -> Series {
    let (mut before, mut last) = (0.0, 1.0);
    std::array::from_fn(|k| {
        if k > 0 {
            (before, last) = (last, -damping * last - stiffness * before);
        }
        last / factorial(k + 1)
    })
}

/// int_0^r a(u) b(u) u^power du / r^{power+1}.
fn integral_of_product(a: &Series, b: &Series, power: usize) -> Series {
    std::array::from_fn(|k| (0..=k).map(|i| a[i] * b[k - i]).sum::<f64>() / (k + power + 1) as f64)
}

fn factorial(k: usize) -> f64 {
    (1..=k).map(|i| i as f64).product()
}

/// The coefficients of several series, power by power.
fn side_by_side<const N: usize>(series: [Series; N]) -> SideBySide<N> {
    std::array::from_fn(|k| std::array::from_fn(|i| series[i][k]))
}

/// The sums of several series, all at once, by Horner's rule.
#[inline(always)]
fn sums<L: Lanes, const N: usize>(series: &SideBySide<N>, r: L) -> [L; N] {
    let mut sums = [L::splat(0.0); N];
    for coefficients in series.iter().rev() {
        for (sum, &c) in sums.iter_mut().zip(coefficients) {
            *sum = sum.mul_add(r, L::splat(c));
        }
    }
    sums
}

/// The law of v and x given n, from the covariance of n, v and x ([`SlipTransition::given_noise`]).
/// It is computed from the Cholesky factor of the correlation matrix. The entries of this matrix
/// are all of order one, while the covariance itself has a condition number of h^-4.
#[inline(always)]
pub fn given_noise<L: Lanes>(&[nn, nv, nx, vv, vx, xx]: &[L; 6]) -> [L; 5] {
    let (zero, one) = (L::splat(0.0), L::splat(1.0));
    let (sn, sv, sx) = (nn.sqrt(), vv.sqrt(), xx.sqrt());
    let (rnv, rnx, rvx) = (ratio(nv, sn * sv), ratio(nx, sn * sx), ratio(vx, sv * sx));
    // The argument of this root is never negative in law. Rounding may make it negative where the
    // noise is almost white.
    let l22 = (one - rnv * rnv).or_at_least(zero).sqrt();
    let l32 = ratio(rvx - rnv * rnx, l22);
    let l33 = (one - rnx * rnx - l32 * l32).or_at_least(zero).sqrt();
    let per_noise = ratio(one, sn);
    [
        sv * rnv * per_noise,
        sv * l22,
        sx * rnx * per_noise,
        sx * l32,
        sx * l33,
    ]
}

/// a/b, or 0 where b = 0.
#[inline(always)]
fn ratio<L: Lanes>(a: L, b: L) -> L {
    L::select(b.gt(L::splat(0.0)), a / b, L::splat(0.0))
}
