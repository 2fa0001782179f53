//! A remote store in a bucket of a service that speaks S3. The bucket and a prefix come from the
//! URL; credentials, region and endpoint from the environment variables `AWS_*`.

use std::fs::File;
use std::future::Future;
use std::io::{Read as _, Write};
use std::path::Path;
use std::time::Duration;

use anyhow::{Context as _, Result};
use coronet::file::{self, FileError};
use coronet::pipeline::remote::{Objects, RemoteError};
use object_store::aws::{AmazonS3, AmazonS3Builder};
use object_store::{
    Error, MultipartUpload, ObjectStore, ObjectStoreExt as _, PutMode, PutOptions, RetryConfig,
};
use tokio::runtime::{Builder, Runtime};

use crate::fault::Usage;

/// Bytes of one request: each has its own time limit, 30 s unless AWS_TIMEOUT sets it.
const PIECE: u64 = 8 << 20;

/// Objects in a bucket.
pub struct S3 {
    bucket: AmazonS3,
    prefix: String,
    place: String,
    runtime: Runtime,
}

impl S3 {
    /// Connects to nothing yet.
    pub fn open(url: &str) -> Result<S3> {
        // Fails if there is one already, which is as good.
        let _ = rustls::crypto::ring::default_provider().install_default();
        let path = url.strip_prefix("s3://").unwrap_or(url);
        let (name, prefix) = path.split_once('/').unwrap_or((path, ""));
        let retry = RetryConfig {
            max_retries: 2,
            retry_timeout: Duration::from_secs(20),
            ..RetryConfig::default()
        };
        let builder = AmazonS3Builder::from_env().with_bucket_name(name);
        let bucket = builder.with_retry(retry).build();
        let wrong = |error: Error| Usage(format!("--remote {url}: {}", short(&error)));
        let mut runtime = Builder::new_current_thread();
        Ok(S3 {
            bucket: bucket.map_err(wrong)?,
            prefix: prefix.trim_matches('/').to_string(),
            place: url.to_string(),
            runtime: runtime.enable_all().build().context("cannot wait for S3")?,
        })
    }

    fn path(&self, name: &str) -> object_store::path::Path {
        object_store::path::Path::from(format!("{}/{name}", self.prefix))
    }

    fn wait<T>(&self, work: impl Future<Output = T>) -> T {
        self.runtime.block_on(work)
    }

    /// Puts a file in pieces.
    fn put_long(&self, name: &str, file: &Path) -> Result<(), RemoteError> {
        let path = self.path(name);
        let mut upload = self
            .wait(self.bucket.put_multipart(&path))
            .map_err(unusable)?;
        let sent = self.send(upload.as_mut(), file);
        if sent.is_err() {
            // What cannot be taken back is no object.
            let _ = self.wait(upload.abort());
        }
        sent
    }

    fn send(&self, upload: &mut dyn MultipartUpload, path: &Path) -> Result<(), RemoteError> {
        let mut file = file::open_no_link(path)?;
        loop {
            let piece = read_piece(&mut file, path)?;
            if piece.is_empty() {
                break;
            }
            self.wait(upload.put_part(piece.into())).map_err(unusable)?;
        }
        self.wait(upload.complete()).map_err(unusable)?;
        Ok(())
    }
}

fn read_piece(file: &mut File, path: &Path) -> Result<Vec<u8>, RemoteError> {
    let mut piece = Vec::new();
    let read = file.take(PIECE).read_to_end(&mut piece);
    read.map_err(FileError::new(path, "read"))?;
    Ok(piece)
}

impl Objects for S3 {
    fn place(&self) -> String {
        self.place.clone()
    }

    fn get(&self, name: &str, limit: u64, to: &mut dyn Write) -> Result<bool, RemoteError> {
        let Some(size) = self.size(name)? else {
            return Ok(false);
        };
        if size > limit {
            let what = format!("is longer than {limit} bytes");
            return Err(RemoteError::bad(name, what));
        }
        let path = self.path(name);
        for start in (0..size).step_by(PIECE as usize) {
            let range = start..size.min(start + PIECE);
            let length = range.end - start;
            let piece = match self.wait(self.bucket.get_range(&path, range)) {
                Err(Error::NotFound { .. }) => return Err(RemoteError::bad(name, "has gone")),
                other => other.map_err(unusable)?,
            };
            if piece.len() as u64 != length {
                return Err(RemoteError::bad(name, "is cut off"));
            }
            to.write_all(&piece)
                .map_err(FileError::new(Path::new(name), "keep"))?;
        }
        Ok(true)
    }

    fn size(&self, name: &str) -> Result<Option<u64>, RemoteError> {
        match self.wait(self.bucket.head(&self.path(name))) {
            Err(Error::NotFound { .. }) => Ok(None),
            other => Ok(Some(other.map_err(unusable)?.size)),
        }
    }

    fn put(&self, name: &str, file: &Path, replace: bool) -> Result<bool, RemoteError> {
        let mut source = file::open_no_link(file)?;
        let first = read_piece(&mut source, file)?;
        // Only an object of one piece can be put on a condition. Longer ones are named after what
        // they hold.
        if first.len() as u64 == PIECE {
            let is_there = !replace && self.size(name)?.is_some();
            return match is_there {
                true => Ok(false),
                false => self.put_long(name, file).map(|()| true),
            };
        }
        let mode = match replace {
            true => PutMode::Overwrite,
            false => PutMode::Create,
        };
        let options = PutOptions::from(mode);
        let path = self.path(name);
        match self.wait(self.bucket.put_opts(&path, first.into(), options)) {
            Err(Error::AlreadyExists { .. } | Error::Precondition { .. }) => Ok(false),
            other => other.map(|_| true).map_err(unusable),
        }
    }
}

/// Why the service cannot be used, in a word that leads on.
fn unusable(error: Error) -> RemoteError {
    let remedy = match &error {
        Error::PermissionDenied { .. } | Error::Unauthenticated { .. } => {
            "no permission; check AWS_ACCESS_KEY_ID, AWS_SECRET_ACCESS_KEY and the rights of the \
             bucket: "
        }
        Error::NotFound { .. } => "no such bucket: ",
        _ => "it cannot be reached or does not answer as S3 does: ",
    };
    RemoteError::Unusable(format!("{remedy}{}", short(&error)))
}

/// The innermost cause, in one line.
fn short(error: &dyn std::error::Error) -> String {
    let mut cause = error;
    while let Some(next) = cause.source() {
        cause = next;
    }
    let text = cause.to_string();
    text.lines()
        .next()
        .unwrap_or_default()
        .chars()
        .take(300)
        .collect()
}
