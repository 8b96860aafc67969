// One picture from several: every pixel comes from the sources that see its place best. One thread per pixel.
// Twin: `blend` in crates/core/src/warp/blend.rs.

#import shared/proxy_geometry.wgsl

const SOURCES: u32 = 8u;
const THREADS: u32 = 64u;

/// Lenses of the sources, set when the pipeline is made: where a driver runs on a processor, a branch on a value that is
/// read costs both sides.
override lenses: u32 = MIXED;

const PERSPECTIVE: u32 = 0u;
const RADIAL: u32 = 1u;
const MIXED: u32 = 2u;

/// Picture to be drawn.
struct Drawing {
    eye: Placement,
    proxy: ProxyGeometry,
    width: u32,
    height: u32,
    /// Number of sources.
    sources: u32,
    /// Members of `BlendWeights` from here on.
    angle_on_ground: f32,
    angle_above: f32,
    resolution: f32,
    border_px: f32,
    softness: f32,
    disagreement: f32,
    padding_0: u32,
    padding_1: u32,
    padding_2: u32,
}

/// Recorded picture and its pose.
struct Source {
    camera: Camera,
    placement: Placement,
    /// Gain of red, green and blue.
    gain: vec4<f32>,
    /// Columns and rows.
    size: vec2<u32>,
    /// Layer of the texture that holds the picture.
    layer: u32,
    padding: u32,
}

@group(0) @binding(0) var<uniform> drawing: Drawing;
@group(0) @binding(1) var<uniform> sources: array<Source, SOURCES>;
/// `RayTable`: blocks of sixteen pixels of a row, 0 where a pixel sees nothing.
@group(0) @binding(2) var<storage, read> rays: array<f32>;
/// One word per pixel: red in the lowest byte, then green, blue and the mask, 255 where the scene is shown.
@group(0) @binding(3) var pictures: texture_2d_array<u32>;
/// One word with colour and source, then one with the trust.
@group(0) @binding(4) var<storage, read_write> warped: array<vec2<u32>>;

const NOWHERE: u32 = 255u;
const OUTSIDE: u32 = 254u;
const LANES: u32 = 16u;

/// Colour and weight that a source gives to a pixel.
struct Opinion {
    color: vec3<f32>,
    weight: f32,
}

var<private> opinions: array<Opinion, SOURCES>;

fn ray(column: u32, row: u32) -> vec3<f32> {
    let blocks_in_row = (drawing.width + LANES - 1u) / LANES;
    let first = (row * blocks_in_row + column / LANES) * (3u * LANES) + column % LANES;
    return vec3<f32>(rays[first], rays[first + LANES], rays[first + 2u * LANES]);
}

fn texel(place: vec2<u32>, layer: u32) -> u32 {
    return textureLoad(pictures, place, layer, 0).x;
}

fn color_of(word: u32) -> vec3<f32> {
    return vec3<f32>(vec3<u32>(word & 255u, (word >> 8u) & 255u, (word >> 16u) & 255u));
}

/// Bilinear colours (0–255), and 1 where the scene is shown, else 0. A picture with only one column or row has no neighbour
/// to interpolate with.
fn sample(number: u32, place: vec2<f32>) -> vec4<f32> {
    let size = sources[number].size;
    let layer = sources[number].layer;
    let last = vec2<f32>(max(size, vec2<u32>(2u)) - 2u);
    // Places count in parts of a pixel, as on the processor.
    let inside = round(clamp(place, vec2<f32>(0.0), last + 1.0) * 256.0) / 256.0;
    let corner = floor(min(inside, last));
    let f = inside - corner;
    let first = vec2<u32>(corner);
    let a = texel(first, layer);
    let b = texel(first + vec2<u32>(1u, 0u), layer);
    let c = texel(first + vec2<u32>(0u, 1u), layer);
    let d = texel(first + vec2<u32>(1u, 1u), layer);
    let top = mix(color_of(a), color_of(b), f.x);
    let bottom = mix(color_of(c), color_of(d), f.x);
    let shown = select(0.0, 1.0, ((a & b & c & d) >> 24u) == 255u);
    return select(vec4<f32>(0.0), vec4<f32>(mix(top, bottom, f.y), shown), all(size >= vec2<u32>(2u)));
}

/// Weight of a source that sees the point, before it is compared with the others.
fn source_weight(number: u32, point: ProxyPoint, pixel: Pixel) -> f32 {
    let position = sources[number].placement.position.xyz;
    let cosine = dot(point.direction, point.place - position) * pixel.nearness;
    let ground = point.on_ground;
    // Ratio of pixels per length on the surface, the target's to the source's: squared, it falls with the square of the
    // distance, and on the ground once more for the oblique view.
    let nearer = 1.0 / (point.distance * pixel.nearness);
    let flatter = nearer * drawing.eye.position.z / position.z;
    let density = nearer * nearer * (1.0 + ground * (flatter - 1.0));
    let per_angle = drawing.angle_above + ground * (drawing.angle_on_ground - drawing.angle_above);
    let penalty =
        drawing.softness + per_angle * (1.0 - cosine) + drawing.resolution * max(density - 1.0, 0.0) / 3.0;
    let to_border = min(pixel.place, sources[number].camera.largest_px - pixel.place);
    let fade = min((min(to_border.x, to_border.y) + 1.0) / drawing.border_px, 1.0);
    return fade / (penalty * penalty);
}

fn opinion_of(number: u32, point: ProxyPoint) -> Opinion {
    let camera = sources[number].camera;
    let is_radial = lenses == RADIAL || (lenses == MIXED && camera.is_radial == 1u);
    let pixel = see(camera, is_radial, sources[number].placement, point);
    if !(pixel.seen && unhidden(sources[number].placement.position.xyz, point)) {
        return Opinion(vec3<f32>(0.0), 0.0);
    }
    let found = sample(number, pixel.place);
    let color = min(found.xyz * sources[number].gain.xyz, vec3<f32>(255.0));
    return Opinion(color, found.w * source_weight(number, point, pixel));
}

/// Weighted mean colour, and the sum of the weights.
fn weighted_mean() -> vec4<f32> {
    var sum = vec4<f32>(0.0);
    for (var number = 0u; number < drawing.sources; number++) {
        let opinion = opinions[number];
        sum += opinion.weight * vec4<f32>(opinion.color, 1.0);
    }
    return vec4<f32>(sum.xyz / (1e-12 + sum.w), sum.w);
}

/// Mean colour with less weight for outliers, and the sum of the weights; the weights keep their reduced values.
fn agreed(before: vec4<f32>) -> vec4<f32> {
    if drawing.sources < 3u {
        return before;
    }
    let per_square = 1.0 / (drawing.disagreement * drawing.disagreement);
    var priors: array<f32, SOURCES>;
    for (var number = 0u; number < drawing.sources; number++) {
        priors[number] = opinions[number].weight;
    }
    var mean = before;
    for (var round = 0u; round < 3u; round++) {
        for (var number = 0u; number < drawing.sources; number++) {
            let difference = opinions[number].color - mean.xyz;
            opinions[number].weight = priors[number] / (1.0 + per_square * dot(difference, difference));
        }
        mean = weighted_mean();
    }
    return mean;
}

/// Result for a point: its colour and source in one word, then the trust.
fn mixed(point: ProxyPoint) -> vec2<u32> {
    var best = 0.0;
    for (var number = 0u; number < drawing.sources; number++) {
        opinions[number] = opinion_of(number, point);
        best = max(best, opinions[number].weight);
    }
    let before = weighted_mean();
    let mean = agreed(before);
    var source = NOWHERE;
    var largest = 0.0;
    for (var number = 0u; number < drawing.sources; number++) {
        let weight = opinions[number].weight;
        source = select(source, number, weight > largest);
        largest = max(largest, weight);
    }
    let penalty = 1.0 / sqrt(max(best, 1e-12)) - drawing.softness;
    let agreement = mean.w / max(before.w, 1e-12);
    let trust = select(min(agreement / (1.0 + max(penalty, 0.0)), 1.0), 0.0, source == NOWHERE);
    let color = vec3<u32>(mean.xyz + 0.5);
    return vec2<u32>(color.x | (color.y << 8u) | (color.z << 16u) | (source << 24u), u32(255.0 * trust + 0.5));
}

@compute @workgroup_size(THREADS)
fn blend(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) thread: u32,
) {
    let index = (group.y * groups.x + group.x) * THREADS + thread;
    if index >= drawing.width * drawing.height {
        return;
    }
    let in_camera = ray(index % drawing.width, index / drawing.width);
    if all(in_camera == vec3<f32>(0.0)) {
        warped[index] = vec2<u32>(OUTSIDE << 24u, 0u);
        return;
    }
    warped[index] = mixed(proxy_point(drawing.eye, in_camera));
}
