use std::time::Instant as Clock;
use stick_slip::lanes::*;
use stick_slip::model::*;
use stick_slip::noise::*;
use stick_slip::scheme::*;
struct Fill {
    streams: LaneStreams,
    tile: Vec<f64>,
    n: usize,
}
impl LaneProgram for Fill {
    #[inline(always)]
    fn run<L: Lanes>(&mut self) {
        for _ in 0..self.n {
            for r in 0..4 {
                self.streams.fill_normals::<L>(r * L::WIDTH, 64, &mut self.tile[r * L::WIDTH..], 4 * L::WIDTH);
            }
        }
    }
}
#[derive(Default)]
struct Count {
    sticks: u64,
    dur: f64,
    ent: Vec<f64>,
    k: u64,
    sl: u64,
}
impl Observer for Count {
    fn event(&mut self, l: usize, e: Event) {
        match e.kind {
            EventKind::StickEntered => {
                self.ent[l] = e.time;
                self.sl += 1;
            }
            EventKind::SlipStarted(_) => {
                if self.ent[l] >= 0. {
                    self.sticks += 1;
                    self.dur += e.time - self.ent[l];
                }
            }
            _ => {
                self.k += 1;
            }
        }
    }
    fn snapshot(&mut self, _: Instant, _: Snapshot<'_>) {}
}
fn min(n: usize, mut f: impl FnMut()) -> f64 {
    (0..n)
        .map(|_| {
            let t = Clock::now();
            f();
            t.elapsed().as_secs_f64()
        })
        .fold(1e9, f64::min)
}
fn scalar(h: f64, t: f64, paths: u64, cw: &[f64]) -> (f64, f64) {
    use rand::SeedableRng;
    use rand_distr::{Distribution, StandardNormal};
    use rand_pcg::Pcg64Dxsm;
    let hm = h;
    let (k, kr, fd, fs) = (1., 1.5, 1., 1.2);
    let nn = (t / h).round() as usize;
    let (dec, kick) = ((-h).exp(), ((1. - (-2. * h).exp()) / 2.).sqrt());
    let (mut cnt, mut sd) = (0., 0.);
    for p in 0..paths {
        let mut g = Pcg64Dxsm::seed_from_u64(p);
        let (mut x, mut v, mut e, mut ts) = (6f64, 0f64, 0f64, -1f64);
        let mut b = cw[0] - k * x;
        let mut st = true;
        for i in 0..nn {
            let s = v + hm * b;
            let xn = x + h * v;
            let vn = if s.abs() <= hm * fs { 0. } else { s - (hm * fd).copysign(s) };
            let z: f64 = StandardNormal.sample(&mut g);
            e = dec * e + kick * z;
            b = cw[i + 1] + kr * e - k * xn;
            if st {
                if vn != 0. {
                    st = false;
                    if ts >= 0. {
                        cnt += 1.;
                        sd += i as f64 * h - ts;
                    }
                }
            } else if vn == 0. {
                if b.abs() <= fs {
                    st = true;
                    ts = (i + 1) as f64 * h;
                }
            }
            x = xn;
            v = vn;
        }
    }
    (cnt, sd)
}
fn main() {
    let h: f64 = std::env::args().nth(1).map_or(1e-3, |s| s.parse().unwrap());
    let reps: usize = std::env::args().nth(2).map_or(40, |s| s.parse().unwrap());
    let m = Model {
        oscillator: Oscillator { mass: 1., stiffness: 1., damping: 0., dilatation: 6. },
        friction: Friction { static_force: 1.2, dynamic_force: 1. },
        temperature: Temperature {
            harmonics: vec![Harmonic { amplitude: 1., angular_frequency: 0.25, phase: 0. }],
            noise: Some(Noise { intensity: 0.25, relaxation_rate: 1., diffusion: 1., initial: InitialNoise::At(0.) }),
        },
        initial_displacement: 6.,
    };
    let end = 60. * h / 1e-3 / 60.; // 1000 steps
    let tl = Timeline { end, output_step: end / 2., period: None };
    let cw: Vec<f64> = (0..=5000).map(|i| 6. * (0.25 * h * i as f64).cos()).collect();
    let lanes: Vec<u64> = (0..256).collect();
    let tsc = min(reps, || {
        std::hint::black_box(scalar(h, end, 64, &cw));
    }) / 64e3
        * 1e9;
    println!("scalar {tsc:.3} ns");
    for set in InstructionSet::ALL {
        let w = if set == InstructionSet::Avx512 { 8 } else { 4 };
        let mut f =
            Fill { streams: LaneStreams::new(1, &(0..32).collect::<Vec<_>>(), 32), tile: vec![0.; 64 * 32], n: 50 };
        let tn = min(reps, || set.run(&mut f)) / (50. * 64. * 4. * w as f64) * 1e9;
        let s = DiscreteVi::new(&m, &tl, h).with_instructions(set);
        let tk = min(reps, || {
            let mut c = Count { ent: vec![-1.; 256], ..Default::default() };
            s.simulate(1, &lanes, &mut c);
        }) / 256e3
            * 1e9;
        println!(
            "{:8} normal {tn:.3} ns  step {tk:.3} ns  ratio {:.2}  scalar/step {:.2}",
            set.name(),
            tk / tn,
            tsc / tk
        );
    }
}
