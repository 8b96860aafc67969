// Point that a pixel sees, and which other cameras see it: the same steps, in the same order, as `proxy_points`, `see` and
// `unhidden` in crates/core/src/warp/kernel.rs.

#import shared/camera.wgsl

/// Pose as `camera = (right, down, forward) · (world − position)`. The fourth components are 0.
struct Placement {
    right: vec4<f32>,
    down: vec4<f32>,
    forward: vec4<f32>,
    position: vec4<f32>,
}

/// Upright rectangle perpendicular to the x axis, metres.
struct Billboard {
    x: f32,
    half_width: f32,
    top: f32,
    opening_half_width: f32,
    opening_top: f32,
    padding_0: u32,
    padding_1: u32,
    padding_2: u32,
}

/// Box around the field, with the goals in it.
struct ProxyGeometry {
    low: vec4<f32>,
    high: vec4<f32>,
    billboards: array<Billboard, BILLBOARDS>,
}

const BILLBOARDS: u32 = 4u;

struct ProxyPoint {
    /// Position in the world, metres.
    place: vec3<f32>,
    /// Unit direction from the camera, world axes.
    direction: vec3<f32>,
    /// Distance from the camera, metres.
    distance: f32,
    /// 1 on the ground, else 0.
    on_ground: f32,
}

/// Distance beyond any proxy geometry, metres.
const FAR_M: f32 = 1e30;

/// Whether a point in the plane of a billboard, above the ground, lies on the billboard enlarged by `wider` on all sides.
fn holds(billboard: Billboard, wider: f32, across: f32, up: f32) -> bool {
    let is_opening = abs(across) < billboard.opening_half_width - wider && up < billboard.opening_top - wider;
    return abs(across) <= billboard.half_width + wider && up <= billboard.top + wider && !is_opening;
}

/// Traces a ray from a camera inside the proxy geometry.
fn proxy_point(eye: Placement, ray: vec3<f32>) -> ProxyPoint {
    let position = eye.position.xyz;
    let direction = eye.right.xyz * ray.x + eye.down.xyz * ray.y + eye.forward.xyz * ray.z;
    let end = select(drawing.proxy.high.xyz, drawing.proxy.low.xyz, direction < vec3<f32>(0.0)) - position;
    // A ray parallel to a wall never meets it: this avoids a division by 0.
    let is_across = abs(direction) > vec3<f32>(1e-12);
    let to_wall = select(vec3<f32>(FAR_M), end / direction, is_across);
    var distance = min(to_wall.x, to_wall.y);
    var on_ground = select(0.0, 1.0, to_wall.z < distance && direction.z < 0.0);
    distance = min(distance, to_wall.z);
    for (var number = 0u; number < BILLBOARDS; number++) {
        let billboard = drawing.proxy.billboards[number];
        let to_billboard = (billboard.x - position.x) / direction.x;
        let y = position.y + to_billboard * direction.y;
        let z = position.z + to_billboard * direction.z;
        let is_hit = to_billboard > 0.0 && to_billboard < distance && z >= 0.0 && holds(billboard, 0.0, y, z);
        distance = select(distance, to_billboard, is_hit);
        on_ground = select(on_ground, 0.0, is_hit);
    }
    return ProxyPoint(position + distance * direction, direction, distance, on_ground);
}

/// Pixel at which another camera sees the point.
fn see(camera: Camera, is_radial: bool, placement: Placement, point: ProxyPoint) -> Pixel {
    let offset = point.place - placement.position.xyz;
    let in_camera = vec3<f32>(
        dot(placement.right.xyz, offset),
        dot(placement.down.xyz, offset),
        dot(placement.forward.xyz, offset),
    );
    return project_point(camera, is_radial, in_camera);
}

/// Fraction of the way to a point beyond which a billboard does not hide it: points on the billboard itself stay visible.
const ON_SCREEN: f32 = 0.999;
/// Radius of a typical post. Seen from the side, a round post hides more than the flat one that stands for it; the excess
/// grows with one over the cosine.
const POST_RADIUS_M: f32 = 0.05;
/// Factor below 1: pixels and compression spread a post's colour beyond its edge.
const SHARP_EDGE: f32 = 0.6;
/// Limit of one over the cosine: seen nearly edge-on, a billboard would hide everything.
const MOST_OBLIQUE: f32 = 4.0;

/// Whether no goal stands between a camera and the point.
fn unhidden(position: vec3<f32>, point: ProxyPoint) -> bool {
    var is_unhidden = true;
    let way = point.place - position;
    let slope = way.y / way.x;
    let margin = POST_RADIUS_M * (min(sqrt(1.0 + slope * slope), MOST_OBLIQUE) - SHARP_EDGE);
    for (var number = 0u; number < BILLBOARDS; number++) {
        let billboard = drawing.proxy.billboards[number];
        let share = (billboard.x - position.x) / way.x;
        let across = position.y + share * way.y;
        let up = position.z + share * way.z;
        let is_between = share > 0.0 && share < ON_SCREEN;
        is_unhidden = is_unhidden && !(is_between && holds(billboard, margin, across, up));
    }
    return is_unhidden;
}
