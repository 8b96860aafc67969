//! Rates with intervals by walk: runs of one walk share a world and count as one.

use std::collections::BTreeMap;

use crate::run::Outcome;

/// Returns a rate over runs with Wilson's 95 % interval. The runs of a walk are averaged, and the interval is that of so many
/// walks.
pub fn rate(runs: &[&Outcome], is: &dyn Fn(&Outcome) -> bool) -> String {
    let hits: Vec<(u64, bool)> = runs.iter().map(|run| (run.task.seed, is(run))).collect();
    of_walks(&hits)
}

/// Returns a rate over hits and misses, each with the seed of its walk.
pub fn of_walks(hits: &[(u64, bool)]) -> String {
    let Some((part, low, high)) = interval(hits) else { return "–".to_owned() };
    let count = hits.iter().filter(|(_, hit)| *hit).count();
    let percent = |value: f64| (100.0 * value).clamp(0.0, 100.0);
    format!("{:.0} % ({count} of {}; {:.0}–{:.0} %)", percent(part), hits.len(), percent(low), percent(high))
}

/// Returns the mean over walks and Wilson's interval for so many walks (Wilson 1927); None without walks.
fn interval(hits: &[(u64, bool)]) -> Option<(f64, f64, f64)> {
    const Z: f64 = 1.96;
    let mut walks: BTreeMap<u64, (f64, f64)> = BTreeMap::new();
    for (seed, hit) in hits {
        let (sum, count) = walks.entry(*seed).or_default();
        (*sum, *count) = (*sum + f64::from(u8::from(*hit)), *count + 1.0);
    }
    if walks.is_empty() {
        return None;
    }
    let n = walks.len() as f64;
    let p = walks.values().map(|(sum, count)| sum / count).sum::<f64>() / n;
    let middle = (p + Z * Z / (2.0 * n)) / (1.0 + Z * Z / n);
    let reach = Z / (1.0 + Z * Z / n) * (p * (1.0 - p) / n + Z * Z / (4.0 * n * n)).sqrt();
    Some((p, middle - reach, middle + reach))
}

/// Returns the value at a fraction of sorted numbers; None without any.
pub fn quantile(values: &mut [f64], part: f64) -> Option<f64> {
    values.sort_by(f64::total_cmp);
    values.get(((values.len().max(1) - 1) as f64 * part).round() as usize).copied()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn runs_of_one_walk_count_as_one() {
        let (p, low, high) = interval(&[(1, true), (1, true), (1, true), (2, false)]).unwrap();
        let alone = interval(&[(1, true), (2, false)]).unwrap();
        assert_eq!((p, low, high), alone);
        // Wilson's interval for one of two.
        assert!((p - 0.5).abs() < 1e-12 && (low - 0.0945).abs() < 1e-3 && (high - 0.9055).abs() < 1e-3);
        assert!(interval(&[]).is_none());
    }
}
