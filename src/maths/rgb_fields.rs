//! Fields of three channels: a value at every place of a list.

/// a b, channel by channel.
pub(crate) fn product(a: &[[f32; 3]], b: &[[f32; 3]]) -> Vec<[f32; 3]> {
    let pairs = a.iter().zip(b);
    pairs
        .map(|(a, b)| [a[0] * b[0], a[1] * b[1], a[2] * b[2]])
        .collect()
}

/// Adds `more`, times a factor a channel.
pub(crate) fn add(sum: &mut [[f32; 3]], more: &[[f32; 3]], factor: [f64; 3]) {
    let factor = factor.map(|f| f as f32);
    for (total, value) in sum.iter_mut().zip(more) {
        for channel in 0..3 {
            total[channel] += value[channel] * factor[channel];
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn channels_keep_to_themselves() {
        let mut sum = product(&[[1.0, 2.0, 3.0]], &[[5.0, 7.0, 11.0]]);
        assert_eq!(sum, [[5.0, 14.0, 33.0]]);
        add(&mut sum, &[[1.0, 1.0, 2.0]], [1.0, -4.0, 0.5]);
        assert_eq!(sum, [[6.0, 10.0, 34.0]]);
    }
}
