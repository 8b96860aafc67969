// Log-weights to probabilities, without overflow at any sum, and the best particle so far. Twins: `normalise` and
// `best_index` in crates/core/src/filter/weights.rs.

#import shared/filter.wgsl
#import shared/largest.wgsl
#import shared/total.wgsl

@group(0) @binding(0) var<uniform> frame: Frame;
@group(0) @binding(1) var<storage, read> particles: array<Particle>;
@group(0) @binding(2) var<storage, read> weights: array<f32>;
@group(0) @binding(3) var<storage, read_write> probabilities: array<u32>;
@group(0) @binding(4) var<storage, read_write> outcome: Outcome;

@compute @workgroup_size(ALL_THREADS)
fn normalise(@builtin(local_invocation_index) thread: u32) {
    let run = run_of(thread, frame.particles);
    var mine = Place(LOWEST, run.x);
    for (var i = run.x; i < run.y; i++) {
        mine = larger(mine, Place(weights[i], i));
    }
    let largest = largest_of_workgroup(thread, mine);
    var sum = 0.0;
    for (var i = run.x; i < run.y; i++) {
        sum += exp(weights[i] - largest.value);
    }
    let total = total_of_workgroup(thread, vec4<f32>(sum, 0.0, 0.0, 0.0)).x;
    for (var i = run.x; i < run.y; i++) {
        probabilities[i] = u32(exp(weights[i] - largest.value) / total * ONE);
    }
    if thread == 0u && largest.value > outcome.best_log_weight {
        outcome.best = particles[largest.index];
        outcome.best_log_weight = largest.value;
    }
}
