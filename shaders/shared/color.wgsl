// Colour pictures: red, green and blue bytes without gaps, so that three words hold four pixels.

struct FourColors {
    a: vec3<u32>,
    b: vec3<u32>,
    c: vec3<u32>,
    d: vec3<u32>,
}

fn colors_of(low: u32, middle: u32, high: u32) -> FourColors {
    return FourColors(
        vec3<u32>(low & 255u, (low >> 8u) & 255u, (low >> 16u) & 255u),
        vec3<u32>(low >> 24u, middle & 255u, (middle >> 8u) & 255u),
        vec3<u32>((middle >> 16u) & 255u, middle >> 24u, high & 255u),
        vec3<u32>((high >> 8u) & 255u, (high >> 16u) & 255u, high >> 24u),
    );
}
