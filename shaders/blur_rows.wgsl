// Gaussian blur along the rows; the edge's value is repeated outside. Twin: `blur_rows` in
// crates/core/src/preprocess/blur.rs.

#import shared/picture.wgsl

@group(0) @binding(0) var<uniform> picture: Picture;
@group(0) @binding(1) var<storage, read> grey: array<u32>;
/// 2 · radius + 1 weights that sum to one.
@group(0) @binding(2) var<storage, read> weights: array<f32>;
@group(0) @binding(3) var<storage, read_write> across: array<vec4<f32>>;

fn blurred(pixel: u32) -> f32 {
    let row = pixel / picture.width * picture.width;
    let column = pixel - row;
    var sum = 0.0;
    for (var i = 0u; i <= 2u * picture.blur_radius; i++) {
        let source = row + min(max(column + i, picture.blur_radius) - picture.blur_radius, picture.width - 1u);
        sum += weights[i] * f32(byte_of(grey[source / 4u], source));
    }
    return sum;
}

@compute @workgroup_size(PICTURE_THREADS)
fn blur_rows(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) thread: u32,
) {
    let index = thread_number(group, groups, thread);
    if index >= words_of(picture) {
        return;
    }
    let pixel = 4u * index;
    across[index] = vec4<f32>(blurred(pixel), blurred(pixel + 1u), blurred(pixel + 2u), blurred(pixel + 3u));
}
