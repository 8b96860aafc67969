// Largest value in a workgroup and its index: the first among equals.

struct Place {
    value: f32,
    index: u32,
}

var<workgroup> places: array<Place, ALL_THREADS>;

fn larger(a: Place, b: Place) -> Place {
    if b.value > a.value || (b.value == a.value && b.index < a.index) {
        return b;
    }
    return a;
}

/// Largest of all threads' values with its index, returned to every thread.
fn largest_of_workgroup(thread: u32, place: Place) -> Place {
    // The threads may still be reading the result of an earlier call.
    workgroupBarrier();
    places[thread] = place;
    for (var half = ALL_THREADS / 2u; half > 0u; half /= 2u) {
        workgroupBarrier();
        if thread < half {
            places[thread] = larger(places[thread], places[thread + half]);
        }
    }
    workgroupBarrier();
    return places[0];
}
