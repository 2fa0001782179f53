//! The campaigns, whole, some minutes on two cores (see `docs/how-to/campaigns.md`):
//! `cargo test --release --test campaign -- --nocapture --test-threads 1`.

#![cfg(all(target_os = "linux", target_arch = "x86_64"))]

#[path = "campaign/beginning.rs"]
mod beginning;
#[path = "campaign/disk.rs"]
mod disk;
#[path = "campaign/fault.rs"]
mod fault;
#[path = "campaign/flip.rs"]
mod flip;
#[path = "campaign/kill.rs"]
mod kill;
#[path = "campaign/place.rs"]
mod place;
#[path = "campaign/power.rs"]
mod power;
#[path = "campaign/report.rs"]
mod report;
#[path = "campaign/syscalls.rs"]
mod syscalls;
#[path = "campaign/trace.rs"]
mod trace;

#[test]
fn every_call_fails() {
    fault::campaign(1);
}

#[test]
fn killed_before_every_call() {
    kill::campaign(1);
}

#[test]
fn power_cut_after_every_act() {
    power::campaign(1);
}

#[test]
fn every_byte_changed_is_seen() {
    flip::campaign(1);
}
