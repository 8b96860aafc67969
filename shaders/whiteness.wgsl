// The smallest of the three channels. Twin: `whiteness` in crates/core/src/preprocess/grey.rs.

#import shared/picture.wgsl

@group(0) @binding(0) var<uniform> picture: Picture;
/// Red, green and blue bytes, without gaps.
@group(0) @binding(1) var<storage, read> rgb: array<u32>;
@group(0) @binding(2) var<storage, read_write> grey: array<u32>;

fn whiteness_of(red: u32, green: u32, blue: u32) -> u32 {
    return min(min(red, green), blue);
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
    // Twelve bytes are four pixels.
    let a = rgb[3u * index];
    let b = rgb[3u * index + 1u];
    let c = rgb[3u * index + 2u];
    grey[index] = word_of(vec4<u32>(
        whiteness_of(a & 255u, (a >> 8u) & 255u, (a >> 16u) & 255u),
        whiteness_of(a >> 24u, b & 255u, (b >> 8u) & 255u),
        whiteness_of((b >> 16u) & 255u, b >> 24u, c & 255u),
        whiteness_of((c >> 8u) & 255u, (c >> 16u) & 255u, c >> 24u),
    ));
}
