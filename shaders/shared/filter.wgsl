// What the kernels of the particle filter share.

/// A pose of the camera: `CameraPose` in single precision.
struct Particle {
    x_m: f32,
    y_m: f32,
    yaw_rad: f32,
    height_m: f32,
    pitch_rad: f32,
    roll_rad: f32,
    padding_0: f32,
    padding_1: f32,
}

/// What one update is told.
struct Frame {
    seed: vec2<u32>,
    number: u32,
    particles: u32,
    /// RESIDUAL and so on.
    resampling: u32,
    /// BEST and so on.
    estimator: u32,
    /// Remainders of the residual scheme are shifted right by this, so that their sum fits a word.
    rest_shift: u32,
    /// Since the previous picture, in the camera's frame.
    forward_m: f32,
    left_m: f32,
    turn_rad: f32,
    predict_sigma_m: f32,
    predict_sigma_rad: f32,
    diffuse_sigma_m: f32,
    diffuse_sigma_rad: f32,
    /// By joints and IMU.
    height_m: f32,
    pitch_rad: f32,
    roll_rad: f32,
    /// What these are worth; 0 where the particles take them as they are.
    height_sigma_m: f32,
    angle_sigma_rad: f32,
    /// Factors of the two sums along a pose's lines that add up to its log-weight.
    per_value: f32,
    per_seen: f32,
    padding_0: u32,
    padding_1: u32,
    padding_2: u32,
}

/// One of the T rounds of weighing and resampling.
struct Iteration {
    number: u32,
    /// Of the diffusion.
    scale: f32,
    padding_0: u32,
    padding_1: u32,
}

const ALTERNATIVES: u32 = 6u;

/// What comes of an update.
struct Outcome {
    /// The best particle of all iterations.
    best: Particle,
    estimate: Particle,
    alternatives: array<Particle, 6>,
    alternative_count: u32,
    best_log_weight: f32,
    effective_sample_size: f32,
    spread_m: f32,
}

const BEST: u32 = 0u;
const MEAN: u32 = 1u;
const CLUSTER: u32 = 2u;

const RESIDUAL: u32 = 0u;
const SYSTEMATIC: u32 = 1u;
const STRATIFIED: u32 = 2u;
const MULTINOMIAL: u32 = 3u;

/// Threads of kernels that handle one particle a thread.
const THREADS: u32 = 64u;
/// Threads of kernels that look at all particles, one workgroup of them: each takes a run of neighbours.
const ALL_THREADS: u32 = 256u;

/// Probabilities are whole numbers of this: sums of them do not depend on their order.
const ONE: f32 = 2147483648.0;

const LOWEST: f32 = -3.4e38;

/// The run of particles of a thread: first and end.
fn run_of(thread: u32, particles: u32) -> vec2<u32> {
    let length = (particles + ALL_THREADS - 1u) / ALL_THREADS;
    return min(vec2<u32>(thread, thread + 1u) * length, vec2<u32>(particles));
}
