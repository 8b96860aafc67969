//! Pictures that a simulator renders itself.

use glam::Vec3;

use crate::{
    canvas::{Canvas, Fragment},
    class::Class,
    layer::{Layer, Object, Sphere},
    pixel_box::PixelBox,
    view::View,
};

/// Pixel of a [`PictureLayer`].
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct LayerPixel {
    /// Linear red, green and blue, times alpha; 1 is a white surface in the hall's light.
    pub color: Vec3,
    /// Opacity, or how much of the pixel is covered, 0 to 1.
    pub alpha: f32,
    /// Distance along the pixel's ray, metres.
    pub distance_m: f32,
    /// Place of what it shows in [`PictureLayer::objects`].
    pub object: u16,
}

/// Picture with opacity, distances and labels of the same size as the camera's, through the camera's lens.
#[derive(Debug, Clone)]
pub struct PictureLayer {
    size: [u32; 2],
    pixels: Vec<LayerPixel>,
    /// Class and name of what it shows.
    pub objects: Vec<(Class, String)>,
    /// Spheres that stand for what it shows where that takes light from the ground; none cast no shadow.
    pub occluders: Vec<Sphere>,
}

impl PictureLayer {
    /// Makes a layer of pixels, row by row from the top; `None` where their number is not that of a picture of this size.
    pub fn new(size: [u32; 2], pixels: Vec<LayerPixel>, objects: Vec<(Class, String)>) -> Option<Self> {
        let count = size[0] as usize * size[1] as usize;
        (pixels.len() == count).then(|| Self { size, pixels, objects, occluders: Vec::new() })
    }

    fn area(&self) -> PixelBox {
        let shown = self.pixels.iter().enumerate().filter(|(_, pixel)| pixel.alpha > 0.0);
        shown.fold(PixelBox::default(), |area, (index, _)| {
            let index = index as u32;
            area.union(PixelBox::around(index % self.size[0], index / self.size[0]))
        })
    }
}

impl Layer for PictureLayer {
    fn objects(&self) -> Vec<Object<'_>> {
        self.objects.iter().map(|(class, name)| Object { class: *class, name: name.into() }).collect()
    }

    /// Draws the picture; one of another size than the camera's is left out.
    fn draw(&self, view: &View<'_>, canvas: &mut Canvas) {
        if view.size() != self.size {
            return;
        }
        let white = view.light().sky;
        let area = self.area();
        canvas.open(area);
        for (v, u) in (area.top..area.bottom).flat_map(|v| (area.left..area.right).map(move |u| (v, u))) {
            let pixel = self.pixels[(v * self.size[0] + u) as usize];
            canvas.put(
                u,
                v,
                Fragment {
                    color: white * pixel.color,
                    alpha: pixel.alpha,
                    distance_m: pixel.distance_m,
                    object: pixel.object,
                    parts: Fragment::ALL,
                },
            );
        }
    }

    fn occluders(&self) -> Vec<Sphere> {
        self.occluders.clone()
    }
}
