//! The options of a run in addition to its scenario: everything that determines where the run ends
//! and what is computed from its paths.

use super::Provenance;
use crate::ensemble::{BLOCK_SIZE, Plan};
use crate::scenario::Scenario;
use crate::stats::Goal;
use std::fmt;
use std::ops::Range;
use std::str::FromStr;
use std::time::Duration;

/// The options of a run in addition to its scenario. Without a time limit, options and scenario
/// together determine every bit of the outcome.
#[derive(Clone, Debug, PartialEq)]
pub struct Asked {
    /// The largest number of paths of the run. If the run is cut into parts, it is that of all
    /// parts together.
    pub paths: u64,
    /// The part of the run that is simulated; `None` means the whole run.
    pub part: Option<Part>,
    /// The run ends when all these goals are reached.
    pub goals: Vec<Goal>,
    /// The run ends when this much wall-clock time is spent.
    pub max_time: Option<Duration>,
    /// Whether the bias of the step is estimated.
    pub with_bias: bool,
}

impl Asked {
    /// This many paths, without a time limit and without the bias of the step.
    pub fn paths(paths: u64) -> Self {
        Asked {
            paths,
            part: None,
            goals: Vec::new(),
            max_time: None,
            with_bias: false,
        }
    }

    /// Where the numbers of a run of the scenario come from.
    pub fn provenance(&self, scenario: &Scenario) -> Provenance {
        Provenance {
            paths: self.paths,
            ..Provenance::of(scenario)
        }
    }

    /// The ensemble of a run of the scenario.
    pub fn plan(&self, scenario: &Scenario) -> Plan {
        Plan {
            paths: self.paths,
            ..scenario.plan()
        }
    }

    /// The numbers of the blocks that are to be simulated.
    pub fn blocks(&self) -> Range<u64> {
        let all = self.paths.div_ceil(BLOCK_SIZE);
        self.part.map_or(0..all, |part| part.blocks(all))
    }

    /// The number of paths that are to be simulated; if this is a part, those of the part only.
    pub fn own_paths(&self) -> u64 {
        let Range { start, end } = self.blocks();
        (end * BLOCK_SIZE).min(self.paths) - (start * BLOCK_SIZE).min(self.paths)
    }
}

/// One of several parts of a run, such as `3/16` for the third of 16. Each part consists of
/// consecutive blocks.
///
/// ```
/// use stickslip::engine::Part;
///
/// let part: Part = "3/16".parse()?;
/// assert_eq!(part.blocks(160), 20..30);
/// # Ok::<(), stickslip::engine::NoPart>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Part {
    number: u64,
    of: u64,
}

/// The error for a text that does not name a part.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("must be a part from 1/N to N/N, such as 3/16")]
pub struct NoPart;

impl Part {
    /// Part `number` of `of` parts. Numbers begin at 1; `None` if there is no such part.
    pub fn new(number: u64, of: u64) -> Option<Part> {
        (1..=of).contains(&number).then_some(Part { number, of })
    }

    /// The number of the part, from 1.
    pub fn number(self) -> u64 {
        self.number
    }

    /// Number of parts of the run.
    pub fn of(self) -> u64 {
        self.of
    }

    /// The blocks of this part, if the run has `all` blocks. The numbers of blocks of two parts of
    /// a run differ by at most one.
    pub fn blocks(self, all: u64) -> Range<u64> {
        let before =
            |parts: u64| (u128::from(all) * u128::from(parts) / u128::from(self.of)) as u64;
        before(self.number - 1)..before(self.number)
    }
}

impl fmt::Display for Part {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}/{}", self.number, self.of)
    }
}

impl FromStr for Part {
    type Err = NoPart;

    fn from_str(text: &str) -> Result<Self, NoPart> {
        let number = |text: &str| text.trim().parse().ok();
        let parts = text
            .split_once('/')
            .and_then(|(part, of)| Some((number(part)?, number(of)?)));
        parts
            .and_then(|(part, of)| Part::new(part, of))
            .ok_or(NoPart)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        /// No block is left out, none is in two parts, and the numbers of blocks of two parts
        /// differ by at most one.
        #[test]
        fn parts_are_the_run(all in 1_u64..=1 << 40, of in 1_u64..200) {
            let blocks: Vec<_> = (1..=of).map(|number| Part::new(number, of).expect("in range").blocks(all)).collect();
            prop_assert_eq!((blocks[0].start, blocks[blocks.len() - 1].end), (0, all));
            prop_assert!(blocks.windows(2).all(|pair| pair[0].end == pair[1].start));
            let sizes = || blocks.iter().map(|range| range.end - range.start);
            prop_assert!(sizes().max() <= sizes().min().map(|least| least + 1));
        }
    }

    #[test]
    fn a_part_is_read_as_it_is_written() {
        assert_eq!(
            "3/16".parse::<Part>().map(|part| part.to_string()),
            Ok("3/16".into())
        );
        for text in ["", "3", "0/4", "5/4", "1/0", "-1/4", "1/4/2", "1.5/4"] {
            assert_eq!(text.parse::<Part>(), Err(NoPart), "{text}");
        }
    }
}
