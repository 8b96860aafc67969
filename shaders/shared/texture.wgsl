// Bilinear values of an 8-bit picture whose texels hold their right, lower and lower right neighbours too: the twin of
// `sample_block` in crates/core/src/observation/kernel.rs, where a texel has fewer values and two are loaded at once.

fn sample(place: vec2<f32>) -> f32 {
    let corner = floor(place);
    let f = place - corner;
    let texel = textureLoad(texels, vec2<u32>(corner), 0).x;
    let top = mix_bytes(texel & 255u, (texel >> 8u) & 255u, f.x);
    let bottom = mix_bytes((texel >> 16u) & 255u, texel >> 24u, f.x);
    return top + f.y * (bottom - top);
}

fn mix_bytes(a: u32, b: u32, fraction: f32) -> f32 {
    return f32(a) + fraction * (f32(b) - f32(a));
}
