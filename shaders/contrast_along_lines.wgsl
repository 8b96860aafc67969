// Σ weight · contrast and Σ weight over all samples seen with both flanks, for every pose: `contrast`.
// Twin: `contrast_along_lines` in crates/core/src/observation/kernel.rs.

#import shared/ground.wgsl
#import shared/texture.wgsl
#import shared/scoring.wgsl

/// Something dark where a line should be is no worse than no line.
const MIN_CONTRAST: f32 = -0.25;

fn weighted_contrast(camera: Camera, pose: CameraFromGround, places: vec4<f32>) -> vec2<f32> {
    let centre = project(camera, pose, places.xy);
    let left = project(camera, pose, places.zw);
    let right = project(camera, pose, 2.0 * places.xy - places.zw);
    if !(centre.seen && left.seen && right.seen) {
        return vec2<f32>(0.0);
    }
    let line = sample(centre.place);
    let flank = max(sample(left.place), sample(right.place));
    // The flanks lie two line widths apart.
    let width_px = 0.5 * length(left.place - right.place);
    let resolved = (width_px - settings.min_width_px) * settings.per_width_px;
    let near = centre.nearness;
    let area = settings.relative_area * pose.x.w * near * near * near;
    let weight = clamp(min(resolved, area), 0.0, 1.0);
    let contrast = (line - flank) / (line + flank + settings.dark_level) * settings.per_contrast;
    return vec2<f32>(weight * clamp(contrast, MIN_CONTRAST, 1.0), weight);
}

@compute @workgroup_size(THREADS)
fn contrast_along_lines(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(local_invocation_index) thread: u32,
) {
    let index = group.y * settings.groups_along_x + group.x;
    var sum = vec2<f32>(0.0);
    if index < settings.poses {
        // Read once: the compiler cannot know that the value does not change in between.
        let lens = camera;
        let pose = poses[index];
        let count = settings.samples;
        for (var i = thread; i < count; i += THREADS) {
            sum += weighted_contrast(lens, pose, line_sample(i));
        }
    }
    let total = sum_of_workgroup(thread, sum);
    if thread == 0u && index < settings.poses {
        sums[index] = total;
    }
}
