// Inputs that the scoring kernels share, and the sum over a workgroup. One workgroup scores one pose.

const THREADS: u32 = 32u;

/// Settings of one dispatch.
struct Settings {
    /// Number of line samples.
    samples: u32,
    /// Number of poses.
    poses: u32,
    /// Workgroups along x: a dispatch of more poses uses y as well.
    groups_along_x: u32,
    /// Inverse of the picture's line contrast.
    per_contrast: f32,
    dark_level: f32,
    min_width_px: f32,
    per_width_px: f32,
    relative_area: f32,
}

@group(0) @binding(0) var<uniform> camera: Camera;
@group(0) @binding(1) var<uniform> settings: Settings;
/// Centre (x, y) and, for contrast, left flank (x, y) of a line sample; the right flank mirrors the left one.
@group(0) @binding(2) var samples: texture_2d<u32>;
@group(0) @binding(3) var texels: texture_2d<u32>;
@group(0) @binding(4) var<storage, read> poses: array<CameraFromGround>;
@group(0) @binding(5) var<storage, read_write> sums: array<vec2<f32>>;

/// Samples per row of their texture.
const SAMPLES_IN_ROW: u32 = 1024u;

fn line_sample(index: u32) -> vec4<f32> {
    return bitcast<vec4<f32>>(textureLoad(samples, vec2<u32>(index % SAMPLES_IN_ROW, index / SAMPLES_IN_ROW), 0));
}

var<workgroup> partial_sums: array<vec2<f32>, THREADS>;

/// Sum of all threads' values, returned to the first thread.
fn sum_of_workgroup(thread: u32, value: vec2<f32>) -> vec2<f32> {
    partial_sums[thread] = value;
    for (var half = THREADS / 2u; half > 0u; half /= 2u) {
        workgroupBarrier();
        if thread < half {
            partial_sums[thread] += partial_sums[thread + half];
        }
    }
    return partial_sums[thread];
}
