//! Things that the simulator moves.

use std::slice;

use reality_sim::{
    Pose2,
    glam::{DVec2, DVec3, Vec3},
    sensor::linear_from_srgb,
    simulator::{self, Layer},
};

use crate::status::Failure;

/// Ball of one colour.
#[derive(Debug, Clone, Copy, PartialEq)]
#[repr(C)]
pub struct Ball {
    /// Centre, metres.
    pub x_m: f64,
    /// Centre, metres.
    pub y_m: f64,
    /// Centre, metres: the radius where the ball lies on the ground.
    pub z_m: f64,
    /// Radius, metres.
    pub radius_m: f64,
    /// Velocity in the world, metres per second, by which the picture is blurred.
    pub velocity_m_s: [f64; 3],
    /// Colour in white light: red, green and blue, sRGB.
    pub color: [u8; 3],
}

/// Robot of simple parts.
#[derive(Debug, Clone, Copy, PartialEq)]
#[repr(C)]
pub struct Robot {
    /// Place between its feet, metres.
    pub x_m: f64,
    /// Place between its feet, metres.
    pub y_m: f64,
    /// Heading, radians.
    pub yaw_rad: f64,
    /// Height, metres.
    pub height_m: f64,
    /// Phase of its gait, radians. It stands where this is not a number.
    pub gait_rad: f64,
    /// Velocity in the world, metres per second, by which the picture is blurred.
    pub velocity_m_s: [f64; 2],
    /// Colour of its team in white light: red, green and blue, sRGB.
    pub color: [u8; 3],
}

/// Everything that is drawn over the recorded scene.
#[derive(Debug, Clone, Copy)]
#[repr(C)]
pub struct Scene {
    /// Balls; not read where there are none.
    pub balls: *const Ball,
    /// Number of balls.
    pub ball_count: usize,
    /// Robots; not read where there are none.
    pub robots: *const Robot,
    /// Number of robots.
    pub robot_count: usize,
}

/// Returns an orange ball of FIFA's size 1 that lies on the ground.
#[unsafe(no_mangle)]
pub extern "C" fn rs_ball(x_m: f64, y_m: f64) -> Ball {
    Ball { x_m, y_m, z_m: 0.065, radius_m: 0.065, velocity_m_s: [0.0; 3], color: [255, 128, 0] }
}

/// Returns a blue robot as tall as a NAO that stands.
#[unsafe(no_mangle)]
pub extern "C" fn rs_robot(x_m: f64, y_m: f64, yaw_rad: f64) -> Robot {
    Robot {
        x_m,
        y_m,
        yaw_rad,
        height_m: 0.58,
        gait_rad: f64::NAN,
        velocity_m_s: [0.0; 2],
        color: [40, 90, 220],
    }
}

impl Scene {
    /// Makes the layers, balls first.
    ///
    /// # Safety
    ///
    /// The pointers are those of as many balls and robots as the scene says.
    pub unsafe fn layers(&self) -> Result<Vec<Box<dyn Layer>>, Failure> {
        // SAFETY: the caller says so.
        let (balls, robots) = unsafe {
            (given("balls", self.balls, self.ball_count)?, given("robots", self.robots, self.robot_count)?)
        };
        let balls = balls.iter().enumerate().map(|(number, ball)| ball.layer(number));
        let robots = robots.iter().enumerate().map(|(number, robot)| robot.layer(number));
        balls.chain(robots).collect()
    }
}

/// Returns an array of C, which may be missing if it is empty.
///
/// # Safety
///
/// There are so many valid values at the pointer.
unsafe fn given<'a, T>(name: &str, first: *const T, count: usize) -> Result<&'a [T], Failure> {
    match (first.is_null(), count) {
        (_, 0) => Ok(&[]),
        (true, _) => Err(Failure::argument(format!("scene: {name} is NULL, but there are {count} of them"))),
        // SAFETY: the caller says so.
        (false, _) => Ok(unsafe { slice::from_raw_parts(first, count) }),
    }
}

impl Ball {
    fn layer(&self, number: usize) -> Result<Box<dyn Layer>, Failure> {
        let [vx, vy, vz] = self.velocity_m_s;
        check("ball", number, &[self.x_m, self.y_m, self.z_m, vx, vy, vz], self.radius_m)?;
        let mut ball = simulator::Ball::on_ground(self.x_m, self.y_m, self.radius_m, reflectance(self.color));
        ball.center_in_world.z = self.z_m;
        Ok(Box::new(ball.moving(DVec3::new(vx, vy, vz)).named(format!("ball {number}"))))
    }
}

impl Robot {
    fn layer(&self, number: usize) -> Result<Box<dyn Layer>, Failure> {
        let [vx, vy] = self.velocity_m_s;
        check("robot", number, &[self.x_m, self.y_m, self.yaw_rad, vx, vy], self.height_m)?;
        let place = Pose2::new(self.x_m, self.y_m, self.yaw_rad);
        let mut robot = simulator::Humanoid::standing(place, self.height_m, reflectance(self.color));
        robot.gait_rad = self.gait_rad.is_finite().then_some(self.gait_rad);
        robot.velocity_in_world = DVec2::new(vx, vy);
        Ok(Box::new(robot.named(format!("robot {number}"))))
    }
}

fn check(what: &str, number: usize, numbers: &[f64], size_m: f64) -> Result<(), Failure> {
    if !numbers.iter().all(|number| number.is_finite()) {
        return Err(Failure::argument(format!(
            "{what} {number}: a place, heading or velocity is not finite"
        )));
    }
    if !(size_m.is_finite() && size_m > 0.0) {
        return Err(Failure::argument(format!("{what} {number}: its size is {size_m}: give metres above 0")));
    }
    Ok(())
}

/// Returns the reflectance of what has this colour, sRGB, in white light as bright as full white.
fn reflectance(srgb: [u8; 3]) -> Vec3 {
    Vec3::from_array(srgb.map(linear_from_srgb))
}
