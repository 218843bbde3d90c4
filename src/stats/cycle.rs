//! The long-term motion of a scenario without noise.

/// The maximum number of stored states at phase zero.
const STATES: usize = 64;

/// The long-term motion of a scenario without noise.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LimitCycle {
    /// x minus its drift since t = 0, at the times n P, the last of them, with periodic forcing,
    /// and otherwise at the beginnings of the last slips. A length.
    pub section: Vec<f64>,
    /// Half the range of x minus its drift: of the motion in the last cycle if there is one, in the
    /// last half of the counted time if no slip begins there and there is no periodic forcing, and
    /// otherwise in all the counted time. 0 if the body rests or slides steadily. A length.
    pub amplitude: f64,
    /// The cycle; none if no state recurs.
    pub repeats: Option<Repeats>,
}

/// A motion that repeats itself.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Repeats {
    /// The time after which the motion repeats itself.
    pub period: f64,
    /// The number of periods P of the forcing; none without a forcing.
    pub forcing_periods: Option<usize>,
    /// The advance of the body in that time.
    pub advance: f64,
    /// The slips that begin in that time.
    pub slips: usize,
    /// The sticks that begin in that time.
    pub sticks: usize,
    /// The share of that time at rest.
    pub at_rest: f64,
    /// Whether the motion half a cycle later is its mirror image.
    pub is_symmetric: bool,
}

impl LimitCycle {
    /// The names of the numbers of a cycle in a data set.
    pub const NUMBERS: [&str; 8] = [
        "amplitude",
        "period",
        "forcing_periods",
        "advance",
        "slips",
        "sticks",
        "at_rest",
        "is_symmetric",
    ];

    /// The length of a section in a data set.
    pub const STATES: usize = STATES;

    /// The numbers of a cycle; NaN where there is none.
    pub fn numbers(&self) -> [f64; 8] {
        let Some(of) = self.repeats else {
            return std::array::from_fn(|i| if i == 0 { self.amplitude } else { f64::NAN });
        };
        let forcing_periods = of.forcing_periods.map_or(f64::NAN, |n| n as f64);
        let counted = [of.slips, of.sticks].map(|n| n as f64);
        let symmetric = f64::from(u8::from(of.is_symmetric));
        [
            self.amplitude,
            of.period,
            forcing_periods,
            of.advance,
            counted[0],
            counted[1],
            of.at_rest,
            symmetric,
        ]
    }

    /// The cycle with these numbers and this section, which may end with NaN.
    pub fn of_numbers(
        [
            amplitude,
            period,
            forcing_periods,
            advance,
            slips,
            sticks,
            at_rest,
            symmetric,
        ]: [f64; 8],
        section: &[f64],
    ) -> Self {
        let forcing_periods = Some(forcing_periods)
            .filter(|n| !n.is_nan())
            .map(|n| n as usize);
        let (slips, sticks, is_symmetric) = (slips as usize, sticks as usize, symmetric == 1.0);
        let repeats = Repeats {
            period,
            forcing_periods,
            advance,
            slips,
            sticks,
            at_rest,
            is_symmetric,
        };
        LimitCycle {
            section: section.iter().copied().filter(|x| !x.is_nan()).collect(),
            amplitude,
            repeats: (!period.is_nan()).then_some(repeats),
        }
    }
}
