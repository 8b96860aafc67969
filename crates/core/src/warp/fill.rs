//! Colours for pixels that no neighbour saw: smoothly continued from those around them.
//!
//! The pull-push method (Gortler et al., 1996): the picture is halved again and again, means taken over the known pixels
//! only, until all are known; on the way back every unknown pixel takes the colour of the coarser picture.

/// Colours with weights, 0 for unknown.
struct Level {
    width: usize,
    height: usize,
    /// Red, green, blue, weight.
    pixels: Vec<[f32; 4]>,
}

/// Fills the pixels that are not known. Nothing happens where none is known at all.
pub(crate) fn fill(colors: &mut [[u8; 3]], width: usize, is_known: impl Fn(usize) -> bool) {
    let known = |index: usize| f32::from(u8::from(is_known(index)));
    let count = (0..colors.len()).filter(|&index| is_known(index)).count();
    if count == 0 || count == colors.len() {
        return;
    }
    let pixels = colors.iter().enumerate();
    let pixels = pixels.map(|(index, color)| {
        let weight = known(index);
        let [red, green, blue] = color.map(|value| weight * f32::from(value));
        [red, green, blue, weight]
    });
    let mut levels = vec![Level { width, height: colors.len() / width, pixels: pixels.collect() }];
    while let Some(finest) = levels.last().filter(|level| level.pixels.iter().any(|pixel| pixel[3] == 0.0)) {
        levels.push(halved(finest));
    }
    let mut coarse = levels.pop();
    while let Some(mut fine) = levels.pop() {
        if let Some(coarse) = &coarse {
            take_unknown(&mut fine, coarse);
        }
        coarse = Some(fine);
    }
    for (index, (color, pixel)) in
        colors.iter_mut().zip(coarse.iter().flat_map(|level| &level.pixels)).enumerate()
    {
        if !is_known(index) {
            *color = [0, 1, 2].map(|channel| (pixel[channel] / pixel[3] + 0.5) as u8);
        }
    }
}

/// Sums over two by two pixels, their weight at most 1.
fn halved(fine: &Level) -> Level {
    let (width, height) = (fine.width.div_ceil(2), fine.height.div_ceil(2));
    let mut pixels = vec![[0.0_f32; 4]; width * height];
    for (v, row) in fine.pixels.chunks(fine.width).enumerate() {
        for (u, pixel) in row.iter().enumerate() {
            let sum = &mut pixels[(v / 2) * width + u / 2];
            for channel in 0..4 {
                sum[channel] += pixel[channel];
            }
        }
    }
    for pixel in &mut pixels {
        let scale = 1.0 / pixel[3].max(1.0);
        *pixel = pixel.map(|value| value * scale);
    }
    Level { width, height, pixels }
}

/// Unknown pixels take the bilinear colour of the next coarser level.
fn take_unknown(fine: &mut Level, coarse: &Level) {
    let at = |u: isize, v: isize| {
        let u = u.clamp(0, coarse.width as isize - 1) as usize;
        let v = v.clamp(0, coarse.height as isize - 1) as usize;
        coarse.pixels[v * coarse.width + u]
    };
    for v in 0..fine.height {
        for u in 0..fine.width {
            let pixel = &mut fine.pixels[v * fine.width + u];
            if pixel[3] > 0.0 {
                continue;
            }
            // The middle of a coarse pixel lies between two fine ones: three quarters of its own, one of the next.
            let (cu, cv) = ((u / 2) as isize, (v / 2) as isize);
            let (nu, nv) = (cu + if u % 2 == 0 { -1 } else { 1 }, cv + if v % 2 == 0 { -1 } else { 1 });
            let taps = [(at(cu, cv), 9.0), (at(nu, cv), 3.0), (at(cu, nv), 3.0), (at(nu, nv), 1.0)];
            let total: f32 = taps.iter().map(|(tap, share)| share * tap[3]).sum();
            if total > 0.0 {
                let mean = |channel: usize| {
                    taps.iter().map(|(tap, share)| share * tap[channel]).sum::<f32>() / total
                };
                *pixel = [mean(0), mean(1), mean(2), 1.0];
            }
        }
    }
}
