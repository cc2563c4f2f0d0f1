//! Arrivals that were traced before, for those who look at one surface many
//! times.

use rayon::prelude::*;

use super::Arrival;

/// A ray that escaped; zeros are what the system has at hand.
const ESCAPED: u32 = 0;

/// Where the rays of every vertex arrive, as many of each.
pub(crate) struct KeptArrivals {
    rays: u32,
    /// Triangle x 2 + front + 1, and the bits of the barycentric coordinates.
    sites: Vec<[u32; 4]>,
}

impl KeptArrivals {
    /// Room for `rays` of each of so many vertices; until they are traced, all escape.
    pub(crate) fn untraced(rays: u32, vertices: usize) -> Self {
        Self {
            rays,
            sites: vec![[0; 4]; vertices * rays as usize],
        }
    }

    /// The rows of `vertices` vertices at a time, in order.
    pub(crate) fn rows_mut(
        &mut self,
        vertices: usize,
    ) -> impl IndexedParallelIterator<Item = KeptRows<'_>> {
        let chunks = self.sites.par_chunks_mut(vertices * self.rays as usize);
        chunks.map(|sites| KeptRows { sites })
    }

    /// Bytes that so many rays take.
    pub(crate) const fn bytes_of(rays: u64) -> u64 {
        rays * size_of::<[u32; 4]>() as u64
    }

    /// Rays of each vertex.
    pub(crate) fn rays(&self) -> u32 {
        self.rays
    }

    /// The first `count` arrivals of a vertex, at most [`Self::rays`].
    pub(crate) fn of_vertex(
        &self,
        vertex: u32,
        count: u32,
    ) -> impl Iterator<Item = Option<Arrival>> {
        let first = vertex as usize * self.rays as usize;
        self.sites[first..first + count as usize]
            .iter()
            .map(arrival)
    }
}

/// The rows of some vertices, to be filled.
pub(crate) struct KeptRows<'a> {
    sites: &'a mut [[u32; 4]],
}

impl KeptRows<'_> {
    /// Puts in the arrivals of all their rays, vertex by vertex.
    pub(crate) fn fill(self, arrivals: impl Iterator<Item = Option<Arrival>>) {
        for (place, arrival) in self.sites.iter_mut().zip(arrivals) {
            *place = site(arrival);
        }
    }
}

fn site(arrival: Option<Arrival>) -> [u32; 4] {
    arrival.map_or([ESCAPED; 4], |it| {
        let [a, b, c] = it.barycentrics.map(f32::to_bits);
        [(it.triangle << 1 | u32::from(it.front)) + 1, a, b, c]
    })
}

fn arrival(site: &[u32; 4]) -> Option<Arrival> {
    let &[side, a, b, c] = site;
    let side = side.checked_sub(1)?;
    Some(Arrival {
        triangle: side >> 1,
        barycentrics: [a, b, c].map(f32::from_bits),
        front: side & 1 == 1,
    })
}
