//! Room for arrays that grow by little: an eighth more, and not the double, as a vector would take.
//! The number of particles of a rank changes with each sort, and every array follows.

/// Room for `more` entries.
#[inline(always)]
pub fn make_room<T>(all: &mut Vec<T>, more: usize) {
    let room = all.len() + more;
    if room > all.capacity() {
        all.reserve_exact(more + room / 8);
    }
}

/// `all` with `count` entries, new ones of `value`.
pub fn resize<T: Clone>(all: &mut Vec<T>, count: usize, value: T) {
    make_room(all, count.saturating_sub(all.len()));
    all.resize(count, value);
}
