// Sum over a workgroup.

var<workgroup> totals: array<vec4<f32>, ALL_THREADS>;

/// Sum of all threads' values, returned to every thread.
fn total_of_workgroup(thread: u32, value: vec4<f32>) -> vec4<f32> {
    // The threads may still be reading the result of an earlier call.
    workgroupBarrier();
    totals[thread] = value;
    for (var half = ALL_THREADS / 2u; half > 0u; half /= 2u) {
        workgroupBarrier();
        if thread < half {
            totals[thread] += totals[thread + half];
        }
    }
    workgroupBarrier();
    return totals[0];
}
