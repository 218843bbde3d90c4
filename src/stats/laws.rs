//! The laws that a run reports on request: durations of slips, sizes of jumps, and times from slip
//! to slip, folded path by path ([`LawFold`]) and as moments ([`LawsSums`]).

use super::Statistic;
use super::law::{Folded, LawSums, PhaseLaw};
use super::measure::{Measure, Sampled};
use crate::model::{Event, EventKind};
use crate::sums::Replicate;
use crate::sums::codec::sums;
use crate::sums::interval::Measured;

/// Number of these laws.
pub(super) const LAWS: usize = PhaseLaw::ASKED.len();

/// The running sums of one path. A slip is counted if it begins after the burn-in, and so is the
/// time from its beginning to that of the next slip.
#[derive(Clone, Copy, Debug)]
pub(super) struct LawFold {
    /// The end of the burn-in.
    after: f64,
    /// When and where the present slip began, if it is counted.
    running: Option<(f64, f64)>,
    /// When the last slip began, if it is counted.
    last_start: Option<f64>,
    /// The values of each law, in the order of [`PhaseLaw::ASKED`].
    folded: [Folded; LAWS],
    /// The signed jumps x_{j+1} - x_j.
    signed_jumps: Folded,
}

impl LawFold {
    /// A path with a burn-in that ends at this time.
    pub fn counted_after(after: f64) -> Self {
        let nothing = Folded::default();
        LawFold {
            after,
            running: None,
            last_start: None,
            folded: [nothing; LAWS],
            signed_jumps: nothing,
        }
    }

    /// Add the next event. `count` receives the values that it completes.
    #[inline]
    pub fn event(&mut self, event: &Event, mut count: impl FnMut(PhaseLaw, f64)) {
        match event.kind {
            EventKind::SlipStarted(_) => {
                if let Some(last) = self.last_start {
                    self.add(PhaseLaw::Recurrence, event.time - last, &mut count);
                }
                let is_counted = event.time >= self.after;
                self.last_start = is_counted.then_some(event.time);
                self.running = is_counted.then_some((event.time, event.displacement));
            }
            EventKind::StickEntered => {
                let Some((time, displacement)) = self.running.take() else {
                    return;
                };
                let jump = event.displacement - displacement;
                self.signed_jumps.add(jump);
                self.add(PhaseLaw::Slip, event.time - time, &mut count);
                self.add(PhaseLaw::Jump, jump.abs(), &mut count);
                match jump {
                    jump if jump > 0.0 => self.add(PhaseLaw::JumpForward, jump, &mut count),
                    jump if jump < 0.0 => self.add(PhaseLaw::JumpBackward, -jump, &mut count),
                    _ => {}
                }
            }
            EventKind::SubPhaseBoundary(_) => {}
        }
    }

    fn add(&mut self, law: PhaseLaw, value: f64, count: &mut impl FnMut(PhaseLaw, f64)) {
        self.folded[place(law)].add(value);
        count(law, value);
    }

    /// The path ends at t_end. `censor` receives the times that are cut off. The jump of a slip
    /// that is cut off may become larger or smaller, so it is not used.
    pub fn end(&self, time: f64, mut censor: impl FnMut(PhaseLaw, f64)) {
        if let Some((start, _)) = self.running {
            censor(PhaseLaw::Slip, time - start);
        }
        if let Some(start) = self.last_start {
            censor(PhaseLaw::Recurrence, time - start);
        }
    }
}

/// The place of a law in [`PhaseLaw::ASKED`].
fn place(law: PhaseLaw) -> usize {
    law as usize - 1
}

sums! {
    /// Moments over paths.
    #[derive(Clone, Debug, Default, PartialEq)]
    pub(super) struct LawsSums {
        laws: [LawSums; LAWS],
        signed_jumps: LawSums,
    }
}

impl LawsSums {
    /// The sums over the paths of a block.
    pub fn of(paths: &[LawFold], unit: Replicate) -> Self {
        LawsSums {
            laws: std::array::from_fn(|law| LawSums::of(paths, |path| path.folded[law], unit)),
            signed_jumps: LawSums::of(paths, |path| path.signed_jumps, unit),
        }
    }

    /// The moments of a law.
    pub fn law(&self, law: PhaseLaw) -> &LawSums {
        &self.laws[place(law)]
    }
}

impl Measure for LawsSums {
    fn measured(&self, statistic: Statistic, Sampled { unit, .. }: &Sampled) -> Option<Measured> {
        let [slip, jump, recurrence] =
            [PhaseLaw::Slip, PhaseLaw::Jump, PhaseLaw::Recurrence].map(|law| self.law(law));
        Some(match statistic {
            Statistic::SlipDurationMean => slip.mean(),
            Statistic::SlipDurationSd => slip.sd(*unit),
            Statistic::SlipDurationCv => slip.coefficient_of_variation(*unit),
            Statistic::JumpSd => self.signed_jumps.sd(*unit),
            Statistic::JumpAbsSd => jump.sd(*unit),
            Statistic::JumpAbsCv => jump.coefficient_of_variation(*unit),
            Statistic::RecurrenceTimeMean => recurrence.mean(),
            Statistic::RecurrenceTimeSd => recurrence.sd(*unit),
            Statistic::RecurrenceTimeCv => recurrence.coefficient_of_variation(*unit),
            _ => return None,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::stats::synthetic::{slip, stick, turn};

    /// Slips begin at 1, 4 and 6. The first begins before the end of the burn-in at 2, and the last
    /// runs at t_end = 7.
    #[test]
    fn slips_and_the_times_to_the_next_count_from_the_burn_in_on() {
        let events = [
            slip(1.0, 5.0),
            stick(3.0, 6.0),
            slip(4.0, 6.0),
            turn(4.5, 7.0),
            stick(5.5, 3.0),
            slip(6.0, 3.0),
        ];
        let mut path = LawFold::counted_after(2.0);
        let (mut counted, mut censored) = (Vec::new(), Vec::new());
        events
            .iter()
            .for_each(|event| path.event(event, |law, value| counted.push((law, value))));
        path.end(7.0, |law, value| censored.push((law, value)));
        let slips = [
            (PhaseLaw::Slip, 1.5),
            (PhaseLaw::Jump, 3.0),
            (PhaseLaw::JumpBackward, 3.0),
            (PhaseLaw::Recurrence, 2.0),
        ];
        assert_eq!(counted, slips);
        assert_eq!(
            censored,
            [(PhaseLaw::Slip, 1.0), (PhaseLaw::Recurrence, 1.0)]
        );
        assert_eq!(
            path.signed_jumps,
            Folded {
                count: 1,
                sum: -3.0,
                squares: 9.0
            }
        );
    }
}
