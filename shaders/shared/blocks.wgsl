// Line samples on the ground in blocks of up to sixteen, and the cubics by which their pixels are interpolated: the twin of
// crates/core/src/observation/interpolation.rs.

#import shared/ground.wgsl

/// Texels of a block, `BlockLayout` in crates/gpu/src/layout.rs: limits and size, centre, four nodes, sixteen samples.
@group(0) @binding(2) var blocks: texture_2d<u32>;

const BLOCKS_IN_ROW: u32 = 32u;
const TEXELS: u32 = 22u;
/// First texels of the nodes and of the samples.
const FIRST_NODE: u32 = 2u;
const FIRST_SAMPLE: u32 = 6u;

fn block_texel(block: u32, texel: u32) -> vec4<f32> {
    let place = vec2<u32>(block % BLOCKS_IN_ROW * TEXELS + texel, block / BLOCKS_IN_ROW);
    return bitcast<vec4<f32>>(textureLoad(blocks, place, 0));
}

/// Centre (x, y) and, for contrast, left flank (x, y) of a line sample; the right flank mirrors the left one.
fn line_sample(block: u32, number: u32) -> vec4<f32> {
    return block_texel(block, FIRST_SAMPLE + number);
}

/// Block of samples, without these.
struct Block {
    largest_nearness: f32,
    min_cos: f32,
    samples: u32,
    is_beyond: bool,
}

fn block_of(camera: Camera, pose: CameraFromGround, number: u32) -> Block {
    let first = block_texel(number, 0u);
    let centre = block_texel(number, 1u).xy;
    return Block(first.x, first.y, u32(first.z), is_beyond(camera, pose, centre, first.w));
}

/// Column, row and nearness of samples as functions of t, which goes from −1 to 1 in the sixteen samples of a block.
struct Cubic {
    /// Factors of 1, t, t² and t³.
    c: array<vec3<f32>, 4>,
    is_right: bool,
}

/// Cubic through the nodes at t = −1, −1/3, 1/3 and 1.
fn cubic_of(camera: Camera, pose: CameraFromGround, block: Block, nodes: array<vec2<f32>, 4>) -> Cubic {
    let a = place_of_point(camera, is_radial, in_camera(pose, nodes[0]));
    let b = place_of_point(camera, is_radial, in_camera(pose, nodes[1]));
    let c = place_of_point(camera, is_radial, in_camera(pose, nodes[2]));
    let d = place_of_point(camera, is_radial, in_camera(pose, nodes[3]));
    let nearness = vec4<f32>(a.nearness, b.nearness, c.nearness, d.nearness);
    let cosine = vec4<f32>(a.cosine, b.cosine, c.cosine, d.cosine);
    let is_right = all(nearness <= vec4<f32>(block.largest_nearness)) && all(cosine >= vec4<f32>(block.min_cos));
    let p = vec3<f32>(a.place, a.nearness);
    let q = vec3<f32>(b.place, b.nearness);
    let r = vec3<f32>(c.place, c.nearness);
    let s = vec3<f32>(d.place, d.nearness);
    return Cubic(
        array<vec3<f32>, 4>(
            (9.0 * (q + r) - (p + s)) / 16.0,
            (27.0 * (r - q) - (s - p)) / 16.0,
            9.0 * ((p + s) - (q + r)) / 16.0,
            9.0 * ((s - p) - 3.0 * (r - q)) / 16.0,
        ),
        is_right,
    );
}

fn interpolated(camera: Camera, cubic: Cubic, number: u32) -> Pixel {
    let t = f32(number) * (2.0 / 15.0) - 1.0;
    let value = cubic.c[0] + t * (cubic.c[1] + t * (cubic.c[2] + t * cubic.c[3]));
    return Pixel(value.xy, value.z, is_inside(camera, value.xy));
}
