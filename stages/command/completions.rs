//! `coronet completions`: completion of the commands in a shell.

use anyhow::Result;
use clap::CommandFactory as _;
use clap_complete::Shell;

use crate::arguments::Arguments;
use crate::print;

/// Prints the completions of a shell.
pub fn completions(shell: Shell) -> Result<()> {
    let mut script = Vec::new();
    clap_complete::generate(shell, &mut Arguments::command(), "coronet", &mut script);
    print::out!("{}", String::from_utf8_lossy(&script).trim_end());
    Ok(())
}
