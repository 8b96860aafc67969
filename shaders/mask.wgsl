// Sets all pixels outside the field's border to zero. Twin: `FieldBorder::mask` in
// crates/core/src/preprocess/border.rs.

#import shared/picture.wgsl

@group(0) @binding(0) var<uniform> picture: Picture;
/// One bit for each cell of two by two pixels, row after row: whether the cell lies inside.
@group(0) @binding(1) var<storage, read> inside: array<u32>;
@group(0) @binding(2) var<storage, read_write> image: array<u32>;

/// All bits of two neighbouring pixels, or none.
fn pair_of(cell: u32) -> u32 {
    return 0xffffu * ((inside[cell / 32u] >> (cell % 32u)) & 1u);
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
    let row = index / picture.row_words;
    let column = index - row * picture.row_words;
    let cell = row / 2u * picture.mask_columns + 2u * column;
    image[index] &= pair_of(cell) | (pair_of(cell + 1u) << 16u);
}
