//! The list of the stores that the settings can name; no other module lists them.

use super::embedded;
use super::interface::StoreKind;
use super::s3;

/// Every kind of store; the first is the default.
pub const STORES: &[StoreKind] = &[embedded::FOLDER_STORE, s3::S3_STORE];
