//! What is still to be done in a cell: a queue for every task, and what each waiting lane needs,
//! two rows of a table.

use crate::lanes::{Lanes, ROW, Row};
use crate::noise::LaneDraws;

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
    /// The pieces behind it, as rows of `right`.
    stack: Vec<Row>,
    /// The lanes that waited for anything in this cell.
    pub flagged: Vec<u32>,
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
            flagged: Vec::with_capacity(rows),
            queues: std::array::from_fn(|_| Queue { lanes: vec![0; rows], len: 0 }),
            batch: vec![0; rows],
            taken: 0,
            lanes: rows,
        }
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

    /// Put pieces behind the lanes, as rows of `right`.
    #[inline(always)]
    pub fn place_behind<L: Lanes>(&mut self, rows: &Rows, count: Count<L>, piece: [L; ROW]) {
        let places = self.places(rows, count);
        L::scatter_rows(piece, &mut self.stack, &places);
    }

    /// The pieces placed last behind the lanes, which are no longer counted.
    #[inline(always)]
    pub fn last_behind<L: Lanes>(&self, rows: &Rows, count: Count<L>) -> [L; ROW] {
        L::gather_rows(&self.stack, &self.places(rows, count))
    }

    /// Where in the stack the next pieces behind these lanes are.
    #[inline(always)]
    fn places<L: Lanes>(&self, rows: &Rows, count: Count<L>) -> Rows {
        let mut depths = [0; ROW];
        L::store_bits(count.behind(), &mut depths);
        let mut places = [0; ROW];
        for i in 0..L::WIDTH {
            places[i] = rows[i] * DEPTH as u32 + (depths[i] as u32 & (DEPTH as u32 - 1));
        }
        places
    }

    /// The rows of the lanes of a mask, and for the others the one that stands for none.
    #[inline(always)]
    pub fn only<L: Lanes>(&self, rows: &Rows, lanes: u32) -> Rows {
        let nobody = (self.lanes - 1) as u32;
        let mut only = [nobody; ROW];
        for i in 0..L::WIDTH {
            only[i] = if lanes >> i & 1 == 1 { rows[i] } else { nobody };
        }
        only
    }
}

/// What is counted of a flagged lane, packed into one number: the place of its next random number,
/// how many pieces wait behind it (where a slip stops, how often that was tried), whether its
/// normals are mirrored, and what it has spent.
#[derive(Clone, Copy)]
pub struct Count<L: Lanes>(pub L::Bits);

const BEHIND: u64 = 1 << 32;
const MOST_BEHIND: u64 = 0x7F;
const MIRRORED: u64 = 1 << 39;
const SPENT: u32 = 40;

impl<L: Lanes> Count<L> {
    /// Nothing yet; the first number is at this place, and the normals of some paths are mirrored.
    #[inline(always)]
    pub fn from(place: u64, flip: L::Bits) -> Self {
        Count(L::keep_and_set(flip, MIRRORED, place))
    }

    /// All ones where the normals of a path are mirrored.
    #[inline(always)]
    fn flip(self) -> L::Bits {
        let is_not = L::xor(L::keep_and_set(self.0, MIRRORED, 0), L::splat_bits(MIRRORED));
        L::add_bits(L::shr::<39>(is_not), L::splat_bits(u64::MAX))
    }

    /// The random numbers of lanes with these keys, from the next one on.
    #[inline(always)]
    pub fn draws(self, cell: u64, origin: L::Bits, key: L::Bits) -> LaneDraws<L> {
        let place = L::keep_and_set(self.0, BEHIND - 1, 0);
        LaneDraws { origin, key, counter: L::add_bits(place, L::splat_bits(cell << 32)), flip: self.flip() }
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

    /// Those behind which nothing waits, or where nothing was tried.
    #[inline(always)]
    pub fn has_none(self) -> L::Mask {
        L::from_integers(self.behind()).le(L::splat(0.0))
    }

    /// Those behind which so much waits, or where so much was tried.
    #[inline(always)]
    pub fn has(self, many: f64) -> L::Mask {
        L::from_integers(self.behind()).ge(L::splat(many))
    }

    /// So many random numbers were taken.
    #[inline(always)]
    pub fn drawn(self, numbers: u64) -> Self {
        Count(L::add_bits(self.0, L::splat_bits(numbers)))
    }

    /// One was taken in these lanes.
    #[inline(always)]
    pub fn drawn_where(self, mask: L::Mask) -> Self {
        self.plus(mask, 1)
    }

    /// One more piece waits.
    #[inline(always)]
    pub fn behind_where(self, mask: L::Mask) -> Self {
        self.plus(mask, BEHIND)
    }

    /// One piece less waits.
    #[inline(always)]
    pub fn taken(self) -> Self {
        Count(L::add_bits(self.0, L::splat_bits(BEHIND.wrapping_neg())))
    }

    /// Nothing waits, nothing was tried.
    #[inline(always)]
    pub fn alone_where(self, mask: L::Mask) -> Self {
        let alone = L::keep_and_set(self.0, !(MOST_BEHIND * BEHIND), 0);
        Count(L::select(mask, L::from_bits(alone), self.number()).to_bits())
    }

    /// One more evaluation.
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

/// Where the count is in a row of `left`, whatever the task.
pub const COUNT: usize = 4;

impl Jobs {
    /// What a lane has spent in the cell since it was flagged.
    pub fn spent(&self, lane: usize) -> u64 {
        self.left[lane].0[COUNT].to_bits() >> SPENT
    }
}
