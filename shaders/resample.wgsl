// Every slot finds its own ancestor. Twin: `Resampling::resample` in crates/core/src/filter/resample.rs.

#import shared/filter.wgsl
#import shared/angles.wgsl
#import shared/random.wgsl

@group(0) @binding(0) var<uniform> frame: Frame;
@group(0) @binding(1) var<uniform> iteration: Iteration;
@group(0) @binding(2) var<storage, read> shares: array<vec2<u32>>;
@group(0) @binding(3) var<storage, read> particles: array<Particle>;
@group(0) @binding(4) var<storage, read_write> survivors: array<Particle>;

/// First particle whose cumulative share exceeds a value: the share of the certain copies, or of the drawn ones.
fn ancestor_of(value: u32, is_drawn: bool) -> u32 {
    var low = 0u;
    var high = frame.particles - 1u;
    while low < high {
        let middle = (low + high) / 2u;
        let share = shares[middle];
        if select(share.x, share.y, is_drawn) > value {
            high = middle;
        } else {
            low = middle + 1u;
        }
    }
    return low;
}

/// numerator / denominator as a fraction of 2³², for a numerator below the denominator and both below 2³¹.
fn fraction(numerator: u32, denominator: u32) -> u32 {
    var rest = numerator;
    var quotient = 0u;
    for (var bit = 0u; bit < 32u; bit++) {
        rest *= 2u;
        quotient *= 2u;
        if rest >= denominator {
            rest -= denominator;
            quotient += 1u;
        }
    }
    return quotient;
}

/// Position of a draw in [0, 1), as a fraction of 2³².
fn place_of(draw: u32, drawn: u32) -> u32 {
    let resample = stream(RESAMPLE, iteration.number);
    // The position has 24 random bits, as in `unit`.
    if frame.resampling == SYSTEMATIC || frame.resampling == STRATIFIED {
        let random = words(resample, select(draw, 0u, frame.resampling == SYSTEMATIC), 0u).x & 0xffffff00u;
        return fraction(draw, drawn) + random / drawn;
    }
    return words(resample, draw, 0u).x & 0xffffff00u;
}

@compute @workgroup_size(THREADS)
fn resample(@builtin(global_invocation_id) id: vec3<u32>) {
    let index = id.x;
    if index >= frame.particles {
        return;
    }
    let all = shares[frame.particles - 1u];
    var ancestor: u32;
    if index < all.x {
        ancestor = ancestor_of(index, false);
    } else {
        let place = place_of(index - all.x, frame.particles - all.x);
        ancestor = ancestor_of(wide_product(place, all.y).x, true);
    }
    survivors[index] = particles[ancestor];
}
