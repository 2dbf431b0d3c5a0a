//! Parameters of a scheme that vary from point to point.

use crate::fault::Fault;

/// Vertex parameters: one number per control point for each parameter that is given.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Attributes {
    /// The parameter step, in radians, before it is divided by the arities of the levels.
    pub alpha: Option<Vec<f64>>,
    /// The kernel value.
    pub kernel: Option<Vec<f64>>,
    /// The compensation value.
    pub compensation: Option<Vec<f64>>,
    /// The push-back factor.
    pub delta: Option<Vec<f64>>,
}

impl Attributes {
    /// All arrays with their names.
    pub fn arrays(&self) -> [(&'static str, Option<&[f64]>); 4] {
        [
            ("alpha", self.alpha.as_deref()),
            ("kernel", self.kernel.as_deref()),
            ("compensation", self.compensation.as_deref()),
            ("delta", self.delta.as_deref()),
        ]
    }

    /// Returns the parameters with each array replaced by its image under `change`.
    #[must_use]
    pub fn changed(&self, change: impl Fn(&[f64]) -> Vec<f64>) -> Self {
        let change = |array: &Option<Vec<f64>>| array.as_deref().map(&change);
        Self {
            alpha: change(&self.alpha),
            kernel: change(&self.kernel),
            compensation: change(&self.compensation),
            delta: change(&self.delta),
        }
    }

    /// Returns the parameters of the points after an upsampling, by linear interpolation.
    #[must_use]
    pub fn upsampled(&self, arity: u32, closed: bool) -> Self {
        self.changed(|array| {
            let edges = array.len() - usize::from(!closed);
            let points = (0..edges).flat_map(|e| (0..arity).map(move |j| between(array, e, j, arity)));
            let last = array.last().copied().filter(|_| !closed);
            points.chain(last).collect()
        })
    }

    /// Returns the parameters of the points `start .. start + n`.
    #[must_use]
    pub fn slice(&self, start: usize, n: usize) -> Self {
        self.changed(|array| array.iter().skip(start).take(n).copied().collect())
    }
}

/// Returns the value at the fraction `j / d` of edge `e`.
pub fn between(array: &[f64], e: usize, j: u32, d: u32) -> f64 {
    let next = array[(e + 1) % array.len()];
    (f64::from(d - j) * array[e] + f64::from(j) * next) / f64::from(d)
}

impl Attributes {
    /// Checks that every given array has one finite number per point.
    ///
    /// # Errors
    /// Faults with pointers below the parameters.
    pub fn check(&self, n: usize) -> Result<(), Vec<Fault>> {
        let mut faults = Vec::new();
        for (name, array) in self.arrays() {
            let Some(array) = array else { continue };
            if array.len() != n {
                let detail = format!("{} numbers for {n} points; give one a point", array.len());
                faults.push(Fault::new(format!("/{name}"), detail));
            } else if let Some(i) = array.iter().position(|x| !x.is_finite()) {
                faults.push(Fault::new(format!("/{name}/{i}"), format!("{} is not a finite number", array[i])));
            }
        }
        if faults.is_empty() { Ok(()) } else { Err(faults) }
    }
}
