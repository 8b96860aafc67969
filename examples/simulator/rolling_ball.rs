//! The true ball, and the way that it rolls.

use std::f64::consts::TAU;

use reality_sim::{CameraPose, Pose2, field::FieldDimensions, glam::DVec2};

use crate::noise::{Noise, Use};

/// Distance at which the ball rolls ahead of where the recording camera was, metres.
const AHEAD_M: f64 = 0.9;
/// Number of pictures before and after a picture over which the way is averaged.
const SMOOTHED: usize = 3;
/// Mean speed, metres per second, the share by which it changes, and the time in which it does, seconds: the ball is pushed
/// again and again.
const SPEED_M_S: f64 = 0.18;
const CHANGE: f64 = 0.6;
const PERIOD_S: [f64; 2] = [4.0, 9.0];
/// Distance of the way from the edge of the carpet, metres.
const MARGIN_M: f64 = 0.2;

/// Way on which somebody pushes the ball: ahead of where the recording robot walked, so that whoever follows the ball walks
/// where pictures are.
#[derive(Debug, Clone)]
pub struct BallRoute {
    /// Recorded poses, with the way of the ball up to the place ahead of each, metres.
    stations: Vec<Station>,
}

#[derive(Debug, Clone, Copy)]
struct Station {
    camera: Pose2,
    ball: DVec2,
    way_m: f64,
}

impl BallRoute {
    /// Lays the route ahead of recorded poses, in the order in which they were recorded. `None` where they lead nowhere.
    pub fn ahead_of(poses: &[CameraPose], field: &FieldDimensions) -> Option<Self> {
        let most = field.carpet_half_extent_m() - MARGIN_M;
        let ahead = |pose: &CameraPose| {
            let place = pose.planar().position_in_world() + AHEAD_M * DVec2::from_angle(pose.yaw_rad);
            place.clamp(-most, most)
        };
        let places: Vec<DVec2> = poses.iter().map(ahead).collect();
        let smoothed = |index: usize| {
            let around = &places[index.saturating_sub(SMOOTHED)..(index + SMOOTHED + 1).min(places.len())];
            around.iter().sum::<DVec2>() / around.len() as f64
        };
        let mut stations: Vec<Station> = Vec::with_capacity(poses.len());
        for (index, pose) in poses.iter().enumerate() {
            let ball = smoothed(index);
            let way_m = stations.last().map_or(0.0, |last| last.way_m + last.ball.distance(ball));
            stations.push(Station { camera: pose.planar(), ball, way_m });
        }
        let route = Self { stations };
        (route.length_m() > 0.0).then_some(route)
    }

    /// Returns the length of the way, metres.
    pub fn length_m(&self) -> f64 {
        self.stations.last().map_or(0.0, |last| last.way_m)
    }

    /// Returns the place of the ball after a way, metres, which turns round at either end.
    fn place(&self, way_m: f64) -> DVec2 {
        let way_m = self.folded(way_m);
        let next = self.next(way_m);
        let (a, b) = (self.stations[next - 1], self.stations[next]);
        let length_m = b.way_m - a.way_m;
        let part = if length_m > 0.0 { (way_m - a.way_m) / length_m } else { 0.0 };
        a.ball.lerp(b.ball, part)
    }

    /// Returns the recorded pose that has the ball ahead of it after a way, metres.
    pub fn camera(&self, way_m: f64) -> Pose2 {
        self.stations[self.next(self.folded(way_m))].camera
    }

    /// Returns the first station after a way; there is one before it.
    fn next(&self, way_m: f64) -> usize {
        let next = self.stations.partition_point(|station| station.way_m <= way_m);
        next.clamp(1, self.stations.len() - 1)
    }

    fn folded(&self, way_m: f64) -> f64 {
        let length_m = self.length_m();
        let way_m = way_m.rem_euclid(2.0 * length_m);
        if way_m > length_m { 2.0 * length_m - way_m } else { way_m }
    }
}

/// Ball that rolls along a route.
#[derive(Debug, Clone)]
pub struct RollingBall {
    route: BallRoute,
    way_m: f64,
    time_s: f64,
    period_s: f64,
    phase_rad: f64,
}

impl RollingBall {
    /// Puts the ball on the route after a way, metres.
    pub fn new(route: BallRoute, way_m: f64, noise: Noise) -> Self {
        let [_, _, _, _, phase_rad, period] = noise.normals(Use::Constant, 0);
        let [least, most] = PERIOD_S;
        let period_s = least + (most - least) / (1.0 + period.exp());
        Self { route, way_m, time_s: 0.0, period_s, phase_rad }
    }

    /// Returns its place on the ground, metres.
    pub fn place_in_world(&self) -> DVec2 {
        self.route.place(self.way_m)
    }

    /// Returns its velocity, metres per second.
    pub fn velocity_in_world(&self) -> DVec2 {
        const STEP_S: f64 = 0.02;
        let way_m = self.speed_m_s() * STEP_S;
        let [before, after] = [-0.5, 0.5].map(|part| self.route.place(self.way_m + part * way_m));
        (after - before) / STEP_S
    }

    /// Rolls on for some seconds.
    pub fn roll(&mut self, seconds: f64) {
        self.way_m += self.speed_m_s() * seconds;
        self.time_s += seconds;
    }

    fn speed_m_s(&self) -> f64 {
        SPEED_M_S * (1.0 + CHANGE * (TAU * self.time_s / self.period_s + self.phase_rad).sin())
    }
}
