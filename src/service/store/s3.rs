//! The shared store in a bucket of S3, or of what speaks its protocol.

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
use super::shared::Shared;

/// How often a call is tried again, within its own time. Half of it fails where one machine of the store restarts;
/// twice of it has its time run out first.
const RETRIES: usize = 2;
/// Shortest and longest pause before a try: a machine of the store that is busy is given a moment, and all pauses
/// together stay below a look's own time. Half of them ask a busy store twice as fast; twice of them outlast a look.
const PAUSES: (Duration, Duration) = (Duration::from_millis(50), Duration::from_millis(500));

/// The store as the settings name it. What is known of jobs stays in the folder of the server that accepted them.
pub(super) const KIND: StoreKind = StoreKind {
    name: "s3",
    in_folder: false,
    open: |place| {
        let bucket: Arc<AmazonS3> = Arc::new(client(&place.bucket, place.connect)?);
        Ok(Arc::new(Shared::open(bucket, place)?) as Arc<dyn Store>)
    },
    records: |dir| {
        let held = files::take_hold(dir)?;
        Ok(Arc::new(HeldRecords { records: RecordFile::open(&dir.join(RECORDS_FILE))?, _held: held }))
    },
};

/// Makes the clients of a bucket, and of those who give out its credentials.
#[derive(Debug)]
struct Connector(Connect);

impl HttpConnector for Connector {
    fn connect(&self, _: &ClientOptions) -> object_store::Result<HttpClient> {
        (self.0)()
    }
}

/// Records in a folder that nothing else holds.
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
}

/// A client of a bucket. Credentials come from the variables `AWS_...`, or from where a machine or a container of AWS
/// gets its own; what is given here is stronger than the variables.
fn client(bucket: &Bucket, connect: Connect) -> Result<AmazonS3, StoreError> {
    if bucket.name.is_empty() {
        return Err(wrong("no bucket is given; name one with --s3-bucket"));
    }
    let is_address = ["http://", "https://"].iter().any(|scheme| bucket.endpoint.starts_with(scheme));
    if !bucket.endpoint.is_empty() && !is_address {
        return Err(wrong("the endpoint is no address; write it like https://s3.example.org"));
    }
    let backoff = BackoffConfig { init_backoff: PAUSES.0, max_backoff: PAUSES.1, base: 2.0 };
    let retry = RetryConfig { backoff, max_retries: RETRIES, retry_timeout: super::calls::PATIENCE };
    let mut builder = AmazonS3Builder::from_env()
        .with_bucket_name(&bucket.name)
        .with_retry(retry)
        .with_http_connector(Connector(connect))
        .with_disable_tagging(true)
        // one at a time, which every store knows
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
