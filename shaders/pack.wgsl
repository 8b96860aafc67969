// A word for every pixel: its own value and those of its right, lower and lower right neighbours, so that a bilinear
// look-up costs one load. Twin: `Texture::pack` in crates/core/src/preprocess/texture.rs.

#import shared/picture.wgsl

@group(0) @binding(0) var<uniform> picture: Picture;
@group(0) @binding(1) var<storage, read> image: array<u32>;
@group(0) @binding(2) var texels: texture_storage_2d<r32uint, write>;

fn value(pixel: u32) -> u32 {
    return byte_of(image[pixel / 4u], pixel);
}

fn texel(pixel: u32, column: u32, row: u32) -> u32 {
    let right = select(0u, 1u, column + 1u < picture.width);
    let below = select(0u, picture.width, row + 1u < picture.height);
    return word_of(vec4<u32>(value(pixel), value(pixel + right), value(pixel + below), value(pixel + below + right)));
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
    let end = min(4u * index + 4u, picture.width * picture.height);
    for (var pixel = 4u * index; pixel < end; pixel++) {
        let row = pixel / picture.width;
        let column = pixel - row * picture.width;
        textureStore(texels, vec2<u32>(column, row), vec4<u32>(texel(pixel, column, row), 0u, 0u, 0u));
    }
}
