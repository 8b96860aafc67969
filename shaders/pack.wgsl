// One texel per pixel: its own value and those of its right, lower and lower right neighbours, so that a bilinear look-up
// costs one load. Twin, whose texels share the values at their right: `Texture::pack` in crates/core/src/preprocess/texture.rs.

#import shared/picture.wgsl

@group(0) @binding(0) var<uniform> picture: Picture;
@group(0) @binding(1) var<storage, read> image: array<u32>;
@group(0) @binding(2) var texels: texture_storage_2d<r32uint, write>;

/// Five pixels of a row, from the first one of a word on; beyond the last column its value is repeated.
fn five_of(row: u32, column: u32) -> array<u32, 5> {
    let first = row * picture.row_words;
    var values: array<u32, 5>;
    for (var i = 0u; i < 5u; i++) {
        let source = min(4u * column + i, picture.width - 1u);
        values[i] = byte_of(image[first + source / 4u], source);
    }
    return values;
}

@compute @workgroup_size(PICTURE_THREADS)
fn pack(
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
    let here = five_of(row, column);
    let below = five_of(min(row + 1u, picture.height - 1u), column);
    for (var i = 0u; i < 4u; i++) {
        // Pixels beyond the texture are not written.
        let texel = word_of(vec4<u32>(here[i], here[i + 1u], below[i], below[i + 1u]));
        textureStore(texels, vec2<u32>(4u * column + i, row), vec4<u32>(texel, 0u, 0u, 0u));
    }
}
