//! Pinhole pictures of what a simulator draws itself, around a camera of any lens.

use glam::{DMat3, DVec2, DVec3, Vec3};
use reality_sim_core::pose::CameraPose;
use reality_sim_sensor::linear_from_srgb;

use crate::{
    canvas::{Canvas, Fragment, PART_OFFSETS, PARTS},
    class::Class,
    layer::{Layer, Object, Sphere},
    pixel_box::PixelBox,
    view::View,
};

/// Side of a cube around the camera, of which a pinhole camera of 90° across takes a picture. The cube's axes are the camera's.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum CubeSide {
    /// z, which the camera looks along.
    Forward,
    /// −x.
    Left,
    /// x.
    Right,
    /// −y.
    Up,
    /// y.
    Down,
    /// −z.
    Backward,
}

/// Number of a pixel of a [`CubeFace`] that shows no object.
pub const NO_CUBE_OBJECT: u16 = u16::MAX;

/// Picture on one side of the cube, or of a window of it, in the axes of [`CubeSide::axes_in_cube`]; pixels row by row from the top
/// left.
#[derive(Debug, Clone)]
pub struct CubeFace {
    /// Side of the cube.
    pub side: CubeSide,
    /// Number of columns, and of rows, of the whole side.
    pub size: u32,
    /// Pixels of the side that are given; the others show nothing.
    pub window: PixelBox,
    /// Red, green and blue, sRGB; 255 is a white surface in the hall's light.
    pub srgb: Vec<[u8; 3]>,
    /// Depths along the face's axis, metres.
    pub depth_m: Vec<f32>,
    /// Objects of the pixels, places in [`CubeLayer::objects`], or [`NO_CUBE_OBJECT`].
    pub object_of: Vec<u16>,
}

/// Pictures on the sides of a cube around the camera, brought through its lens. Sides that show nothing can be left out.
///
/// Each of a pixel's parts takes the pixel of the cube that its ray meets, so that edges are smooth where the cube is as fine as
/// the camera's picture.
#[derive(Debug, Clone)]
pub struct CubeLayer {
    cube_from_world: DMat3,
    faces: [Option<CubeFace>; 6],
    /// Linear values of sRGB's.
    linear: [f32; 256],
    /// Class and name of what it shows.
    pub objects: Vec<(Class, String)>,
    /// Spheres that stand for what it shows where that takes light from the ground; none cast no shadow.
    pub occluders: Vec<Sphere>,
}

impl CubeSide {
    /// All sides.
    pub const ALL: [Self; 6] = [Self::Forward, Self::Left, Self::Right, Self::Up, Self::Down, Self::Backward];

    /// Returns the axes of the side's picture, right, down and forward, in the cube's axes.
    pub fn axes_in_cube(self) -> [DVec3; 3] {
        match self {
            Self::Forward => [DVec3::X, DVec3::Y, DVec3::Z],
            Self::Left => [DVec3::Z, DVec3::Y, DVec3::NEG_X],
            Self::Right => [DVec3::NEG_Z, DVec3::Y, DVec3::X],
            Self::Up => [DVec3::X, DVec3::Z, DVec3::NEG_Y],
            Self::Down => [DVec3::X, DVec3::NEG_Z, DVec3::Y],
            Self::Backward => [DVec3::NEG_X, DVec3::Y, DVec3::NEG_Z],
        }
    }

    /// Returns the side that a direction in the cube's axes meets.
    pub fn of(direction: DVec3) -> Self {
        let size = direction.abs();
        match size.max_element() {
            largest if largest == size.z => {
                if direction.z > 0.0 {
                    Self::Forward
                } else {
                    Self::Backward
                }
            }
            largest if largest == size.x => {
                if direction.x > 0.0 {
                    Self::Right
                } else {
                    Self::Left
                }
            }
            _ => {
                if direction.y > 0.0 {
                    Self::Down
                } else {
                    Self::Up
                }
            }
        }
    }
}

impl CubeFace {
    fn is_whole(&self) -> bool {
        let pixels = self.window.width() as usize * self.window.height() as usize;
        let is_inside = self.window.right <= self.size && self.window.bottom <= self.size;
        is_inside && [self.srgb.len(), self.depth_m.len(), self.object_of.len()] == [pixels; 3]
    }

    /// Returns the direction of a pixel's centre in the cube's axes, of any length.
    fn ray_in_cube(&self, pixel: usize) -> DVec3 {
        let width = self.window.width() as usize;
        let (column, row) =
            (self.window.left as usize + pixel % width, self.window.top as usize + pixel / width);
        let slope = |place: usize| (2.0 * place as f64 + 1.0) / f64::from(self.size) - 1.0;
        let [right, down, forward] = self.side.axes_in_cube();
        forward + slope(column) * right + slope(row) * down
    }

    /// Returns the pixel at slopes to the right and down, −1 to 1 across the side; `None` outside the window.
    fn pixel(&self, right: f64, down: f64) -> Option<usize> {
        // A conversion to an integer keeps to its range.
        let [column, row] = [right, down].map(|slope| (0.5 * (slope + 1.0) * f64::from(self.size)) as u32);
        let (column, row) = (column.min(self.size - 1), row.min(self.size - 1));
        let (left, top) = (self.window.left, self.window.top);
        self.window
            .contains(column, row)
            .then(|| (row - top) as usize * self.window.width() as usize + (column - left) as usize)
    }
}

/// What a ray meets on the cube.
struct Hit {
    color: Vec3,
    distance_m: f32,
    object: u16,
}

impl CubeLayer {
    /// Makes a layer of some sides of the cube, drawn from a pose; `None` where a face has not as many values as pixels.
    pub fn new(pose: CameraPose, faces: Vec<CubeFace>, objects: Vec<(Class, String)>) -> Option<Self> {
        let mut all = [const { None }; 6];
        for face in faces {
            if !face.is_whole() {
                return None;
            }
            let side = face.side as usize;
            all[side] = Some(face);
        }
        let linear = std::array::from_fn(|value| linear_from_srgb(value as u8));
        let cube_from_world = pose.rotation_world_from_camera().transpose();
        Some(Self { cube_from_world, faces: all, linear, objects, occluders: Vec::new() })
    }

    fn meet(&self, ray_in_cube: DVec3) -> Option<Hit> {
        let side = CubeSide::of(ray_in_cube);
        let face = self.faces[side as usize].as_ref()?;
        let [right, down, forward] = side.axes_in_cube().map(|axis| axis.dot(ray_in_cube));
        let pixel = face.pixel(right / forward, down / forward)?;
        let object = face.object_of[pixel];
        let color = face.srgb[pixel].map(|value| self.linear[usize::from(value)]);
        // The ray has unit length.
        let distance_m = f64::from(face.depth_m[pixel]) / forward;
        (object != NO_CUBE_OBJECT).then_some(Hit {
            color: color.into(),
            distance_m: distance_m as f32,
            object,
        })
    }

    /// Puts what a pixel's parts show: one fragment for each object.
    fn draw_pixel(&self, rays: &PixelRays, u: u32, v: u32, white: Vec3, canvas: &mut Canvas) {
        let mut fragments: Vec<(Fragment, f32)> = Vec::new();
        for part in 0..PARTS {
            let Some(hit) = self.meet(self.cube_from_world * rays.of_part(part)) else { continue };
            let bit = 1 << part;
            match fragments.iter_mut().find(|(fragment, _)| fragment.object == hit.object) {
                Some((fragment, count)) => {
                    fragment.color += hit.color;
                    fragment.distance_m += hit.distance_m;
                    fragment.parts |= bit;
                    *count += 1.0;
                }
                None => {
                    let Hit { color, distance_m, object } = hit;
                    fragments.push((Fragment { color, alpha: 1.0, distance_m, object, parts: bit }, 1.0));
                }
            }
        }
        for (fragment, count) in fragments {
            let color = white * fragment.color / count;
            canvas.put(u, v, Fragment { color, distance_m: fragment.distance_m / count, ..fragment });
        }
    }

    /// Returns the pixels of a picture that may show something.
    fn area(&self, view: &View<'_>) -> PixelBox {
        let mut area = PixelBox::default();
        let (eye, world_from_cube) = (view.pose().position_in_world(), self.cube_from_world.transpose());
        for face in self.faces.iter().flatten() {
            // What a pixel of the face shows is at most this far from where its centre is seen.
            let around = 2.0 * view.lens().fx.max(view.lens().fy) / f64::from(face.size) + 1.0;
            let shown = face.object_of.iter().enumerate().filter(|(_, object)| **object != NO_CUBE_OBJECT);
            for (pixel, _) in shown {
                let point_in_world = eye + world_from_cube * face.ray_in_cube(pixel);
                let Some(pixel) = view.project(point_in_world).map(|seen| seen.pixel) else { continue };
                let [least, most] = [pixel - around, pixel + around].map(|corner| corner.to_array());
                area =
                    PixelBox::touched(least, most, view.size()).map_or(area, |touched| area.union(touched));
            }
        }
        area
    }
}

/// Rays of a pixel in the world: linear over the pixel.
struct PixelRays {
    middle: DVec3,
    per_column: DVec3,
    per_row: DVec3,
}

impl PixelRays {
    fn new(view: &View<'_>, u: u32, v: u32) -> Option<Self> {
        let ray = |du: f64, dv: f64| view.ray(DVec2::new(f64::from(u) + du, f64::from(v) + dv));
        let middle = ray(0.0, 0.0)?;
        // At the rim of the lens there is a ray on one side only.
        let change = |du: f64, dv: f64| {
            let after = ray(du, dv).map(|ray| 2.0 * (ray - middle));
            after.or_else(|| ray(-du, -dv).map(|ray| 2.0 * (middle - ray))).unwrap_or_default()
        };
        Some(Self { middle, per_column: change(0.5, 0.0), per_row: change(0.0, 0.5) })
    }

    fn of_part(&self, part: usize) -> DVec3 {
        let [right, down] = [0, 1].map(|axis: usize| f64::from(PART_OFFSETS[axis][part]));
        (self.middle + right * self.per_column + down * self.per_row).normalize_or(self.middle)
    }
}

impl Layer for CubeLayer {
    fn objects(&self) -> Vec<Object<'_>> {
        self.objects.iter().map(|(class, name)| Object { class: *class, name: name.into() }).collect()
    }

    fn draw(&self, view: &View<'_>, canvas: &mut Canvas) {
        let white = view.light().sky;
        let area = self.area(view);
        canvas.open(area);
        for (v, u) in (area.top..area.bottom).flat_map(|v| (area.left..area.right).map(move |u| (v, u))) {
            if let Some(rays) = PixelRays::new(view, u, v) {
                self.draw_pixel(&rays, u, v, white, canvas);
            }
        }
    }

    fn occluders(&self) -> Vec<Sphere> {
        self.occluders.clone()
    }
}
