//! The work that remains in a macro step: one queue per task, and for each waiting lane the data of
//! its task, a row in each of two tables.

use super::crossing::{TASKS, Task};
use crate::lanes::{Lanes, ROW, Row};
use crate::noise::LaneDraws;

/// The maximum number of waiting pieces of one lane. A lane with more crosses the macro step in
/// scalar form, which would happen often with half of this if f_s is close to f_d.
pub const DEPTH: usize = 32;

/// The rows of the lanes that are worked on together. A place without a lane holds the last row of
/// the tables, which belongs to no path.
pub type RowNumbers = [u32; ROW];

/// The tables and queues.
pub struct Jobs {
    /// For each lane, the start of its piece or interval, and its [`Count`].
    pub left: Vec<Row>,
    /// For each lane, the end of its piece or interval, and the keys of the random numbers of its
    /// path.
    pub right: Vec<Row>,
    /// The pieces of each lane that wait, in the layout of `right`. It is reserved for the maximum,
    /// and grows within that, so that nothing is copied; few paths ever need it all, and unused
    /// memory costs no time.
    stack: Vec<Row>,
    /// The lanes that were flagged in this macro step.
    flagged: Queue,
    queues: [Queue; TASKS.len()],
    /// The lanes that were taken out of a queue and remain to be worked on.
    batch: Queue,
    lanes: usize,
    /// The number of lanes of a register.
    pub width: usize,
}

/// Lanes that wait. The last one is taken first.
pub(super) struct Queue {
    /// Has room for a whole register after the last lane.
    lanes: Vec<u32>,
    len: usize,
}

impl Queue {
    /// An empty queue with room for `rows` lanes, and a register more.
    pub fn new(rows: usize) -> Self {
        Queue {
            lanes: vec![0; rows + ROW],
            len: 0,
        }
    }

    pub fn clear(&mut self) {
        self.len = 0;
    }

    /// Puts the lanes of a mask into the queue.
    #[inline(always)]
    pub fn push<L: Lanes>(&mut self, rows: &RowNumbers, lanes: u32) {
        self.lanes[self.len..self.len + ROW].copy_from_slice(&L::compress(rows, lanes));
        self.len += lanes.count_ones() as usize;
    }

    /// Takes out up to a register of lanes. Returns them and a mask of them; in the other places is
    /// the row `nobody`.
    #[inline(always)]
    pub fn pop<L: Lanes>(&mut self, nobody: u32) -> Option<(RowNumbers, u32)> {
        if self.len == 0 {
            return None;
        }
        let count = self.len.min(L::WIDTH);
        self.len -= count;
        let mut rows = [0; ROW];
        rows.copy_from_slice(&self.lanes[self.len..self.len + ROW]);
        if count < L::WIDTH {
            rows[count..].fill(nobody);
        }
        Some((rows, (1 << count) - 1))
    }
}

impl Jobs {
    /// Tables and queues for `lanes` lanes, a whole number of registers.
    pub fn new(lanes: usize) -> Self {
        let rows = lanes + ROW;
        let mut stack = Vec::with_capacity(DEPTH * rows);
        stack.resize(rows, Row([0.0; ROW]));
        Jobs {
            left: vec![Row([0.0; ROW]); rows],
            right: vec![Row([0.0; ROW]); rows],
            stack,
            flagged: Queue::new(rows),
            queues: std::array::from_fn(|_| Queue::new(rows)),
            batch: Queue::new(rows),
            lanes: rows,
            width: ROW,
        }
    }

    /// Empties all queues.
    pub fn clear(&mut self) {
        self.flagged.clear();
        self.queues.iter_mut().for_each(Queue::clear);
    }

    /// Notes that the lanes of a mask may have an event in this macro step.
    #[inline(always)]
    pub fn flag<L: Lanes>(&mut self, rows: &RowNumbers, lanes: u32) {
        self.flagged.push::<L>(rows, lanes);
    }

    /// The lanes that were flagged in this macro step.
    pub fn flagged(&self) -> &[u32] {
        &self.flagged.lanes[..self.flagged.len]
    }

    /// Puts the lanes of a mask into a queue.
    #[inline(always)]
    pub fn push<L: Lanes>(&mut self, task: Task, rows: &RowNumbers, lanes: u32) {
        self.queues[task as usize].push::<L>(rows, lanes);
    }

    /// Takes lanes out of the longest queue: as many whole registers as it has, or all its lanes
    /// where no queue fills a register. [`Jobs::next`] returns them register by register. So the
    /// work on one register need not wait until the lanes of the one before are in other queues.
    pub fn longest(&mut self) -> Option<Task> {
        let mut longest = 0;
        for i in 1..TASKS.len() {
            if self.queues[i].len > self.queues[longest].len {
                longest = i;
            }
        }
        let queue = &mut self.queues[longest];
        let taken = if queue.len < self.width {
            queue.len
        } else {
            queue.len - queue.len % self.width
        };
        if taken == 0 {
            return None;
        }
        queue.len -= taken;
        self.batch.lanes[..taken].copy_from_slice(&queue.lanes[queue.len..queue.len + taken]);
        self.batch.len = taken;
        Some(TASKS[longest])
    }

    /// The next lanes of those taken out of the queue, and a mask of them.
    #[inline(always)]
    pub fn next<L: Lanes>(&mut self) -> Option<(RowNumbers, u32)> {
        self.batch.pop::<L>(self.nobody())
    }

    /// The row that belongs to no path.
    pub fn nobody(&self) -> u32 {
        (self.lanes - 1) as u32
    }

    /// Puts a piece on top of the waiting pieces of each lane.
    #[inline(always)]
    pub fn place_behind<L: Lanes>(&mut self, rows: &RowNumbers, count: Count<L>, piece: [L; ROW]) {
        let places = self.places(rows, count);
        let last = places.into_iter().fold(0, u32::max);
        if last as usize >= self.stack.len() {
            self.grow(last);
        }
        L::scatter_rows(piece, &mut self.stack, &places);
    }

    /// Makes room in the stack for this place.
    #[cold]
    #[inline(never)]
    fn grow(&mut self, place: u32) {
        let layers = place as usize / self.lanes + 1;
        self.stack.resize(layers * self.lanes, Row([0.0; ROW]));
    }

    /// The topmost waiting piece of each lane. `count` no longer counts it.
    #[inline(always)]
    pub fn last_behind<L: Lanes>(&self, rows: &RowNumbers, count: Count<L>) -> [L; ROW] {
        L::gather_rows(&self.stack, &self.places(rows, count))
    }

    /// The place in the stack of the next waiting piece of each lane. The first pieces of all lanes
    /// are neighbours, and so are the second ones, so that what is used of the stack stays in the
    /// cache. The row that belongs to no path has one place.
    #[inline(always)]
    fn places<L: Lanes>(&self, rows: &RowNumbers, count: Count<L>) -> RowNumbers {
        let mut depths = [0; ROW];
        L::store_bits(count.behind(), &mut depths);
        let mut places = [0; ROW];
        for i in 0..L::WIDTH {
            let depth = if rows[i] == self.nobody() {
                0
            } else {
                depths[i] as u32 & (DEPTH as u32 - 1)
            };
            places[i] = depth * self.lanes as u32 + rows[i];
        }
        places
    }

    /// The same rows, but those of the first lane where there is none. So a user-defined force is
    /// evaluated only where paths are.
    #[inline(always)]
    pub fn known(&self, rows: &RowNumbers) -> RowNumbers {
        let (nobody, mut known) = (self.nobody(), *rows);
        for row in &mut known[1..] {
            if *row == nobody {
                *row = rows[0];
            }
        }
        known
    }

    /// The rows of the lanes of a mask; for the other lanes the row that belongs to no path.
    #[inline(always)]
    pub fn only<L: Lanes>(&self, rows: &RowNumbers, lanes: u32) -> RowNumbers {
        let nobody = self.nobody();
        let mut only = [nobody; ROW];
        for i in 0..L::WIDTH {
            only[i] = if lanes >> i & 1 == 1 { rows[i] } else { nobody };
        }
        only
    }
}

/// The counters of a flagged lane, packed into one number.
///
/// ```text
/// bits 0 to 31    the place of its next random number
/// bits 32 to 38   the number of its waiting pieces; while a stop is searched, of attempts
/// bit 39          whether its normals are mirrored
/// bits 40 to 63   its evaluations
/// ```
#[derive(Clone, Copy)]
pub struct Count<L: Lanes>(pub L::Bits);

const BEHIND: u64 = 1 << 32;
const MOST_BEHIND: u64 = 0x7F;
const MIRRORED: u64 = 1 << 39;
const SPENT: u32 = 40;

impl<L: Lanes> Count<L> {
    /// Counters at zero, with the first random number at this place. `flip` says for which paths
    /// the normals are mirrored.
    #[inline(always)]
    pub fn from(place: u64, flip: L::Bits) -> Self {
        Count(L::keep_and_set(flip, MIRRORED, place))
    }

    /// All bits set where the normals of a path are mirrored.
    #[inline(always)]
    pub fn flip(self) -> L::Bits {
        let is_not = L::xor(
            L::keep_and_set(self.0, MIRRORED, 0),
            L::splat_bits(MIRRORED),
        );
        L::add_bits(L::shr::<39>(is_not), L::splat_bits(u64::MAX))
    }

    /// The random numbers of the lanes with these keys, from the next one on.
    #[inline(always)]
    pub fn draws(self, macro_step: u64, origin: L::Bits, key: L::Bits) -> LaneDraws<L> {
        let place = L::keep_and_set(self.0, BEHIND - 1, 0);
        LaneDraws::at_places([origin, key, self.flip()], macro_step, place)
    }

    #[inline(always)]
    pub fn of(number: L) -> Self {
        Count(number.to_bits())
    }

    #[inline(always)]
    pub fn number(self) -> L {
        L::from_bits(self.0)
    }

    #[inline(always)]
    fn behind(self) -> L::Bits {
        L::keep_and_set(L::shr::<32>(self.0), MOST_BEHIND, 0)
    }

    /// The lanes without waiting pieces, or without attempts.
    #[inline(always)]
    pub fn has_none(self) -> L::Mask {
        L::from_integers(self.behind()).le(L::splat(0.0))
    }

    /// The lanes with at least `many` waiting pieces, or attempts.
    #[inline(always)]
    pub fn has(self, many: f64) -> L::Mask {
        L::from_integers(self.behind()).ge(L::splat(many))
    }

    /// Counts random numbers that were taken.
    #[inline(always)]
    pub fn drawn(self, numbers: u64) -> Self {
        Count(L::add_bits(self.0, L::splat_bits(numbers)))
    }

    /// Counts one more waiting piece, or one more attempt, in these lanes.
    #[inline(always)]
    pub fn behind_where(self, mask: L::Mask) -> Self {
        self.plus(mask, BEHIND)
    }

    /// Counts one waiting piece fewer.
    #[inline(always)]
    pub fn taken(self) -> Self {
        Count(L::add_bits(self.0, L::splat_bits(BEHIND.wrapping_neg())))
    }

    /// Sets the number of waiting pieces, or of attempts, to zero in these lanes.
    #[inline(always)]
    pub fn scalar_where(self, mask: L::Mask) -> Self {
        let scalar = L::keep_and_set(self.0, !(MOST_BEHIND * BEHIND), 0);
        Count(L::select(mask, L::from_bits(scalar), self.number()).to_bits())
    }

    /// Counts one evaluation.
    #[inline(always)]
    pub fn spent(self) -> Self {
        Count(L::add_bits(self.0, L::splat_bits(1 << SPENT)))
    }

    #[inline(always)]
    pub fn spent_where(self, mask: L::Mask) -> Self {
        self.plus(mask, 1 << SPENT)
    }

    #[inline(always)]
    fn plus(self, mask: L::Mask, what: u64) -> Self {
        let what = L::select(mask, L::from_bits(L::splat_bits(what)), L::splat(0.0));
        Count(L::add_bits(self.0, what.to_bits()))
    }
}

/// The place of the [`Count`] in a row of `left`, which is the same for all tasks.
pub const COUNT: usize = 4;

impl Jobs {
    /// The evaluations of a lane in this macro step since it was flagged.
    pub fn spent(&self, lane: usize) -> u64 {
        self.left[lane].0[COUNT].to_bits() >> SPENT
    }
}
