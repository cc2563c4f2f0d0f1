//! The larger and the smaller of two numbers, written out. `f32::max` and its like
//! leave open which of 0 and -0 they return, and processors differ: Arm's
//! instruction takes 0 for the larger, x86's returns one of its operands. So
//! `.clippy.toml` bans them.

/// Numbers of which the larger and the smaller have the same bits everywhere.
pub(crate) trait Order: Copy {
    /// This number, or `least` where it is below; of 0 and -0, `least`. Of a number
    /// and what is none, the number, as `max` has it.
    fn at_least(self, least: Self) -> Self;
    /// This number, or `most` where it is above; of 0 and -0, `most`. Of a number
    /// and what is none, the number, as `min` has it.
    fn at_most(self, most: Self) -> Self;
}

macro_rules! order {
    ($number:ty) => {
        impl Order for $number {
            #[inline(always)]
            fn at_least(self, least: Self) -> Self {
                if self > least || least.is_nan() {
                    self
                } else {
                    least
                }
            }

            #[inline(always)]
            fn at_most(self, most: Self) -> Self {
                if self < most || most.is_nan() {
                    self
                } else {
                    most
                }
            }
        }
    };
}

order!(f32);
order!(f64);

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_ordered_and_a_number_stands_against_none() {
        for (a, b) in [(1.0, 2.0), (-3.0, 0.5), (f64::NEG_INFINITY, 0.0)] {
            assert_eq!([a.at_least(b), b.at_least(a)], [b, b]);
            assert_eq!([a.at_most(b), b.at_most(a)], [a, a]);
        }
        for number in [1.0_f32.at_least(f32::NAN), f32::NAN.at_least(1.0)] {
            assert_eq!(number, 1.0);
        }
        for number in [1.0_f32.at_most(f32::NAN), f32::NAN.at_most(1.0)] {
            assert_eq!(number, 1.0);
        }
        assert!(f32::NAN.at_least(f32::NAN).is_nan());
    }

    #[test]
    fn of_two_zeros_the_limit_is_returned() {
        for [number, limit] in [[0.0_f32, -0.0], [-0.0, 0.0]] {
            assert_eq!(number.at_least(limit).to_bits(), limit.to_bits());
            assert_eq!(number.at_most(limit).to_bits(), limit.to_bits());
        }
    }
}
