// The smallest of the three channels. Twin: `whiteness` in crates/core/src/preprocess/grey.rs.

#import shared/color.wgsl
#import shared/picture.wgsl

@group(0) @binding(0) var<uniform> picture: Picture;
/// Red, green and blue bytes, without gaps.
@group(0) @binding(1) var<storage, read> rgb: array<u32>;
@group(0) @binding(2) var<storage, read_write> grey: array<u32>;

fn whiteness_of(color: vec3<u32>) -> u32 {
    return min(min(color.r, color.g), color.b);
}

@compute @workgroup_size(PICTURE_THREADS)
fn whiteness(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) thread: u32,
) {
    let index = thread_number(group, groups, thread);
    if index >= words_of(picture) {
        return;
    }
    let colors = colors_of(rgb[3u * index], rgb[3u * index + 1u], rgb[3u * index + 2u]);
    grey[index] =
        word_of(vec4<u32>(whiteness_of(colors.a), whiteness_of(colors.b), whiteness_of(colors.c), whiteness_of(colors.d)));
}
