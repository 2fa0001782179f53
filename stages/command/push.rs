//! `coronet push`: puts finished results into a remote store.

use std::collections::BTreeMap;
use std::path::PathBuf;

use anyhow::{Result, bail};
use coronet::pipeline::remote::{Put, Remote, RemoteError};
use coronet::pipeline::stamp::StampError;
use coronet::pipeline::{Stamp, Store};
use serde_json::json;

use super::run::no_remote;
use super::verify::existing;
use crate::arguments::PushArguments;
use crate::fault::{Unreadable, Untrusted};
use crate::print::{counted, note, out, shown};
use crate::remote;
use crate::runs::Run;

pub fn push(arguments: &PushArguments) -> Result<()> {
    let store = existing(&arguments.store.artifacts)?;
    let objects =
        remote::open(arguments.remote.url(), &arguments.store.artifacts)?.ok_or_else(no_remote)?;
    let remote = Remote::new(&*objects);
    // No clean-up removes what is on its way.
    let _shared = store.share(&mut |_| true)?;
    remote.tidy();
    let (mut new, mut known, mut bad) = (0, 0, 0);
    let mut unread = None;
    for (folder, stamp) in results(&store, &arguments.names, &mut bad, &mut unread)? {
        let word = match remote.put(&folder, &stamp) {
            Ok(Put::New) => {
                new += 1;
                "put"
            }
            Ok(Put::Known) => {
                known += 1;
                "known"
            }
            Err(RemoteError::Unusable(what)) => {
                bail!(Unreadable(format!(
                    "remote store {}: {what}",
                    remote.place()
                )))
            }
            Err(RemoteError::File(error)) => return Err(error.into()),
            Err(error) => {
                note!("warning: {}: {error}", stamp.label());
                bad += 1;
                "bad"
            }
        };
        match arguments.store.json {
            true => out!(
                "{}",
                json!({"stage": stamp.stage, "body": stamp.body, "key": stamp.key,
                    "digest": stamp.digest, "put": word})
            ),
            false => out!("{word:8} {:20} {}", stamp.label(), stamp.digest.short()),
        }
    }
    if !arguments.store.json {
        let place = remote.place();
        let put = counted(new, "result");
        out!("{put} put into {place}; {known} were there");
    }
    if bad > 0 {
        bail!(Untrusted(format!(
            "{bad} results were not put; `coronet verify` looks at those of this machine"
        )));
    }
    unread.map_or(Ok(()), |unread| Err(unread.into()))
}

/// The finished results that the names reach, or all; `bad`: plus those whose stamp is not valid;
/// `unread`: the first that cannot be read.
fn results(
    store: &Store,
    names: &[String],
    bad: &mut u32,
    unread: &mut Option<Unreadable>,
) -> Result<BTreeMap<PathBuf, Stamp>> {
    let mut results = BTreeMap::new();
    for name in names {
        let run = Run::meant(store, name)?;
        if let Some(folder) = run.gone.first() {
            bail!("{name}: the result in {} is gone", folder.display());
        }
        results.extend(run.results);
    }
    if names.is_empty() {
        for stage in store.stages()? {
            for folder in store.folders(&stage)? {
                match Stamp::read(&folder) {
                    Ok(stamp) => results.extend(stamp.map(|stamp| (folder, stamp))),
                    Err(StampError::File(error)) => {
                        note!("warning: {error}");
                        unread.get_or_insert(Unreadable(error.to_string()));
                    }
                    Err(error) => {
                        note!("warning: {}: {error}", shown(&folder));
                        *bad += 1;
                    }
                }
            }
        }
    }
    Ok(results)
}
