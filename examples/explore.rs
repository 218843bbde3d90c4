use stick_slip::model::*;
use stick_slip::scheme::*;
#[derive(Default, Clone)]
struct P {
    stick: f64,
    n: f64,
    first: f64,
    entered: f64,
    slip0: f64,
    slips: f64,
    subs: f64,
    cur: f64,
    multi: f64,
    xend: f64,
    stat: f64,
    dur2: f64,
    micro: f64,
    jabs: f64,
    xs: f64,
    was_static: bool,
}
struct Obs {
    p: Vec<P>,
    end: f64,
}
impl Observer for Obs {
    fn event(&mut self, lane: usize, e: Event) {
        let p = &mut self.p[lane];
        match e.kind {
            EventKind::SlipStarted(_) => {
                let d = e.time - p.entered;
                p.stat += d;
                if p.slip0 < 0.0 && p.n == 0.0 && p.slips == 0.0 {
                    p.first = d
                } else {
                    p.stick += d;
                    p.dur2 += d * d;
                    p.n += 1.0
                }
                p.slip0 = e.time;
                p.cur = 1.0;
                p.was_static = false;
                p.xs = e.displacement;
            }
            EventKind::SubPhaseBoundary(_) => p.cur += 1.0,
            EventKind::StickEntered => {
                p.slips += 1.0;
                p.subs += p.cur;
                if p.cur > 1.0 {
                    p.multi += 1.0
                }
                if e.time - p.slip0 < 0.05 {
                    p.micro += 1.0
                }
                p.entered = e.time;
                p.was_static = true;
                p.jabs += (e.displacement - p.xs).abs();
            }
        }
    }
    fn snapshot(&mut self, i: Instant, s: Snapshot<'_>) {
        if i == Instant::End {
            for (l, p) in self.p.iter_mut().enumerate() {
                p.xend = s.displacement[l];
                if p.was_static {
                    p.stat += self.end - p.entered
                }
            }
        }
    }
}
fn main() {
    let a: Vec<f64> = std::env::args().skip(1).map(|s| s.parse().unwrap()).collect();
    let (rho, n, tol, out, end) = (a[0], a[1] as u64, a[2], a[3], a[4]);
    let (fs, fd) = (a.get(5).copied().unwrap_or(1.2), a.get(6).copied().unwrap_or(1.0));
    let seed = a.get(7).copied().unwrap_or(1.0) as u64;
    let m = Model {
        oscillator: Oscillator { mass: 1.0, stiffness: 1.0, damping: 0.0, dilatation: 6.0 },
        friction: Friction { static_force: fs, dynamic_force: fd },
        temperature: Temperature {
            harmonics: vec![Harmonic { amplitude: 1.0, angular_frequency: 0.25, phase: 0.0 }],
            noise: Some(Noise { intensity: rho, relaxation_rate: 1.0, diffusion: 1.0, initial: InitialNoise::At(0.0) }),
        },
        initial_displacement: 6.0,
    };
    let tl = Timeline { end, output_step: out, period: None };
    let sch = EventDriven::new(&m, &tl, tol);
    let mut all = Vec::new();
    let clock = std::time::Instant::now();
    let mut k = 0;
    while k < n {
        let ids: Vec<u64> = (k..(k + 256).min(n)).collect();
        let mut o = Obs { p: vec![P { slip0: -1.0, was_static: true, ..P::default() }; ids.len()], end };
        let f = sch.simulate(seed, &ids, &mut o);
        if !f.is_empty() {
            println!("failed {f:?}")
        }
        all.extend(o.p);
        k += 256;
    }
    let us = clock.elapsed().as_secs_f64() * 1e6 / n as f64;
    let ratio = |f: &dyn Fn(&P) -> f64, g: &dyn Fn(&P) -> f64| {
        let (sf, sg): (f64, f64) = all.iter().fold((0., 0.), |s, p| (s.0 + f(p), s.1 + g(p)));
        let r = sf / sg;
        let v: f64 = all.iter().map(|p| (f(p) - r * g(p)).powi(2)).sum();
        (r, v.sqrt() / sg)
    };
    let show = |name: &str, want: f64, (r, e): (f64, f64)| {
        println!(
            "{name:24} {r:.6} +- {e:.6}  ref {want:.6}  {:+.3} % ({:+.1} se)",
            (r / want - 1.0) * 100.0,
            (r - want) / e
        )
    };
    println!("{us:.2} us/path {:?}", sch.resolution());
    show("stick_duration_mean", 0.443052, ratio(&|p| p.stick, &|p| p.n));
    show("sticks_per_path", 16.92537, ratio(&|p| p.n, &|_| 1.0));
    show("slips_per_path", 17.03947, ratio(&|p| p.slips, &|_| 1.0));
    show("x_end", -4.2316, ratio(&|p| p.xend, &|_| 1.0));
    show("sticking_fraction", 0.138678, ratio(&|p| p.stat / end, &|_| 1.0));
    show("sub_phases_mean", 1.284064, ratio(&|p| p.subs, &|p| p.slips));
    show("multiple", 0.192593, ratio(&|p| p.multi, &|p| p.slips));
    show("jump_abs", 2.49826, ratio(&|p| p.jabs, &|p| p.slips));
    show("micro", 2.985, ratio(&|p| p.micro, &|_| 1.0));
    show("first", 0.775576827665, ratio(&|p| p.first, &|_| 1.0));
    let (m2, _) = ratio(&|p| p.dur2, &|p| p.n);
    let (m1, _) = ratio(&|p| p.stick, &|p| p.n);
    println!("stick sd {:.5} ref .47705", (m2 - m1 * m1).sqrt());
}
