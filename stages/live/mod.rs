//! `--live`: viewers that see an impact while it runs.

#[cfg(feature = "live")]
mod server;

use std::sync::Arc;

use anyhow::Result;
use coronet::record::log::Tap;

/// Where viewers look first.
pub const ADDRESS: &str = "127.0.0.1:8765";

/// Makes what shows a log to viewers.
pub type Viewers = Arc<dyn Fn() -> Tap + Send + Sync>;

/// Waits for viewers at `address`; `None` without one.
///
/// # Errors
/// If nobody can be served there.
pub fn open(address: Option<&str>) -> Result<Option<Viewers>> {
    address.map(serve).transpose()
}

#[cfg(feature = "live")]
fn serve(address: &str) -> Result<Viewers> {
    server::start(address)
}

#[cfg(not(feature = "live"))]
fn serve(_: &str) -> Result<Viewers> {
    anyhow::bail!(crate::fault::Usage(
        "--live: this program was built without it; build it with `--features live`".to_string()
    ))
}
