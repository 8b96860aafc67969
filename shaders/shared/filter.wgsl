// Declarations that the kernels of the particle filter share.

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

/// Inputs of one update.
struct Frame {
    seed: vec2<u32>,
    number: u32,
    particles: u32,
    /// Resampling scheme: RESIDUAL and so on.
    resampling: u32,
    /// Estimator: BEST and so on.
    estimator: u32,
    /// Bits by which remainders of the residual scheme are shifted right, so that their sum fits into one word.
    rest_shift: u32,
    /// Motion since the previous picture, in the camera's frame.
    forward_m: f32,
    left_m: f32,
    turn_rad: f32,
    predict_sigma_m: f32,
    predict_sigma_rad: f32,
    diffuse_sigma_m: f32,
    diffuse_sigma_rad: f32,
    /// Mount pose from joints and IMU.
    height_m: f32,
    pitch_rad: f32,
    roll_rad: f32,
    /// Standard deviations of the mount pose; 0 where the particles take it as it is.
    height_sigma_m: f32,
    angle_sigma_rad: f32,
    /// Factors of the two sums along a pose's lines; the products add up to its log-weight.
    per_value: f32,
    per_seen: f32,
    padding_0: u32,
    padding_1: u32,
    padding_2: u32,
}

/// One of the T rounds of weighting and resampling.
struct Iteration {
    number: u32,
    /// Scale of the diffusion.
    scale: f32,
    padding_0: u32,
    padding_1: u32,
}

const ALTERNATIVES: u32 = 6u;

/// Results of an update.
struct Outcome {
    /// Best particle of all iterations.
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

/// Threads of kernels that handle one particle per thread.
const THREADS: u32 = 64u;
/// Threads of kernels that process all particles in one workgroup: each takes a run of neighbours.
const ALL_THREADS: u32 = 256u;

/// Probability 1 as a whole number: sums of whole numbers do not depend on their order.
const ONE: f32 = 2147483648.0;

const LOWEST: f32 = -3.4e38;

/// Run of particles that a thread handles: first and end.
fn run_of(thread: u32, particles: u32) -> vec2<u32> {
    let length = (particles + ALL_THREADS - 1u) / ALL_THREADS;
    return min(vec2<u32>(thread, thread + 1u) * length, vec2<u32>(particles));
}
