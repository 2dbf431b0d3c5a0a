//! The shared store in a bucket of S3, or of another object store with the same protocol.

use std::fs::File;
use std::io;
use std::sync::Arc;
use std::time::Duration;

use object_store::aws::{AmazonS3, AmazonS3Builder};
use object_store::client::{HttpClient, HttpConnector};
use object_store::{BackoffConfig, ClientOptions, RetryConfig};

use super::error::StoreError;
use super::files;
use super::interface::{Bucket, Connect, Store, StoreKind};
use super::records::{RECORDS_FILE, RecordFile, Records};
use super::shared::BucketStore;

/// Maximum number of retries of a call within its time limit. Half of it would fail while one machine of the store
/// restarts; with twice of it the time limit ends first.
const MAX_RETRIES: usize = 2;
/// Shortest and longest pause before a retry: they give a busy machine of the store some time, and all pauses together
/// stay below the time limit of a lookup. Half of them would retry twice as fast on a busy store; twice of them would
/// outlast a lookup.
const RETRY_PAUSES: (Duration, Duration) = (Duration::from_millis(50), Duration::from_millis(500));

/// The entry of this store in the list of stores. The records of jobs stay in the folder of the server that accepted
/// them.
pub(super) const S3_STORE: StoreKind = StoreKind {
    name: "s3",
    in_folder: false,
    open: |place| {
        let bucket: Arc<AmazonS3> = Arc::new(client(&place.bucket, place.connect)?);
        Ok(Arc::new(BucketStore::open(bucket, place)?) as Arc<dyn Store>)
    },
    records: |dir| {
        let held = files::take_hold(dir)?;
        Ok(Arc::new(HeldRecords { records: RecordFile::open(&dir.join(RECORDS_FILE))?, _held: held }))
    },
};

/// Makes the HTTP clients for the bucket and for the services that issue credentials.
#[derive(Debug)]
struct Connector(Connect);

impl HttpConnector for Connector {
    fn connect(&self, _: &ClientOptions) -> object_store::Result<HttpClient> {
        (self.0)()
    }
}

/// The records in a folder that this process has locked.
#[derive(Debug)]
struct HeldRecords {
    records: RecordFile,
    _held: Vec<File>,
}

impl Records for HeldRecords {
    fn each(&self, tell: &mut dyn FnMut(&[u8], &[u8])) -> Result<(), StoreError> {
        self.records.each(tell)
    }

    fn write(&self, changes: &[(Vec<u8>, Option<Vec<u8>>)]) -> Result<(), StoreError> {
        self.records.write(changes)
    }

    fn check(&self) -> Result<(), StoreError> {
        self.records.check()
    }
}

/// Makes a client of a bucket. Credentials come from the environment variables `AWS_...`, or from the metadata services
/// of AWS machines and containers; values in `bucket` take precedence over the variables.
fn client(bucket: &Bucket, connect: Connect) -> Result<AmazonS3, StoreError> {
    if bucket.name.is_empty() {
        return Err(wrong("no bucket is given; name one with --s3-bucket"));
    }
    let is_address = ["http://", "https://"].iter().any(|scheme| bucket.endpoint.starts_with(scheme));
    if !bucket.endpoint.is_empty() && !is_address {
        return Err(wrong("the endpoint is no address; write it like https://s3.example.org"));
    }
    let backoff = BackoffConfig { init_backoff: RETRY_PAUSES.0, max_backoff: RETRY_PAUSES.1, base: 2.0 };
    let retry = RetryConfig { backoff, max_retries: MAX_RETRIES, retry_timeout: super::calls::CALL_TIMEOUT };
    let mut builder = AmazonS3Builder::from_env()
        .with_bucket_name(&bucket.name)
        .with_retry(retry)
        .with_http_connector(Connector(connect))
        .with_disable_tagging(true)
        // Single deletions work on every store; bulk deletions do not.
        .with_disable_bulk_delete(true);
    if !bucket.region.is_empty() {
        builder = builder.with_region(&bucket.region);
    }
    if !bucket.endpoint.is_empty() {
        builder = builder.with_endpoint(&bucket.endpoint);
    }
    builder.build().map_err(|error| wrong(&error.to_string()))
}

fn wrong(detail: &str) -> StoreError {
    io::Error::new(io::ErrorKind::InvalidInput, detail.to_owned()).into()
}
