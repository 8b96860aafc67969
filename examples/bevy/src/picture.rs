//! Pictures as Bevy's images.

use bevy::{
    asset::RenderAssetUsages,
    image::Image,
    render::render_resource::{Extent3d, TextureDimension, TextureFormat},
};
use reality_sim::image::RgbImage;

/// Pictures are opaque sRGB.
const FORMAT: TextureFormat = TextureFormat::Rgba8UnormSrgb;

/// Makes an opaque black image.
pub(crate) fn black_image(width: u32, height: u32) -> Image {
    let size = Extent3d { width, height, depth_or_array_layers: 1 };
    Image::new_fill(size, TextureDimension::D2, &[0, 0, 0, u8::MAX], FORMAT, RenderAssetUsages::default())
}

/// Writes a picture into an image, whatever that was before.
pub(crate) fn write_picture(picture: &RgbImage, image: &mut Image) {
    let [width, height] = [picture.width(), picture.height()];
    let pixels = width as usize * height as usize;
    let is_like_it = image.width() == width && image.height() == height;
    let has_room = image.data.as_ref().is_some_and(|data| data.len() == 4 * pixels);
    if !(is_like_it && has_room && image.texture_descriptor.format == FORMAT) {
        *image = black_image(width, height);
    }
    let Some(data) = &mut image.data else { return };
    for (rgba, rgb) in data.chunks_exact_mut(4).zip(picture.as_raw().chunks_exact(3)) {
        rgba[..3].copy_from_slice(rgb);
        rgba[3] = u8::MAX;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn picture() -> RgbImage {
        RgbImage::from_fn(3, 2, |x, y| [10 * x as u8, 20 * y as u8, 7].into())
    }

    #[test]
    fn picture_is_written_row_by_row_and_opaque() {
        let mut image = black_image(3, 2);
        write_picture(&picture(), &mut image);
        let expected = [
            [0, 0, 7, 255],
            [10, 0, 7, 255],
            [20, 0, 7, 255],
            [0, 20, 7, 255],
            [10, 20, 7, 255],
            [20, 20, 7, 255],
        ];
        assert_eq!(image.data.unwrap(), expected.concat());
    }

    #[test]
    fn image_of_another_size_or_format_is_made_anew() {
        let single = Extent3d { width: 3, height: 2, depth_or_array_layers: 1 };
        let grey = Image::new_fill(
            single,
            TextureDimension::D2,
            &[0],
            TextureFormat::R8Unorm,
            RenderAssetUsages::default(),
        );
        for mut image in [black_image(5, 4), grey, Image::default()] {
            write_picture(&picture(), &mut image);
            assert_eq!([image.width(), image.height()], [3, 2]);
            assert_eq!(image.texture_descriptor.format, FORMAT);
            assert_eq!(image.data.unwrap()[4..8], [10, 0, 7, 255]);
        }
    }
}
