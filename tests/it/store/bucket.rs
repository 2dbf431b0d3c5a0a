//! A bucket in memory that can be unreachable, forbid access, and replace objects that it should keep.

use std::fmt;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

use async_trait::async_trait;
use axum::body::Bytes;
use futures_util::stream::BoxStream;
use object_store::memory::InMemory;
use object_store::path::Path;
use object_store::{
    CopyOptions, Error, GetOptions, GetResult, ListResult, MultipartUpload, ObjectMeta, ObjectStore, ObjectStoreExt,
    PutMode, PutMultipartOptions, PutOptions, PutPayload, PutResult, Result,
};
use planish::service::clock::{Clock, Monotonic};
use planish::service::store::{Bucket, BucketStore, StoreError, StoreLocation, StorePurpose};

/// A bucket with switchable faults; without any it works.
#[derive(Debug, Default)]
pub(crate) struct FaultyBucket {
    objects: InMemory,
    /// Whether all calls fail.
    pub(crate) away: AtomicBool,
    /// Whether calls never return.
    pub(crate) hangs: AtomicBool,
    /// Whether missing objects are reported as forbidden.
    pub(crate) forbids: AtomicBool,
    /// Whether `If-None-Match` is ignored.
    pub(crate) replaces: AtomicBool,
    /// Number of calls so far.
    pub(crate) calls: AtomicUsize,
}

impl fmt::Display for FaultyBucket {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a bucket with faults")
    }
}

impl FaultyBucket {
    pub(crate) fn new() -> Arc<Self> {
        Arc::default()
    }

    /// Opens a server's store in this bucket, with its own clock.
    pub(crate) fn open_at(
        self: &Arc<Self>,
        capacity: u64,
        clock: Arc<dyn Clock>,
    ) -> std::result::Result<BucketStore, StoreError> {
        let bucket = Bucket { prefix: "planish".to_owned(), ..Bucket::default() };
        let connect = || unreachable!("the bucket is in memory");
        let place = StoreLocation {
            dir: "/nowhere".into(),
            bucket,
            room: StorePurpose::Results,
            capacity_bytes: capacity,
            connect,
            clock,
        };
        BucketStore::open(Arc::clone(self) as Arc<dyn ObjectStore>, &place)
    }

    pub(crate) fn open(self: &Arc<Self>) -> BucketStore {
        self.open_at(super::ROOMY, Arc::new(Monotonic::default())).unwrap()
    }

    pub(crate) fn n_calls(&self) -> usize {
        self.calls.load(Ordering::SeqCst)
    }

    /// Returns the names of all objects that contain a text, in order.
    pub(crate) fn names(&self, with: &str) -> Vec<Path> {
        let listed = now(futures_util::TryStreamExt::try_collect::<Vec<_>>(self.objects.list(None))).unwrap();
        let mut names: Vec<Path> = listed.into_iter().map(|object| object.location).collect();
        names.retain(|name| name.as_ref().contains(with));
        names.sort();
        names
    }

    pub(crate) fn bytes(&self, name: &Path) -> Vec<u8> {
        now(async { self.objects.get(name).await.unwrap().bytes().await.unwrap() }).to_vec()
    }

    pub(crate) fn write(&self, name: &Path, bytes: Vec<u8>) {
        now(self.objects.put(name, PutPayload::from_bytes(Bytes::from(bytes)))).unwrap();
    }

    pub(crate) fn erase(&self, name: &Path) {
        now(self.objects.delete(name)).unwrap();
    }

    async fn fault(&self, path: &Path) -> Result<()> {
        self.calls.fetch_add(1, Ordering::SeqCst);
        if self.hangs.load(Ordering::SeqCst) {
            std::future::pending::<()>().await;
        }
        let source = || "<Error><AWSAccessKeyId>KEYID</AWSAccessKeyId></Error>".into();
        if self.away.load(Ordering::SeqCst) {
            return Err(Error::Generic { store: "S3", source: source() });
        }
        if self.forbids.load(Ordering::SeqCst) {
            return Err(Error::PermissionDenied { path: path.to_string(), source: source() });
        }
        Ok(())
    }
}

/// Runs a future that never waits.
fn now<T>(work: impl Future<Output = T>) -> T {
    tokio::runtime::Builder::new_current_thread().build().unwrap().block_on(work)
}

#[async_trait]
impl ObjectStore for FaultyBucket {
    async fn put_opts(&self, location: &Path, payload: PutPayload, mut opts: PutOptions) -> Result<PutResult> {
        self.fault(location).await?;
        if self.replaces.load(Ordering::SeqCst) {
            opts.mode = PutMode::Overwrite;
        }
        self.objects.put_opts(location, payload, opts).await
    }

    async fn put_multipart_opts(&self, to: &Path, opts: PutMultipartOptions) -> Result<Box<dyn MultipartUpload>> {
        self.objects.put_multipart_opts(to, opts).await
    }

    async fn get_opts(&self, location: &Path, options: GetOptions) -> Result<GetResult> {
        self.fault(location).await?;
        self.objects.get_opts(location, options).await
    }

    fn delete_stream(&self, locations: BoxStream<'static, Result<Path>>) -> BoxStream<'static, Result<Path>> {
        self.calls.fetch_add(1, Ordering::SeqCst);
        self.objects.delete_stream(locations)
    }

    fn list(&self, prefix: Option<&Path>) -> BoxStream<'static, Result<ObjectMeta>> {
        self.objects.list(prefix)
    }

    async fn list_with_delimiter(&self, prefix: Option<&Path>) -> Result<ListResult> {
        self.objects.list_with_delimiter(prefix).await
    }

    async fn copy_opts(&self, from: &Path, to: &Path, opts: CopyOptions) -> Result<()> {
        self.objects.copy_opts(from, to, opts).await
    }
}
