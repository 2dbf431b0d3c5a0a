//! One step of a plan on a small polygon as matrices: one per operator, and their product.

use super::curve::{ExactStep, exact_steps};
use crate::math::exact::{Exact, rounded};
use crate::math::rows::Rows;
use crate::scheme::operator::Role;
use crate::scheme::plan::{Plan, Scheduled};
use crate::scheme::polygon_net::PolygonNet;
use crate::scheme::step::{Action, TermKind};
use crate::scheme::stepper::Stepper;

/// Maximum number of entries of all matrices together: enough for 16 points and the widest usual masks. Half as many
/// refuse the matrices of long words; twice as many make answers twice as long, which nobody reads.
pub const MAX_MATRIX_ENTRIES: usize = 1 << 15;

/// A matrix in f64 and, if known, as fractions.
#[derive(Debug, Clone, PartialEq)]
pub struct Matrix {
    /// The rows, rounded to f64.
    pub rows: Vec<Vec<f64>>,
    /// The rows as fractions, if they are known.
    pub exact: Option<Vec<Vec<Exact>>>,
}

/// The matrix of one operator.
#[derive(Debug, Clone, PartialEq)]
pub struct StepMatrix {
    /// The letter of the operator in words, if it has one.
    pub letter: Option<char>,
    /// The name of the operator.
    pub name: &'static str,
    /// The role of the operator in a step.
    pub role: Role,
    /// Whether the points before the operator become the anchor, towards which later push-backs push.
    pub sets_anchor: bool,
    /// Weights of the points before the operator: row j makes new point j.
    pub points: Matrix,
    /// Weights of the points that entered the last upsampling, added to `points`; push-backs only.
    pub coarse: Option<Matrix>,
}

/// The matrices of the first level of a plan on a polygon.
#[derive(Debug, Clone, PartialEq)]
pub struct StepMatrices {
    /// The matrices of the operators, in the order in which they are applied.
    pub steps: Vec<StepMatrix>,
    /// The product of all operators as one matrix.
    pub product: Matrix,
}

/// The reason why a plan has no matrices.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum NoMatrices {
    /// The matrices would have too many entries.
    #[error(
        "the matrices have more than {MAX_MATRIX_ENTRIES} numbers; ask for fewer points or powers, or a shorter word"
    )]
    TooLarge,
    /// A step fails on this polygon, or is not a matrix.
    #[error("a step of the plan is no matrix here; ask for more points")]
    NoMatrix,
}

impl StepMatrices {
    /// Returns the matrices of the first level on a polygon of `n` points, which is closed or has the ends of the plan.
    /// They are exact on closed polygons if all weights are fractions and `is_static`, because exact weights are those
    /// of the static limit.
    ///
    /// # Errors
    /// [`NoMatrices`].
    pub fn of(plan: &Plan, n: usize, closed: bool, is_static: bool) -> Result<Self, NoMatrices> {
        let scheduled = plan.schedule(1).map_err(|_| NoMatrices::NoMatrix)?;
        let mut net = PolygonNet::new(n, closed, plan.ends, &[]);
        let (mut coarse, mut left) = (n, MAX_MATRIX_ENTRIES);
        let mut steps = Vec::new();
        for step in scheduled.iter().filter(|step| step.level == 1) {
            let next = Stepper::new(plan).next(&net, step).map_err(|_| NoMatrices::NoMatrix)?;
            let sizes = [next.net.n, net.n, coarse];
            let entries = (net.n + coarse).checked_mul(next.net.n).ok_or(NoMatrices::TooLarge)?;
            left = left.checked_sub(entries).ok_or(NoMatrices::TooLarge)?;
            steps.push(StepMatrix::rounded(step, &next.action, sizes).ok_or(NoMatrices::NoMatrix)?);
            if next.action.sets_anchor() {
                coarse = net.n;
            }
            net = next.net;
        }
        if let Some(exact) = (closed && is_static).then(|| exact_steps(plan, n)).flatten() {
            for (step, ExactStep { points, coarse }) in steps.iter_mut().zip(exact) {
                step.points = Matrix::exact(points);
                step.coarse = coarse.map(Matrix::exact);
            }
        }
        let product = product(&steps, n);
        Ok(Self { steps, product })
    }
}

impl StepMatrix {
    /// Returns the matrix of an action that makes `after` points from `before` points, of which `coarse` entered the
    /// last upsampling; `None` if the action is not a table of weights.
    fn rounded(step: &Scheduled, action: &Action, [after, before, coarse]: [usize; 3]) -> Option<Self> {
        let table = action.table()?;
        let mut rows = Rows::default();
        table.make(0..after, &mut rows);
        let mut points = vec![vec![0.0; before]; after];
        let mut of_coarse = vec![vec![0.0; coarse]; after];
        let mut is_lost = false;
        for (r, index) in (0..after).zip(0_u32..) {
            action.weights(index, rows.row(r), |source, weight| match source {
                TermKind::Point(i) => points[r][i as usize] += weight,
                TermKind::Anchor(i) => of_coarse[r][i as usize] += weight,
                TermKind::Lost => is_lost = true,
            });
        }
        let facts = step.letter.facts();
        let matrix = |rows| Matrix { rows, exact: None };
        let coarse = (facts.role == Role::PushBack).then(|| matrix(of_coarse));
        let (letter, name, role, sets_anchor) = (facts.letter, facts.name, facts.role, action.sets_anchor());
        (!is_lost).then(|| Self { letter, name, role, sets_anchor, points: matrix(points), coarse })
    }

    fn as_exact(&self) -> Option<StepWeights<'_, Exact>> {
        let points = self.points.exact.as_deref()?;
        let coarse = match &self.coarse {
            Some(coarse) => Some(coarse.exact.as_deref()?),
            None => None,
        };
        Some((self.sets_anchor, points, coarse))
    }

    fn as_rounded(&self) -> StepWeights<'_, f64> {
        (self.sets_anchor, &self.points.rows, self.coarse.as_ref().map(|coarse| coarse.rows.as_slice()))
    }
}

impl Matrix {
    /// Creates a matrix from fractions.
    pub fn exact(exact: Vec<Vec<Exact>>) -> Self {
        let rows = exact.iter().map(|row| row.iter().map(rounded).collect()).collect();
        Self { rows, exact: Some(exact) }
    }
}

/// Returns the product of all steps as one matrix over the `n` points before them.
fn product(steps: &[StepMatrix], n: usize) -> Matrix {
    if let Some(exact) = steps.iter().map(StepMatrix::as_exact).collect::<Option<Vec<_>>>() {
        return Matrix::exact(composed(&exact, n));
    }
    let rounded: Vec<_> = steps.iter().map(StepMatrix::as_rounded).collect();
    Matrix { rows: composed(&rounded, n), exact: None }
}

/// Whether an operator sets the anchor, its weights of the points, and its weights of the anchor.
type StepWeights<'a, T> = (bool, &'a [Vec<T>], Option<&'a [Vec<T>]>);

fn composed<T: num_traits::Num + Clone>(steps: &[StepWeights<'_, T>], n: usize) -> Vec<Vec<T>> {
    let one = |i: usize, k: usize| if i == k { T::one() } else { T::zero() };
    let mut now: Vec<Vec<T>> = (0..n).map(|i| (0..n).map(|k| one(i, k)).collect()).collect();
    let mut anchor = now.clone();
    for (sets_anchor, points, coarse) in steps {
        let mut next = times(points, &now);
        if let Some(coarse) = coarse {
            for (row, added) in next.iter_mut().zip(times(coarse, &anchor)) {
                row.iter_mut().zip(added).for_each(|(x, y)| *x = x.clone() + y);
            }
        }
        let before = std::mem::replace(&mut now, next);
        if *sets_anchor {
            anchor = before;
        }
    }
    now
}

fn times<T: num_traits::Num + Clone>(a: &[Vec<T>], b: &[Vec<T>]) -> Vec<Vec<T>> {
    let columns = b.first().map_or(0, Vec::len);
    let entry = |row: &[T], k: usize| {
        let terms = row.iter().zip(b).filter(|(x, _)| !x.is_zero());
        terms.fold(T::zero(), |sum, (x, other)| sum + x.clone() * other[k].clone())
    };
    a.iter().map(|row| (0..columns).map(|k| entry(row, k)).collect()).collect()
}
