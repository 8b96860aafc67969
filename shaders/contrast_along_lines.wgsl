// Σ weight · contrast and Σ weight over all samples seen with both flanks, for every pose: `contrast`.
// Twin: `contrast_along_lines` in crates/core/src/observation/kernel.rs.

#import shared/blocks.wgsl
#import shared/texture.wgsl
#import shared/scoring.wgsl

/// Something dark where a line should be is no worse than no line.
const MIN_CONTRAST: f32 = -0.25;

fn weighted_contrast(pose: CameraFromGround, centre: Pixel, left: Pixel, right: Pixel) -> vec2<f32> {
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

fn contrast_of_block(camera: Camera, pose: CameraFromGround, number: u32) -> vec2<f32> {
    let block = block_of(camera, pose, number);
    let a = block_texel(number, FIRST_NODE);
    let b = block_texel(number, FIRST_NODE + 1u);
    let c = block_texel(number, FIRST_NODE + 2u);
    let d = block_texel(number, FIRST_NODE + 3u);
    let centres = array<vec2<f32>, 4>(a.xy, b.xy, c.xy, d.xy);
    let lefts = array<vec2<f32>, 4>(a.zw, b.zw, c.zw, d.zw);
    let rights = array<vec2<f32>, 4>(
        2.0 * a.xy - a.zw, 2.0 * b.xy - b.zw, 2.0 * c.xy - c.zw, 2.0 * d.xy - d.zw,
    );
    let centre = cubic_of(camera, pose, block, centres);
    let left = cubic_of(camera, pose, block, lefts);
    let right = cubic_of(camera, pose, block, rights);
    let is_right = centre.is_right && left.is_right && right.is_right;
    var sum = vec2<f32>(0.0);
    // Loops instead of a branch: where a driver runs on a processor, a branch costs both sides.
    let interpolated_samples = select(0u, block.samples, is_right);
    for (var i = 0u; i < interpolated_samples; i++) {
        sum += weighted_contrast(
            pose,
            interpolated(camera, centre, i),
            interpolated(camera, left, i),
            interpolated(camera, right, i),
        );
    }
    let projected_samples = select(block.samples, 0u, is_right || block.is_beyond);
    for (var i = 0u; i < projected_samples; i++) {
        let places = line_sample(number, i);
        sum += weighted_contrast(
            pose,
            project(camera, pose, places.xy),
            project(camera, pose, places.zw),
            project(camera, pose, 2.0 * places.xy - places.zw),
        );
    }
    return sum;
}

@compute @workgroup_size(POSES, SHARES)
fn contrast_along_lines(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(local_invocation_id) thread: vec3<u32>,
) {
    let index = (group.y * settings.groups_along_x + group.x) * POSES + thread.x;
    var sum = vec2<f32>(0.0);
    if index < settings.poses {
        // Read once: the compiler cannot know that the value does not change in between.
        let lens = camera;
        let pose = poses[index];
        let count = settings.blocks;
        for (var i = thread.y; i < count; i += SHARES) {
            sum += contrast_of_block(lens, pose, i);
        }
    }
    let total = sum_of_shares(thread.x, thread.y, sum);
    if thread.y == 0u && index < settings.poses {
        sums[index] = total;
    }
}
