// Inputs that the scoring kernels share, and the sum over a workgroup. A workgroup scores a few poses: a thread takes every so many blocks
// of samples for one of them. Neighbouring threads take the same block for neighbouring poses, which are mostly close to each other: they
// agree on whether the block is seen, and whether its samples are interpolated.

/// Poses of a workgroup: as many as the threads that run in step on the narrowest devices.
const POSES: u32 = 8u;
/// Threads for each pose.
const SHARES: u32 = 16u;

/// Settings of one dispatch.
struct Settings {
    /// Number of blocks of line samples.
    blocks: u32,
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
// Binding 2 is the texture of the blocks, in blocks.wgsl.
@group(0) @binding(3) var texels: texture_2d<u32>;
@group(0) @binding(4) var<storage, read> poses: array<CameraFromGround>;
@group(0) @binding(5) var<storage, read_write> sums: array<vec2<f32>>;

/// Sum of each share of each pose.
var<workgroup> partial_sums: array<array<vec2<f32>, POSES>, SHARES>;

/// Sum over the shares of a thread's pose, returned to the threads of the first share.
fn sum_of_shares(pose: u32, share: u32, value: vec2<f32>) -> vec2<f32> {
    partial_sums[share][pose] = value;
    for (var half = SHARES / 2u; half > 0u; half /= 2u) {
        workgroupBarrier();
        if share < half {
            partial_sums[share][pose] += partial_sums[share + half][pose];
        }
    }
    return partial_sums[share][pose];
}
