//! Meshes: surfaces of triangles.

use glam::{DAffine3, DVec3, Vec3};

/// Corner of triangles.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Vertex {
    /// Place, metres in the mesh's own frame.
    pub place: Vec3,
    /// Outward normal of the surface; of any length.
    pub normal: Vec3,
    /// Reflectance in red, green and blue, linear, 0 to 1.
    pub reflectance: Vec3,
}

/// Surface of triangles, seen from outside only.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Mesh {
    /// Corners.
    pub vertices: Vec<Vertex>,
    /// Places of each triangle's corners in [`Mesh::vertices`], counter-clockwise seen from outside.
    pub triangles: Vec<[u32; 3]>,
}

impl Mesh {
    /// Makes a sphere of radius 1 from an icosahedron whose triangles are cut in four so many times (at most 5). It is as
    /// large as to have the sphere's mean outline.
    pub fn sphere(cuts: u32, reflectance: Vec3) -> Self {
        let (mut places, mut triangles) = icosahedron();
        for _ in 0..cuts.min(5) {
            (places, triangles) = cut(places, &triangles);
        }
        let radius = mean_outline_radius(&places, &triangles).recip();
        let vertex = |place: &Vec3| Vertex { place: radius * *place, normal: *place, reflectance };
        Self { vertices: places.iter().map(vertex).collect(), triangles }
    }

    /// Makes a cuboid around the origin.
    pub fn cuboid(half_size_m: Vec3, reflectance: Vec3) -> Self {
        let mut mesh = Self::default();
        for (axis, side) in (0..3).flat_map(|axis| [(axis, -1.0), (axis, 1.0)]) {
            let [mut out, mut across, mut up] = [Vec3::ZERO; 3];
            (out[axis], across[(axis + 1) % 3], up[(axis + 2) % 3]) = (side, side, 1.0);
            let first = mesh.vertices.len() as u32;
            for (a, b) in [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)] {
                let place = half_size_m * (out + a * across + b * up);
                mesh.vertices.push(Vertex { place, normal: out, reflectance });
            }
            mesh.triangles.extend([[first, first + 1, first + 2], [first, first + 2, first + 3]]);
        }
        mesh
    }

    /// Makes a rod with round ends between two points.
    pub fn rod(from: Vec3, to: Vec3, radius_m: f32, reflectance: Vec3) -> Self {
        const SIDES: u32 = 8;
        // Angles from the equator to a pole, of the rings of a half sphere.
        const RINGS: [f32; 2] = [0.0, 0.8];
        let along = (to - from).normalize_or(Vec3::Z);
        let (across, up) = along.any_orthonormal_pair();
        let mut mesh = Self::default();
        let mut put = |center: Vec3, normal: Vec3| {
            mesh.vertices.push(Vertex { place: center + radius_m * normal, normal, reflectance });
        };
        put(from, -along);
        let ends =
            RINGS.iter().rev().map(|angle| (from, -angle)).chain(RINGS.iter().map(|angle| (to, *angle)));
        for (center, angle) in ends {
            for side in 0..SIDES {
                let turn = std::f32::consts::TAU * side as f32 / SIDES as f32;
                let out = turn.cos() * across + turn.sin() * up;
                put(center, angle.cos() * out + angle.sin() * along);
            }
        }
        put(to, along);
        let last = mesh.vertices.len() as u32 - 1;
        let at = |ring: u32, side: u32| 1 + ring * SIDES + side % SIDES;
        let rings = 2 * RINGS.len() as u32;
        for side in 0..SIDES {
            mesh.triangles.push([0, at(0, side + 1), at(0, side)]);
            mesh.triangles.push([last, at(rings - 1, side), at(rings - 1, side + 1)]);
            for ring in 0..rings - 1 {
                let [a, b] = [at(ring, side), at(ring, side + 1)];
                let [c, d] = [at(ring + 1, side), at(ring + 1, side + 1)];
                mesh.triangles.extend([[a, b, d], [a, d, c]]);
            }
        }
        mesh
    }

    /// Adds another mesh, moved into this one's frame by a motion.
    pub fn add(&mut self, other: &Self, self_from_other: DAffine3) {
        let first = self.vertices.len() as u32;
        let motion = self_from_other.as_affine3a();
        // Normals stand on what is scaled unevenly.
        let turn = motion.matrix3.inverse().transpose();
        self.vertices.extend(other.vertices.iter().map(|vertex| Vertex {
            place: motion.transform_point3(vertex.place),
            normal: (turn * vertex.normal).normalize_or_zero(),
            ..*vertex
        }));
        self.triangles.extend(other.triangles.iter().map(|corners| corners.map(|corner| corner + first)));
    }

    /// Returns centre and radius of a sphere around the mesh, metres; `None` for one without vertices or with places that are
    /// not finite.
    pub(crate) fn bounds(&self) -> Option<(DVec3, f64)> {
        let places = || self.vertices.iter().map(|vertex| vertex.place);
        let least = places().reduce(Vec3::min)?;
        let most = places().reduce(Vec3::max)?;
        let middle = 0.5 * (least + most);
        let radius = places().map(|place| place.distance(middle)).fold(0.0, f32::max);
        (middle.is_finite() && radius.is_finite()).then(|| (middle.as_dvec3(), f64::from(radius)))
    }
}

fn icosahedron() -> (Vec<Vec3>, Vec<[u32; 3]>) {
    let golden = 0.5 * (1.0 + 5.0_f32.sqrt());
    let corner = |a: f32, b: f32, axis: usize| {
        let mut place = Vec3::ZERO;
        (place[axis], place[(axis + 1) % 3]) = (a, b * golden);
        place.normalize_or_zero()
    };
    let signs = [(-1.0, -1.0), (-1.0, 1.0), (1.0, -1.0), (1.0, 1.0)];
    let places: Vec<Vec3> = (0..3).flat_map(|axis| signs.map(move |(a, b)| corner(a, b, axis))).collect();
    // Neighbours are the nearest; every three that are neighbours of each other are a face.
    let edge = places[0].distance(places[2]).min(places[0].distance(places[1]));
    let is_edge = |a: usize, b: usize| places[a].distance(places[b]) < 1.1 * edge;
    let mut triangles = Vec::new();
    for (a, b) in (0..12).flat_map(|a| (a + 1..12).map(move |b| (a, b))).filter(|(a, b)| is_edge(*a, *b)) {
        for c in (b + 1..12).filter(|c| is_edge(a, *c) && is_edge(b, *c)) {
            let out = (places[b] - places[a]).cross(places[c] - places[a]).dot(places[a]);
            triangles.push(if out > 0.0 { [a, b, c] } else { [a, c, b] }.map(|corner| corner as u32));
        }
    }
    (places, triangles)
}

/// Cuts every triangle into four, with new corners on the unit sphere.
fn cut(mut places: Vec<Vec3>, triangles: &[[u32; 3]]) -> (Vec<Vec3>, Vec<[u32; 3]>) {
    let mut middles = std::collections::BTreeMap::new();
    let mut parts = Vec::with_capacity(4 * triangles.len());
    for &[a, b, c] in triangles {
        let [ab, bc, ca] = [(a, b), (b, c), (c, a)].map(|(from, to)| {
            *middles.entry((from.min(to), from.max(to))).or_insert_with(|| {
                places.push((places[from as usize] + places[to as usize]).normalize_or_zero());
                places.len() as u32 - 1
            })
        });
        parts.extend([[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]);
    }
    (places, parts)
}

/// Returns the mean radius of the outline of a sphere of flat triangles with corners at radius 1: an edge lies inside the
/// circle by up to `1 − cos` of half its angle, two thirds of that in the mean.
fn mean_outline_radius(places: &[Vec3], triangles: &[[u32; 3]]) -> f32 {
    let edges = triangles.iter().flat_map(|[a, b, c]| [(a, b), (b, c), (c, a)]);
    let inside = edges.map(|(a, b)| {
        let half_chord = 0.5 * places[*a as usize].distance(places[*b as usize]);
        1.0 - (1.0 - half_chord * half_chord).max(0.0).sqrt()
    });
    1.0 - 2.0 / 3.0 * inside.sum::<f32>() / (3 * triangles.len()).max(1) as f32
}

#[cfg(test)]
mod tests {
    use glam::DMat3;

    use super::*;

    /// Returns the volume inside a closed surface whose triangles face outwards, by the divergence theorem.
    fn volume(mesh: &Mesh) -> f32 {
        let place = |corner: u32| mesh.vertices[corner as usize].place;
        mesh.triangles.iter().map(|[a, b, c]| place(*a).dot(place(*b).cross(place(*c))) / 6.0).sum()
    }

    /// Checks that normals point away from the side of the triangles that is inside.
    fn check_normals(mesh: &Mesh) {
        for triangle in &mesh.triangles {
            let [a, b, c] = triangle.map(|corner| mesh.vertices[corner as usize]);
            let out = (b.place - a.place).cross(c.place - a.place);
            assert!([a, b, c].iter().all(|corner| corner.normal.dot(out) > 0.0));
        }
    }

    #[test]
    fn bodies_are_closed_face_outwards_and_have_their_volumes() {
        let pi = std::f32::consts::PI;
        let shapes = [
            (Mesh::sphere(3, Vec3::ONE), 4.0 / 3.0 * pi, 0.01),
            (Mesh::cuboid(Vec3::new(1.0, 2.0, 0.5), Vec3::ONE), 8.0, 1e-5),
            // A cylinder of length 2 and two half spheres, of eight sides.
            (
                Mesh::rod(Vec3::new(0.5, 0.0, 1.0), Vec3::new(0.5, 2.0, 1.0), 0.4, Vec3::ONE),
                2.0 * 0.16 * pi + 4.0 / 3.0 * pi * 0.064,
                0.16,
            ),
        ];
        for (mesh, expected, tolerance) in shapes {
            let found = volume(&mesh);
            assert!((found / expected - 1.0).abs() < tolerance, "{found} instead of {expected}");
            check_normals(&mesh);
        }
    }

    #[test]
    fn spheres_have_the_outline_of_a_circle_in_the_mean() {
        for cuts in 2..5 {
            let mesh = Mesh::sphere(cuts, Vec3::ONE);
            // By Cauchy's formula, the mean outline of a convex body has a quarter of its surface's area.
            let place = |corner: u32| mesh.vertices[corner as usize].place;
            let area =
                |[a, b, c]: &[u32; 3]| 0.5 * (place(*b) - place(*a)).cross(place(*c) - place(*a)).length();
            let outline = mesh.triangles.iter().map(area).sum::<f32>() / 4.0;
            let off = outline / std::f32::consts::PI - 1.0;
            assert!(off.abs() < 0.005, "{cuts}: {off}");
        }
    }

    #[test]
    fn a_mesh_that_is_added_is_moved_and_keeps_its_normals_upright() {
        let squeezed = DAffine3::from_mat3_translation(
            DMat3::from_diagonal(DVec3::new(1.0, 1.0, 0.2)),
            DVec3::new(0.0, 0.0, 3.0),
        );
        let mut mesh = Mesh::default();
        mesh.add(&Mesh::sphere(2, Vec3::ONE), squeezed);
        mesh.add(&Mesh::cuboid(Vec3::ONE, Vec3::ONE), DAffine3::IDENTITY);
        assert!((volume(&mesh) - 8.0 - 0.2 * 4.0 / 3.0 * std::f32::consts::PI).abs() < 0.05);
        check_normals(&mesh);
        let (middle, radius_m) = mesh.bounds().unwrap();
        assert!(middle.z > 0.5 && radius_m > 1.5);
        assert_eq!(Mesh::default().bounds(), None);
    }
}
