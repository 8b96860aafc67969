// Grey pictures in storage buffers: four pixels per word, the first in the lowest byte; every row begins with a new word.

/// Size and settings shared by all pictures of a camera.
struct Picture {
    width: u32,
    height: u32,
    /// Words in a row.
    row_words: u32,
    /// Cells of the border's mask in a row.
    mask_columns: u32,
    /// Radius of the blur, pixels.
    blur_radius: u32,
    /// Cap of the distances, grey levels.
    nearness_cap: u32,
    padding_0: u32,
    padding_1: u32,
}

/// Threads per workgroup: each handles one word.
const PICTURE_THREADS: u32 = 64u;

/// Number of a thread, as many as there are words; the groups of large pictures are arranged in two dimensions.
fn thread_number(group: vec3<u32>, groups: vec3<u32>, thread: u32) -> u32 {
    return (group.y * groups.x + group.x) * PICTURE_THREADS + thread;
}

fn words_of(picture: Picture) -> u32 {
    return picture.row_words * picture.height;
}

fn byte_of(word: u32, index: u32) -> u32 {
    return (word >> (8u * (index % 4u))) & 255u;
}

fn bytes_of(word: u32) -> vec4<u32> {
    return vec4<u32>(word & 255u, (word >> 8u) & 255u, (word >> 16u) & 255u, word >> 24u);
}

fn word_of(bytes: vec4<u32>) -> u32 {
    return bytes.x | (bytes.y << 8u) | (bytes.z << 16u) | (bytes.w << 24u);
}
