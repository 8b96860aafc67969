//! The world: true poses, the camera that shows it, and what the robot senses of it.

use std::{sync::Arc, time::Instant};

use reality_sim::{
    Archive, CameraPose, Pose2,
    glam::{DVec2, Vec3},
    mount::MountPose,
    pose::Motion2,
    simulator::{Ball, Camera, Frame, LookError},
};

use crate::{
    noise::{IMU_RAD, Noise, ODOMETRY_M, ODOMETRY_RAD, ODOMETRY_SCALE, PLACED_M, PLACED_RAD, Use},
    rolling_ball::{BallRoute, RollingBall},
    senses::{Command, Senses},
    walker::Walker,
};

/// Radius of the ball, metres.
pub const BALL_RADIUS_M: f64 = 0.065;
/// Reflectance of the ball: red, because an orange one lies in the recorded hall.
const BALL_REFLECTANCE: Vec3 = Vec3::new(0.8, 0.03, 0.03);
/// Highlight of the ball, as measured on ray-traced balls, see docs/simulator.md.
const BALL_GLOSS: f32 = 0.4;
/// Part of the ball's way on which it may start.
const START_PART: f64 = 0.5;

/// What is so, whatever the robot believes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Truth {
    /// Time, seconds.
    pub time_s: f64,
    /// Pose of the camera.
    pub camera: CameraPose,
    /// Place of the ball on the ground, metres.
    pub ball_in_world: DVec2,
    /// Where the robot would be if its odometry were right.
    pub by_odometry: Pose2,
}

/// World with a robot and a ball.
#[derive(Debug)]
pub struct World {
    camera: Camera,
    frame: Frame,
    /// Height, pitch and roll of the camera of a robot that stands.
    standing: CameraPose,
    walker: Walker,
    ball: RollingBall,
    noise: Noise,
    time_s: f64,
    /// Number of pictures so far.
    pictures: u32,
    start: Pose2,
    odometry: Pose2,
    odometry_scale: f64,
    looked_s: f64,
}

impl World {
    /// Puts robot and ball where pictures were recorded. `None` where the archive's recordings lead nowhere.
    pub fn new(archive: Arc<Archive>, noise: Noise) -> Option<Self> {
        let route = BallRoute::ahead_of(&longest_recording(&archive), archive.field())?;
        let way_m = START_PART * noise.start() * route.length_m();
        let start = route.camera(way_m);
        let [scale, ..] = noise.normals(Use::Start, 1);
        Some(Self {
            standing: archive.usual_pose(),
            camera: Camera::new(archive),
            frame: Frame::default(),
            walker: Walker::new(start, noise),
            ball: RollingBall::new(route, way_m, noise),
            noise,
            time_s: 0.0,
            pictures: 0,
            start,
            odometry: Pose2::default(),
            odometry_scale: 1.0 + ODOMETRY_SCALE * scale,
            looked_s: 0.0,
        })
    }

    /// Returns where the person who placed the robot says that it starts.
    pub fn placed(&self) -> Pose2 {
        let [x, y, yaw, ..] = self.noise.normals(Use::Start, 0);
        let Pose2 { x_m, y_m, yaw_rad } = self.start;
        Pose2::new(x_m + PLACED_M * x, y_m + PLACED_M * y, yaw_rad + PLACED_RAD * yaw)
    }

    /// Returns what the robot senses now. Fails where too little was recorded near it.
    pub fn sense(&mut self) -> Result<Senses, LookError> {
        let pose = self.walker.camera_pose(self.standing);
        let place = self.ball.place_in_world();
        let ball = Ball::on_ground(place.x, place.y, BALL_RADIUS_M, BALL_REFLECTANCE)
            .glossy(BALL_GLOSS)
            .moving(self.ball.velocity_in_world().extend(0.0));
        let begin = Instant::now();
        self.camera.set_time_s(self.time_s);
        self.camera.look(pose, &[&ball], &mut self.frame)?;
        self.looked_s += begin.elapsed().as_secs_f64();
        let [pitch, roll, ..] = self.noise.normals(Use::Imu, self.pictures);
        self.pictures += 1;
        Ok(Senses {
            time_s: self.time_s,
            picture: Arc::new(self.frame.picture.clone()),
            mount: MountPose {
                height_m: self.standing.height_m,
                pitch_rad: pose.pitch_rad + IMU_RAD * pitch,
                roll_rad: pose.roll_rad + IMU_RAD * roll,
            },
            odometry: self.odometry,
        })
    }

    /// Lets some seconds pass in which the robot walks with this velocity.
    pub fn go_on(&mut self, command: Command, seconds: f64) {
        let before = self.walker.ground();
        self.walker.walk(command, seconds);
        self.ball.roll(seconds);
        self.time_s += seconds;
        self.count_steps(before.motion_to(self.walker.ground()), seconds);
    }

    fn count_steps(&mut self, motion: Motion2, seconds: f64) {
        let [forward, left, turn, ..] = self.noise.normals(Use::Odometry, self.pictures);
        let (scale, root_s) = (self.odometry_scale, seconds.sqrt());
        self.odometry = self.odometry.moved(Motion2 {
            forward_m: scale * motion.forward_m + ODOMETRY_M * root_s * forward,
            left_m: scale * motion.left_m + ODOMETRY_M * root_s * left,
            turn_rad: scale * motion.turn_rad + ODOMETRY_RAD * root_s * turn,
        });
    }

    /// Returns what is so, for a report: nothing that the robot is made of can read it.
    pub fn truth(&self) -> Truth {
        let moved = Pose2::default().motion_to(self.odometry);
        Truth {
            time_s: self.time_s,
            camera: self.walker.camera_pose(self.standing),
            ball_in_world: self.ball.place_in_world(),
            by_odometry: self.start.moved(moved),
        }
    }

    /// Returns how much of the last picture was recorded, 0 to 1.
    pub fn covered(&self) -> f64 {
        self.frame.covered
    }

    /// Returns the time that the camera has taken so far, seconds.
    pub fn looked_s(&self) -> f64 {
        self.looked_s
    }
}

/// Returns the poses of the recording with most pictures, in the order in which they were taken.
fn longest_recording(archive: &Archive) -> Vec<CameraPose> {
    let mut poses: std::collections::BTreeMap<i64, Vec<(usize, CameraPose)>> = Default::default();
    for image in archive.images() {
        poses.entry(image.sequence_id).or_default().push((image.frame_index, image.pose));
    }
    let mut longest = poses.into_values().max_by_key(Vec::len).unwrap_or_default();
    longest.sort_by_key(|(frame, _)| *frame);
    longest.into_iter().map(|(_, pose)| pose).collect()
}
