// Projection of ground points to pixels: the same steps, in the same order, as `project_block` in
// crates/core/src/observation/kernel.rs.

#import shared/camera.wgsl
#import shared/pose.wgsl

/// Whether the lens is radial or perspective, set when the pipeline is made.
override is_radial: bool = true;

fn project(camera: Camera, pose: CameraFromGround, ground: vec2<f32>) -> Pixel {
    let point = vec3<f32>(
        pose.x.x * ground.x + pose.x.y * ground.y + pose.x.z,
        pose.y.x * ground.x + pose.y.y * ground.y + pose.y.z,
        pose.z.x * ground.x + pose.z.y * ground.y + pose.z.z,
    );
    return project_point(camera, is_radial, point);
}
