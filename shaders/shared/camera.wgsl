// Projection of points in the camera frame to pixels: the same steps, in the same order, as `project_lanes` in
// crates/core/src/camera/kernel.rs.

/// `KernelCamera`, laid out for a uniform buffer.
struct Camera {
    /// fx, fy.
    focal_px: vec2<f32>,
    /// cx, cy.
    centre_px: vec2<f32>,
    /// Largest valid column and row.
    largest_px: vec2<f32>,
    /// Cosine of the largest valid angle from the optical axis.
    min_cos: f32,
    /// 1 for a radial lens, 0 for a perspective one.
    is_radial: u32,
    /// Centre and squared radius of the image circle; the radius is negative where the lens fills the picture.
    circle: vec4<f32>,
    /// Radial: eleven coefficients, scale, offset. Perspective: k1, k2, p1, p2, k3.
    lens_parameters: array<vec4<f32>, 4>,
}

struct Pixel {
    place: vec2<f32>,
    /// Inverse of the distance from the camera, 1/m.
    nearness: f32,
    seen: bool,
}

/// Place of a point in the plane of the picture, whether the picture contains it or not.
struct Place {
    place: vec2<f32>,
    /// Inverse of the distance from the camera, 1/m.
    nearness: f32,
    /// Cosine of the angle from the optical axis.
    cosine: f32,
}

/// Projects a point, without asking whether the camera sees it. `is_radial` is the camera's, or a constant: where a driver runs on a
/// processor, a branch on a value that is read costs both sides.
fn place_of_point(camera: Camera, is_radial: bool, p: vec3<f32>) -> Place {
    let nearness = 1.0 / sqrt(p.x * p.x + p.y * p.y + p.z * p.z);
    let cosine = p.z * nearness;
    // Written out: indexing by a variable would load the array in every step.
    let c0 = camera.lens_parameters[0];
    let c1 = camera.lens_parameters[1];
    let c2 = camera.lens_parameters[2];
    var place: vec2<f32>;
    if is_radial {
        let t = cosine * c2.w + camera.lens_parameters[3].x;
        // Estrin's scheme: short chains of dependent operations.
        let t2 = t * t;
        let t4 = t2 * t2;
        let low = (c0.x + c0.y * t) + (c0.z + c0.w * t) * t2;
        let middle = (c1.x + c1.y * t) + (c1.z + c1.w * t) * t2;
        let high = (c2.x + c2.y * t) + c2.z * t2;
        let h = low + (middle + high * t4) * t4;
        place = p.xy * (h * nearness);
    } else {
        let k1 = c0.x;
        let k2 = c0.y;
        let p1 = c0.z;
        let p2 = c0.w;
        let k3 = c1.x;
        let a = p.x / p.z;
        let b = p.y / p.z;
        let r2 = a * a + b * b;
        let radial = 1.0 + r2 * (k1 + r2 * (k2 + r2 * k3));
        let ab2 = 2.0 * a * b;
        place = vec2<f32>(
            a * radial + p1 * ab2 + p2 * (r2 + 2.0 * a * a),
            b * radial + p1 * (r2 + 2.0 * b * b) + p2 * ab2,
        );
    }
    return Place(camera.focal_px * place + camera.centre_px, nearness, cosine);
}

/// Whether a place is in the picture and in the image circle.
fn is_inside(camera: Camera, place: vec2<f32>) -> bool {
    let from_circle = place - camera.circle.xy;
    let in_circle = camera.circle.z < 0.0 || dot(from_circle, from_circle) <= camera.circle.z;
    let in_picture = all(place >= vec2<f32>(0.0)) && all(place <= camera.largest_px);
    return in_circle && in_picture;
}

/// Projects a point; see `place_of_point` for `is_radial`.
fn project_point(camera: Camera, is_radial: bool, p: vec3<f32>) -> Pixel {
    let found = place_of_point(camera, is_radial, p);
    return Pixel(found.place, found.nearness, found.cosine >= camera.min_cos && is_inside(camera, found.place));
}
