// Counter-based random numbers, Philox 4×32-10, and normal numbers from them: the twin of `Stream` in
// crates/core/src/filter/rng.rs. The words are the same; the normal numbers agree to single precision.

#import shared/product.wgsl

const PREDICT: u32 = 2u;
const DIFFUSE: u32 = 3u;
const RESAMPLE: u32 = 4u;

struct Stream {
    key: vec2<u32>,
    frame: u32,
    purpose_and_iteration: u32,
}

fn stream(purpose: u32, iteration: u32) -> Stream {
    return Stream(frame.seed, frame.number, (purpose << 24u) | (iteration & 0x00ffffffu));
}

fn words(stream: Stream, particle: u32, block: u32) -> vec4<u32> {
    var counter = vec4<u32>(particle, block, stream.frame, stream.purpose_and_iteration);
    var key = stream.key;
    for (var round = 0u; round < 10u; round++) {
        let p0 = wide_product(counter.x, 0xD2511F53u);
        let p1 = wide_product(counter.z, 0xCD9E8D57u);
        counter = vec4<u32>(p1.x ^ counter.y ^ key.x, p1.y, p0.x ^ counter.w ^ key.y, p0.y);
        key += vec2<u32>(0x9E3779B9u, 0xBB67AE85u);
    }
    return counter;
}

/// Number in [0, 1) from 24 bits.
fn unit(word: u32) -> f32 {
    return f32(word >> 8u) * (1.0 / 16777216.0);
}

fn box_muller(a: u32, b: u32) -> vec2<f32> {
    // 1 − unit lies in (0, 1]; near 1 the logarithm may be slightly above 0, and the root needs a number that is not
    // negative.
    let radius = sqrt(max(-2.0 * log(1.0 - unit(a)), 0.0));
    let direction = sin_cos(TAU * unit(b));
    return radius * direction.yx;
}

struct Normals {
    /// Numbers for x, y and yaw.
    planar: vec3<f32>,
    /// Numbers for height, pitch and roll.
    attitude: vec3<f32>,
}

/// Six independent standard normal numbers for one particle.
fn normals(stream: Stream, particle: u32) -> Normals {
    let a = words(stream, particle, 0u);
    let b = words(stream, particle, 1u);
    let n01 = box_muller(a.x, a.y);
    let n23 = box_muller(a.z, a.w);
    let n45 = box_muller(b.x, b.y);
    return Normals(vec3<f32>(n01, n23.x), vec3<f32>(n23.y, n45));
}
