//! The state that all handlers share.

use std::sync::{Arc, LazyLock};

use super::canary::Canary;
use super::connections::Connections;
use super::gate::Gate;
use super::memo::Memo;
use super::request_counts::RequestCounts;
use super::short::Short;
use crate::config::Settings;
use crate::service::desk::Desk;
use crate::service::rate::Rates;

/// The state that all handlers share.
#[derive(Debug)]
pub struct App {
    /// The desk, which finds and computes artifacts.
    pub desk: Arc<Desk>,
    /// The settings of this service.
    pub settings: Settings,
    /// The check of the clients' keys.
    pub gate: Arc<Gate>,
    /// The recent number of requests of each client, for the limit per minute.
    pub rates: Rates,
    /// The job that runs regularly to show whether the service works.
    pub canary: Arc<Canary>,
    /// The keys of the results of recent requests.
    pub memo: Memo,
    /// Recent answers that can be sent again without the router.
    pub short: Short,
    /// The numbers of answers, and of their bytes.
    pub(super) requests: RequestCounts,
    /// The open connections.
    pub connections: Arc<Connections>,
    /// The OpenAPI document, written at its first use.
    pub openapi: LazyLock<String>,
}

/// The state of the router.
pub(super) type SharedApp = Arc<App>;
