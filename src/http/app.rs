//! What every handler knows.

use std::sync::{Arc, LazyLock};

use super::canary::Canary;
use super::connections::Connections;
use super::gate::Gate;
use super::memo::Memo;
use super::request_counts::Requests;
use super::short::Short;
use crate::config::Settings;
use crate::service::desk::Desk;
use crate::service::rate::Rates;

/// What every handler knows.
#[derive(Debug)]
pub struct App {
    /// Finds and makes artifacts.
    pub desk: Arc<Desk>,
    /// The settings of this service.
    pub settings: Settings,
    /// Who is let in.
    pub gate: Arc<Gate>,
    /// How much each client has asked for lately.
    pub rates: Rates,
    /// The job that shows whether the service works.
    pub canary: Arc<Canary>,
    /// What was asked lately.
    pub memo: Memo,
    /// What was answered lately, and can be answered again without the router.
    pub short: Short,
    /// What was answered, counted.
    pub(super) requests: Requests,
    /// The connections that are open.
    pub connections: Arc<Connections>,
    /// The OpenAPI document, written when it is first asked for.
    pub openapi: LazyLock<String>,
}

/// The state of the router.
pub(super) type Shared = Arc<App>;
