//! Halls: carpet, paint, lamps, and what stands about.

use crate::{carpet::CarpetPlan, random::Random, setting::HallPlan};

/// Draws a hall whose light is even to a percent.
pub fn draw(random: &mut Random) -> HallPlan {
    let carpet = carpet(random);
    let size_m = 0.05 * random.between(0.0, 10.0_f64.ln()).exp();
    let wear = (size_m, random.between(0.0, 0.085));
    let edges = (random.between(0.02, 0.06), random.between(0.0, 0.0012));
    let warmth = random.between(-1.0, 1.0);
    let white = [[0.4; 3], [0.5; 3]];
    let coloured = [[0.55, 0.42, 0.02], [0.03, 0.09, 0.4]];
    HallPlan {
        carpet,
        wear,
        line_spread: random.between(0.0, 0.02),
        edges,
        lamp_rgb: [1.0 + 0.12 * warmth, 1.0, 1.0 - 0.15 * warmth],
        ceiling_m: random.between(3.2, 7.0),
        goal_rgb: if random.uniform() < 0.7 { white } else { coloured },
        has_ball: random.uniform() < 0.7,
        robots: random.below(6),
        people: random.below(4),
    }
}

fn carpet(random: &mut Random) -> CarpetPlan {
    let mut layer = |smallest: f64, largest: f64| {
        let size_m = random.between(smallest.ln(), largest.ln()).exp();
        (size_m, random.between(0.005, 0.04))
    };
    let blotches = vec![layer(0.03, 0.12), layer(0.12, 0.6), layer(0.6, 2.0)];
    CarpetPlan {
        roll_m: random.between(1.0, 4.0),
        rolls_along_x: random.sign() > 0.0,
        roll_spread: random.between(0.0, 0.1),
        seam: random.between(0.0, 0.15),
        pile: random.between(0.0, 0.05),
        blotches,
        dirt: random.between(0.0, 0.03),
        paths: (random.below(5), random.between(0.0, 0.06)),
        stains: random.below(7),
        sheen: random.between(0.0, 0.03),
        unevenness: random.between(0.0, 0.004),
    }
}
