//! One path of the cascade, folded as its events arrive.
//!
//! With a burn-in, a phase is counted if it begins at the end of the burn-in or later. So each
//! phase is equally likely to be counted, whatever its duration. The phases running at a given
//! instant would be a biased sample, because long ones are overrepresented. Times and distances are
//! counted from the end of the burn-in on, whatever phase they fall in.

use super::law::Folded;
use crate::model::{Event, EventKind, Sign};

/// The running sums of one path. Every entry is a sum in time order, so it depends on this path
/// alone.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct PathFold {
    now: Now,
    /// The end of the burn-in; 0 if there is none.
    after: f64,
    /// Whether the present phase is counted, because it began after the burn-in.
    is_counted: bool,
    /// Direction of the present or last sub-phase.
    pub direction: Sign,
    /// When the present or last static phase began.
    stick_entered: f64,
    /// x at the last event, where the present sub-phase began.
    last_displacement: f64,
    /// x_j, where the present dynamic phase began.
    slip_origin: f64,
    /// Sub-phases of the present dynamic phase so far, including the present one.
    running_sub_phases: u32,
    /// Completed sticks, j >= 1, that are not counted.
    pub early_sticks: u32,
    /// Completed dynamic phases that are not counted.
    pub early_slips: u32,
    /// Initial displacement x0.
    start: f64,
    /// x - x0 at the end of the burn-in.
    pub early_displacement: f64,
    /// The D_j of the completed sticks, j >= 1, that are counted. The sums below are also of
    /// counted phases.
    pub sticks: Folded,
    /// Duration D_0 of the first stick, once it has ended.
    pub first_duration: Option<f64>,
    /// Completed dynamic phases.
    pub slips: u32,
    /// Sum of the k(j) of these phases.
    pub sub_phases: u32,
    /// Number of these phases with k(j) >= 2.
    pub multiple: u32,
    /// Sum of x_{j+1} - x_j over completed dynamic phases.
    pub jump: f64,
    /// Sum of |x_{j+1} - x_j| over completed dynamic phases.
    pub jump_abs: f64,
    /// Total static time after the burn-in, the first and the last stick included.
    pub stick_time: f64,
    /// Integral of |x'| dt after the burn-in. Since x is monotone on a sub-phase, this is the sum
    /// of the distances between events.
    pub travel: f64,
    /// The work of friction after the burn-in, known at the end.
    pub friction_work: f64,
    /// max |x|, the burn-in included. It is attained at an event, at the start or at the end.
    pub max_displacement: f64,
    /// Displacement at the end, x(t_end).
    pub displacement_end: f64,
}

/// The present phase of a path.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum Now {
    /// Static since t = 0.
    #[default]
    FirstStick,
    /// In static phase j >= 1.
    Stick,
    /// In a dynamic phase.
    Slip,
}

/// A counted phase that an event has completed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum EndedPhase {
    /// The first static phase.
    FirstStick,
    /// A static phase, j >= 1, with its duration D_j.
    Stick(f64),
    /// A dynamic phase, with its number of sub-phases k(j).
    Slip(u32),
}

/// The counted phase that runs at t_end, of which only the beginning is known.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Censored {
    /// The first static phase.
    FirstStick,
    /// A static phase, j >= 1, with its duration so far.
    Stick(f64),
    /// A dynamic phase.
    Slip,
}

impl PathFold {
    /// A path at rest at x0, in its first static phase.
    pub fn starting_at(x0: f64) -> Self {
        PathFold {
            is_counted: true,
            last_displacement: x0,
            slip_origin: x0,
            start: x0,
            max_displacement: x0.abs(),
            displacement_end: x0,
            ..PathFold::default()
        }
    }

    /// The same path if it moves at t = 0, so that it has no first stick.
    pub fn moving(self, is_moving: bool) -> Self {
        if is_moving {
            PathFold {
                now: Now::Slip,
                ..self
            }
        } else {
            self
        }
    }

    /// The same path with a burn-in that ends at this time.
    pub fn counted_after(self, after: f64) -> Self {
        PathFold { after, ..self }
    }

    /// The burn-in ends, at this displacement.
    pub fn count_from_here(&mut self, displacement: f64) {
        self.early_displacement = displacement - self.start;
        self.last_displacement = displacement;
        self.travel = 0.0;
    }

    /// Add the next event. Returns the counted phase that it completes, if it completes one.
    #[inline]
    pub fn event(&mut self, event: &Event) -> Option<EndedPhase> {
        let completed = match event.kind {
            EventKind::SlipStarted(direction) => {
                self.direction = direction;
                self.start_slip(event)
            }
            EventKind::SubPhaseBoundary(direction) => {
                self.direction = direction;
                self.travel += (event.displacement - self.last_displacement).abs();
                self.running_sub_phases += 1;
                None
            }
            EventKind::StickEntered => self.enter_stick(event),
        };
        self.last_displacement = event.displacement;
        self.max_displacement = self.max_displacement.max(event.displacement.abs());
        completed
    }

    /// The part, after the burn-in, of the time from the beginning of the present stick until
    /// `time`.
    fn counted_time(&self, time: f64) -> f64 {
        (time - self.stick_entered.max(self.after)).max(0.0)
    }

    fn start_slip(&mut self, event: &Event) -> Option<EndedPhase> {
        let duration = event.time - self.stick_entered;
        self.stick_time += self.counted_time(event.time);
        let completed = match self.now {
            Now::FirstStick => {
                self.first_duration = Some(duration);
                Some(EndedPhase::FirstStick)
            }
            // The path moves at t = 0.
            Now::Slip => None,
            Now::Stick if self.is_counted => {
                self.sticks.add(duration);
                Some(EndedPhase::Stick(duration))
            }
            Now::Stick => {
                self.early_sticks += 1;
                None
            }
        };
        self.now = Now::Slip;
        self.is_counted = event.time >= self.after;
        self.slip_origin = event.displacement;
        self.running_sub_phases = 1;
        completed
    }

    fn enter_stick(&mut self, event: &Event) -> Option<EndedPhase> {
        self.travel += (event.displacement - self.last_displacement).abs();
        let completed = if self.is_counted {
            let jump = event.displacement - self.slip_origin;
            self.jump += jump;
            self.jump_abs += jump.abs();
            self.slips += 1;
            self.sub_phases += self.running_sub_phases;
            self.multiple += u32::from(self.running_sub_phases >= 2);
            Some(EndedPhase::Slip(self.running_sub_phases))
        } else {
            self.early_slips += 1;
            None
        };
        self.now = Now::Stick;
        self.is_counted = event.time >= self.after;
        self.stick_entered = event.time;
        completed
    }

    /// The path ends at t_end, at this displacement. Returns the counted phase that is cut off. The
    /// first stick is always counted.
    pub fn end(&mut self, time: f64, displacement: f64) -> Option<Censored> {
        self.displacement_end = displacement;
        self.max_displacement = self.max_displacement.max(displacement.abs());
        if self.now == Now::Slip {
            self.travel += (displacement - self.last_displacement).abs();
        } else {
            self.stick_time += self.counted_time(time);
        }
        match self.now {
            Now::FirstStick => Some(Censored::FirstStick),
            _ if !self.is_counted => None,
            Now::Stick => Some(Censored::Stick(time - self.stick_entered)),
            Now::Slip => Some(Censored::Slip),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::Sign::{Negative, Positive};

    fn event(kind: EventKind, time: f64, displacement: f64) -> Event {
        Event {
            kind,
            time,
            displacement,
            force: 0.0,
        }
    }

    #[test]
    fn shaws_cascade_at_forcing_one_half_has_two_sub_phases() {
        // Shaw's case with forcing 1/2 and f_d = 1, from its 40-digit solution: slip at 1.287 from
        // x = 6, turn at 6.425 with x = -9.744, stick at 12.277 with x = 6.341. The end at 13 is
        // within that stick.
        let mut path = PathFold::starting_at(6.0);
        let slip = path.event(&event(
            EventKind::SlipStarted(Negative),
            1.287_002_217_586_568_8,
            6.0,
        ));
        let turn = path.event(&event(
            EventKind::SubPhaseBoundary(Positive),
            6.425_170_197_520_969,
            -9.743_812_675_160_928,
        ));
        let stick = path.event(&event(
            EventKind::StickEntered,
            12.276_691_944_097_36,
            6.341_054_759_946_978,
        ));
        let end = path.end(13.0, 6.341_054_759_946_978);
        assert_eq!(
            (slip, turn, stick),
            (
                Some(EndedPhase::FirstStick),
                None,
                Some(EndedPhase::Slip(2))
            )
        );
        assert_eq!(end, Some(Censored::Stick(13.0 - 12.276_691_944_097_36)));
        assert_eq!(
            (
                path.sticks.count,
                path.slips,
                path.sub_phases,
                path.multiple
            ),
            (0, 1, 2, 1)
        );
        assert_eq!(path.first_duration, Some(1.287_002_217_586_568_8));
        assert_eq!(path.max_displacement, 9.743_812_675_160_928);
        // The travel is 15.7438... + 16.0849..., with the rounding of two differences of numbers
        // near 10.
        assert!((path.travel - 31.828_680_110_268_83).abs() < 1e-13);
        assert!((path.jump - 0.341_054_759_946_978).abs() < 1e-14);
        assert!((path.stick_time - (1.287_002_217_586_568_8 + 0.723_308_055_902_64)).abs() < 1e-13);
    }

    #[test]
    fn a_slip_that_is_cut_off_counts_its_travel_but_no_jump() {
        let mut path = PathFold::starting_at(-2.0);
        path.event(&event(EventKind::SlipStarted(Positive), 0.0, -2.0));
        assert_eq!(path.end(1.0, 3.0), Some(Censored::Slip));
        assert_eq!(path.first_duration, Some(0.0));
        assert_eq!(
            (path.travel, path.max_displacement, path.jump, path.slips),
            (5.0, 3.0, 0.0, 0)
        );
        assert_eq!(path.stick_time, 0.0);
    }

    #[test]
    fn the_largest_displacement_is_a_size_wherever_it_is_reached() {
        let slip_to = |x0: f64, turn: f64, end: f64| {
            let mut path = PathFold::starting_at(x0);
            path.event(&event(EventKind::SlipStarted(Negative), 1.0, x0));
            path.event(&event(EventKind::SubPhaseBoundary(Positive), 2.0, turn));
            path.end(3.0, end);
            path.max_displacement
        };
        // The largest |x| is at the start, at an event, or at t_end, on either side.
        for sign in [1.0, -1.0] {
            assert_eq!(slip_to(sign * 7.0, sign * 3.0, -sign * 5.0), 7.0);
            assert_eq!(slip_to(-sign * 2.0, sign * 7.0, sign * 5.0), 7.0);
            assert_eq!(slip_to(sign * 2.0, sign * 3.0, -sign * 7.0), 7.0);
        }
    }

    #[test]
    fn a_path_that_never_moves_ends_no_stick() {
        let mut path = PathFold::starting_at(6.0);
        assert_eq!(path.end(60.0, 6.0), Some(Censored::FirstStick));
        assert_eq!(
            (path.stick_time, path.first_duration, path.sticks.count),
            (60.0, None, 0)
        );
    }

    #[test]
    fn only_sticks_after_the_first_are_pooled() {
        let mut path = PathFold::starting_at(0.0);
        path.event(&event(EventKind::SlipStarted(Positive), 10.0, 0.0));
        path.event(&event(EventKind::StickEntered, 11.0, 1.0));
        let ended = path.event(&event(EventKind::SlipStarted(Negative), 13.0, 1.0));
        path.event(&event(EventKind::StickEntered, 14.0, -1.0));
        path.event(&event(EventKind::SlipStarted(Negative), 17.0, -1.0));
        assert_eq!(ended, Some(EndedPhase::Stick(2.0)));
        assert_eq!(
            path.sticks,
            Folded {
                count: 2,
                sum: 5.0,
                squares: 13.0
            }
        );
        assert_eq!((path.jump, path.jump_abs), (-1.0, 3.0));
    }

    /// A path whose burn-in ends at 5, in a slip and at x = 1.5.
    #[test]
    fn after_a_burn_in_later_phases_count_and_later_time() {
        let mut path = PathFold::starting_at(0.0).counted_after(5.0);
        let seen = [
            path.event(&event(EventKind::SlipStarted(Positive), 1.0, 0.0)),
            path.event(&event(EventKind::StickEntered, 2.0, 1.0)),
            path.event(&event(EventKind::SlipStarted(Positive), 4.0, 1.0)),
        ];
        assert_eq!(seen, [Some(EndedPhase::FirstStick), None, None]);
        path.count_from_here(1.5);
        let seen = [
            path.event(&event(EventKind::StickEntered, 6.0, 3.0)),
            path.event(&event(EventKind::SlipStarted(Positive), 9.0, 3.0)),
            path.event(&event(EventKind::SubPhaseBoundary(Negative), 10.0, 4.0)),
            path.event(&event(EventKind::StickEntered, 11.0, 2.0)),
            path.event(&event(EventKind::SlipStarted(Positive), 12.0, 2.0)),
        ];
        // The slip from 4 to 6 began before the end of the burn-in. It is in no count and no jump,
        // but its distance from 1.5 on is in the travel.
        let counted = [
            None,
            Some(EndedPhase::Stick(3.0)),
            None,
            Some(EndedPhase::Slip(2)),
            Some(EndedPhase::Stick(1.0)),
        ];
        assert_eq!(seen, counted);
        assert_eq!(path.end(14.0, 5.0), Some(Censored::Slip));
        assert_eq!(
            (path.first_duration, path.early_sticks, path.early_slips),
            (Some(1.0), 1, 2)
        );
        assert_eq!(
            path.sticks,
            Folded {
                count: 2,
                sum: 4.0,
                squares: 10.0
            }
        );
        assert_eq!(
            (
                path.slips,
                path.sub_phases,
                path.multiple,
                path.jump,
                path.jump_abs
            ),
            (1, 2, 1, -1.0, 1.0)
        );
        assert_eq!(
            (path.stick_time, path.travel, path.early_displacement),
            (4.0, 1.5 + 1.0 + 2.0 + 3.0, 1.5)
        );
        assert_eq!((path.max_displacement, path.displacement_end), (5.0, 5.0));
    }

    /// The path sticks from 2 on, and the burn-in ends at 5. Then the path slips at 8, or never.
    #[test]
    fn only_the_time_after_the_burn_in_counts() {
        let sticking = || {
            let mut path = PathFold::starting_at(0.0).counted_after(5.0);
            path.event(&event(EventKind::SlipStarted(Positive), 1.0, 0.0));
            path.event(&event(EventKind::StickEntered, 2.0, 1.0));
            path.count_from_here(1.0);
            path
        };
        let mut ended = sticking();
        assert_eq!(
            ended.event(&event(EventKind::SlipStarted(Negative), 8.0, 1.0)),
            None
        );
        assert_eq!(
            ended.event(&event(EventKind::StickEntered, 9.0, 0.0)),
            Some(EndedPhase::Slip(1))
        );
        assert_eq!(ended.end(10.0, 0.0), Some(Censored::Stick(1.0)));
        assert_eq!(
            (
                ended.sticks.count,
                ended.early_sticks,
                ended.stick_time,
                ended.travel
            ),
            (0, 1, 4.0, 1.0)
        );
        let mut cut = sticking();
        assert_eq!(cut.end(10.0, 1.0), None);
        assert_eq!(
            (cut.early_sticks, cut.stick_time, cut.travel),
            (0, 5.0, 0.0)
        );
        let mut first = PathFold::starting_at(0.0).counted_after(5.0);
        first.count_from_here(0.0);
        assert_eq!(
            (first.end(10.0, 0.0), first.stick_time),
            (Some(Censored::FirstStick), 5.0)
        );
        // A phase that begins at the end of the burn-in is counted.
        let mut at_once = PathFold::starting_at(0.0).counted_after(5.0);
        at_once.event(&event(EventKind::SlipStarted(Positive), 1.0, 0.0));
        at_once.event(&event(EventKind::StickEntered, 5.0, 2.0));
        at_once.count_from_here(2.0);
        let ended = at_once.event(&event(EventKind::SlipStarted(Positive), 7.0, 2.0));
        assert_eq!(
            (ended, at_once.stick_time, at_once.travel),
            (Some(EndedPhase::Stick(2.0)), 2.0, 0.0)
        );
    }
}
