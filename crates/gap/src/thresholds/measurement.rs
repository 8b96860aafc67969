//! Which pieces of line and blocks of carpet are measured, and which measurements are kept.

/// Which pieces of line and blocks of carpet are measured, and which measurements are kept.
#[derive(Debug, Clone, Copy)]
pub(crate) struct MeasurementThresholds {
    pub(crate) line: LineThresholds,
    pub(crate) profile: ProfileThresholds,
    pub(crate) carpet: CarpetThresholds,
    pub(crate) visibility: VisibilityThresholds,
}

/// Which pieces of line are predicted, and with how much contrast they are found.
#[derive(Debug, Clone, Copy)]
pub(crate) struct LineThresholds {
    /// Distance between samples along a line on the ground, metres. Chosen.
    pub(crate) spacing_m: f64,
    /// Distance between samples in the picture, pixels. Chosen.
    pub(crate) spacing_px: f64,
    /// Smallest and largest half width of a line that is measured, pixels: thinner lines are too faint, wider ones too near.
    /// Chosen.
    pub(crate) half_width_px: [f64; 2],
    /// Smallest half width, in standard deviations of the blur: a thinner line keeps less contrast than the carpet has of
    /// its own. Chosen.
    pub(crate) least_half_width_sigmas: f64,
    /// Margin between a piece of line and the picture's border, beyond the line's sides and the search, pixels. Chosen.
    pub(crate) border_margin_px: f64,
    /// Blurs with which lines are searched, one after the other until they are found: standard deviation beside the
    /// predicted one, pixels. Chosen.
    pub(crate) extra_blur_px: [f64; 4],
    /// Smallest contrast of a line to the carpet where nothing blurs it, grey levels. Chosen.
    pub(crate) least_sharp_contrast: f64,
    /// Smallest contrast of a blurred line, grey levels: the carpet's texture has as much. Chosen.
    pub(crate) least_blurred_contrast: f64,
}

/// Which pixels a line's profile is fitted to, and which fits are kept.
#[derive(Debug, Clone, Copy)]
pub(crate) struct ProfileThresholds {
    /// Half the length of the piece of line, pixels. Chosen.
    pub(crate) half_length_px: f64,
    /// Where the blurred side of the line ends, in standard deviations of the predicted blur. Chosen: 99 % of an edge's rise is
    /// within it.
    pub(crate) flank_sigmas: f64,
    /// Flank that is taken beyond the blurred side of the line, pixels. Chosen.
    pub(crate) flank_px: f64,
    /// Largest distance of the fitted middle from the searched one, beyond half the line's width, pixels. Chosen.
    pub(crate) most_shift_px: f64,
    /// Fewest degrees of freedom of a fit: pixels less the five parameters. Chosen.
    pub(crate) least_degrees_of_freedom: usize,
    /// Half the window of the centroids beyond the line's side: standard deviations of the blur, that of the stored chroma
    /// included. Chosen: 98 % of an edge's rise is within it.
    pub(crate) color_window_sigmas: f64,
    /// And pixels beside that. Chosen.
    pub(crate) color_window_margin_px: f64,
    /// Fewest pixels of either flank. Chosen.
    pub(crate) least_flank_pixels: f64,
    /// Smallest flank that is left for the colour channels, pixels. Chosen.
    pub(crate) least_color_flank_px: f64,
    /// Standard deviation of the blur where chroma is stored at half the resolution, averaged in pairs and interpolated,
    /// pixels. Follows from that subsampling; not measured.
    pub(crate) chroma_sigma_px: f64,
    /// Smallest contrast that a colour channel needs for an offset of its own, as a part of luma's contrast. Chosen.
    pub(crate) least_color_contrast: f64,
    /// Smallest and largest variance of a line's blur that is believed, pixels squared; the smallest is a part of the
    /// pixel's own aperture of 1/12. Chosen.
    pub(crate) variance_px2: [f64; 2],
    /// Smallest contrast of a fitted line to its flanks, encoded values (0–1). Chosen.
    pub(crate) least_contrast: f64,
    /// Distance of the line's inner part, whose colour is measured, from the line's side: standard deviations of the blur.
    /// Chosen: at two, an edge has risen to 98 %.
    pub(crate) inner_margin_sigmas: f64,
    /// And pixels beside that. Chosen.
    pub(crate) inner_margin_px: f64,
    /// Smallest half width of that inner part, pixels. Chosen.
    pub(crate) least_inner_half_width_px: f64,
    /// Fewest pixels of that inner part. Chosen.
    pub(crate) least_inner_pixels: f64,
    /// Largest residual of a fit, root mean square, as a part of the line's contrast. Chosen.
    pub(crate) most_residual: f64,
}

/// Which pixels show carpet, and in which coefficients its noise is measured.
#[derive(Debug, Clone, Copy)]
pub(crate) struct CarpetThresholds {
    /// Width of pictures from which on blocks of carpet have 16 × 16 pixels, and not 8 × 8, pixels. Chosen.
    pub(crate) large_blocks_from_width_px: u32,
    /// Lowest and highest frequency in which noise is measured, as the sum of the coefficient's row and column: lower ones
    /// hold the carpet's texture, and of higher ones a JPEG file keeps little. Chosen.
    pub(crate) noise_frequencies: [usize; 2],
    /// Largest quantisation step of a coefficient in which noise is measured, grey levels. Chosen.
    pub(crate) most_quantization_step: f64,
    /// Factor within which a pixel's ratios of red and blue to green are the carpet's. Chosen.
    pub(crate) same_hue_factor: f64,
    /// Factor within which a pixel's green is the carpet's: lenses vignette, and lamps light the field unevenly. Chosen.
    pub(crate) same_brightness_factor: f64,
    /// Half the side of the square of pixels whose mean is compared with the carpet, pixels. Chosen.
    pub(crate) averaged_half_side_px: i64,
}

/// How far from other things lines and carpet are measured.
#[derive(Debug, Clone, Copy)]
pub(crate) struct VisibilityThresholds {
    /// What belongs to a block of carpet beyond its outermost pixels: standard deviations of the blur. Chosen: a line blurred
    /// by as much has 2 % of its contrast there.
    pub(crate) block_margin_sigmas: f64,
    /// And pixels beside that. Chosen.
    pub(crate) block_margin_px: f64,
    /// Distance of a block of carpet from lines and from the carpet's edge beside what the blur takes, metres. Chosen.
    pub(crate) carpet_margin_m: f64,
    /// The same from goal posts, metres. Chosen.
    pub(crate) post_margin_m: f64,
    /// Side of the marks on the field, metres: nothing is measured beside them. Chosen.
    pub(crate) mark_m: f64,
    /// Depth of the net behind a goal line, metres, at least. Chosen.
    pub(crate) net_m: f64,
    /// Flank that a line's profile needs beyond the line's side, pixels. Chosen.
    pub(crate) flank_px: f64,
    /// How far into that flank other things reach, in standard deviations of the blur. Chosen.
    pub(crate) flank_sigmas: f64,
}

impl MeasurementThresholds {
    pub(super) const DEFAULT: Self = Self {
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
