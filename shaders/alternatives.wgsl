// The best particles that lie apart from each other, best first. Twin: `alternatives` in
// crates/core/src/filter/particle_filter.rs.

#import shared/filter.wgsl
#import shared/angles.wgsl
#import shared/largest.wgsl

@group(0) @binding(0) var<uniform> frame: Frame;
@group(0) @binding(1) var<storage, read> particles: array<Particle>;
@group(0) @binding(2) var<storage, read> weights: array<f32>;
@group(0) @binding(3) var<storage, read_write> outcome: Outcome;

/// `ALTERNATIVE_DISTANCE`.
const DISTANCE_M: f32 = 0.12;
const DISTANCE_RAD: f32 = 0.08;

fn is_apart(particle: Particle, other: Particle) -> bool {
    return length(vec2<f32>(particle.x_m - other.x_m, particle.y_m - other.y_m)) > DISTANCE_M
        || abs(wrap_angle(particle.yaw_rad - other.yaw_rad)) > DISTANCE_RAD;
}

fn is_apart_from_all(particle: Particle, count: u32, others: ptr<function, array<Particle, 6>>) -> bool {
    for (var i = 0u; i < count; i++) {
        if !is_apart(particle, others[i]) {
            return false;
        }
    }
    return true;
}

@compute @workgroup_size(ALL_THREADS)
fn alternatives(@builtin(local_invocation_index) thread: u32) {
    let run = run_of(thread, frame.particles);
    var found: array<Particle, 6>;
    var count = 0u;
    for (var round = 0u; round < ALTERNATIVES; round++) {
        var mine = Place(LOWEST, frame.particles);
        for (var i = run.x; i < run.y; i++) {
            if weights[i] > mine.value && is_apart_from_all(particles[i], count, &found) {
                mine = Place(weights[i], i);
            }
        }
        // No thread leaves the loop early: all threads must reach the barriers in it.
        let best = largest_of_workgroup(thread, mine).index;
        if best < frame.particles {
            found[count] = particles[best];
            count += 1u;
        }
    }
    if thread == 0u {
        outcome.alternatives = found;
        outcome.alternative_count = count;
    }
}
