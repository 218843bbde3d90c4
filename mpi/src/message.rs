//! Messages between ranks, each of a kind and bytes. Sending and waiting do not keep a processor
//! busy.

use mpi::point_to_point::{Message, Status};
use mpi::request::{Request, Scope};
use mpi::topology::SimpleCommunicator;
use mpi::traits::*;
use std::time::Duration;
use stick_slip::sums::{Codec as _, Damaged, Reader};

/// The kind of a message, which is its tag in MPI.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    Run,
    Lease,
    Stop,
    Halt,
    End,
    Parcel,
    Count,
    Counts,
    Failed,
}

const KINDS: [Kind; 9] =
    [Kind::Run, Kind::Lease, Kind::Stop, Kind::Halt, Kind::End, Kind::Parcel, Kind::Count, Kind::Counts, Kind::Failed];

/// A message that was received.
pub(super) struct Received {
    pub kind: Kind,
    /// The rank that sent it.
    pub from: usize,
    pub bytes: Vec<u8>,
}

/// The length of a piece in bytes. MPI counts bytes with a C integer, so a long message is sent in
/// pieces, all of this length but the last.
const PIECE: usize = 1 << 28;

/// How long to sleep between two looks at a transfer. Both sides must look repeatedly until a long
/// message is transferred, because MPI moves its parts only during a call.
const TRANSFER: Duration = Duration::from_micros(500);

/// The next message, if one has arrived. With `only`, messages of other ranks are left waiting.
pub(super) fn receive_from(only: Option<usize>) -> Option<Received> {
    let world = SimpleCommunicator::world();
    let (message, status) = match only {
        Some(rank) => world.process_at_rank(rank as i32).immediate_matched_probe()?,
        None => world.any_process().immediate_matched_probe()?,
    };
    let (from, tag) = (status.source_rank(), status.tag());
    let mut bytes = Vec::new();
    let mut last = append(message, &status, &mut bytes);
    while last == PIECE {
        let (message, status) = world.process_at_rank(from).matched_probe_with_tag(tag);
        last = append(message, &status, &mut bytes);
    }
    let kind = KINDS.into_iter().find(|kind| *kind as i32 == tag)?;
    Some(Received { kind, from: from as usize, bytes })
}

/// The next message of any rank, if one has arrived.
pub(super) fn receive() -> Option<Received> {
    receive_from(None)
}

/// Append the bytes of a message, and return how many there are.
fn append(message: Message, status: &Status, bytes: &mut Vec<u8>) -> usize {
    let length = status.count(u8::equivalent_datatype()).max(0) as usize;
    let start = bytes.len();
    bytes.resize(start + length, 0);
    mpi::request::scope(|scope| finish(message.immediate_matched_receive_into(scope, &mut bytes[start..])));
    length
}

/// Wait until a transfer is complete. A blocking call of MPI would check without a pause, and so
/// keep a processor busy while the other side sleeps.
fn finish<'a, S: Scope<'a>>(mut request: Request<'a, [u8], S>) {
    while let Err(pending) = request.test() {
        request = pending;
        std::thread::sleep(TRANSFER);
    }
}

/// Send a message, and sleep until it is received.
pub(super) fn send(to: usize, kind: Kind, bytes: &[u8]) {
    let world = SimpleCommunicator::world();
    let process = world.process_at_rank(to as i32);
    // If the last piece were full, the receiver would wait for another one, so an empty piece
    // follows.
    let pieces = bytes.len() / PIECE + 1;
    for piece in (0..pieces).map(|k| &bytes[k * PIECE..bytes.len().min((k + 1) * PIECE)]) {
        mpi::request::scope(|scope| finish(process.immediate_send_with_tag(scope, piece, kind as i32)));
    }
}

/// Write the length of a list of bytes, and then the bytes.
pub(super) fn write_bytes(bytes: &[u8], out: &mut Vec<u8>) {
    (bytes.len() as u64).write(out);
    out.extend(bytes);
}

/// Read a list of bytes that `write_bytes` wrote.
pub(super) fn read_bytes<'a>(from: &mut Reader<'a>) -> Result<&'a [u8], Damaged> {
    let length = from.length()?;
    from.take(length)
}

/// The number of this rank.
pub(super) fn rank() -> usize {
    SimpleCommunicator::world().rank() as usize
}

/// End all ranks immediately.
pub(super) fn abort() -> ! {
    SimpleCommunicator::world().abort(1)
}

/// The time to sleep before the next look for messages. It is zero at first and grows with every
/// look; a new `Pause` is begun when a message has come.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Pause(u32);

impl Pause {
    const LONGEST: Duration = Duration::from_millis(20);

    /// The time to sleep now.
    pub fn next(&mut self) -> Duration {
        let pause = Duration::from_millis(1) * self.0.div_ceil(4);
        self.0 += 1;
        pause.min(Pause::LONGEST)
    }
}
