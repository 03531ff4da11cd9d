//! The transform and its counts.

use super::*;

/// Waves that nothing acts on are the values, of all components, of some and of the last alone, for even and odd counts beside and
/// beyond a tile; each component counts once there and once back, and one that is nothing only back.
#[test]
fn what_nothing_acts_on_stays() {
    for counts in [[7, 10], [10, 7], [16, 18], [3, 33], [2, 2]] {
        let transform = Transform::<3>::new(&counts);
        let values: Vec<f64> = (0..3 * transform.nodes()).map(|i| ((7 * i + 3) % 11) as f64 - 4.0).collect();
        let close = |a: &[f64], b: &[f64]| a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-14);
        let mut all = values.clone();
        transform.filter(&mut all, (0..3, 0..3), |_, _| {}).unwrap();
        assert!(close(&all, &values) && transform.counted() == 6);
        let mut some = values.clone();
        transform.filter(&mut some, (0..3, 1..2), |_, w| w[1] *= 2.0).unwrap();
        let doubled = |(i, value): (usize, &f64)| if i % 3 == 1 { 2.0 * value } else { *value };
        assert!(close(&some, &values.iter().enumerate().map(doubled).collect::<Vec<_>>()));
        let mut last: Vec<f64> = values.iter().skip(2).step_by(3).copied().collect();
        transform.filter_last(&mut last, |_| 1.0).unwrap();
        assert!(close(&last, &values.iter().skip(2).step_by(3).copied().collect::<Vec<_>>()));
        let waves = transform.forward(&values).unwrap();
        assert!(close(&transform.inverse(|k| &waves[k]).unwrap(), &values));
        let before = transform.counted();
        let mut normal: Vec<f64> = values.iter().enumerate().map(|(i, v)| if i % 3 == 2 { *v } else { 0.0 }).collect();
        transform.filter(&mut normal, (0..3, 0..3), |_, _| {}).unwrap();
        assert_eq!(transform.counted() - before, 4);
        transform.filter(&mut vec![0.0; 3 * transform.nodes()], (0..3, 0..3), |_, w| w[0].re = 1.0).unwrap();
        assert_eq!(transform.counted() - before, 4);
    }
}
