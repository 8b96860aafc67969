// Moves the particles to the next picture. Twin: `ParticleFilter::predict` in
// crates/core/src/filter/particle_filter.rs.

#import shared/filter.wgsl
#import shared/angles.wgsl
#import shared/random.wgsl

@group(0) @binding(0) var<uniform> frame: Frame;
@group(0) @binding(1) var<storage, read_write> survivors: array<Particle>;

@compute @workgroup_size(THREADS)
fn predict(@builtin(global_invocation_id) id: vec3<u32>) {
    let index = id.x;
    if index >= frame.particles {
        return;
    }
    let planar = normals(stream(PREDICT, 0u), index).planar;
    var particle = survivors[index];
    let heading = sin_cos(particle.yaw_rad);
    particle.x_m += heading.y * frame.forward_m - heading.x * frame.left_m + frame.predict_sigma_m * planar.x;
    particle.y_m += heading.x * frame.forward_m + heading.y * frame.left_m + frame.predict_sigma_m * planar.y;
    particle.yaw_rad = wrap_angle(particle.yaw_rad + frame.turn_rad + frame.predict_sigma_rad * planar.z);
    survivors[index] = particle;
}
