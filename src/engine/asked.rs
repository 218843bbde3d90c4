//! What a run is asked besides its scenario: all that decides where it ends and what is made of it.

use crate::ensemble::BLOCK_SIZE;
use crate::stats::Goal;
use std::fmt;
use std::ops::Range;
use std::str::FromStr;
use std::time::Duration;

/// What a run is asked besides its scenario. With the scenario it decides every bit of the outcome,
/// but for a time limit.
#[derive(Clone, Debug, PartialEq)]
pub struct Asked {
    /// Most paths of the run; of all parts together, where it is cut into parts.
    pub paths: u64,
    /// Which part of the run, if not all of it.
    pub part: Option<Part>,
    /// The run ends when all of them are reached.
    pub goals: Vec<Goal>,
    /// The run ends when so much time is spent.
    pub max_time: Option<Duration>,
    /// Whether the bias of the step is estimated.
    pub with_bias: bool,
}

impl Asked {
    /// Numbers of the blocks that are to be simulated.
    pub fn blocks(&self) -> Range<u64> {
        let all = self.paths.div_ceil(BLOCK_SIZE);
        self.part.map_or(0..all, |part| part.blocks(all))
    }

    /// Number of the paths that are to be simulated.
    pub fn own_paths(&self) -> u64 {
        let Range { start, end } = self.blocks();
        (end * BLOCK_SIZE).min(self.paths) - (start * BLOCK_SIZE).min(self.paths)
    }
}

/// One of so many parts of a run, each of them consecutive blocks: written `3/16`.
///
/// ```
/// use stick_slip::engine::Part;
///
/// let part: Part = "3/16".parse()?;
/// assert_eq!(part.blocks(160), 20..30);
/// # Ok::<(), stick_slip::engine::NoPart>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Part {
    number: u64,
    of: u64,
}

/// Why a text is no part.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("not a part such as 3/16, from 1/N to N/N")]
pub struct NoPart;

impl Part {
    /// Part `number`, from 1, of so many.
    pub fn new(number: u64, of: u64) -> Option<Part> {
        (1..=of).contains(&number).then_some(Part { number, of })
    }

    /// Which part it is, from 1.
    pub fn number(self) -> u64 {
        self.number
    }

    /// How many parts there are.
    pub fn of(self) -> u64 {
        self.of
    }

    /// Its blocks, of so many. The parts of a run have equally many blocks, or one more.
    pub fn blocks(self, all: u64) -> Range<u64> {
        let before = |parts: u64| (u128::from(all) * u128::from(parts) / u128::from(self.of)) as u64;
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
        let parts = text.split_once('/').and_then(|(part, of)| Some((number(part)?, number(of)?)));
        parts.and_then(|(part, of)| Part::new(part, of)).ok_or(NoPart)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        /// Nothing is left out, nothing is done twice, and no part has more than one block more
        /// than another.
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
        assert_eq!("3/16".parse::<Part>().map(|part| part.to_string()), Ok("3/16".into()));
        for text in ["", "3", "0/4", "5/4", "1/0", "-1/4", "1/4/2", "1.5/4"] {
            assert_eq!(text.parse::<Part>(), Err(NoPart), "{text}");
        }
    }
}
