//! Ranks that are processes of MPI.

use std::sync::Mutex;

use anyhow::{Context as _, Result, ensure};
use coronet::space::ranks::Communicator;
use mpi::Threading;
use mpi::environment::Universe;
use mpi::request::multiple_scope;
use mpi::topology::SimpleCommunicator;
use mpi::traits::{Communicator as _, Destination as _, Source as _};

/// Most bytes of a message: their number must be an `int` of C. What is longer goes in pieces, of
/// which only the last is shorter than this.
const PIECE: usize = 1 << 30;

static UNIVERSE: Mutex<Option<Universe>> = Mutex::new(None);

/// All processes of the launch.
pub struct World {
    rank: usize,
    size: usize,
}

impl World {
    /// Joins the others.
    pub fn join() -> Result<Self> {
        let joined = mpi::initialize_with_threading(Threading::Serialized);
        let (universe, found) = joined.context("MPI has started twice")?;
        ensure!(
            found >= Threading::Serialized,
            "this MPI library lets only the main thread of a program communicate; use one with \
             MPI_THREAD_SERIALIZED"
        );
        let world = universe.world();
        let (rank, size) = (world.rank() as usize, world.size() as usize);
        *UNIVERSE.lock().expect("only held for a moment") = Some(universe);
        Ok(World { rank, size })
    }

    /// Leaves the others.
    pub fn leave() {
        UNIVERSE.lock().expect("only held for a moment").take();
    }
}

impl Communicator for World {
    fn rank(&self) -> usize {
        self.rank
    }

    fn size(&self) -> usize {
        self.size
    }

    fn exchange_while(
        &self,
        to: &[(usize, Vec<u8>)],
        from: &[(usize, Option<usize>)],
        meanwhile: &mut dyn FnMut(),
    ) -> Vec<Vec<u8>> {
        let world = SimpleCommunicator::world();
        let at = |rank: usize| world.process_at_rank(rank as i32);
        let pieces = |size: usize| size / PIECE + 1;
        let of_length = |(_, size): &(usize, Option<usize>)| vec![0; size.unwrap_or(0)];
        let mut received: Vec<Vec<u8>> = from.iter().map(of_length).collect();
        let coming = from.iter().filter_map(|(_, size)| size.map(pieces)).sum();
        let going = to.iter().map(|(_, bytes)| pieces(bytes.len())).sum();
        multiple_scope(going, |sends, sending| {
            multiple_scope(coming, |receives, receiving| {
                for ((rank, size), bytes) in from.iter().zip(&mut received) {
                    let mut left = &mut bytes[..];
                    for _ in 0..size.map_or(0, pieces) {
                        let (piece, rest) = left.split_at_mut(left.len().min(PIECE));
                        receiving.add(at(*rank).immediate_receive_into(receives, piece));
                        left = rest;
                    }
                }
                for (rank, bytes) in to {
                    for k in 0..pieces(bytes.len()) {
                        let piece = &bytes[k * PIECE..bytes.len().min((k + 1) * PIECE)];
                        sending.add(at(*rank).immediate_send(sends, piece));
                    }
                }
                meanwhile();
                receiving.wait_all(&mut Vec::new());
            });
            let unknown = from.iter().zip(&mut received);
            for ((rank, _), bytes) in unknown.filter(|((_, size), _)| size.is_none()) {
                let mut last = PIECE;
                while last == PIECE {
                    let more = at(*rank).receive_vec::<u8>().0;
                    last = more.len();
                    bytes.extend(more);
                }
            }
            sending.wait_all(&mut Vec::new());
        });
        received
    }
}
