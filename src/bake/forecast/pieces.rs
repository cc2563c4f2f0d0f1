//! The pieces that vertices fall into, before there are partitions.

use crate::bake::BakeSettings;
use crate::bake::function_shares::{functions_by_share, root_shares};
use crate::bake::neighbours::vertex_graph;
use crate::bake::scheme::{Partitioner, Scheme};
use crate::bake::transfer::GROUP;
use crate::surface::Surface;

/// The pieces that vertices fall into, as far as they matter here.
pub(super) struct Pieces {
    pub(super) component_of: Vec<u32>,
    /// Vertices, parts and functions of each component.
    pub(super) sizes: Vec<usize>,
    pub(super) parts: Vec<usize>,
    pub(super) functions: Vec<usize>,
    /// Receivers, about as the bake groups them.
    pub(super) groups: Vec<Vec<u32>>,
}

impl Pieces {
    /// Parts of a component count as equal in vertices and area.
    pub(super) fn of(surface: &Surface, settings: &BakeSettings) -> Self {
        let vertex_count = surface.vertices.len();
        let components = match settings.scheme.partitioner() {
            Partitioner::Relume => vertex_graph(surface).connected_components(),
            // The parts of METIS hold small components together.
            Partitioner::Metis => vec![(0..vertex_count as u32).collect()],
        };
        let mut component_of = vec![0; vertex_count];
        for (index, members) in components.iter().enumerate() {
            for &vertex in members {
                component_of[vertex as usize] = index as u32;
            }
        }
        let per_part = settings.part_size(vertex_count).max(1) as usize;
        let parts_of = |size: usize| ((size + per_part / 2) / per_part).clamp(1, size.max(1));
        let parts: Vec<usize> = components.iter().map(|c| parts_of(c.len())).collect();
        let (mut part_areas, mut part_sizes) = (Vec::new(), Vec::new());
        for (members, &parts) in components.iter().zip(&parts) {
            let areas = members
                .iter()
                .map(|&v| surface.vertices.areas()[v as usize]);
            let area: f64 = areas.map(f64::from).sum();
            part_areas.extend(std::iter::repeat_n(area / parts as f64, parts));
            part_sizes.extend(std::iter::repeat_n(members.len() / parts, parts));
        }
        let total = settings.function_count(vertex_count);
        // What a part hands on is not known here; its area stands for it.
        let shares = match settings.scheme {
            Scheme::Relume => root_shares(&part_areas, &part_sizes),
            Scheme::Paper => vec![1.0; part_sizes.len()],
        };
        let of_parts = functions_by_share(&shares, &part_sizes, total);
        let mut rest = of_parts.as_slice();
        let mut functions = Vec::new();
        for &parts in &parts {
            let (own, others) = rest.split_at(parts);
            functions.push(own.iter().map(|&count| count as usize).sum());
            rest = others;
        }
        Self {
            component_of,
            sizes: components.iter().map(Vec::len).collect(),
            parts,
            functions,
            groups: components
                .iter()
                .flat_map(|members| members.chunks(GROUP).map(<[u32]>::to_vec))
                .collect(),
        }
    }

    /// Groups of all parts: the last of each may be shorter.
    pub(super) fn group_count(&self) -> usize {
        let of_component =
            |(&size, &parts): (&usize, &usize)| parts * (size / parts).div_ceil(GROUP);
        self.sizes.iter().zip(&self.parts).map(of_component).sum()
    }

    /// Values of all functions: those of a part at its vertices.
    pub(super) fn value_count(&self) -> usize {
        let of_component = |i: usize| self.sizes[i] * self.functions[i] / self.parts[i];
        (0..self.sizes.len()).map(of_component).sum()
    }
}
