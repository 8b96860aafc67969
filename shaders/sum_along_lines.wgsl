// Σ texture value along all lines in view, and the number of samples in view, for every pose: `gauss` and `distance`.
// Twin: `sum_along_lines` in crates/core/src/observation/kernel.rs.

#import shared/blocks.wgsl
#import shared/texture.wgsl
#import shared/scoring.wgsl

/// Value and number of one sample.
fn value_of(pixel: Pixel) -> vec2<f32> {
    if !pixel.seen {
        return vec2<f32>(0.0);
    }
    return vec2<f32>(sample(pixel.place), 1.0);
}

fn sum_of_block(camera: Camera, pose: CameraFromGround, number: u32) -> vec2<f32> {
    let block = block_of(camera, pose, number);
    let nodes = array<vec2<f32>, 4>(
        block_texel(number, FIRST_NODE).xy,
        block_texel(number, FIRST_NODE + 1u).xy,
        block_texel(number, FIRST_NODE + 2u).xy,
        block_texel(number, FIRST_NODE + 3u).xy,
    );
    let cubic = cubic_of(camera, pose, block, nodes);
    var sum = vec2<f32>(0.0);
    // Loops instead of a branch: where a driver runs on a processor, a branch costs both sides.
    let interpolated_samples = select(0u, block.samples, cubic.is_right);
    for (var i = 0u; i < interpolated_samples; i++) {
        sum += value_of(interpolated(camera, cubic, i));
    }
    let projected_samples = select(block.samples, 0u, cubic.is_right || block.is_beyond);
    for (var i = 0u; i < projected_samples; i++) {
        sum += value_of(project(camera, pose, line_sample(number, i).xy));
    }
    return sum;
}

@compute @workgroup_size(POSES, SHARES)
fn sum_along_lines(
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
            sum += sum_of_block(lens, pose, i);
        }
    }
    let total = sum_of_shares(thread.x, thread.y, sum);
    if thread.y == 0u && index < settings.poses {
        sums[index] = total;
    }
}
