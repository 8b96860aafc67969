// Diffuses the survivors of the previous iteration; the first iteration only sets their attitude. Twin:
// `ParticleFilter::diffuse` in crates/core/src/filter/particle_filter.rs.

#import shared/filter.wgsl
#import shared/angles.wgsl
#import shared/random.wgsl

@group(0) @binding(0) var<uniform> frame: Frame;
@group(0) @binding(1) var<uniform> iteration: Iteration;
@group(0) @binding(2) var<storage, read> survivors: array<Particle>;
@group(0) @binding(3) var<storage, read_write> particles: array<Particle>;

@compute @workgroup_size(THREADS)
fn diffuse(@builtin(global_invocation_id) id: vec3<u32>) {
    let index = id.x;
    if index >= frame.particles {
        return;
    }
    let noise = normals(stream(DIFFUSE, iteration.number), index);
    var particle = survivors[index];
    if iteration.number == 0u {
        particle.height_m = frame.height_m;
        particle.pitch_rad = frame.pitch_rad;
        particle.roll_rad = frame.roll_rad;
    } else {
        particle.x_m += iteration.scale * frame.diffuse_sigma_m * noise.planar.x;
        particle.y_m += iteration.scale * frame.diffuse_sigma_m * noise.planar.y;
        particle.yaw_rad = wrap_angle(particle.yaw_rad + iteration.scale * frame.diffuse_sigma_rad * noise.planar.z);
    }
    particle.height_m += iteration.scale * frame.height_sigma_m * noise.attitude.x;
    particle.pitch_rad += iteration.scale * frame.angle_sigma_rad * noise.attitude.y;
    particle.roll_rad += iteration.scale * frame.angle_sigma_rad * noise.attitude.z;
    particles[index] = particle;
}
