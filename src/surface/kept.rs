//! Arrivals that were traced before, for those who look at one surface many
//! times.

use super::Arrival;

/// A ray that escaped.
const ESCAPED: u32 = u32::MAX;

/// Where the rays of every vertex arrive, as many of each.
pub(crate) struct KeptArrivals {
    rays: u32,
    /// Triangle x 2 + front, and the bits of the barycentric coordinates.
    sites: Vec<[u32; 4]>,
}

impl KeptArrivals {
    /// Arrivals vertex by vertex, `rays` of each.
    pub(crate) fn new(rays: u32, arrivals: impl Iterator<Item = Option<Arrival>>) -> Self {
        Self {
            rays,
            sites: arrivals.map(site).collect(),
        }
    }

    /// Bytes that `rays` of a vertex take.
    pub(crate) const fn bytes_of(rays: u32) -> usize {
        rays as usize * size_of::<[u32; 4]>()
    }

    /// Joins lists of the same number of rays, in their order, and gives each back
    /// to the system once it is copied.
    pub(crate) fn concat(rays: u32, lists: Vec<Self>) -> Self {
        let mut sites = Vec::with_capacity(lists.iter().map(|list| list.sites.len()).sum());
        for list in lists {
            sites.extend(list.sites);
        }
        Self { rays, sites }
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

fn site(arrival: Option<Arrival>) -> [u32; 4] {
    arrival.map_or([ESCAPED; 4], |it| {
        let [a, b, c] = it.barycentrics.map(f32::to_bits);
        [it.triangle << 1 | u32::from(it.front), a, b, c]
    })
}

fn arrival(site: &[u32; 4]) -> Option<Arrival> {
    let &[side, a, b, c] = site;
    (side != ESCAPED).then(|| Arrival {
        triangle: side >> 1,
        barycentrics: [a, b, c].map(f32::from_bits),
        front: side & 1 == 1,
    })
}
