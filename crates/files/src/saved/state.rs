//! The saved state of a run: its question, its progress, and how much of its log is valid.
//!
//! The bytes are a magic name, a version, the contents, and a checksum of all of these. Numbers are
//! written as [`stickslip::sums::Codec`] writes them, texts as their length and their bytes.

use super::SavedError;
use super::checksum::checksum;
use super::rows::Position;
use std::path::Path;
use std::time::Duration;
use stickslip::engine::{Asked, Part, Program, Provenance, SoFar};
use stickslip::model::{NamedSeries, Series};
use stickslip::scenario::Scenario;
use stickslip::stats::{Bound, Goal, RunTotals, Statistic};
use stickslip::sums::{Codec, Damaged, Reader};

/// The first bytes of a state.
pub(crate) const MAGIC: &[u8; 8] = b"sticksav";
/// Version of the contents.
const VERSION: u64 = 7;

/// What a run is asked to do. It is the same in every saved state of the run.
#[derive(Clone, Debug, PartialEq)]
pub struct RunQuestion {
    /// What is simulated.
    pub scenario: Scenario,
    /// Number of paths, part, goals, time limit and bias.
    pub asked: Asked,
    /// A text that the caller gets back when the run is continued. The store does not interpret it.
    pub note: String,
}

impl RunQuestion {
    /// The first difference between this question and another one, in words; `None` if they are
    /// equal.
    pub(crate) fn difference_from(&self, other: &RunQuestion) -> Option<String> {
        let [mine, theirs] = [self, other].map(|question| lines(&question.scenario.to_toml()));
        if let Some([mine, theirs]) = first_difference(&mine, &theirs) {
            return Some(format!("it has `{mine}`, but this one has `{theirs}`"));
        }
        (self.asked != other.asked).then(|| "its goals, limits or options differ".into())
    }

    /// The question as the bytes of a state without paths.
    pub fn to_bytes(&self) -> Vec<u8> {
        let totals = RunTotals::empty(
            &self.scenario.model,
            &self.scenario.timeline(),
            &self.scenario.record,
        );
        to_bytes(
            self,
            &totals.to_bytes(),
            Duration::ZERO,
            Position::default(),
        )
    }
}

/// The lines of a text without comments and empty lines.
pub(crate) fn lines(text: &str) -> Vec<String> {
    let lines = text.lines();
    let lines = lines.map(|line| line.split("  #").next().unwrap_or("").trim().to_string());
    lines.filter(|line| !line.is_empty()).collect()
}

/// The first lines that differ. A title lists what was changed, so the changed key is more
/// informative.
pub(crate) fn first_difference(first: &[String], second: &[String]) -> Option<[String; 2]> {
    let at = |list: &[String], i| list.get(i).cloned().unwrap_or_else(|| "nothing".into());
    let differing = (0..first.len().max(second.len())).filter(|&i| first.get(i) != second.get(i));
    let mut pairs = differing.map(|i| [at(first, i), at(second, i)]);
    let any = pairs.next()?;
    match any[0].starts_with("title = ") {
        true => pairs.next().or(Some(any)),
        false => Some(any),
    }
}

/// A state that was read back.
#[derive(Clone, Debug)]
pub(crate) struct State {
    pub program: Program,
    pub question: RunQuestion,
    pub so_far: SoFar,
    /// How much of the log of rows counts.
    pub rows: Position,
}

impl State {
    /// Number of paths that the state contains.
    pub fn paths(&self) -> u64 {
        let blocks = self.so_far.totals.blocks();
        let block_size = self.program.block_size;
        let most = self.question.asked.paths;
        let paths = |block: u64| block.saturating_mul(block_size).min(most);
        blocks
            .iter()
            .map(|range| paths(range.end) - paths(range.start))
            .sum()
    }

    /// The provenance of its numbers, with the program that began the run.
    pub fn header(&self) -> Provenance {
        let header = self.question.asked.provenance(&self.question.scenario);
        Provenance {
            program: self.program.clone(),
            ..header
        }
    }

    /// An error if another program began the run, because it need not produce the same bits.
    pub fn check_program(&self, path: &Path) -> Result<(), SavedError> {
        if self.program == Program::mine() {
            Ok(())
        } else {
            Err(other_program(path, &self.program))
        }
    }
}

fn other_program(path: &Path, program: &Program) -> SavedError {
    let [theirs, mine] = [program, &Program::mine()].map(Program::to_string);
    SavedError::OtherProgram {
        path: path.to_owned(),
        theirs,
        mine,
    }
}

/// The state of a run as bytes. `totals` are the bytes of its sums.
pub(crate) fn to_bytes(
    question: &RunQuestion,
    totals: &[u8],
    spent: Duration,
    rows: Position,
) -> Vec<u8> {
    let RunQuestion {
        scenario,
        asked,
        note,
    } = question;
    let program = Program::mine();
    let mut out = MAGIC.to_vec();
    VERSION.write(&mut out);
    for text in [&program.version, &program.git_hash, &program.generator] {
        write_text(text, &mut out);
    }
    program.block_size.write(&mut out);
    write_text(&scenario.to_toml(), &mut out);
    let samples = scenario.samples();
    (samples.len() as u64).write(&mut out);
    samples
        .iter()
        .for_each(|samples| write_series(samples, &mut out));
    asked.paths.write(&mut out);
    let (number, of) = asked.part.map_or((0, 0), |part| (part.number(), part.of()));
    number.write(&mut out);
    of.write(&mut out);
    (asked.goals.len() as u64).write(&mut out);
    for Goal { statistic, bound } in &asked.goals {
        write_text(statistic.name(), &mut out);
        let (kind, bound) = match bound {
            Bound::Relative(bound) => (0, bound),
            Bound::Absolute(bound) => (1_u64, bound),
        };
        kind.write(&mut out);
        bound.write(&mut out);
    }
    nanoseconds(asked.max_time.unwrap_or(Duration::ZERO)).write(&mut out);
    u64::from(asked.with_bias).write(&mut out);
    write_text(note, &mut out);
    nanoseconds(spent).write(&mut out);
    rows.length.write(&mut out);
    u64::from(rows.checksum).write(&mut out);
    (totals.len() as u64).write(&mut out);
    out.extend(totals);
    let sum = checksum(0, &out);
    out.extend(sum.to_le_bytes());
    out
}

/// Read the state of a run from bytes. `path` is named in error messages.
pub(crate) fn of_bytes(bytes: &[u8], path: &Path) -> Result<State, SavedError> {
    let damaged = || SavedError::Damaged {
        path: path.to_owned(),
    };
    let (body, sum) = bytes.split_last_chunk::<4>().ok_or_else(damaged)?;
    let mut from = Reader::new(body);
    if from.take(MAGIC.len()).ok() != Some(MAGIC) || u32::from_le_bytes(*sum) != checksum(0, body) {
        return Err(damaged());
    }
    let version: u64 = from.value().map_err(|_| damaged())?;
    if version > VERSION {
        return Err(SavedError::Newer {
            path: path.to_owned(),
        });
    }
    parse(version, &mut from).map_err(|unread| match unread {
        ParseError::Damaged => damaged(),
        ParseError::OtherProgram(program) => other_program(path, &program),
    })
}

/// Why bytes with a correct checksum are not a state that can be used.
enum ParseError {
    Damaged,
    OtherProgram(Box<Program>),
}

impl From<Damaged> for ParseError {
    fn from(_: Damaged) -> Self {
        ParseError::Damaged
    }
}

fn parse(format: u64, from: &mut Reader<'_>) -> Result<State, ParseError> {
    let (version, git_hash, generator) = (read_text(from)?, read_text(from)?, read_text(from)?);
    let program = Program {
        version,
        git_hash,
        generator,
        block_size: from.value()?,
    };
    if format != VERSION {
        return Err(ParseError::OtherProgram(program.into()));
    }
    let text = read_text(from)?;
    let samples = (0..from.length()?)
        .map(|_| read_series(from))
        .collect::<Result<Vec<_>, _>>()?;
    let scenario = Scenario::parse_stored("state", &text, &[], &samples).map_err(|_| Damaged)?;
    let paths = from.value()?;
    let [number, of]: [u64; 2] = from.value()?;
    let part = if of == 0 {
        None
    } else {
        Some(Part::new(number, of).ok_or(Damaged)?)
    };
    let goals = (0..from.length()?)
        .map(|_| goal(from))
        .collect::<Result<_, _>>()?;
    let max_time = Some(Duration::from_nanos(from.value()?)).filter(|time| !time.is_zero());
    let with_bias = from.value::<u64>()? == 1;
    let asked = Asked {
        paths,
        part,
        goals,
        max_time,
        with_bias,
    };
    let note = read_text(from)?;
    let spent = Duration::from_nanos(from.value()?);
    let rows = Position {
        length: from.value()?,
        checksum: from.value::<u64>()?.try_into().map_err(|_| Damaged)?,
    };
    let length = from.length()?;
    let empty = RunTotals::empty(&scenario.model, &scenario.timeline(), &scenario.record);
    // If the sums cannot be read and the state names another program, that difference is reported
    // instead of damage.
    let totals = empty
        .read(from.take(length)?)
        .map_err(|_| match program == Program::mine() {
            true => ParseError::Damaged,
            false => ParseError::OtherProgram(program.clone().into()),
        })?;
    let is_sound = from.left() == 0 && is_of(&totals, &asked);
    let question = RunQuestion {
        scenario,
        asked,
        note,
    };
    if is_sound {
        Ok(State {
            program,
            question,
            so_far: SoFar { totals, spent },
            rows,
        })
    } else {
        Err(ParseError::Damaged)
    }
}

/// Write what was measured: its table, the number of samples, all times, all values.
fn write_series(NamedSeries { name, series }: &NamedSeries, out: &mut Vec<u8>) {
    write_text(name, out);
    (series.times().len() as u64).write(out);
    series
        .times()
        .iter()
        .chain(series.values())
        .for_each(|number| number.write(out));
}

fn read_series(from: &mut Reader<'_>) -> Result<NamedSeries, Damaged> {
    let (name, samples) = (read_text(from)?, from.length()?);
    let mut numbers = || {
        (0..samples)
            .map(|_| from.value())
            .collect::<Result<Vec<f64>, Damaged>>()
    };
    let (times, values) = (numbers()?, numbers()?);
    let series = Series::new(times, values).map_err(|_| Damaged)?.into();
    Ok(NamedSeries { name, series })
}

/// Whether these sums are of the first requested blocks.
fn is_of(totals: &RunTotals, asked: &Asked) -> bool {
    match totals.blocks().as_slice() {
        [] => true,
        [done] => done.start == asked.blocks().start && done.end <= asked.blocks().end,
        _ => false,
    }
}

fn goal(from: &mut Reader<'_>) -> Result<Goal, Damaged> {
    let statistic = Statistic::from_name(&read_text(from)?).ok_or(Damaged)?;
    let (kind, bound): (u64, f64) = (from.value()?, from.value()?);
    let bound = if kind == 0 {
        Bound::Relative(bound)
    } else {
        Bound::Absolute(bound)
    };
    Ok(Goal { statistic, bound })
}

/// Nanoseconds in 64 bits, which are enough for 584 years; longer times are cut to that.
fn nanoseconds(time: Duration) -> u64 {
    time.as_nanos().try_into().unwrap_or(u64::MAX)
}

fn write_text(text: &str, out: &mut Vec<u8>) {
    (text.len() as u64).write(out);
    out.extend(text.as_bytes());
}

fn read_text(from: &mut Reader<'_>) -> Result<String, Damaged> {
    let length = from.length()?;
    String::from_utf8(from.take(length)?.to_vec()).map_err(|_| Damaged)
}

#[cfg(test)]
mod tests {
    use super::*;
    use stickslip::config::Override;
    use stickslip::ensemble::BLOCK_SIZE;

    fn question() -> RunQuestion {
        // With a burn-in every count of the sums is above zero.
        let set = [
            "time.output_step=30",
            "time.end=30",
            "time.step=0.1",
            "scheme.kind=discrete-vi",
            "statistics.after=9",
        ];
        let set: Vec<Override> = set
            .iter()
            .map(|text| Override::set(text).expect("well formed"))
            .collect();
        let text = stickslip::config::shipped("rho025").expect("shipped").text;
        let scenario = Scenario::parse("rho025", text, &set).expect("sound");
        let asked = Asked {
            paths: 6 * BLOCK_SIZE - 7,
            part: Part::new(2, 3),
            goals: vec![
                "stick_duration_mean < 0.123456789%"
                    .parse()
                    .expect("a goal"),
            ],
            max_time: Some(Duration::new(17_400, 123_456_789)),
            with_bias: true,
        };
        RunQuestion {
            scenario,
            asked,
            note: "of the caller\u{2014}any text".into(),
        }
    }

    fn state(blocks: std::ops::Range<u64>) -> Vec<u8> {
        let question = question();
        let plan = question.scenario.plan();
        let mut totals = RunTotals::empty(plan.model(), plan.timeline(), &plan.record);
        blocks.for_each(|block| totals.push(block, plan.block(block).totals).expect("once"));
        let rows = Position {
            length: 1 << 40,
            checksum: 0xdead_beef,
        };
        to_bytes(&question, &totals.to_bytes(), Duration::new(3, 5), rows)
    }

    fn read(bytes: &[u8]) -> Result<State, SavedError> {
        of_bytes(bytes, Path::new("state"))
    }

    #[test]
    fn a_state_comes_back_with_every_bit() {
        for blocks in [2..2, 2..3, 2..4] {
            let bytes = state(blocks.clone());
            let state = read(&bytes).expect("as written");
            assert_eq!(state.question, question());
            assert_eq!(state.paths(), (blocks.end - blocks.start) * BLOCK_SIZE);
            let SoFar { totals, spent } = &state.so_far;
            assert_eq!(*spent, Duration::new(3, 5));
            assert_eq!(
                to_bytes(&state.question, &totals.to_bytes(), *spent, state.rows),
                bytes
            );
            state
                .check_program(Path::new("state"))
                .expect("this program");
        }
    }

    /// The bytes are cut at every length, and one or two bits of every byte are flipped.
    #[test]
    fn bytes_other_than_those_written_are_damage() {
        let bytes = state(2..3);
        let is_damaged = |bytes: &[u8]| matches!(read(bytes), Err(SavedError::Damaged { .. }));
        assert!((0..bytes.len()).all(|length| is_damaged(&bytes[..length])));
        let mut damaged = bytes.clone();
        for at in 0..bytes.len() {
            for bits in [1 << (at % 8), 0b1000_0001] {
                damaged[at] ^= bits;
                assert!(is_damaged(&damaged), "{at}");
                damaged[at] = bytes[at];
            }
        }
        assert!(read(&damaged).is_ok());
    }

    /// Even when the checksum is right, the contents are checked against each other. So bytes that
    /// were changed on purpose, with a new checksum, give an error or another valid state, but no
    /// panic.
    #[test]
    fn whole_bytes_that_make_no_sense_are_an_error() {
        let bytes = state(2..3);
        let body = &bytes[..bytes.len() - 4];
        let with_sum = |body: &[u8]| [body, &checksum(0, body).to_le_bytes()].concat();
        assert!((0..body.len()).all(|length| read(&with_sum(&body[..length])).is_err()));
        for at in 0..body.len().min(6_000) {
            for byte in [0, 1, 0x7f, 0xff] {
                let mut changed = body.to_vec();
                changed[at] = byte;
                // The change may give another valid state, so only a panic fails the test.
                let _ = read(&with_sum(&changed));
            }
        }
        // The blocks are not those of the part.
        assert!(
            read(&state(0..1)).is_err()
                && read(&state(3..5)).is_err()
                && read(&state(3..4)).is_err()
        );
    }

    #[test]
    fn another_program_and_a_newer_one_are_told_from_damage() {
        let bytes = state(2..3);
        let mine = stickslip::engine::PROGRAM_VERSION;
        let at = MAGIC.len() + 2;
        assert_eq!(&bytes[at..at + mine.len()], mine.as_bytes());
        let with = |change: &dyn Fn(&mut Vec<u8>)| {
            let mut body = bytes[..bytes.len() - 4].to_vec();
            change(&mut body);
            let sum = checksum(0, &body);
            body.extend(sum.to_le_bytes());
            read(&body)
        };
        let other = with(&|body| body[at] = b'9').expect("it can be shown");
        let error = other
            .check_program(Path::new("state"))
            .expect_err("and not continued");
        assert!(
            error.to_string().contains("started by version 9"),
            "{error}"
        );
        let newer = with(&|body| body[MAGIC.len()] = VERSION as u8 + 1).expect_err("newer");
        assert!(matches!(newer, SavedError::Newer { .. }), "{newer}");
    }
}
