// The particles as poses for the scoring kernels. Twin: `CameraFromGround::new` in
// crates/core/src/observation/kernel.rs.

#import shared/filter.wgsl
#import shared/angles.wgsl
#import shared/pose.wgsl

@group(0) @binding(0) var<uniform> frame: Frame;
@group(0) @binding(1) var<storage, read> particles: array<Particle>;
@group(0) @binding(2) var<storage, read_write> poses: array<CameraFromGround>;

/// One of the camera's axes in the world, as a row of the pose.
fn row_of(axis: vec3<f32>, position: vec3<f32>, last: f32) -> vec4<f32> {
    return vec4<f32>(axis.xy, -dot(axis, position), last);
}

@compute @workgroup_size(THREADS)
fn camera_from_ground(@builtin(global_invocation_id) id: vec3<u32>) {
    let index = id.x;
    if index >= frame.particles {
        return;
    }
    let particle = particles[index];
    let yaw = sin_cos(particle.yaw_rad);
    let pitch = sin_cos(particle.pitch_rad);
    let roll = sin_cos(particle.roll_rad);
    let forward = vec3<f32>(yaw.y * pitch.y, yaw.x * pitch.y, -pitch.x);
    let right_0 = vec3<f32>(yaw.x, -yaw.y, 0.0);
    let down_0 = cross(forward, right_0);
    let right = roll.y * right_0 + roll.x * down_0;
    let down = roll.y * down_0 - roll.x * right_0;
    let position = vec3<f32>(particle.x_m, particle.y_m, particle.height_m);
    poses[index] = CameraFromGround(
        row_of(right, position, particle.height_m),
        row_of(down, position, 0.0),
        row_of(forward, position, 0.0),
    );
}
