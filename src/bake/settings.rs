//! Settings that change a bake's bits.

use super::paper;
use super::scheme::Scheme;
use crate::scene::BakeKeys;

/// Rays a vertex. Error of one bounce in per cent, mean and 95th percentile, of coarse
/// meshes under tuning lights at 3,072, 4,096, 6,144 and 8,192: cornell 1.25 / 2.4,
/// 1.12 / 2.3, 1.00 / 2.0, 0.93 / 1.9; window 4.16 / 9.6, 3.60 / 8.2, 3.51 / 7.7, 3.20 /
/// 7.9 (suns through a window light small places, which few rays of a row meet). A bake
/// of Cornell's box by default took 26 % more processor time at 6,144 than at 3,072
/// (when its error was stated by 1,024 receivers).
pub(crate) const RAYS: u32 = 6144;
/// Basis functions for 1,000 vertices. Error of one bounce in per cent at 32, 64
/// and 96: the sheet's room 5.0, 2.9, 2.3, the window's room 4.6, 3.6, 3.2, at
/// bytes a vertex of 100, 98 and 121. Shared by what bounces, at 32, 64, 96 and 128 and
/// nearly equal bytes (96 functions take some 4 % more): the mean of cornell, window and sheet 2.87, 2.24, 2.15, 2.17.
const FUNCTIONS_PER_1000: f64 = 64.0;
/// Coefficients a vertex: near field and components. At 48, 72 and 96, the mean of
/// cornell, window and sheet 2.39, 2.24, 2.22 % at 88, 121 and 135 bytes a vertex.
const COEFFICIENTS: u32 = 72;
/// Vertices a partition: 48 to 64 partitions at 35,000 vertices (decision 8). At 300
/// and 600 the coarse meshes of cornell, window and sheet agree within 0.3 %.
const VERTICES_PER_PART: u32 = 600;

/// Settings of a bake, resolved against their defaults.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BakeSettings {
    /// How the transfer is stored.
    pub scheme: Scheme,
    /// Rays a lighting vertex.
    pub rays: u32,
    /// Basis functions in all; `None`: 64 for 1,000 vertices, in the published
    /// scheme 1,024.
    pub functions: Option<u32>,
    /// Coefficients a vertex in the mean, near field included; in the published
    /// scheme the most that a vertex keeps.
    pub coefficients: u32,
    /// Vertices a partition; the published scheme has a rule of its own (500
    /// below 10,000 vertices, 1,000 from there on).
    pub vertices_per_part: u32,
    /// Error of indirect light to reach, relative: keys that are free follow
    /// from it. `None`: the defaults, whatever error they have.
    pub error: Option<f64>,
    /// Which keys the search for an error may change.
    pub free: FreeKeys,
}

/// Keys of a bake that nobody has set.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct FreeKeys {
    /// `rays`.
    pub rays: bool,
    /// `functions`.
    pub functions: bool,
    /// `coefficients`.
    pub coefficients: bool,
}

impl BakeSettings {
    /// The settings that `[bake]` asks for, in relume's own scheme.
    pub fn of_keys(keys: &BakeKeys) -> Self {
        Self::of_scheme(Scheme::Relume, keys)
    }

    /// The settings that `[bake]` asks for, with the defaults of a scheme.
    pub fn of_scheme(scheme: Scheme, keys: &BakeKeys) -> Self {
        let coefficients = match scheme {
            Scheme::Relume => COEFFICIENTS,
            Scheme::Paper => paper::COEFFICIENTS,
        };
        Self {
            scheme,
            rays: keys.rays.unwrap_or(RAYS),
            functions: keys.functions,
            coefficients: keys.coefficients.unwrap_or(coefficients),
            vertices_per_part: VERTICES_PER_PART,
            error: keys.error,
            free: FreeKeys {
                rays: keys.rays.is_none(),
                functions: keys.functions.is_none(),
                coefficients: keys.coefficients.is_none(),
            },
        }
    }

    /// Vertices a partition in a scene of so many.
    pub(super) fn part_size(&self, vertices: usize) -> u32 {
        match self.scheme {
            Scheme::Relume => self.vertices_per_part,
            Scheme::Paper => paper::vertices_per_part(vertices),
        }
    }

    /// Basis functions for so many vertices.
    pub(crate) fn function_count(&self, vertices: usize) -> u32 {
        self.functions.unwrap_or_else(|| match self.scheme {
            Scheme::Relume => (vertices as f64 * FUNCTIONS_PER_1000 / 1000.0).ceil() as u32,
            Scheme::Paper => paper::FUNCTIONS,
        })
    }
}
