// Projection of ground points to pixels: the same steps, in the same order, as `project_block` in
// crates/core/src/observation/kernel.rs.

#import shared/camera.wgsl
#import shared/pose.wgsl

/// Whether the lens is radial or perspective, set when the pipeline is made.
override is_radial: bool = true;

fn in_camera(pose: CameraFromGround, ground: vec2<f32>) -> vec3<f32> {
    return vec3<f32>(
        pose.x.x * ground.x + pose.x.y * ground.y + pose.x.z,
        pose.y.x * ground.x + pose.y.y * ground.y + pose.y.z,
        pose.z.x * ground.x + pose.z.y * ground.y + pose.z.z,
    );
}

fn project(camera: Camera, pose: CameraFromGround, ground: vec2<f32>) -> Pixel {
    return project_point(camera, is_radial, in_camera(pose, ground));
}

/// Whether a whole circle lies outside the lens's largest angle: `CameraFromGround::is_beyond` on the CPU.
fn is_beyond(camera: Camera, pose: CameraFromGround, circle_centre: vec2<f32>, radius: f32) -> bool {
    let centre = in_camera(pose, circle_centre);
    // The circle's point with the smallest angle has at most this z, and at least this distance.
    let least_distance = length(centre) - select(radius, -radius, camera.min_cos < 0.0);
    return centre.z + radius < camera.min_cos * least_distance;
}
