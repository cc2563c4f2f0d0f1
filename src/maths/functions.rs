//! Elementary functions from `libm`: compiled from one source, they give the
//! same bits on every target, which the platform's own library does not.
//! This is the only place that may name it (`.clippy.toml` bans the methods of
//! the standard library).

/// Sine of `x` radians.
pub(crate) fn sin(x: f64) -> f64 {
    libm::sin(x)
}

/// Cosine of `x` radians.
pub(crate) fn cos(x: f64) -> f64 {
    libm::cos(x)
}

/// Arc cosine in radians, 0 to pi.
pub(crate) fn acos(x: f64) -> f64 {
    libm::acos(x)
}

/// Tangent of `x` radians.
pub(crate) fn tan(x: f64) -> f64 {
    libm::tan(x)
}

/// e to the power of `x`.
pub(crate) fn exp(x: f64) -> f64 {
    libm::exp(x)
}

/// Natural logarithm.
pub(crate) fn ln(x: f64) -> f64 {
    libm::log(x)
}

/// 2 to the power of `x`.
pub(crate) fn exp2(x: f64) -> f64 {
    libm::exp2(x)
}

/// Logarithm to the base 2.
pub(crate) fn log2(x: f64) -> f64 {
    libm::log2(x)
}

/// Cube root.
pub(crate) fn cbrt(x: f64) -> f64 {
    libm::cbrt(x)
}

/// `x` to the power of `y`.
pub(crate) fn pow(x: f64, y: f64) -> f64 {
    libm::pow(x, y)
}

/// Linear value of an sRGB-encoded one, both 0..1 (IEC 61966-2-1).
pub(crate) fn linear_from_srgb(encoded: f64) -> f64 {
    if encoded <= 0.04045 {
        encoded / 12.92
    } else {
        pow((encoded + 0.055) / 1.055, 2.4)
    }
}

/// Sine of `x` radians in single precision.
pub(crate) fn sin_f32(x: f32) -> f32 {
    libm::sinf(x)
}

/// Cosine of `x` radians in single precision.
pub(crate) fn cos_f32(x: f32) -> f32 {
    libm::cosf(x)
}

/// Arc cosine in single precision, radians; the argument is clamped to -1..1.
pub(crate) fn acos_f32(x: f32) -> f32 {
    libm::acosf(x.clamp(-1.0, 1.0))
}

/// Angle of the point (`x`, `y`) from the x axis in single precision, radians,
/// -pi to pi.
pub(crate) fn atan2_f32(y: f32, x: f32) -> f32 {
    libm::atan2f(y, x)
}
