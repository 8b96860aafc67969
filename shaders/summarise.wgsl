// Estimate, spread of the particles around it, and effective sample size. Twin:
// `ParticleFilter::summarise` in crates/core/src/filter/particle_filter.rs.

#import shared/filter.wgsl
#import shared/angles.wgsl
#import shared/total.wgsl

@group(0) @binding(0) var<uniform> frame: Frame;
@group(0) @binding(1) var<storage, read> particles: array<Particle>;
@group(0) @binding(2) var<storage, read> probabilities: array<u32>;
@group(0) @binding(3) var<storage, read_write> outcome: Outcome;

/// `CLUSTER_RADIUS_M` and `CLUSTER_ANGLE_RAD`.
const CLUSTER_RADIUS_M: f32 = 0.25;
const CLUSTER_ANGLE_RAD: f32 = 0.25;

fn distance_m(a: Particle, b: Particle) -> f32 {
    return length(vec2<f32>(a.x_m - b.x_m, a.y_m - b.y_m));
}

fn counts(particle: Particle, centre: Particle) -> bool {
    return frame.estimator != CLUSTER
        || (distance_m(particle, centre) <= CLUSTER_RADIUS_M
            && abs(wrap_angle(particle.yaw_rad - centre.yaw_rad)) <= CLUSTER_ANGLE_RAD);
}

@compute @workgroup_size(ALL_THREADS)
fn summarise(@builtin(local_invocation_index) thread: u32) {
    let run = run_of(thread, frame.particles);
    let best = outcome.best;
    // Sums are taken relative to the best particle: small numbers keep their digits.
    var place = vec4<f32>(0.0);
    var attitude = vec4<f32>(0.0);
    var squares = 0.0;
    for (var i = run.x; i < run.y; i++) {
        let weight = f32(probabilities[i]) / ONE;
        let particle = particles[i];
        squares += weight * weight;
        if counts(particle, best) {
            let turn = sin_cos(wrap_angle(particle.yaw_rad - best.yaw_rad));
            place += weight * vec4<f32>(particle.x_m - best.x_m, particle.y_m - best.y_m, turn);
            attitude += weight * vec4<f32>(
                particle.height_m - best.height_m,
                particle.pitch_rad - best.pitch_rad,
                particle.roll_rad - best.roll_rad,
                1.0,
            );
        }
    }
    place = total_of_workgroup(thread, place);
    attitude = total_of_workgroup(thread, attitude);
    let square = total_of_workgroup(thread, vec4<f32>(squares, 0.0, 0.0, 0.0)).x;
    var estimate = best;
    if frame.estimator != BEST && attitude.w > 0.0 {
        estimate.x_m += place.x / attitude.w;
        estimate.y_m += place.y / attitude.w;
        estimate.yaw_rad = wrap_angle(best.yaw_rad + atan2(place.z, place.w));
        estimate.height_m += attitude.x / attitude.w;
        estimate.pitch_rad += attitude.y / attitude.w;
        estimate.roll_rad += attitude.z / attitude.w;
    }
    var spread = 0.0;
    for (var i = run.x; i < run.y; i++) {
        let distance = distance_m(particles[i], estimate);
        spread += f32(probabilities[i]) / ONE * distance * distance;
    }
    let spread_all = total_of_workgroup(thread, vec4<f32>(spread, 0.0, 0.0, 0.0)).x;
    if thread == 0u {
        outcome.estimate = estimate;
        outcome.effective_sample_size = select(0.0, 1.0 / square, square > 0.0);
        outcome.spread_m = sqrt(spread_all);
    }
}
