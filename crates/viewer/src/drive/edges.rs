//! Edges of the triangulation, thinned to as many as can be distinguished.

use glam::DVec2;
use reality_sim_db::index::PoseIndex;

/// Largest number of edges to draw: more would merge into a grey area.
const MOST_EDGES: usize = 6000;

/// Rectangle on the field: smallest and largest x and y in the world frame, metres.
pub type Region = [DVec2; 2];

/// Edges of one sector's triangulation within a region.
#[derive(Debug, Clone, PartialEq)]
pub struct Edges {
    /// Weight of the sector at the heading; the weights of both sectors add up to 1.
    pub share: f64,
    /// Edges to draw, in the world frame, metres.
    pub shown_in_world: Vec<[DVec2; 2]>,
    /// Number of edges in the region.
    pub count: usize,
}

/// Returns the edges in a region of the triangulations around a heading, radians. Where there are too many, every n-th is
/// kept: the triangulation's order covers the whole region.
pub fn edges(index: &PoseIndex, yaw_rad: f64, region: Region) -> Vec<Edges> {
    let sectors = index.triangulations(yaw_rad).into_iter();
    let clipped = sectors.map(|sector| {
        let mut edges_in_world = sector.edges_in_world;
        edges_in_world.retain(|&ends| may_lie_in(ends, region));
        (sector.share, edges_in_world)
    });
    clipped.map(|(share, edges_in_world)| thinned(share, edges_in_world)).collect()
}

fn thinned(share: f64, edges_in_world: Vec<[DVec2; 2]>) -> Edges {
    let count = edges_in_world.len();
    let step = count.div_ceil(MOST_EDGES).max(1);
    Edges { share, shown_in_world: edges_in_world.into_iter().step_by(step).collect(), count }
}

/// Whether the bounding box of an edge intersects a region.
fn may_lie_in([from, to]: [DVec2; 2], [min, max]: Region) -> bool {
    from.min(to).cmple(max).all() && from.max(to).cmpge(min).all()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn edges_that_cross_a_region_lie_in_it_and_those_beside_it_do_not() {
        let region = [DVec2::new(-1.0, -1.0), DVec2::new(1.0, 2.0)];
        let edge = |x: f64, y: f64, to_x: f64, to_y: f64| [DVec2::new(x, y), DVec2::new(to_x, to_y)];
        assert!(may_lie_in(edge(0.0, 0.0, 0.5, 1.5), region), "within");
        assert!(may_lie_in(edge(-5.0, 0.0, 5.0, 0.1), region), "across, both ends outside");
        assert!(!may_lie_in(edge(1.1, -5.0, 1.2, 5.0), region), "beside");
        assert!(!may_lie_in(edge(-0.5, 2.5, 0.5, 2.1), region), "above");
    }

    #[test]
    fn of_too_many_edges_some_are_left_from_all_over_the_region_and_all_are_counted() {
        let edge = |number: usize| [DVec2::new(number as f64, 0.0), DVec2::new(number as f64, 1.0)];
        let edges = thinned(0.4, (0..20_001).map(edge).collect());
        assert_eq!(edges.count, 20_001);
        assert!(edges.shown_in_world.len() <= MOST_EDGES && edges.shown_in_world.len() > MOST_EDGES / 2);
        let last = edges.shown_in_world.last().unwrap()[0].x;
        assert!(edges.shown_in_world[0][0].x == 0.0 && last > 19_990.0, "{last}");
        let few = thinned(0.4, (0..50).map(edge).collect());
        assert_eq!((few.shown_in_world.len(), few.count), (50, 50));
    }
}
