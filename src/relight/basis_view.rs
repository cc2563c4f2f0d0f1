//! The basis itself, in colours: its partitions and its functions.

use glam::Vec3;
use thiserror::Error;

use super::component::{BasisFunction, Component};
use super::palette::{distinct_colours, linear};
use crate::bake::Basis;
use crate::maths::functions::linear_from_srgb;
use crate::maths::order::Order;
use crate::surface::NONE;

/// sRGB levels of what lies outside of a function's partition and faces the
/// camera.
const OUTSIDE: [u8; 3] = [136, 136, 136];
/// Share of that grey, linear, where a surface is seen edge-on: with less
/// contrast nobody sees where in the scene the partition lies.
const EDGE_ON: f32 = 0.25;

/// The basis has no such function.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Error)]
pub enum BasisFunctionError {
    /// Its number is too large.
    #[error(
        "{asked}: the basis has {functions} functions in {partitions} partitions; \
         functions are numbered from 0 to {}",
        functions - 1
    )]
    Function {
        /// What was asked for.
        asked: BasisFunction,
        /// Functions of the basis.
        functions: usize,
        /// Partitions of the basis.
        partitions: usize,
    },
    /// The number of its partition is too large.
    #[error(
        "{asked}: the basis has {partitions} partitions, numbered from 0 to {}",
        partitions - 1
    )]
    Partition {
        /// What was asked for.
        asked: BasisFunction,
        /// Partitions of the basis.
        partitions: usize,
    },
    /// Its number in its partition is too large.
    #[error(
        "{asked}: partition {partition} of {partitions} has function numbers from 0 to {} \
         (functions in all: {functions})",
        functions - 1
    )]
    FunctionOfPartition {
        /// What was asked for.
        asked: BasisFunction,
        /// Its partition.
        partition: u32,
        /// Functions of the partition.
        functions: usize,
        /// Partitions of the basis.
        partitions: usize,
    },
}

/// What a component shows of the basis, by lighting vertex.
#[derive(Debug)]
pub(super) enum BasisView {
    /// Colour of each vertex's partition, linear.
    Partitions(Vec<Vec3>),
    /// A function's value over its largest magnitude; `None` outside of its
    /// partition.
    Function(Vec<Option<f32>>),
}

impl BasisView {
    /// What a component shows; `None` if that is not the basis.
    pub(super) fn of(
        basis: &Basis,
        component: Component,
    ) -> Result<Option<Self>, BasisFunctionError> {
        Ok(match component {
            Component::Partitions => Some(Self::partitions(basis)),
            Component::Basis(asked) => Some(Self::function(basis, asked)?),
            _ => None,
        })
    }

    fn partitions(basis: &Basis) -> Self {
        let colours = distinct_colours(basis.part_count());
        let slots = basis.slot_of_vertex().iter();
        Self::Partitions(
            slots
                .map(|&slot| colours[basis.row(slot).0 as usize])
                .collect(),
        )
    }

    fn function(basis: &Basis, asked: BasisFunction) -> Result<Self, BasisFunctionError> {
        let (partition, function) = find(basis, asked)?;
        let slots = basis.slot_of_vertex().iter();
        let values: Vec<Option<f32>> = slots
            .map(|&slot| {
                let (part, row) = basis.row(slot);
                (part == partition).then(|| row[function])
            })
            .collect();
        let magnitudes = values.iter().flatten().map(|value| value.abs());
        let largest = magnitudes.fold(f32::MIN_POSITIVE, f32::at_least);
        let normalised = |value: &Option<f32>| value.map(|value| value / largest);
        Ok(Self::Function(values.iter().map(normalised).collect()))
    }

    /// Linear colour at a point of a triangle, by the vertices of the side that
    /// is seen, or [`NONE`]; black where there is none. `facing` is the cosine
    /// between the normal and the way to the camera.
    ///
    /// The corner that weighs most decides which partition the point is in: its
    /// third of the triangle is what the vertex's area counts. Colours do not
    /// blend, and a function is interpolated inside its partition alone.
    pub(super) fn colour(&self, corners: [u32; 3], barycentrics: [f32; 3], facing: f32) -> Vec3 {
        let mut nearest: Option<(u32, f32)> = None;
        for (vertex, weight) in corners.into_iter().zip(barycentrics) {
            if vertex != NONE && nearest.is_none_or(|(_, most)| weight > most) {
                nearest = Some((vertex, weight));
            }
        }
        let Some((nearest, _)) = nearest else {
            return Vec3::ZERO;
        };
        match self {
            Self::Partitions(colours) => colours[nearest as usize],
            Self::Function(values) if values[nearest as usize].is_none() => {
                linear(&OUTSIDE) * (EDGE_ON + (1.0 - EDGE_ON) * facing)
            }
            Self::Function(values) => signed_colour(inside_mean(values, corners, barycentrics)),
        }
    }
}

/// Mean of a function over those corners that lie in its partition.
fn inside_mean(values: &[Option<f32>], corners: [u32; 3], barycentrics: [f32; 3]) -> f32 {
    let (mut sum, mut weights) = (0.0, 0.0);
    for (vertex, weight) in corners.into_iter().zip(barycentrics) {
        if let Some(Some(value)) = values.get(vertex as usize) {
            sum += weight * value;
            weights += weight;
        }
    }
    if weights > 0.0 { sum / weights } else { 0.0 }
}

/// Red for 1, white for 0, blue for -1, in equal steps of sRGB levels.
fn signed_colour(value: f32) -> Vec3 {
    let rest = linear_from_srgb(f64::from(1.0 - value.abs().at_most(1.0))) as f32;
    if value > 0.0 {
        Vec3::new(1.0, rest, rest)
    } else {
        Vec3::new(rest, rest, 1.0)
    }
}

/// Partition of a function, and its number there.
fn find(basis: &Basis, asked: BasisFunction) -> Result<(u32, usize), BasisFunctionError> {
    let (partitions, functions) = (basis.part_count(), basis.function_count());
    match asked {
        BasisFunction::InAll(number) => {
            let number = number as usize;
            (0..partitions as u32)
                .map(|part| (part, basis.function_range(part)))
                .find(|(_, range)| range.contains(&number))
                .map(|(part, range)| (part, number - range.start))
                .ok_or(BasisFunctionError::Function {
                    asked,
                    functions,
                    partitions,
                })
        }
        BasisFunction::InPartition {
            partition,
            function,
        } => {
            if partition as usize >= partitions {
                return Err(BasisFunctionError::Partition { asked, partitions });
            }
            let functions = basis.function_range(partition).len();
            if function as usize >= functions {
                return Err(BasisFunctionError::FunctionOfPartition {
                    asked,
                    partition,
                    functions,
                    partitions,
                });
            }
            Ok((partition, function as usize))
        }
    }
}
