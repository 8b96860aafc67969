// Sets all pixels outside the field's border to zero. Twin: `FieldBorder::mask` in
// crates/core/src/preprocess/border.rs.

#import shared/picture.wgsl

@group(0) @binding(0) var<uniform> picture: Picture;
/// A bit for each cell of two by two pixels, row after row: whether it lies inside.
@group(0) @binding(1) var<storage, read> inside: array<u32>;
@group(0) @binding(2) var<storage, read_write> image: array<u32>;

fn mask_of(pixel: u32) -> u32 {
    let row = pixel / picture.width;
    let column = pixel - row * picture.width;
    let cell = row / 2u * picture.mask_columns + column / 2u;
    return 255u * ((inside[cell / 32u] >> (cell % 32u)) & 1u);
}

@compute @workgroup_size(PICTURE_THREADS)
fn mask(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) thread: u32,
) {
    let index = thread_number(group, groups, thread);
    if index >= words_of(picture) {
        return;
    }
    let pixel = 4u * index;
    image[index] &=
        word_of(vec4<u32>(mask_of(pixel), mask_of(pixel + 1u), mask_of(pixel + 2u), mask_of(pixel + 3u)));
}
