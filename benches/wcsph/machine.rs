//! What the machine can do: bandwidth of the memory and peak of the arithmetic.

use crate::meter::line;
use coronet::space::lane::wide;
use rayon::ThreadPool;
use rayon::prelude::*;
use std::hint::black_box;
use std::time::Instant;

/// Words of each of the three arrays of the triad: 128 MiB, far out of every cache.
const WORDS: usize = 1 << 24;

/// Registers' worth of independent sums, so that the latency of one does not show.
const CHAINS: usize = 12;

/// Prints both; the bandwidth on each number of threads, GB/s.
pub fn measure(threads: &[ThreadPool; 2]) -> [f64; 2] {
    let mut bandwidth = [0.0; 2];
    let mut a = vec![0.0f64; WORDS];
    let (b, c) = (vec![1.0f64; WORDS], vec![2.0f64; WORDS]);
    for (k, pool) in threads.iter().enumerate() {
        let bytes = 24.0 * WORDS as f64;
        let seconds = best(7, || pool.install(|| triad(&mut a, &b, &c)));
        let name = format!("machine.triad.t{}", k + 1);
        bandwidth[k] = 1e-9 * bytes / seconds;
        line(&name, bandwidth[k], "GB/s");
    }
    for (k, pool) in threads.iter().enumerate() {
        let rounds = 20_000_000usize;
        let each = |_| {
            black_box(chains(black_box(rounds)));
        };
        let both = || (0..=k).into_par_iter().for_each(each);
        let seconds = best(5, || pool.install(both));
        let operations = (k + 1) as f64 * (2 * 8 * CHAINS * rounds) as f64;
        let name = format!("machine.fma_f32.t{}", k + 1);
        line(&name, 1e-9 * operations / seconds, "GFLOP/s");
    }
    bandwidth
}

/// Least wall seconds of several repeats: what disturbs only adds.
fn best(repeats: usize, mut work: impl FnMut()) -> f64 {
    let mut least = f64::INFINITY;
    for _ in 0..repeats {
        let start = Instant::now();
        work();
        least = least.min(start.elapsed().as_secs_f64());
    }
    least
}

/// a = b + s c (STREAM).
fn triad(a: &mut [f64], b: &[f64], c: &[f64]) {
    let size = 1 << 16;
    let parts = a
        .par_chunks_mut(size)
        .zip(b.par_chunks(size))
        .zip(c.par_chunks(size));
    parts.for_each(|((a, b), c)| {
        for ((a, b), c) in a.iter_mut().zip(b).zip(c) {
            *a = b + 3.0 * c;
        }
    });
    black_box(a);
}

fn chains(rounds: usize) -> f32 {
    #[cfg(target_arch = "x86_64")]
    if wide() {
        // SAFETY: `wide` has found the features.
        return unsafe { chains_avx2(rounds) };
    }
    assert!(!wide());
    run(rounds)
}

/// # Safety
/// The processor has AVX2 and FMA.
#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma")]
unsafe fn chains_avx2(rounds: usize) -> f32 {
    run(rounds)
}

#[inline(always)]
fn run(rounds: usize) -> f32 {
    let mut sums = [[1.0f32; 8]; CHAINS];
    let (scale, add) = (black_box(0.999f32), black_box(0.001f32));
    for _ in 0..rounds {
        for sum in &mut sums {
            for lane in sum {
                *lane = lane.mul_add(scale, add);
            }
        }
    }
    sums.iter().flatten().sum()
}
