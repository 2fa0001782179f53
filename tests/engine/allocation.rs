//! An allocator that counts what one thread asks of it.

use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;

struct Counting;

thread_local! {
    /// Allocations of this thread since it began to count, if it does.
    static COUNT: Cell<Option<usize>> = const { Cell::new(None) };
    /// Bytes that this thread has now and had at most beyond those when it began to count, if it
    /// does.
    static HELD: Cell<Option<(isize, isize)>> = const { Cell::new(None) };
}

fn note() {
    // A thread that is going away counts no more.
    let _ = COUNT.try_with(|count| count.set(count.get().map(|n| n + 1)));
}

fn hold(more: usize, less: usize) {
    let change = |(now, most): (isize, isize)| {
        let before = most.max(now + more as isize);
        (now + more as isize - less as isize, before)
    };
    let _ = HELD.try_with(|held| held.set(held.get().map(change)));
}

// SAFETY: the allocator of the system does all the work.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        note();
        hold(layout.size(), 0);
        // SAFETY: the caller promises the same.
        unsafe { System.alloc(layout) }
    }
    unsafe fn alloc_zeroed(&self, layout: Layout) -> *mut u8 {
        note();
        hold(layout.size(), 0);
        // SAFETY: the caller promises the same.
        unsafe { System.alloc_zeroed(layout) }
    }
    unsafe fn realloc(&self, old: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        note();
        hold(size, layout.size());
        // SAFETY: the caller promises the same.
        unsafe { System.realloc(old, layout, size) }
    }
    unsafe fn dealloc(&self, old: *mut u8, layout: Layout) {
        hold(0, layout.size());
        // SAFETY: the caller promises the same.
        unsafe { System.dealloc(old, layout) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

/// Allocations and reallocations of this thread while `work` runs.
pub fn counted(work: impl FnOnce()) -> usize {
    COUNT.set(Some(0));
    work();
    COUNT.take().unwrap()
}

/// Bytes that this thread held at most at a time while `work` ran, beyond those at its start; while
/// an array grows, both the old and the new one count.
pub fn peak(work: impl FnOnce()) -> usize {
    HELD.set(Some((0, 0)));
    work();
    HELD.take().unwrap().1 as usize
}

#[test]
fn allocations_are_counted() {
    let mut kept = Vec::new();
    assert_eq!(counted(|| kept.push(1u64)), 1);
    assert_eq!(counted(|| kept[0] += 1), 0);
    assert_eq!(counted(|| kept.reserve(1000)), 1);
    assert_eq!(counted(|| drop(vec![0u8; 1 << 20])), 1);
}

#[test]
fn the_most_bytes_at_a_time_are_counted() {
    assert_eq!(peak(|| drop(vec![0u8; 1 << 20])), 1 << 20);
    let grown = peak(|| {
        drop(vec![0u8; 1 << 20]);
        let mut kept = Vec::<u8>::with_capacity(1 << 10);
        kept.reserve_exact(1 << 19);
    });
    assert_eq!(grown, 1 << 20);
    let two = peak(|| drop((vec![0u8; 1000], vec![0u8; 500])));
    assert_eq!(two, 1500);
}
