// Gaussian blur along the columns, rounded to bytes; the edge's value is repeated outside. Twin: `blur_columns` in
// crates/core/src/preprocess/blur.rs.

#import shared/picture.wgsl

@group(0) @binding(0) var<uniform> picture: Picture;
@group(0) @binding(1) var<storage, read> across: array<vec4<f32>>;
/// Three zeros, 2 · radius + 1 weights that sum to one, three zeros.
@group(0) @binding(2) var<storage, read> weights: array<f32>;
@group(0) @binding(3) var<storage, read_write> image: array<u32>;

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
    let row = index / picture.row_words;
    let column = index - row * picture.row_words;
    let radius = picture.blur_radius;
    var sum = vec4<f32>(0.5);
    for (var i = 0u; i <= 2u * radius; i++) {
        let source = min(max(row + i, radius) - radius, picture.height - 1u);
        sum += weights[i + 3u] * across[source * picture.row_words + column];
    }
    image[index] = word_of(min(vec4<u32>(sum), vec4<u32>(255u)));
}
