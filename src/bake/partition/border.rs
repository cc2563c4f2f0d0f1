//! Border vertices change sides: first to even out the weights, then to
//! shorten the cut (in the manner of Fiduccia and Mattheyses 1982, without
//! moves that make things worse for a while).

use super::Split;

/// Passes that even out the weights, at most.
const BALANCE_PASSES: u32 = 24;

/// A part may weigh this many percent of the mean after a move that shortens
/// the cut. 125 gave the same cuts and less even parts.
const HEAVIEST_PERCENT: u64 = 112;

/// The affinity of an edge of mean cost. Edges twice as dear hold half as
/// tightly: borders run along creases and across long edges.
const MEAN_AFFINITY: u64 = 16;

/// Affinities stay in this range, so that no single edge rules a border.
const AFFINITY_RANGE: (u64, u64) = (4, 64);

/// Affinity that a move may lose if it evens out the weights, one mean edge:
/// without loss a strip of 4 x 2000 stays at 1.10 of the mean (1.02 with), and
/// twice as much frays borders (19 % longer around a hole).
const BALANCE_LOSS: i64 = 16;

/// Edges looked at to find out whether a part stays connected. A vertex that
/// needs more stays where it is.
const CONNECTION_BUDGET: usize = 512;

/// Evens out the weights of the parts, then shortens the cut; returns twice the
/// affinity of the edges that are cut.
pub(super) fn refine(split: &mut Split, passes: u32) -> u64 {
    let mut border = Border::new(split);
    for _ in 0..BALANCE_PASSES {
        if border.pass(Border::evens_out) == 0 {
            break;
        }
    }
    for _ in 0..passes {
        border.pass(Border::shortens_cut);
    }
    border.cut()
}

/// A vertex that could leave `from` for `to`.
struct Move {
    weight: u64,
    from: usize,
    to: usize,
    /// Affinity to `to` less affinity to `from`.
    gain: i64,
}

struct Border<'a, 'b> {
    split: &'a mut Split<'b>,
    part_weights: Vec<u64>,
    mean_weight: u64,
    mean_cost: u64,
    connection: Connection,
}

impl<'a, 'b> Border<'a, 'b> {
    fn new(split: &'a mut Split<'b>) -> Self {
        let part_weights = split.part_weights();
        let edges = split
            .members
            .iter()
            .flat_map(|&vertex| split.graph.costs(vertex));
        let (count, total) = edges.fold((0_u64, 0_u64), |(count, sum), &cost| {
            (count + 1, sum + u64::from(cost))
        });
        Self {
            mean_weight: part_weights.iter().sum::<u64>() / part_weights.len() as u64,
            mean_cost: total / count.max(1),
            part_weights,
            connection: Connection::default(),
            split,
        }
    }

    /// Moves border vertices in ascending order; the number of moves.
    fn pass(&mut self, worthwhile: impl Fn(&Self, &Move) -> bool) -> usize {
        let members = self.split.members;
        let mut moves = 0;
        for &vertex in members {
            if self.is_inside(vertex) {
                continue;
            }
            if let Some(best) = self.best_move(vertex, &worthwhile)
                && self.connection.survives_without(self.split, vertex)
            {
                self.split.labels[vertex as usize] = self.split.first_label + best.to as u32;
                self.part_weights[best.from] -= best.weight;
                self.part_weights[best.to] += best.weight;
                moves += 1;
            }
        }
        moves
    }

    /// Whether all neighbours are in the part of the vertex.
    fn is_inside(&self, vertex: u32) -> bool {
        let labels = &self.split.labels;
        let neighbours = self.split.graph.neighbours(vertex).iter();
        neighbours
            .copied()
            .all(|other| labels[other as usize] == labels[vertex as usize])
    }

    /// The worthwhile move of greatest gain, to the lowest part on ties.
    fn best_move(&self, vertex: u32, worthwhile: &impl Fn(&Self, &Move) -> bool) -> Option<Move> {
        let weight = self.split.weight(vertex);
        let from = (self.split.labels[vertex as usize] - self.split.first_label) as usize;
        let (inside, mut outside) = self.affinities(vertex, from);
        outside.sort_unstable();
        let mut best: Option<Move> = None;
        for (to, affinity) in outside {
            let candidate = Move {
                weight,
                from,
                to,
                gain: affinity - inside,
            };
            let better = best.as_ref().is_none_or(|best| candidate.gain > best.gain);
            if better && worthwhile(self, &candidate) {
                best = Some(candidate);
            }
        }
        best
    }

    /// Affinity of a vertex to its own part and to each neighbouring part.
    fn affinities(&self, vertex: u32, from: usize) -> (i64, Vec<(usize, i64)>) {
        let mut inside = 0;
        let mut outside: Vec<(usize, i64)> = Vec::new();
        for (neighbour, cost) in self.split.graph.edges_of(vertex) {
            let part = (self.split.labels[neighbour as usize] - self.split.first_label) as usize;
            let affinity = self.affinity(cost);
            if part == from {
                inside += affinity;
            } else if let Some(known) = outside.iter_mut().find(|known| known.0 == part) {
                known.1 += affinity;
            } else {
                outside.push((part, affinity));
            }
        }
        (inside, outside)
    }

    /// Affinity of the edges that are cut, each counted from both ends.
    fn cut(&self) -> u64 {
        let label = |vertex: u32| self.split.labels[vertex as usize];
        let edges = self.split.members.iter().flat_map(|&vertex| {
            let edges = self.split.graph.edges_of(vertex);
            edges.filter(move |&(neighbour, _)| label(neighbour) != label(vertex))
        });
        edges.map(|(_, cost)| self.affinity(cost) as u64).sum()
    }

    fn affinity(&self, cost: u32) -> i64 {
        let affinity = MEAN_AFFINITY * self.mean_cost / u64::from(cost);
        affinity.clamp(AFFINITY_RANGE.0, AFFINITY_RANGE.1) as i64
    }

    /// Weight flows down from heavy parts only, so that these passes come to an end.
    fn evens_out(&self, candidate: &Move) -> bool {
        let from = self.part_weights[candidate.from];
        let to = self.part_weights[candidate.to];
        from > self.mean_weight && candidate.gain >= -BALANCE_LOSS && to + candidate.weight < from
    }

    fn shortens_cut(&self, candidate: &Move) -> bool {
        let from = self.part_weights[candidate.from];
        let to = self.part_weights[candidate.to] + candidate.weight;
        let fits = to * 100 <= self.mean_weight * HEAVIEST_PERCENT;
        candidate.gain > 0 && (fits || to < from)
    }
}

/// Search for ways around a vertex inside its part.
#[derive(Default)]
struct Connection {
    reached: Vec<u32>,
}

impl Connection {
    /// Whether the part of `vertex` is sure to stay one piece, and not empty,
    /// without it: a short search joins all its neighbours in the part.
    fn survives_without(&mut self, split: &Split, vertex: u32) -> bool {
        let label = split.labels[vertex as usize];
        let inside = |vertex: u32| split.labels[vertex as usize] == label;
        let neighbours = split.graph.neighbours(vertex);
        let wanted = neighbours
            .iter()
            .filter(|&&neighbour| inside(neighbour))
            .count();
        let Some(&start) = neighbours.iter().find(|&&neighbour| inside(neighbour)) else {
            return false;
        };
        self.reached.clear();
        self.reached.push(start);
        let (mut found, mut visited, mut budget) = (1, 0, CONNECTION_BUDGET);
        while found < wanted && visited < self.reached.len() {
            let row = split.graph.neighbours(self.reached[visited]);
            visited += 1;
            if row.len() > budget {
                return false;
            }
            budget -= row.len();
            for &other in row {
                if other != vertex && inside(other) && !self.reached.contains(&other) {
                    self.reached.push(other);
                    found += usize::from(neighbours.binary_search(&other).is_ok());
                }
            }
        }
        found == wanted
    }
}
