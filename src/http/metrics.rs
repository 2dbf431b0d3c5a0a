//! GET /metrics: the activity and the contents of the service, for Prometheus.

use std::fmt::{Display, Write};

use axum::extract::{MatchedPath, Request, State};
use axum::http::header;
use axum::middleware::Next;
use axum::response::{IntoResponse, Response};

use super::app::{App, SharedApp};
use super::request_counts::RequestCounts;
use crate::service::peer::QuotaKind;
use crate::service::pool::Lane;
use crate::service::tally::BOUNDS_MS;

/// Counts and logs the answers of the router, by route.
pub(super) async fn counted(State(app): State<SharedApp>, request: Request, next: Next) -> Response {
    let method = request.method().clone();
    let route = request.extensions().get::<MatchedPath>().map_or("none", MatchedPath::as_str).to_owned();
    let begun = app.desk.clock().now();
    let response = next.run(request).await;
    let (status, took) = (response.status().as_u16(), app.desk.clock().now().saturating_sub(begun));
    // not the path, as signatures and jobs do not belong in logs
    tracing::info!(%method, route, status, took_ms = took.as_secs_f64() * 1000.0, "answered");
    app.requests.count(&method, &route, response.status().as_u16());
    response
}

/// Counters and gauges in the text format of Prometheus; all labels are of closed sets.
#[utoipa::path(
    get, path = "/metrics", tag = "operations",
    responses((status = 200, description = "The metrics", body = String, content_type = "text/plain",
        example = "# TYPE planish_jobs_known gauge\nplanish_jobs_known 0\n"))
)]
pub(super) async fn metrics(State(app): State<SharedApp>) -> Response {
    ([(header::CONTENT_TYPE, "text/plain; version=0.0.4")], text(&app)).into_response()
}

/// A page of metrics that is being written.
#[derive(Default)]
struct MetricsPage(String);

impl MetricsPage {
    fn family(&mut self, name: &str, kind: &str, help: &str) {
        // writing to a string does not fail
        let _ = write!(self.0, "# HELP {name} {help}\n# TYPE {name} {kind}\n");
    }

    fn value(&mut self, name: &str, labels: &[(&str, &str)], value: impl Display) {
        let labels: Vec<String> = labels.iter().map(|(label, value)| format!("{label}=\"{value}\"")).collect();
        let labels = if labels.is_empty() { String::new() } else { format!("{{{}}}", labels.join(",")) };
        let _ = writeln!(self.0, "{name}{labels} {value}");
    }

    /// Writes a family with one label.
    fn by<'a, V: Display>(
        &mut self,
        (name, kind, help): (&str, &str, &str),
        label: &str,
        values: impl IntoIterator<Item = (&'a str, V)>,
    ) {
        self.family(name, kind, help);
        values.into_iter().for_each(|(of, value)| self.value(name, &[(label, of)], value));
    }

    /// Writes a family with one value.
    fn one(&mut self, (name, kind, help): (&str, &str, &str), value: impl Display) {
        self.family(name, kind, help);
        self.value(name, &[], value);
    }
}

fn text(app: &App) -> String {
    let mut page = MetricsPage::default();
    requests(&mut page, &app.requests);
    work(&mut page, app);
    stores(&mut page, app);
    page.0
}

fn requests(page: &mut MetricsPage, requests: &RequestCounts) {
    page.family("planish_requests_total", "counter", "Answers by method, route and status.");
    requests.each(|method, route, status, n| {
        let status = status.to_string();
        let labels = [("method", method), ("route", route), ("status", &status)];
        page.value("planish_requests_total", &labels, n);
    });
    page.one(("planish_sent_bytes_total", "counter", "Bytes of answers, without their heads."), requests.sent_bytes());
}

fn work(page: &mut MetricsPage, app: &App) {
    let (desk, counter, gauge) = (&app.desk, "counter", "gauge");
    let tally = &desk.tally;
    let ended = ("planish_computations_total", counter, "Computations by how they ended.");
    page.by(ended, "outcome", tally.computations());
    page.by(("planish_jobs_settled_total", counter, "Jobs by how they ended."), "outcome", tally.jobs());
    page.one(("planish_jobs_known", gauge, "Jobs of which something is known."), desk.jobs.n_known());
    let stage = "planish_stage_seconds";
    page.family(stage, "histogram", "Time of the stages of computations that were done.");
    for (name, histogram) in tally.stages() {
        let (buckets, count, sum) = histogram.read();
        for (bound, n) in BOUNDS_MS.iter().zip(buckets) {
            #[expect(clippy::cast_precision_loss, reason = "the bounds are few digits")]
            let bound = (*bound as f64 / 1000.0).to_string();
            page.value("planish_stage_seconds_bucket", &[("stage", name), ("le", &bound)], n);
        }
        page.value("planish_stage_seconds_bucket", &[("stage", name), ("le", "+Inf")], count);
        page.value("planish_stage_seconds_sum", &[("stage", name)], sum.as_secs_f64());
        page.value("planish_stage_seconds_count", &[("stage", name)], count);
    }
    let [short, long] = desk.pool.waiting();
    let waiting = [
        ("reading", desk.pool.waiting_to_be_read()),
        ("short", short),
        ("long", long),
        ("jobs-short", desk.queue.waiting(Lane::Short)),
        ("jobs-long", desk.queue.waiting(Lane::Long)),
    ];
    page.by(("planish_queue_waiting", gauge, "Jobs and computations that wait, by line."), "line", waiting);
    page.one(("planish_computations_under_way", gauge, "Computations that wait or run."), desk.n_under_way());
    page.one(("planish_keys", gauge, "Keys that are let in; 0 where there are none."), app.gate.n_keys());
    page.one(
        ("planish_requests_in_flight", gauge, "Requests for work under a bound."),
        desk.peers.held(QuotaKind::InFlight),
    );
    page.one(("planish_listeners", gauge, "Clients that listen to events."), desk.peers.held(QuotaKind::Listening));
    let [made_room, refused] = app.connections.crowding();
    let crowding = [("made_room", made_room), ("refused", refused)];
    page.by(("planish_connections_crowded_total", counter, "Connections that were too many."), "what", crowding);
    page.one(("planish_connections", gauge, "Connections that are open."), app.connections.n_open());
    if let Some((age, _)) = app.canary.last_success() {
        let since = ("planish_canary_age_seconds", gauge, "Time since the canary job last succeeded.");
        page.one(since, age.as_secs_f64());
    }
}

fn stores(page: &mut MetricsPage, app: &App) {
    let (desk, counter, gauge) = (&app.desk, "counter", "gauge");
    let found = ("planish_results_found_total", counter, "Looks for results by the tier that had them.");
    page.by(found, "tier", desk.tally.lookups());
    let shares: Vec<_> =
        desk.account.shares().into_iter().map(|share| (share.name, share.usage(), share.capacity)).collect();
    let taken = ("planish_memory_taken_bytes", gauge, "Memory taken, by share.");
    page.by(taken, "share", shares.iter().map(|(name, usage, _)| (*name, usage.taken)));
    let capacity = ("planish_memory_capacity_bytes", gauge, "Memory there is, by share.");
    page.by(capacity, "share", shares.iter().map(|(name, _, capacity)| (*name, *capacity)));
    let refused = ("planish_memory_refused_total", counter, "Requests refused because a share was empty.");
    page.by(refused, "share", shares.iter().map(|(name, usage, _)| (*name, usage.refused)));
    let tiers = desk.stores();
    let artifacts = ("planish_store_artifacts", gauge, "Files or results held.");
    page.by(artifacts, "store", tiers.iter().map(|(name, usage)| (*name, usage.artifacts)));
    let bytes = ("planish_store_bytes", gauge, "What they take.");
    page.by(bytes, "store", tiers.iter().map(|(name, usage)| (*name, usage.bytes)));
    let evicted = ("planish_store_evicted_total", counter, "Those that left for others.");
    page.by(evicted, "store", tiers.iter().map(|(name, usage)| (*name, usage.evicted)));
    let damaged = ("planish_store_damaged_total", counter, "Those that were found damaged and dropped.");
    page.by(damaged, "store", tiers.iter().map(|(name, usage)| (*name, usage.damaged)));
    let away = ("planish_store_away", gauge, "1 while the store does not answer; the service goes on without it.");
    page.by(away, "store", tiers.iter().map(|(name, usage)| (*name, u8::from(usage.away))));
    let disk = ("planish_disk_events_total", counter, "What happened to results on their way to and from the disk.");
    page.by(disk, "event", desk.tiers.disk_counts().list());
}
