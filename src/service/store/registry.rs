//! The stores that can stand behind the memory; the only place that lists them.

use super::embedded;
use super::interface::StoreKind;
use super::s3;

/// Every kind; the first is the usual one.
pub const STORES: &[StoreKind] = &[embedded::KIND, s3::KIND];
