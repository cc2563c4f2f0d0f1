//! Hashes in place of random number generators: a random number is a function
//! of (seed, index, dimension), so it is the same for any number of threads.

/// Mixes 32 bits so that every input bit changes about half of the output bits
/// (Ellis, "hash-prospector", the two-round function `lowbias32`).
pub(crate) fn mix(mut x: u32) -> u32 {
    x ^= x >> 16;
    x = x.wrapping_mul(0x7feb_352d);
    x ^= x >> 15;
    x = x.wrapping_mul(0x846c_a68b);
    x ^ (x >> 16)
}

/// Hash of three integers: a seed, an index and a dimension.
pub(crate) fn hash3(seed: u32, index: u32, dimension: u32) -> u32 {
    mix(mix(mix(seed.wrapping_add(0x9e37_79b9)) ^ index)
        .wrapping_add(dimension.wrapping_mul(0x85eb_ca6b)))
}

/// Uniform number in [0, 1) with 24 bits, from a hash.
pub(crate) fn unit_f32(hash: u32) -> f32 {
    (hash >> 8) as f32 * (1.0 / 16_777_216.0)
}

/// Uniform number in [0, 1) of (seed, index, dimension).
pub(crate) fn uniform(seed: u32, index: u32, dimension: u32) -> f32 {
    unit_f32(hash3(seed, index, dimension))
}
