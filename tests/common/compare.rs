//! How far apart lists of numbers are.

/// The largest difference over the largest value of the first; of lists of nothing but zeros, the difference.
pub fn difference(a: &[f64], b: &[f64]) -> f64 {
    assert_eq!(a.len(), b.len());
    let largest = a.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
    let apart = a.iter().zip(b).fold(0.0_f64, |most, (x, y)| most.max((x - y).abs()));
    if apart == 0.0 { 0.0 } else { apart / largest }
}
