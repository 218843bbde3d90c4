//! One path of the cascade, folded as its events arrive.

use crate::model::{Event, EventKind, Sign};

/// The running sums of one path. Every entry is a sum in time order, so it depends on the path alone.
#[derive(Clone, Copy, Debug)]
pub(super) struct PathFold {
    now: Now,
    /// Direction of the sub-phase that runs now, or ran last.
    pub direction: Sign,
    /// When the static phase that runs now, or ran last, was entered.
    stick_entered: f64,
    /// x at the last event: where the present sub-phase began.
    last_displacement: f64,
    /// x_j: where the present dynamic phase began.
    slip_origin: f64,
    /// Sub-phases of the present dynamic phase, the running one included.
    running_sub_phases: u32,
    /// Completed sticks, j >= 1.
    pub sticks: u32,
    /// Sum of their D_j.
    pub duration: f64,
    /// Sum of their D_j^2.
    pub duration_squared: f64,
    /// D_0, once the first stick has ended.
    pub first_duration: Option<f64>,
    /// Completed dynamic phases.
    pub slips: u32,
    /// Sum of their k(j).
    pub sub_phases: u32,
    /// How many of them have k(j) >= 2.
    pub multiple: u32,
    /// Sum of x_{j+1} - x_j over completed dynamic phases.
    pub jump: f64,
    /// Sum of |x_{j+1} - x_j|.
    pub jump_abs: f64,
    /// Total static time, the first and the last stick included.
    pub stick_time: f64,
    /// Integral of |x'| dt: x is monotone on a sub-phase, so it is the sum of |x change| between events.
    pub travel: f64,
    /// max |x|: attained at an event, at the start or at the end.
    pub max_displacement: f64,
    /// x(t_end).
    pub displacement_end: f64,
}

/// What the path is doing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Now {
    /// Static since t = 0.
    FirstStick,
    /// In static phase j >= 1.
    Stick,
    /// In a dynamic phase.
    Slip,
}

/// A phase that an event has completed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Completed {
    /// The first static phase.
    FirstStick,
    /// A static phase, j >= 1, with its duration D_j.
    Stick(f64),
    /// A dynamic phase, with its number of sub-phases k(j).
    Slip(u32),
}

/// The phase that runs at t_end, of which only the beginning is known.
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
            now: Now::FirstStick,
            direction: Sign::Positive,
            stick_entered: 0.0,
            last_displacement: x0,
            slip_origin: x0,
            running_sub_phases: 0,
            sticks: 0,
            duration: 0.0,
            duration_squared: 0.0,
            first_duration: None,
            slips: 0,
            sub_phases: 0,
            multiple: 0,
            jump: 0.0,
            jump_abs: 0.0,
            stick_time: 0.0,
            travel: 0.0,
            max_displacement: x0.abs(),
            displacement_end: x0,
        }
    }

    /// The next event. Says which phase it completes, if it completes one.
    #[inline]
    pub fn event(&mut self, event: &Event) -> Option<Completed> {
        let completed = match event.kind {
            EventKind::SlipStarted(direction) => {
                self.direction = direction;
                Some(self.start_slip(event))
            }
            EventKind::SubPhaseBoundary(direction) => {
                self.direction = direction;
                self.travel += (event.displacement - self.last_displacement).abs();
                self.running_sub_phases += 1;
                None
            }
            EventKind::StickEntered => Some(self.enter_stick(event)),
        };
        self.last_displacement = event.displacement;
        self.max_displacement = self.max_displacement.max(event.displacement.abs());
        completed
    }

    fn start_slip(&mut self, event: &Event) -> Completed {
        let duration = event.time - self.stick_entered;
        self.stick_time += duration;
        let completed = if self.now == Now::FirstStick {
            self.first_duration = Some(duration);
            Completed::FirstStick
        } else {
            self.sticks += 1;
            self.duration += duration;
            self.duration_squared += duration * duration;
            Completed::Stick(duration)
        };
        self.now = Now::Slip;
        self.slip_origin = event.displacement;
        self.running_sub_phases = 1;
        completed
    }

    fn enter_stick(&mut self, event: &Event) -> Completed {
        self.travel += (event.displacement - self.last_displacement).abs();
        let jump = event.displacement - self.slip_origin;
        self.jump += jump;
        self.jump_abs += jump.abs();
        self.slips += 1;
        self.sub_phases += self.running_sub_phases;
        self.multiple += u32::from(self.running_sub_phases >= 2);
        self.now = Now::Stick;
        self.stick_entered = event.time;
        Completed::Slip(self.running_sub_phases)
    }

    /// t_end, with x there. Says which phase is cut off.
    pub fn end(&mut self, time: f64, displacement: f64) -> Censored {
        self.displacement_end = displacement;
        self.max_displacement = self.max_displacement.max(displacement.abs());
        let so_far = time - self.stick_entered;
        match self.now {
            Now::FirstStick => {
                self.stick_time += so_far;
                Censored::FirstStick
            }
            Now::Stick => {
                self.stick_time += so_far;
                Censored::Stick(so_far)
            }
            Now::Slip => {
                self.travel += (displacement - self.last_displacement).abs();
                Censored::Slip
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::Sign::{Negative, Positive};

    fn event(kind: EventKind, time: f64, displacement: f64) -> Event {
        Event { kind, time, displacement, force: 0.0 }
    }

    #[test]
    fn the_deterministic_cascade_of_the_papers_frequency_one_half_is_read_as_two_sub_phases() {
        // Shaw's case with forcing 1/2, f_d = 1, from its 40-digit solution: slip at 1.287 from x = 6, turn at 6.425 with
        // x = -9.744, stick at 12.277 with x = 6.341. The end at 13 is in the middle of that stick.
        let mut path = PathFold::starting_at(6.0);
        let slip = path.event(&event(EventKind::SlipStarted(Negative), 1.287_002_217_586_568_8, 6.0));
        let turn =
            path.event(&event(EventKind::SubPhaseBoundary(Positive), 6.425_170_197_520_969, -9.743_812_675_160_928));
        let stick = path.event(&event(EventKind::StickEntered, 12.276_691_944_097_36, 6.341_054_759_946_978));
        let end = path.end(13.0, 6.341_054_759_946_978);
        assert_eq!((slip, turn, stick), (Some(Completed::FirstStick), None, Some(Completed::Slip(2))));
        assert_eq!(end, Censored::Stick(13.0 - 12.276_691_944_097_36));
        assert_eq!((path.sticks, path.slips, path.sub_phases, path.multiple), (0, 1, 2, 1));
        assert_eq!(path.first_duration, Some(1.287_002_217_586_568_8));
        assert_eq!(path.max_displacement, 9.743_812_675_160_928);
        // Travel 15.7438... + 16.0849...; rounding of two differences of numbers near 10.
        assert!((path.travel - 31.828_680_110_268_83).abs() < 1e-13);
        assert!((path.jump - 0.341_054_759_946_978).abs() < 1e-14);
        assert!((path.stick_time - (1.287_002_217_586_568_8 + 0.723_308_055_902_64)).abs() < 1e-13);
    }

    #[test]
    fn an_empty_first_stick_lasts_zero_and_a_slip_cut_off_counts_its_travel_but_no_jump() {
        let mut path = PathFold::starting_at(-2.0);
        path.event(&event(EventKind::SlipStarted(Positive), 0.0, -2.0));
        assert_eq!(path.end(1.0, 3.0), Censored::Slip);
        assert_eq!(path.first_duration, Some(0.0));
        assert_eq!((path.travel, path.max_displacement, path.jump, path.slips), (5.0, 3.0, 0.0, 0));
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
        // At the start, at an event, at t_end, on either side.
        for sign in [1.0, -1.0] {
            assert_eq!(slip_to(sign * 7.0, sign * 3.0, -sign * 5.0), 7.0);
            assert_eq!(slip_to(-sign * 2.0, sign * 7.0, sign * 5.0), 7.0);
            assert_eq!(slip_to(sign * 2.0, sign * 3.0, -sign * 7.0), 7.0);
        }
    }

    #[test]
    fn a_path_that_never_moves_sticks_all_the_time_and_ends_no_stick() {
        let mut path = PathFold::starting_at(6.0);
        assert_eq!(path.end(60.0, 6.0), Censored::FirstStick);
        assert_eq!((path.stick_time, path.first_duration, path.sticks), (60.0, None, 0));
    }

    #[test]
    fn only_sticks_after_the_first_are_pooled() {
        let mut path = PathFold::starting_at(0.0);
        path.event(&event(EventKind::SlipStarted(Positive), 10.0, 0.0));
        path.event(&event(EventKind::StickEntered, 11.0, 1.0));
        let ended = path.event(&event(EventKind::SlipStarted(Negative), 13.0, 1.0));
        path.event(&event(EventKind::StickEntered, 14.0, -1.0));
        path.event(&event(EventKind::SlipStarted(Negative), 17.0, -1.0));
        assert_eq!(ended, Some(Completed::Stick(2.0)));
        assert_eq!((path.sticks, path.duration, path.duration_squared), (2, 5.0, 13.0));
        assert_eq!((path.jump, path.jump_abs), (-1.0, 3.0));
    }
}
