//! Smooth curves through typed points.

use glam::DVec4;

/// `count` points, evenly spaced in the curve's parameter, on the Catmull-Rom
/// spline through the given points (Catmull and Rom, "A class of local
/// interpolating splines", 1974), from the first to the last.
pub(crate) fn spline(points: &[DVec4], count: usize) -> Vec<DVec4> {
    let segments = points.len() - 1;
    (0..count)
        .map(|step| {
            let at = (step * segments) as f64 / (count - 1) as f64;
            let segment = (at.floor() as usize).min(segments - 1);
            interpolate(points, segment, at - segment as f64)
        })
        .collect()
}

/// The spline at `t` in 0..1 between a point and its successor; the ends
/// repeat their point.
fn interpolate(points: &[DVec4], segment: usize, t: f64) -> DVec4 {
    let last = points.len() - 1;
    let before = points[segment.saturating_sub(1)];
    let [from, to] = [points[segment], points[segment + 1]];
    let after = points[(segment + 2).min(last)];
    let linear = to - before;
    let quadratic = before * 2.0 - from * 5.0 + to * 4.0 - after;
    let cubic = from * 3.0 - before - to * 3.0 + after;
    from + (linear + (quadratic + cubic * t) * t) * (0.5 * t)
}

/// exp(-x^2 / 2).
pub(crate) fn bell(x: f64) -> f64 {
    libm::exp(-0.5 * x * x)
}
