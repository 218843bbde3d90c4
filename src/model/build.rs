//! Building a model step by step.

use super::{
    Drive, Expression, ExpressionError, Force, Friction, Harmonic, InitialNoise, InputProcess,
    NamedSeries, OrnsteinUhlenbeck, Oscillator, OwnProcess, Problem, RandomInput, RandomProcess,
    Series, Temperature,
};
use std::sync::Arc;

/// A model is built from one of the bodies below, with what acts on it. The forces of all of them
/// add up, as do several temperatures.
///
/// ```
/// use stickslip::model::{Problem, OrnsteinUhlenbeck, Temperature};
///
/// let model = Problem::oscillator(1.0, 1.0)
///     .friction(1.2, 1.0)
///     .temperature(Temperature::harmonic(1.0, 0.25).with(OrnsteinUhlenbeck::new(0.25, 1.0, 1.0)))
///     .force(|x, _v, _t| -0.02 * x.powi(3));
/// assert_eq!(model.total_force(0.0, 1.0, 2.0, 0.0), 1.0 - 2.0 - 0.16);
/// ```
impl Problem {
    /// A body of mass m on a spring of stiffness K, whose rest position is the temperature T, a
    /// length here; [`Problem::dilatation`] makes it beta T. There is no friction yet, and x(0) = 0.
    pub fn oscillator(mass: f64, stiffness: f64) -> Self {
        Problem {
            oscillator: Oscillator {
                mass,
                stiffness,
                damping: 0.0,
                drive: Drive::Dilatation(1.0),
            },
            friction: Friction {
                static_force: 0.0,
                dynamic_force: 0.0,
            },
            temperature: Temperature::default(),
            force: None,
            random: Vec::new(),
            initial_displacement: 0.0,
            initial_velocity: 0.0,
        }
    }

    /// The same body on a belt of this speed, seen from the belt: the support of the spring moves
    /// at that speed.
    pub fn belt(mass: f64, stiffness: f64, speed: f64) -> Self {
        Problem::oscillator(mass, stiffness).temperature(Temperature {
            trend: speed,
            ..Temperature::default()
        })
    }

    /// A body of mass m without a spring, on which the temperature acts as a force.
    pub fn free(mass: f64) -> Self {
        Problem::oscillator(mass, 0.0).force_per_temperature(1.0)
    }

    /// A body without a spring that a constant force pushes, such as m g sin(angle) on an incline.
    pub fn incline(mass: f64, force: f64) -> Self {
        Problem::free(mass).temperature(Temperature {
            offset: force,
            ..Temperature::default()
        })
    }

    /// Friction with the thresholds f_s and f_d, two forces, in both directions.
    pub fn friction(self, static_force: f64, dynamic_force: f64) -> Self {
        let friction = Friction {
            static_force,
            dynamic_force,
        };
        Problem { friction, ..self }
    }

    /// Damping alpha, a force per velocity; the damping force is 2 alpha x'.
    pub fn damping(mut self, damping: f64) -> Self {
        self.oscillator.damping = damping;
        self
    }

    /// The rest position of the spring is beta T.
    pub fn dilatation(mut self, beta: f64) -> Self {
        self.oscillator.drive = Drive::Dilatation(beta);
        self
    }

    /// The temperature acts as the force c T.
    pub fn force_per_temperature(mut self, c: f64) -> Self {
        self.oscillator.drive = Drive::Force(c);
        self
    }

    /// Add this to the temperature.
    pub fn temperature(mut self, temperature: Temperature) -> Self {
        self.temperature = self.temperature.with(temperature);
        self
    }

    /// The force g(x, x', t), in addition to the others. It replaces an earlier one.
    pub fn force(self, g: impl Fn(f64, f64, f64) -> f64 + Send + Sync + 'static) -> Self {
        self.law(Force::function(g))
    }

    /// A force that is a [`super::ForceLaw`] or an [`super::Expression`]. It replaces an earlier
    /// one.
    pub fn law(self, force: Force) -> Self {
        Problem {
            force: Some(force),
            ..self
        }
    }

    /// An input of this name that each path draws, for [`Problem::expression`].
    pub fn input(mut self, name: &str, process: impl InputProcess + 'static) -> Self {
        self.random.push(RandomInput {
            name: format!("input.{name}"),
            process: RandomProcess::Own(OwnProcess(Arc::new(process))),
            step: 1.0,
            envelope: None,
        });
        self
    }

    /// A force as a text in x, xdot, t, these parameters and the inputs. It replaces an earlier one.
    ///
    /// ```
    /// use stickslip::prelude::*;
    ///
    /// // Two ground motions that take turns.
    /// let ground = Realisations::new(vec![0.0, 1.0, 9.0], vec![0.0, 5.0, 0.0, 0.0, -5.0, 0.0])?;
    /// let problem = Problem::free(2.0)
    ///     .friction(3.0, 2.5)
    ///     .input("ag", ground)
    ///     .expression("-m*ag", &[("m", 2.0)])?;
    /// let run = Run::new(problem).paths(4).end(9.0).simulate()?;
    /// assert!(run[Statistic::DisplacementEndMean].estimate.abs() < 1e-9);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn expression(
        self,
        text: &str,
        parameters: &[(&str, f64)],
    ) -> Result<Self, ExpressionError> {
        let parameters: Vec<(String, f64)> = parameters
            .iter()
            .map(|(name, value)| (name.to_string(), *value))
            .collect();
        let inputs = self.random.iter().filter_map(|input| {
            let name = input.name.strip_prefix("input.")?.to_string();
            let series = Arc::new(Series::nothing());
            Some(NamedSeries { name, series })
        });
        let inputs: Vec<NamedSeries> = inputs.collect();
        let expression = Expression::with_inputs(text, &parameters, &inputs)?;
        Ok(self.law(Force::new(expression)))
    }

    /// x(0), a length, and x'(0), a length per time; the body starts at rest at 0 otherwise.
    pub fn start(self, displacement: f64, velocity: f64) -> Self {
        Problem {
            initial_displacement: displacement,
            initial_velocity: velocity,
            ..self
        }
    }
}

impl Temperature {
    /// a cos(w t).
    pub fn harmonic(amplitude: f64, angular_frequency: f64) -> Self {
        let harmonic = Harmonic {
            amplitude,
            angular_frequency,
            phase: 0.0,
        };
        harmonic.into()
    }

    /// The sum of both. A measured series of `other` replaces that of `self`.
    pub fn with(mut self, other: impl Into<Temperature>) -> Self {
        let other = other.into();
        self.offset += other.offset;
        self.trend += other.trend;
        self.harmonics.extend(other.harmonics);
        self.series = other.series.or(self.series);
        self.is_pinned |= other.is_pinned;
        self.noises.extend(other.noises);
        self
    }
}

impl From<Harmonic> for Temperature {
    fn from(harmonic: Harmonic) -> Self {
        Temperature {
            harmonics: vec![harmonic],
            ..Temperature::default()
        }
    }
}

impl From<OrnsteinUhlenbeck> for Temperature {
    fn from(noise: OrnsteinUhlenbeck) -> Self {
        Temperature {
            noises: vec![noise],
            ..Temperature::default()
        }
    }
}

impl OrnsteinUhlenbeck {
    /// rho v(t) with dv = -theta v dt + sigma dW and v(0) = 0.
    pub fn new(intensity: f64, relaxation_rate: f64, diffusion: f64) -> Self {
        OrnsteinUhlenbeck {
            intensity,
            relaxation_rate,
            diffusion,
            initial: InitialNoise::At(0.0),
        }
    }
}
