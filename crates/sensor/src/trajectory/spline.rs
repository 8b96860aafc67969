//! Natural cubic splines over time, split where the points are too far apart.

/// x, y, height, yaw, pitch and roll.
pub(super) type Coordinates = [f64; 6];

/// Piecewise cubic curve through knots, given by their values and second derivatives.
#[derive(Debug, Clone)]
pub(super) struct Spline {
    times_s: Vec<f64>,
    values: Vec<Coordinates>,
    /// Second derivatives; 0 at the ends of every spline.
    bends: Vec<Coordinates>,
}

impl Spline {
    /// Interpolates at least one value, at increasing times. Where two are more than `longest_step_s` apart, a straight line
    /// connects two splines.
    pub(super) fn new(times_s: Vec<f64>, values: &[Coordinates], longest_step_s: f64) -> Self {
        let mut bends = vec![[0.0; 6]; values.len()];
        let mut from = 0;
        for to in 1..=times_s.len() {
            if to == times_s.len() || times_s[to] - times_s[to - 1] > longest_step_s {
                bend(&times_s[from..to], &values[from..to], &mut bends[from..to]);
                from = to;
            }
        }
        Self { times_s, values: values.to_vec(), bends }
    }

    /// Times of the values, seconds.
    pub(super) fn times_s(&self) -> &[f64] {
        &self.times_s
    }

    /// Returns the value at a time; beyond the knots it extrapolates linearly for at most `continuation_s`. NaN if the time
    /// is NaN.
    pub(super) fn at(&self, time_s: f64, continuation_s: f64) -> Coordinates {
        let last = self.times_s.len() - 1;
        if time_s.is_nan() {
            [f64::NAN; 6]
        } else if time_s <= self.times_s[0] {
            let ahead_s = (self.times_s[0] - time_s).min(continuation_s);
            along(&self.values[0], &self.knot_slope(0), -ahead_s)
        } else if time_s >= self.times_s[last] {
            let ahead_s = (time_s - self.times_s[last]).min(continuation_s);
            along(&self.values[last], &self.knot_slope(last), ahead_s)
        } else {
            self.between(time_s)
        }
    }

    /// Returns the derivative of [`Spline::at`] with respect to time.
    pub(super) fn slope(&self, time_s: f64, continuation_s: f64) -> Coordinates {
        let last = self.times_s.len() - 1;
        if time_s.is_nan() {
            [f64::NAN; 6]
        } else if time_s < self.times_s[0] - continuation_s || time_s > self.times_s[last] + continuation_s {
            [0.0; 6]
        } else if time_s <= self.times_s[0] {
            self.knot_slope(0)
        } else if time_s >= self.times_s[last] {
            self.knot_slope(last)
        } else {
            let (before, step_s, [a, b]) = self.piece(time_s);
            self.slope_in(before, step_s, [a, b])
        }
    }

    /// Returns the knot before a time between the first and the last, the step to the next, and the weights of both.
    fn piece(&self, time_s: f64) -> (usize, f64, [f64; 2]) {
        let after = self.times_s.partition_point(|knot_s| *knot_s <= time_s).clamp(1, self.times_s.len() - 1);
        let before = after - 1;
        let step_s = self.times_s[after] - self.times_s[before];
        let weight = (time_s - self.times_s[before]) / step_s;
        (before, step_s, [1.0 - weight, weight])
    }

    fn between(&self, time_s: f64) -> Coordinates {
        let (before, step_s, [a, b]) = self.piece(time_s);
        let bend_weights = [a * a * a - a, b * b * b - b].map(|weight| weight * step_s * step_s / 6.0);
        std::array::from_fn(|axis| {
            a * self.values[before][axis]
                + b * self.values[before + 1][axis]
                + bend_weights[0] * self.bends[before][axis]
                + bend_weights[1] * self.bends[before + 1][axis]
        })
    }

    fn slope_in(&self, before: usize, step_s: f64, [a, b]: [f64; 2]) -> Coordinates {
        let bend_weights = [1.0 - 3.0 * a * a, 3.0 * b * b - 1.0].map(|weight| weight * step_s / 6.0);
        std::array::from_fn(|axis| {
            (self.values[before + 1][axis] - self.values[before][axis]) / step_s
                + bend_weights[0] * self.bends[before][axis]
                + bend_weights[1] * self.bends[before + 1][axis]
        })
    }

    /// Returns the slope at the first or last knot, from its only side.
    fn knot_slope(&self, knot: usize) -> Coordinates {
        let last = self.times_s.len() - 1;
        if last == 0 {
            return [0.0; 6];
        }
        let before = knot.min(last - 1);
        let step_s = self.times_s[before + 1] - self.times_s[before];
        self.slope_in(before, step_s, if knot == before { [1.0, 0.0] } else { [0.0, 1.0] })
    }
}

fn along(value: &Coordinates, slope: &Coordinates, time_s: f64) -> Coordinates {
    std::array::from_fn(|axis| value[axis] + time_s * slope[axis])
}

/// Computes the second derivatives of a natural spline: solves the tridiagonal system for continuous slopes.
fn bend(times_s: &[f64], values: &[Coordinates], bends: &mut [Coordinates]) {
    let count = times_s.len();
    if count < 3 {
        return;
    }
    let step_s = |knot: usize| times_s[knot + 1] - times_s[knot];
    // Upper diagonal after elimination of the lower one.
    let mut upper = vec![0.0; count];
    for knot in 1..count - 1 {
        let pivot = 2.0 * (step_s(knot - 1) + step_s(knot)) - step_s(knot - 1) * upper[knot - 1];
        upper[knot] = step_s(knot) / pivot;
        bends[knot] = std::array::from_fn(|axis| {
            let slope = |knot: usize| (values[knot + 1][axis] - values[knot][axis]) / step_s(knot);
            let change = 6.0 * (slope(knot) - slope(knot - 1));
            (change - step_s(knot - 1) * bends[knot - 1][axis]) / pivot
        });
    }
    for knot in (1..count - 1).rev() {
        bends[knot] = std::array::from_fn(|axis| bends[knot][axis] - upper[knot] * bends[knot + 1][axis]);
    }
}
