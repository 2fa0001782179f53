//! `coronet schema`: the formats of files.

use anyhow::{Result, bail};

use crate::arguments::{FileKind, SchemaArguments};
use crate::fault::Usage;
use crate::print::out;

pub fn schema(arguments: &SchemaArguments) -> Result<()> {
    let schema = match (arguments.of, arguments.markdown) {
        (FileKind::Pipeline, false) => coronet::scene::file::json_schema(),
        (FileKind::Pipeline, true) => coronet::scene::reference::markdown(),
        (FileKind::Study, false) => crate::study::points::schema(),
        (FileKind::Study, true) => bail!(Usage(
            "--markdown: there is no page of studies; leave it out for the JSON schema".into()
        )),
    };
    out!("{}", schema.trim_end());
    Ok(())
}
