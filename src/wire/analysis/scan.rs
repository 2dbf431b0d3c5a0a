//! Requests for scans of a parameter, and their answers for each value and for the intervals between.

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use crate::analysis::scan::{Interval, Scan, ScanResult, ScanRow, Scanned};
use crate::job::RequestedScan;
use crate::math::exact::{Exact, rounded};
use crate::wire::literal::WireLiteral;
use crate::wire::schema;

/// A parameter that runs through values, each of which is analysed.
#[derive(Debug, Clone, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct ScanRequest {
    /// The name of a parameter of the plan with one number for its value; what the plan says of it does not count.
    pub parameter: String,
    /// The first value: a number, or a constant expression such as `"1/81"`, which is exact where it is a fraction.
    #[schema(schema_with = schema::end_of_scan)]
    pub from: WireLiteral,
    /// The last value, above the first.
    #[schema(schema_with = schema::end_of_scan)]
    pub to: WireLiteral,
    /// Equal steps between them; 100 when left out. A parameter of whole numbers has no more steps than there are such
    /// between the ends, and values are rounded down to them.
    #[schema(minimum = 1, maximum = 1000, default = 100)]
    pub steps: Option<u32>,
}

/// Default number of steps of a scan. Half as many show coarser curves; twice as many take twice as long.
const DEFAULT_STEPS: u32 = 100;

impl ScanRequest {
    /// Converts the scan, which is then checked against its plan.
    pub(super) fn resolve(self) -> RequestedScan {
        let Self { parameter, from, to, steps } = self;
        RequestedScan { parameter, from: from.0, to: to.0, steps: steps.unwrap_or(DEFAULT_STEPS) }
    }
}

/// What is proved of a scheme at each value of a parameter.
#[derive(Debug, Clone, Serialize, ToSchema)]
pub struct ScanAnswer {
    /// `scan`.
    pub kind: &'static str,
    /// The name of the parameter.
    pub parameter: String,
    /// The first value.
    pub from: ExactAnswer,
    /// The last value.
    pub to: ExactAnswer,
    /// Steps between them.
    pub steps: u32,
    /// What is known at each value, in ascending order.
    pub values: Vec<ScanValueAnswer>,
    /// For each k the maximal intervals at whose values C^k was proved. Their ends were narrowed by bisection, so that
    /// values between those of the scan were looked at, too; between them nothing is proved.
    pub intervals: Vec<ScanIntervalAnswer>,
}

/// An exact number.
#[derive(Debug, Clone, Serialize, ToSchema)]
pub struct ExactAnswer {
    /// Rounded to f64.
    pub value: f64,
    /// As a fraction.
    pub exact: String,
}

/// What is known at one value of the parameter.
#[derive(Debug, Clone, Default, Serialize, ToSchema)]
pub struct ScanValueAnswer {
    /// The value, rounded to f64.
    pub value: f64,
    /// The value as a fraction.
    pub exact: String,
    /// Why there is no scheme to analyse, where there is none; then the other fields are absent.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub refused: Option<String>,
    /// Order of the sum rules.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub sum_rules: Option<usize>,
    /// The largest k for which limits are proved to be C^k, -1 where not even convergence is.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub proved_c: Option<i64>,
    /// The smallest k for which it is disproved; absent where nothing is, as of plans whose masks change from level to
    /// level.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub disproved_c: Option<i64>,
    /// Between which numbers the Hoelder exponent of the scheme lies, or of its static limit.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub holder: Option<[f64; 2]>,
}

/// An interval of values with a proof of C^k.
#[derive(Debug, Clone, Serialize, ToSchema)]
pub struct ScanIntervalAnswer {
    /// The order k.
    pub k: i64,
    /// The least value with a proof.
    pub from: ExactAnswer,
    /// The greatest value with a proof.
    pub to: ExactAnswer,
    /// The next value below at which C^k is disproved; null where none was found before the next interval or the end
    /// of the scan.
    pub disproved_below: Option<ExactAnswer>,
    /// The next value above at which C^k is disproved, likewise.
    pub disproved_above: Option<ExactAnswer>,
}

impl ScanAnswer {
    pub(super) fn new(scan: &Scan, scanned: &Scanned) -> Self {
        Self {
            kind: "scan",
            parameter: scan.parameter.clone(),
            from: ExactAnswer::new(&scan.from),
            to: ExactAnswer::new(&scan.to),
            steps: scan.steps,
            values: scanned.rows.iter().map(ScanValueAnswer::new).collect(),
            intervals: scanned.intervals.iter().map(ScanIntervalAnswer::new).collect(),
        }
    }
}

impl ExactAnswer {
    fn new(x: &Exact) -> Self {
        Self { value: rounded(x), exact: x.to_string() }
    }
}

impl ScanValueAnswer {
    fn new(row: &ScanRow) -> Self {
        let ExactAnswer { value, exact } = ExactAnswer::new(&row.value);
        let none = Self { value, exact, ..Self::default() };
        match &row.found {
            ScanResult::Refused(why) => Self { refused: Some(why.clone()), ..none },
            ScanResult::Verdict(verdict) => Self {
                sum_rules: Some(verdict.order),
                proved_c: Some(verdict.proved_c),
                disproved_c: verdict.disproved_c,
                holder: verdict.holder,
                ..none
            },
        }
    }
}

impl ScanIntervalAnswer {
    fn new(interval: &Interval) -> Self {
        Self {
            k: interval.k,
            from: ExactAnswer::new(&interval.from),
            to: ExactAnswer::new(&interval.to),
            disproved_below: interval.before.as_ref().map(ExactAnswer::new),
            disproved_above: interval.after.as_ref().map(ExactAnswer::new),
        }
    }
}
