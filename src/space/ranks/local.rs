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

impl Local {
    fn send(&self, to: &[(usize, Vec<u8>)]) {
        for (rank, bytes) in to {
            let sent = self.to[*rank].send(bytes.clone());
            sent.expect("the other rank runs");
        }
    }

    fn receive(&self, rank: usize) -> Vec<u8> {
        let from = self.from[rank].lock();
        let from = from.expect("no other thread of this rank");
        from.recv().expect("the other rank runs")
    }
}

impl Communicator for Local {
    fn rank(&self) -> usize {
        self.rank
    }

    fn size(&self) -> usize {
        self.to.len()
    }

    fn exchange(&self, to: &[(usize, Vec<u8>)], from: &[usize]) -> Vec<Vec<u8>> {
        self.send(to);
        from.iter().map(|&rank| self.receive(rank)).collect()
    }

    fn exchange_while(
        &self,
        to: &[(usize, Vec<u8>)],
        from: &[(usize, usize)],
        meanwhile: &mut dyn FnMut(),
    ) -> Vec<Vec<u8>> {
        self.send(to);
        meanwhile();
        from.iter().map(|(rank, _)| self.receive(*rank)).collect()
    }
}
