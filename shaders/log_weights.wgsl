// Log-weight of a particle from the sums along its lines, joints and IMU included. Twin:
// `ParticleFilter::log_weights` in crates/core/src/filter/particle_filter.rs.

#import shared/filter.wgsl
#import shared/angles.wgsl

@group(0) @binding(0) var<uniform> frame: Frame;
@group(0) @binding(1) var<storage, read> particles: array<Particle>;
@group(0) @binding(2) var<storage, read> sums: array<vec2<f32>>;
@group(0) @binding(3) var<storage, read_write> weights: array<f32>;

fn log_prior(particle: Particle) -> f32 {
    if frame.height_sigma_m <= 0.0 {
        return 0.0;
    }
    let height = (particle.height_m - frame.height_m) / frame.height_sigma_m;
    let pitch = (particle.pitch_rad - frame.pitch_rad) / frame.angle_sigma_rad;
    let roll = wrap_angle(particle.roll_rad - frame.roll_rad) / frame.angle_sigma_rad;
    return -0.5 * (height * height + pitch * pitch + roll * roll);
}

@compute @workgroup_size(THREADS)
fn log_weights(@builtin(global_invocation_id) id: vec3<u32>) {
    let index = id.x;
    if index >= frame.particles {
        return;
    }
    let sum = sums[index];
    weights[index] = frame.per_value * sum.x + frame.per_seen * sum.y + log_prior(particles[index]);
}
