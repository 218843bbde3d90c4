//! What is still to be done in a cell: a queue for every task, and what each waiting lane needs, two
//! rows of a table.

use crate::lanes::{Lanes, ROW, Row};

/// What a flagged lane waits for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Task {
    /// A piece of a stick is parted in its middle.
    Halve,
    /// Whether a piece of a stick is left.
    Decide,
    /// The next piece of a stick.
    StickOn,
    /// A sub-phase begins inside the cell.
    Begin,
    /// An interval of a slip is parted in its middle.
    Bisect,
    /// The next interval of a slip.
    SlipOn,
    /// A slip stops in an interval.
    Stop,
}

const TASKS: [Task; 7] =
    [Task::Halve, Task::Decide, Task::StickOn, Task::Begin, Task::Bisect, Task::SlipOn, Task::Stop];

/// Pieces that may wait behind another one.
pub const DEPTH: usize = 32;

/// Lanes that are worked on together; those beyond the last are the one that stands for none.
pub type Rows = [u32; ROW];

/// The tables and queues.
pub struct Jobs {
    /// What is left of a piece, or where it begins.
    pub left: Vec<Row>,
    /// What is right of it, and what tells the random numbers of the path apart.
    pub right: Vec<Row>,
    /// The pieces behind it, `depth lanes + lane`, as rows of `right`.
    stack: Vec<Row>,
    /// How many pieces are behind it; where a slip stops, how often that was tried.
    pub top: Vec<u32>,
    queues: [Queue; 7],
    /// Lanes taken out of a queue, and how many are still to be worked on.
    batch: Vec<u32>,
    taken: usize,
    lanes: usize,
}

/// The lanes that wait for a task; the last one comes first.
struct Queue {
    /// With room for a whole register behind the last.
    lanes: Vec<u32>,
    len: usize,
}

impl Jobs {
    /// For so many lanes, a whole number of registers.
    pub fn new(lanes: usize) -> Self {
        let rows = lanes + ROW;
        Jobs {
            left: vec![Row([0.0; ROW]); rows],
            right: vec![Row([0.0; ROW]); rows],
            stack: vec![Row([0.0; ROW]); rows * DEPTH],
            top: vec![0; rows],
            queues: std::array::from_fn(|_| Queue { lanes: vec![0; rows], len: 0 }),
            batch: vec![0; rows],
            taken: 0,
            lanes: rows,
        }
    }

    /// How many lanes wait.
    pub fn waiting(&self) -> usize {
        self.queues.iter().map(|queue| queue.len).sum()
    }

    /// Put the lanes of a mask in a queue.
    #[inline(always)]
    pub fn push<L: Lanes>(&mut self, task: Task, rows: &Rows, lanes: u32) {
        let queue = &mut self.queues[task as usize];
        queue.lanes[queue.len..queue.len + ROW].copy_from_slice(&L::compress(rows, lanes));
        queue.len += lanes.count_ones() as usize;
    }

    /// Take out all whole registers of lanes from the longest queue, or, where no queue has a whole
    /// one, what is in it. They are handed out by [`Jobs::next`], so that what is done with one
    /// register need not wait for where the lanes of the one before it went.
    #[inline(always)]
    pub fn longest<L: Lanes>(&mut self) -> Option<Task> {
        let mut longest = 0;
        for i in 1..TASKS.len() {
            if self.queues[i].len > self.queues[longest].len {
                longest = i;
            }
        }
        let queue = &mut self.queues[longest];
        let taken = if queue.len < L::WIDTH { queue.len } else { queue.len - queue.len % L::WIDTH };
        if taken == 0 {
            return None;
        }
        queue.len -= taken;
        self.batch[..taken].copy_from_slice(&queue.lanes[queue.len..queue.len + taken]);
        self.taken = taken;
        Some(TASKS[longest])
    }

    /// The next lanes of those taken out, and a mask of them.
    #[inline(always)]
    pub fn next<L: Lanes>(&mut self) -> Option<(Rows, u32)> {
        if self.taken == 0 {
            return None;
        }
        let count = self.taken.min(L::WIDTH);
        self.taken -= count;
        let mut rows = [0; ROW];
        rows.copy_from_slice(&self.batch[self.taken..self.taken + ROW]);
        if count < L::WIDTH {
            rows[count..].fill((self.lanes - 1) as u32);
        }
        Some((rows, (1 << count) - 1))
    }

    /// The rows of the stack on top of those that wait behind these lanes.
    #[inline(always)]
    fn above(&self, rows: &[u32]) -> Rows {
        let mut above = [0; 8];
        for (place, &row) in above.iter_mut().zip(rows) {
            *place = self.top[row as usize] * self.lanes as u32 + row;
        }
        above
    }

    /// Put pieces behind the lanes, without counting them.
    #[inline(always)]
    pub fn place_behind<L: Lanes>(&mut self, rows: &[u32], piece: [L; ROW]) {
        let above = self.above(rows);
        L::scatter_rows(piece, &mut self.stack, &above);
    }

    /// The nearest pieces behind lanes that each have one, which are taken off.
    #[inline(always)]
    pub fn take_behind<L: Lanes>(&mut self, rows: &[u32], lanes: u32) -> [L; ROW] {
        for (i, &row) in rows.iter().enumerate() {
            self.top[row as usize] -= lanes >> i & 1;
        }
        let above = self.above(rows);
        L::gather_rows(&self.stack, &above)
    }

    /// Those of the lanes behind which no piece waits.
    #[inline(always)]
    pub fn without_more(&self, rows: &[u32], lanes: u32) -> u32 {
        let mut done = 0;
        for (i, &row) in rows.iter().enumerate() {
            done |= u32::from(self.top[row as usize] == 0) << i;
        }
        done & lanes
    }

    /// Those of the lanes behind which no more pieces can be placed.
    #[inline(always)]
    pub fn full(&self, rows: &[u32], lanes: u32) -> u32 {
        let mut full = 0;
        for (i, &row) in rows.iter().enumerate() {
            full |= u32::from(self.top[row as usize] as usize + 2 > DEPTH) << i;
        }
        full & lanes
    }

    /// Nothing waits behind the lanes of a mask, and nothing was tried.
    #[inline(always)]
    pub fn begin(&mut self, rows: &[u32], lanes: u32) {
        for (i, &row) in rows.iter().enumerate() {
            self.top[row as usize] *= !lanes >> i & 1;
        }
    }

    /// Those of the lanes that have been tried so often.
    #[inline(always)]
    pub fn tried(&self, rows: &[u32], lanes: u32, times: u32) -> u32 {
        let mut tried = 0;
        for (i, &row) in rows.iter().enumerate() {
            tried |= u32::from(self.top[row as usize] >= times) << i;
        }
        tried & lanes
    }

    /// The rows of the lanes of a mask, and for the others the one that stands for none.
    #[inline(always)]
    pub fn only(&self, rows: &[u32], lanes: u32) -> Rows {
        let mut only = [(self.lanes - 1) as u32; 8];
        for (i, (to, &row)) in only.iter_mut().zip(rows).enumerate() {
            *to = if lanes >> i & 1 == 1 { row } else { *to };
        }
        only
    }

    /// Count the pieces placed behind the lanes of a mask.
    #[inline(always)]
    pub fn count_behind(&mut self, rows: &[u32], lanes: u32) {
        for (i, &row) in rows.iter().enumerate() {
            self.top[row as usize] += lanes >> i & 1;
        }
    }
}
