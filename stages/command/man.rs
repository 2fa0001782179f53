//! `coronet man`: manual pages.

use std::path::Path;

use anyhow::{Context as _, Result};
use clap::CommandFactory as _;
use coronet::record::atomic::{create_folder, write_file};

use crate::arguments::Arguments;
use crate::print;

/// Writes a manual page of the program and of each command.
pub fn pages(folder: &Path) -> Result<()> {
    create_folder(folder)?;
    let program = Arguments::command();
    let commands = program.get_subcommands().cloned().map(|command| {
        let name = format!("coronet-{}", command.get_name());
        command.name(name)
    });
    for command in std::iter::once(program.clone()).chain(commands) {
        let path = folder.join(format!("{}.1", command.get_name()));
        let mut page = Vec::new();
        clap_mangen::Man::new(command).render(&mut page)?;
        write_file(&path, &page).with_context(|| format!("cannot write {}", path.display()))?;
        print::out!("{}", path.display());
    }
    Ok(())
}
