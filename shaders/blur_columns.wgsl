// Gaussian blur along the columns, rounded to bytes; the edge's value is repeated outside. Twin: `blur_columns` in
// crates/core/src/preprocess/blur.rs.

#import shared/picture.wgsl

@group(0) @binding(0) var<uniform> picture: Picture;
@group(0) @binding(1) var<storage, read> across: array<f32>;
/// 2 · radius + 1 weights that sum to one.
@group(0) @binding(2) var<storage, read> weights: array<f32>;
@group(0) @binding(3) var<storage, read_write> image: array<u32>;

fn blurred(pixel: u32) -> u32 {
    let row = pixel / picture.width;
    let column = pixel - row * picture.width;
    var sum = 0.5;
    for (var i = 0u; i <= 2u * picture.blur_radius; i++) {
        let source = min(max(row + i, picture.blur_radius) - picture.blur_radius, picture.height - 1u);
        sum += weights[i] * across[source * picture.width + column];
    }
    return min(u32(sum), 255u);
}

@compute @workgroup_size(PICTURE_THREADS)
fn blur_columns(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) thread: u32,
) {
    let index = thread_number(group, groups, thread);
    if index >= words_of(picture) {
        return;
    }
    let pixel = 4u * index;
    image[index] =
        word_of(vec4<u32>(blurred(pixel), blurred(pixel + 1u), blurred(pixel + 2u), blurred(pixel + 3u)));
}
