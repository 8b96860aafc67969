//! Which pieces of line and blocks of carpet are measured, and which measurements are kept.

/// Which pieces of line and blocks of carpet are measured, and which measurements are kept.
#[derive(Debug, Clone, Copy)]
pub(crate) struct MeasurementThresholds {
    pub(crate) line: LineThresholds,
    pub(crate) profile: ProfileThresholds,
    pub(crate) carpet: CarpetThresholds,
    pub(crate) visibility: VisibilityThresholds,
    /// Darkest and brightest mean encoded value that tells of the light, 0 to 1. Chosen: below, files keep little of a colour
    /// and noise is cut off at black; above, it is cut off at white.
    pub(crate) level: [f64; 2],
}

/// Which pieces of line are predicted, and with how much contrast they are found.
#[derive(Debug, Clone, Copy)]
pub(crate) struct LineThresholds {
    /// Distance between samples along a line on the ground, metres. Chosen: of these, one is taken every `spacing_px`.
    pub(crate) spacing_m: f64,
    /// Distance between samples in the picture, pixels. Chosen: profiles are 5 px long, so that neighbours share no pixel.
    pub(crate) spacing_px: f64,
    /// Smallest and largest half width of a line that is measured, pixels: thinner lines are too faint, wider ones too near.
    /// Chosen: lines from 1 to 60 px wide.
    pub(crate) half_width_px: [f64; 2],
    /// Smallest half width, in standard deviations of the blur: a bar of half width `w σ` keeps erf(w / √2) of its contrast,
    /// which are 20 %, about what the carpet has of its own. Chosen, when a defocus of 2.7 px at 320 × 240 had brought in
    /// false mount_roll, chromatic_aberration and field_dimensions.
    pub(crate) least_half_width_sigmas: f64,
    /// Margin between a piece of line and the picture's border, beyond the line's width and the search, pixels. Chosen: the 4
    /// px of a profile's flank, and 2.5 standard deviations of a blur of 1.6 px.
    pub(crate) border_margin_px: f64,
    /// Blurs with which lines are searched, one after the other until they are found: standard deviation beside the predicted
    /// one, pixels. The last is the end of defocus's range. Chosen, when a defocus of 2.7 px at 320 × 240 hid most lines from
    /// a search without them.
    pub(crate) extra_blur_px: [f64; 4],
    /// Smallest contrast of a line to the carpet where nothing blurs it, grey levels. Chosen; no measurement.
    pub(crate) least_sharp_contrast: f64,
    /// Smallest contrast of a blurred line, grey levels. Chosen: the carpet's texture has as much.
    pub(crate) least_blurred_contrast: f64,
}

/// Which pixels a line's profile is fitted to, and which fits are kept.
#[derive(Debug, Clone, Copy)]
pub(crate) struct ProfileThresholds {
    /// Encoded value of a colour from which it may be cut off at white, 0 to 1. Chosen: JPEG's rounding moves white by two grey
    /// levels.
    pub(crate) white: f64,
    /// Largest share of a profile's samples that may be cut off where its blur is measured. Chosen: single pixels are noise.
    pub(crate) most_white_share: f64,
    /// Half the length of the piece of line, pixels. Chosen: the ends of an arc of 50 px radius depart by 0.06 px from its
    /// tangent there.
    pub(crate) half_length_px: f64,
    /// Where the blurred side of the line ends, in standard deviations of the predicted blur. Chosen: 99.4 % of an edge's
    /// rise is within it.
    pub(crate) flank_sigmas: f64,
    /// Flank that is taken beyond the blurred side of the line, pixels. Chosen: with the 5 px of a piece's length, it has
    /// about twenty pixels a side.
    pub(crate) flank_px: f64,
    /// Largest distance of the fitted middle from the searched one, beyond half the line's width, pixels. Chosen; no
    /// measurement.
    pub(crate) most_shift_px: f64,
    /// Fewest degrees of freedom of a fit: pixels less the five parameters. Chosen: with `n` of them the standard deviation
    /// of the residuals is known to 1 / √(2 n), which are 21 %.
    pub(crate) least_degrees_of_freedom: usize,
    /// Half the window of the centroids beyond the line's side: standard deviations of the blur, that of the stored chroma
    /// included. Chosen: 97.7 % of an edge's rise is within it.
    pub(crate) color_window_sigmas: f64,
    /// And pixels beside that. Chosen; no measurement.
    pub(crate) color_window_margin_px: f64,
    /// Fewest pixels of either flank. Chosen; no measurement.
    pub(crate) least_flank_pixels: f64,
    /// Smallest flank that is left for the colour channels where the window would take all of it, pixels. Chosen: with the 5
    /// px of a piece's length, it has seven pixels.
    pub(crate) least_color_flank_px: f64,
    /// Standard deviation of the blur where chroma is stored at half the resolution, pixels. Averaging in pairs has a
    /// variance of 1/4 px², interpolation between their middles one of 3/4 px², repetition one of 1/4 px²: between 0.7 and 1.
    /// Chosen between; draw 1 showed that without it shifts come out 7 % too small.
    pub(crate) chroma_sigma_px: f64,
    /// Smallest contrast that a colour channel needs for an offset of its own, as a part of luma's contrast. Chosen; no
    /// measurement.
    pub(crate) least_color_contrast: f64,
    /// Smallest and largest variance of a line's blur that is believed, pixels squared. Chosen: a quarter of the 1/12 of the
    /// pixel's own aperture, and a standard deviation of 7.7 px.
    pub(crate) variance_px2: [f64; 2],
    /// Smallest contrast of a fitted line to its flanks, encoded values (0–1). Chosen: five grey levels, less than the search
    /// asks for.
    pub(crate) least_contrast: f64,
    /// Distance of the line's inner part, whose colour is measured, from the line's side: standard deviations of the blur.
    /// Chosen: the side has risen to 97.7 % there. Doubling it changes a report, see `docs/figures/gap_thresholds.md`.
    pub(crate) inner_margin_sigmas: f64,
    /// And pixels beside that. Chosen; no measurement. Doubling it changes a report, see `docs/figures/gap_thresholds.md`.
    pub(crate) inner_margin_px: f64,
    /// Smallest half width of that inner part, pixels. Chosen; no measurement.
    pub(crate) least_inner_half_width_px: f64,
    /// Fewest pixels of that inner part. Chosen; no measurement.
    pub(crate) least_inner_pixels: f64,
    /// Largest residual of a fit, root mean square, as a part of the line's contrast. Chosen; no measurement.
    pub(crate) most_residual: f64,
}

/// Which pixels show carpet, and in which coefficients its noise is measured.
#[derive(Debug, Clone, Copy)]
pub(crate) struct CarpetThresholds {
    /// Width of pictures from which on blocks of carpet have 16 × 16 pixels, and not 8 × 8, pixels. Chosen: between the 320
    /// and the 640 px of the study's pictures, so that a block shows as much carpet in both.
    pub(crate) large_blocks_from_width_px: u32,
    /// Side of the squares of the ground in which only some blocks are measured, metres. Derived: the smallest patch of
    /// carpet, [`super::ReflectanceThresholds::smallest_carpet_patch_m`].
    pub(crate) thinned_square_m: f64,
    /// Number of blocks that are measured in such a square. Chosen: near the camera dozens show it, and the light on them is
    /// the same; a few suffice to tell that of the lens.
    pub(crate) most_blocks_in_square: usize,
    /// Difference of the quarters of a block in which noise is measured, as a part of the darkest one, encoded. Chosen: above
    /// blotches and noise, below the edge of a shadow.
    pub(crate) most_unevenness: f64,
    /// Lowest and highest frequency in which noise is measured, as the sum of the coefficient's row and column. Chosen: lower
    /// ones hold the carpet's texture, and of higher ones a JPEG file keeps little. Doubling it changes a report, see
    /// `docs/figures/gap_thresholds.md`.
    pub(crate) noise_frequencies: [usize; 2],
    /// Largest quantisation step of a coefficient in which noise is measured, grey levels. Chosen: of noise of 3 grey levels,
    /// 5 % of the coefficients are then rounded to something else than 0.
    pub(crate) most_quantization_step: f64,
    /// Factor within which a pixel's ratios of red and blue to green are the carpet's. Chosen, when a line behind the ball
    /// was called missing in a recording with nothing hidden.
    pub(crate) same_hue_factor: f64,
    /// Factor within which a pixel's green is the carpet's. Chosen: lenses vignette, and lamps light the field unevenly.
    pub(crate) same_brightness_factor: f64,
    /// Half the side of the square of pixels whose mean is compared with the carpet, pixels. Chosen: nine pixels, the fewest
    /// around one.
    pub(crate) averaged_half_side_px: i64,
}

/// How far from other things lines and carpet are measured.
#[derive(Debug, Clone, Copy)]
pub(crate) struct VisibilityThresholds {
    /// What belongs to a block of carpet beyond its outermost pixels: standard deviations of the blur. Chosen: an edge has
    /// 2.3 % of its height there.
    pub(crate) block_margin_sigmas: f64,
    /// And pixels beside that. Chosen; no measurement.
    pub(crate) block_margin_px: f64,
    /// Distance of a block of carpet from lines and from the carpet's edge beside what the blur takes, metres. Chosen: ten
    /// times the usual error of a reference position.
    pub(crate) carpet_margin_m: f64,
    /// The same from goal posts, metres. Chosen; no measurement.
    pub(crate) post_margin_m: f64,
    /// Side of the marks on the field, metres: nothing is measured beside them. Chosen; no measurement.
    pub(crate) mark_m: f64,
    /// Depth of the net behind a goal line, metres, at least. Chosen: a field's file does not tell it.
    pub(crate) net_m: f64,
    /// Flank that a line's profile needs beyond the line's side, pixels. Chosen: a pixel more than
    /// [`ProfileThresholds::flank_px`].
    pub(crate) flank_px: f64,
    /// How far other things reach into that flank, in standard deviations of the blur. Chosen: two more than
    /// [`ProfileThresholds::flank_sigmas`], at which the edge of another thing has 2.3 % of its height.
    pub(crate) flank_sigmas: f64,
}

impl MeasurementThresholds {
    pub(super) const DEFAULT: Self = Self {
        level: [0.12, 0.97],
        line: LineThresholds {
            spacing_m: 0.03,
            spacing_px: 9.0,
            half_width_px: [0.5, 30.0],
            least_half_width_sigmas: 0.25,
            border_margin_px: 8.0,
            extra_blur_px: [0.0, 1.5, 3.0, 5.0],
            least_sharp_contrast: 25.0,
            least_blurred_contrast: 8.0,
        },
        profile: ProfileThresholds {
            white: 0.99,
            most_white_share: 0.02,
            half_length_px: 2.5,
            flank_sigmas: 2.5,
            flank_px: 4.0,
            most_shift_px: 2.0,
            least_degrees_of_freedom: 11,
            color_window_sigmas: 2.0,
            color_window_margin_px: 1.0,
            least_flank_pixels: 3.0,
            least_color_flank_px: 1.5,
            chroma_sigma_px: 0.9,
            least_color_contrast: 0.3,
            variance_px2: [0.02, 60.0],
            least_contrast: 0.02,
            inner_margin_sigmas: 2.0,
            inner_margin_px: 1.5,
            least_inner_half_width_px: 0.8,
            least_inner_pixels: 6.0,
            most_residual: 0.2,
        },
        carpet: CarpetThresholds {
            large_blocks_from_width_px: 480,
            thinned_square_m: 0.25,
            most_unevenness: 0.12,
            most_blocks_in_square: 4,
            noise_frequencies: [3, 6],
            most_quantization_step: 12.0,
            same_hue_factor: 1.3,
            same_brightness_factor: 2.0,
            averaged_half_side_px: 1,
        },
        visibility: VisibilityThresholds {
            block_margin_sigmas: 2.0,
            block_margin_px: 2.0,
            carpet_margin_m: 0.03,
            post_margin_m: 0.05,
            mark_m: 0.15,
            net_m: 0.3,
            flank_px: 5.0,
            flank_sigmas: 4.5,
        },
    };
}
