// Prefix sums of every particle's certain copies and of its share of the drawn ones. Twin: `Resampling::cumulate`
// in crates/core/src/filter/resample.rs.

#import shared/filter.wgsl
#import shared/product.wgsl

@group(0) @binding(0) var<uniform> frame: Frame;
@group(0) @binding(1) var<storage, read> probabilities: array<u32>;
/// Certain copies, and the share of the drawn ones, each particle's own included.
@group(0) @binding(2) var<storage, read_write> shares: array<vec2<u32>>;

fn share_of(probability: u32) -> vec2<u32> {
    if frame.resampling != RESIDUAL {
        return vec2<u32>(0u, probability);
    }
    // Expected number of copies with 31 fractional bits.
    let expected = wide_product(frame.particles, probability);
    return vec2<u32>((expected.x << 1u) | (expected.y >> 31u), (expected.y & 0x7fffffffu) >> frame.rest_shift);
}

var<workgroup> runs: array<vec2<u32>, ALL_THREADS>;

@compute @workgroup_size(ALL_THREADS)
fn cumulate(@builtin(local_invocation_index) thread: u32) {
    let run = run_of(thread, frame.particles);
    var sum = vec2<u32>(0u);
    for (var i = run.x; i < run.y; i++) {
        sum += share_of(probabilities[i]);
    }
    runs[thread] = sum;
    // Inclusive scan (Hillis and Steele, "Data parallel algorithms", 1986).
    for (var step = 1u; step < ALL_THREADS; step *= 2u) {
        workgroupBarrier();
        var before = vec2<u32>(0u);
        if thread >= step {
            before = runs[thread - step];
        }
        workgroupBarrier();
        runs[thread] += before;
    }
    var so_far = runs[thread] - sum;
    for (var i = run.x; i < run.y; i++) {
        so_far += share_of(probabilities[i]);
        shares[i] = vec2<u32>(min(so_far.x, frame.particles), so_far.y);
    }
}
