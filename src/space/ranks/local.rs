//! Ranks that are threads of one process.

use super::Communicator;
use std::sync::mpsc::{Receiver, Sender, channel};
use std::sync::{Arc, Mutex};

/// One of several threads that know each other.
pub struct Local {
    rank: usize,
    to: Vec<Sender<Vec<u8>>>,
    from: Vec<Mutex<Receiver<Vec<u8>>>>,
}

/// So many that know each other.
pub fn ranks(size: usize) -> Vec<Arc<Local>> {
    let mut to: Vec<Vec<Sender<Vec<u8>>>> = (0..size).map(|_| Vec::new()).collect();
    let mut from: Vec<Vec<Mutex<Receiver<Vec<u8>>>>> = (0..size).map(|_| Vec::new()).collect();
    for to in &mut to {
        for from in &mut from {
            let (sender, receiver) = channel();
            to.push(sender);
            from.push(Mutex::new(receiver));
        }
    }
    let ranks = to.into_iter().zip(from).enumerate();
    ranks
        .map(|(rank, (to, from))| Arc::new(Local { rank, to, from }))
        .collect()
}

impl Communicator for Local {
    fn rank(&self) -> usize {
        self.rank
    }

    fn size(&self) -> usize {
        self.to.len()
    }

    fn exchange_while(
        &self,
        to: &[(usize, Vec<u8>)],
        from: &[(usize, Option<usize>)],
        meanwhile: &mut dyn FnMut(),
    ) -> Vec<Vec<u8>> {
        for (rank, bytes) in to {
            self.to[*rank]
                .send(bytes.clone())
                .expect("the other rank runs");
        }
        meanwhile();
        let receive = |&(rank, _): &(usize, _)| {
            let from = self.from[rank]
                .lock()
                .expect("no other thread of this rank");
            from.recv().expect("the other rank runs")
        };
        from.iter().map(receive).collect()
    }
}
