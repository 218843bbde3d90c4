//! The same scene as seen otherwise: in a mirror, in other units, from a later start.

use super::scene::{Samples, Scene};

/// Factors of the units of mass, length, time and temperature.
#[derive(Clone, Copy)]
pub struct Units {
    pub mass: f64,
    pub length: f64,
    pub time: f64,
    pub temperature: f64,
}

impl Units {
    pub fn force(&self) -> f64 {
        self.mass * self.length / (self.time * self.time)
    }
}

fn times(samples: &Samples, time: f64, value: f64) -> Samples {
    let by = |of: &[f64], factor: f64| of.iter().map(|x| x * factor).collect();
    let (times, values) = samples.as_ref()?;
    Some((by(times, time), by(values, value)))
}

/// Samples from a time on, which becomes 0.
fn from(samples: &Samples, start: f64) -> Samples {
    let (times, values) = samples.as_ref()?;
    let first = times.partition_point(|t| *t <= start);
    let begin = std::iter::once((0.0, super::scene::at(samples, start)));
    let later = times[first..].iter().zip(&values[first..]);
    Some(
        begin
            .chain(later.map(|(t, value)| (t - start, *value)))
            .unzip(),
    )
}

impl Scene {
    /// The scene in which everything points the other way. Under noise, T stays as it is and acts with
    /// the other sign.
    pub fn mirrored(&self) -> Scene {
        let mut scene = self.clone();
        if self.is_random() {
            scene.drive = -scene.drive;
        } else {
            (scene.offset, scene.trend) = (-scene.offset, -scene.trend);
            scene
                .harmonics
                .iter_mut()
                .for_each(|harmonic| harmonic[0] *= -1.0);
            scene.series = times(&scene.series, 1.0, -1.0);
        }
        scene.friction.swap(0, 1);
        scene.input = times(&scene.input, 1.0, -1.0);
        let written = &mut scene.written;
        for variable in [
            &mut written.x,
            &mut written.v,
            &mut written.e,
            &mut written.s,
        ] {
            *variable = format!("(-{variable})");
        }
        written.factor = -1.0;
        (scene.x0, scene.v0) = (-scene.x0, -scene.v0);
        scene
    }

    /// The scene in other units.
    pub fn scaled(&self, units: Units) -> Scene {
        let Units {
            mass,
            length,
            time,
            temperature,
        } = units;
        let mut scene = self.clone();
        scene.mass *= mass;
        scene.stiffness *= mass / (time * time);
        scene.damping *= mass / time;
        scene.drive *= if self.is_dilatation {
            length
        } else {
            units.force()
        } / temperature;
        scene.friction = scene
            .friction
            .map(|side| side.map(|force| force * units.force()));
        scene.offset *= temperature;
        scene.trend *= temperature / time;
        for [a, w, _] in &mut scene.harmonics {
            (*a, *w) = (*a * temperature, *w / time);
        }
        scene.series = times(&scene.series, time, temperature);
        scene.input = times(&scene.input, time, 1.0);
        for ([rho, theta, sigma], _) in &mut scene.noises {
            (*rho, *theta, *sigma) = (*rho * temperature, *theta / time, *sigma / time.sqrt());
        }
        if let Some([strength, theta]) = &mut scene.white {
            (*strength, *theta) = (*strength * temperature * temperature * time, *theta / time);
        }
        let written = &mut scene.written;
        written.x = format!("(x*{:?})", 1.0 / length);
        written.v = format!("(xdot*{:?})", time / length);
        written.t = format!("(t*{:?})", 1.0 / time);
        written.factor = units.force();
        (scene.x0, scene.v0) = (scene.x0 * length, scene.v0 * length / time);
        for of in [
            &mut scene.end,
            &mut scene.after,
            &mut scene.period,
            &mut scene.output_step,
            &mut scene.step,
        ] {
            *of *= time;
        }
        scene
    }

    /// The scene without noise that begins at a time of this one, with the state of then.
    pub fn started_at(&self, start: f64, [x, v]: [f64; 2]) -> Scene {
        let mut scene = self.clone();
        scene.offset += scene.trend * start;
        for [_, w, phase] in &mut scene.harmonics {
            *phase += *w * start;
        }
        scene.series = from(&scene.series, start);
        scene.input = from(&scene.input, start);
        scene.written.t = format!("(t + {start:?})");
        (scene.x0, scene.v0) = (x, v);
        scene.end -= start;
        if scene.scheme.has_step() {
            scene.end = (scene.end / scene.step).round() * scene.step;
        }
        scene.after = 0.0;
        scene
    }
}
