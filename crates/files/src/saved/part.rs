//! The state of a part that is kept in memory.

use super::rows::Position;
use super::state::{RunQuestion, to_bytes};
use std::time::Duration;
use stickslip::engine::{Asked, Moment, Sink, SinkError};
use stickslip::scenario::Scenario;
use stickslip::stats::{BlockResult, Record};

/// A sink that makes the state of a part of a run: the bytes by which it is joined to the others.
/// The file of the same part has the same bytes.
#[derive(Debug, Default)]
pub struct PartRecorder {
    question: Option<RunQuestion>,
    rows: Position,
    bytes: Vec<u8>,
    state: Option<Vec<u8>>,
}

impl PartRecorder {
    /// The state; none for a run that is not a part.
    pub fn into_state(self) -> Option<Vec<u8>> {
        self.state
    }
}

impl Sink for PartRecorder {
    fn begin(&mut self, scenario: &Scenario, asked: &Asked) -> Result<(), SinkError> {
        let question = || RunQuestion {
            scenario: scenario.clone(),
            asked: asked.clone(),
            note: String::new(),
        };
        self.question = asked.part.map(|_| question());
        Ok(())
    }

    fn block(&mut self, block: &BlockResult) -> Result<(), SinkError> {
        if self
            .question
            .as_ref()
            .is_some_and(|question| question.scenario.record != Record::NOTHING)
        {
            self.bytes.clear();
            self.rows = self.rows.after(&block.rows, &mut self.bytes);
        }
        Ok(())
    }

    fn save(&mut self, moment: &Moment<'_>) -> Result<(), SinkError> {
        if let Some(question) = self.question.as_ref().filter(|_| moment.is_last) {
            // The time that was spent is left out, so that equal parts are equal.
            self.state = Some(to_bytes(
                question,
                &moment.state(),
                Duration::ZERO,
                self.rows,
            ));
        }
        Ok(())
    }
}
