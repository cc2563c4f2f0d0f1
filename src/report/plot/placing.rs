//! Where the labels of marks stand: beside their points, clear of the data and
//! of each other as far as that is possible.
use crate::maths::order::Order;

/// A rectangle in the plot's units, `y` downward.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Rectangle {
    pub(super) left: f64,
    pub(super) top: f64,
    pub(super) right: f64,
    pub(super) bottom: f64,
}

impl Rectangle {
    fn overlap(&self, other: &Self) -> f64 {
        let width = self.right.at_most(other.right) - self.left.at_least(other.left);
        let height = self.bottom.at_most(other.bottom) - self.top.at_least(other.top);
        width.at_least(0.0) * height.at_least(0.0)
    }

    fn area(&self) -> f64 {
        (self.right - self.left) * (self.bottom - self.top)
    }

    fn holds(&self, (x, y): (f64, f64)) -> bool {
        (self.left..=self.right).contains(&x) && (self.top..=self.bottom).contains(&y)
    }
}

/// Distances of a label from its point that are tried, nearest first.
const DISTANCES: [f64; 3] = [11.0, 22.0, 36.0];
/// Directions that are tried, in the order in which they read best.
const DIRECTIONS: [(f64, f64); 8] = [
    (1.0, 0.0),
    (1.0, -1.0),
    (1.0, 1.0),
    (0.0, -1.0),
    (0.0, 1.0),
    (-1.0, 0.0),
    (-1.0, -1.0),
    (-1.0, 1.0),
];
/// What a place costs: so much for each square unit outside the plot or under
/// another label, for each point of the data below it, and for a step away.
const OUTSIDE_COST: f64 = 10.0;
const LABEL_COST: f64 = 1.0;
const POINT_COST: f64 = 40.0;
const DISTANCE_COST: f64 = 15.0;

/// The cheapest rectangle of this size beside a point.
pub(super) fn place_label(
    point: (f64, f64),
    (width, height): (f64, f64),
    area: &Rectangle,
    labels: &[Rectangle],
    data: &[(f64, f64)],
) -> Rectangle {
    let rectangle = |distance: f64, (across, down): (f64, f64)| {
        let x = point.0 + across * distance + 0.5 * (across - 1.0) * width;
        let y = point.1 + down * distance + 0.5 * (down - 1.0) * height;
        Rectangle {
            left: x,
            top: y,
            right: x + width,
            bottom: y + height,
        }
    };
    let cost = |place: &Rectangle, step: usize| {
        let outside = place.area() - place.overlap(area);
        let under: f64 = labels.iter().map(|label| place.overlap(label)).sum();
        let points = data.iter().filter(|&&point| place.holds(point)).count();
        OUTSIDE_COST * outside
            + LABEL_COST * under
            + POINT_COST * points as f64
            + DISTANCE_COST * step as f64
    };
    let mut best = (f64::INFINITY, rectangle(DISTANCES[0], DIRECTIONS[0]));
    for (step, distance) in DISTANCES.into_iter().enumerate() {
        for direction in DIRECTIONS {
            let place = rectangle(distance, direction);
            let cost = cost(&place, step);
            if cost < best.0 {
                best = (cost, place);
            }
        }
    }
    best.1
}

#[cfg(test)]
mod tests {
    use super::*;

    const AREA: Rectangle = Rectangle {
        left: 0.0,
        top: 0.0,
        right: 200.0,
        bottom: 100.0,
    };

    #[test]
    fn labels_stay_inside_and_off_each_other() {
        let points = [(190.0, 50.0), (185.0, 52.0), (5.0, 5.0), (6.0, 95.0)];
        let mut labels = Vec::new();
        for point in points {
            labels.push(place_label(point, (60.0, 12.0), &AREA, &labels, &points));
        }
        for (index, label) in labels.iter().enumerate() {
            assert_eq!(label.overlap(&AREA), label.area(), "{label:?} lies inside");
            assert!(!points.iter().any(|&point| label.holds(point)), "{label:?}");
            for other in &labels[..index] {
                assert_eq!(label.overlap(other), 0.0, "{label:?} over {other:?}");
            }
        }
    }
}
