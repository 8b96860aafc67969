// Σ texture value along all lines in view, and the number of samples in view, for every pose: `gauss` and `distance`.
// Twin: `sum_along_lines` in crates/core/src/observation/kernel.rs.

#import shared/ground.wgsl
#import shared/texture.wgsl
#import shared/scoring.wgsl

@compute @workgroup_size(THREADS)
fn sum_along_lines(
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
            let pixel = project(lens, pose, line_sample(i).xy);
            if pixel.seen {
                sum += vec2<f32>(sample(pixel.place), 1.0);
            }
        }
    }
    let total = sum_of_workgroup(thread, sum);
    if thread == 0u && index < settings.poses {
        sums[index] = total;
    }
}
