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

/// From a patch and to it is what comes from a face that has nothing elsewhere, at those nodes, and from a patch to all nodes what comes
/// anywhere, to the last bit: lines that have nothing are not transformed, but are none the less there.
#[test]
fn a_patch_is_a_face_with_nothing_elsewhere() {
    for counts in [[7, 10], [16, 18], [2, 40]] {
        let transform = Transform::<3>::new(&counts);
        let nodes: Vec<usize> = (0..transform.nodes()).filter(|i| i / counts[1] % 3 != 1 && i % 5 < 2).collect();
        let patch = transform.patch(nodes.clone());
        assert_eq!(patch.nodes(), nodes);
        let mut all = vec![0.0; 3 * transform.nodes()];
        let mut some: Vec<f64> = (0..3 * nodes.len()).map(|i| ((7 * i + 3) % 11) as f64 - 4.0).collect();
        for (node, values) in nodes.iter().zip(some.chunks_exact(3)) {
            all[3 * node..][..3].copy_from_slice(values);
        }
        let act = |wave: usize, w: &mut [Complex<f64>; 3]| {
            let share = 1.0 / (1.0 + wave as f64);
            *w = [w[1] * share, w[2] + w[0] * share, w[0] - w[1]];
        };
        let mut everywhere = vec![1.0; all.len()];
        transform.filter_from((&patch, &some), &mut everywhere, 0..3, act).unwrap();
        transform.filter_patch(&patch, &mut some, (0..3, 0..3), act).unwrap();
        transform.filter(&mut all, (0..3, 0..3), act).unwrap();
        assert_eq!(everywhere, all);
        let there: Vec<f64> = nodes.iter().flat_map(|node| all[3 * node..][..3].to_vec()).collect();
        assert_eq!(some, there);
    }
}
