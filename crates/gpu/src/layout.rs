//! Structures shared with the shaders, laid out as in WGSL; a test compares every offset with naga's.

use bytemuck::{Pod, Zeroable};
use reality_sim_core::{
    camera::{KernelCamera, Lens, RADIAL_TERMS},
    observation::{CameraFromGround, ContrastScale, LineBlock, SamplePoints},
    pose::CameraPose,
    warp::{Billboard, BlendWeights, MAX_SOURCES, Placement, ProxyGeometry, Source, Target},
};

/// `Camera` in `shaders/shared/camera.wgsl`.
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct CameraLayout {
    focal_px: [f32; 2],
    centre_px: [f32; 2],
    largest_px: [f32; 2],
    min_cos: f32,
    is_radial: u32,
    circle: [f32; 4],
    lens_parameters: [f32; 16],
}

/// `CameraFromGround` in `shaders/shared/pose.wgsl`.
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct PoseLayout {
    x: [f32; 4],
    y: [f32; 4],
    z: [f32; 4],
}

/// `Settings` in `shaders/shared/scoring.wgsl`.
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct SettingsLayout {
    pub blocks: u32,
    pub poses: u32,
    pub groups_along_x: u32,
    per_contrast: f32,
    dark_level: f32,
    min_width_px: f32,
    per_width_px: f32,
    relative_area: f32,
}

/// Block of line samples in the texture that `shaders/shared/blocks.wgsl` reads.
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct BlockLayout {
    largest_nearness: f32,
    min_cos: f32,
    samples: f32,
    radius: f32,
    centre: [f32; 2],
    padding: [f32; 2],
    nodes: [SamplePoints; 4],
    points: [SamplePoints; 16],
}

/// `Picture` in `shaders/shared/picture.wgsl`.
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct PictureLayout {
    pub width: u32,
    pub height: u32,
    pub row_words: u32,
    pub mask_columns: u32,
    pub blur_radius: u32,
    pub nearness_cap: u32,
    pub padding_0: u32,
    pub padding_1: u32,
}

/// `Particle` in `shaders/shared/filter.wgsl`.
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct ParticleLayout {
    x_m: f32,
    y_m: f32,
    yaw_rad: f32,
    height_m: f32,
    pitch_rad: f32,
    roll_rad: f32,
    padding_0: f32,
    padding_1: f32,
}

/// `Frame` in `shaders/shared/filter.wgsl`.
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct FrameLayout {
    pub seed: [u32; 2],
    pub number: u32,
    pub particles: u32,
    pub resampling: u32,
    pub estimator: u32,
    pub rest_shift: u32,
    pub forward_m: f32,
    pub left_m: f32,
    pub turn_rad: f32,
    pub predict_sigma_m: f32,
    pub predict_sigma_rad: f32,
    pub diffuse_sigma_m: f32,
    pub diffuse_sigma_rad: f32,
    pub height_m: f32,
    pub pitch_rad: f32,
    pub roll_rad: f32,
    pub height_sigma_m: f32,
    pub angle_sigma_rad: f32,
    pub per_value: f32,
    pub per_seen: f32,
    pub padding_0: u32,
    pub padding_1: u32,
    pub padding_2: u32,
}

/// `Iteration` in `shaders/shared/filter.wgsl`.
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct IterationLayout {
    pub number: u32,
    pub scale: f32,
    pub padding_0: u32,
    pub padding_1: u32,
}

/// `Outcome` in `shaders/shared/filter.wgsl`.
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct OutcomeLayout {
    pub best: ParticleLayout,
    pub estimate: ParticleLayout,
    pub alternatives: [ParticleLayout; 6],
    pub alternative_count: u32,
    pub best_log_weight: f32,
    pub effective_sample_size: f32,
    pub spread_m: f32,
}

/// `Placement` in `shaders/shared/proxy_geometry.wgsl`.
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct PlacementLayout {
    right: [f32; 4],
    down: [f32; 4],
    forward: [f32; 4],
    position: [f32; 4],
}

/// `Billboard` in `shaders/shared/proxy_geometry.wgsl`.
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct BillboardLayout {
    x: f32,
    half_width: f32,
    top: f32,
    opening_half_width: f32,
    opening_top: f32,
    padding_0: u32,
    padding_1: u32,
    padding_2: u32,
}

/// `ProxyGeometry` in `shaders/shared/proxy_geometry.wgsl`.
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct ProxyGeometryLayout {
    low: [f32; 4],
    high: [f32; 4],
    billboards: [BillboardLayout; 4],
}

/// `Drawing` in `shaders/blend.wgsl`.
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct DrawingLayout {
    eye: PlacementLayout,
    proxy: ProxyGeometryLayout,
    width: u32,
    height: u32,
    sources: u32,
    angle_on_ground: f32,
    angle_above: f32,
    resolution: f32,
    border_px: f32,
    softness: f32,
    disagreement: f32,
    padding_0: u32,
    padding_1: u32,
    padding_2: u32,
}

/// `Source` in `shaders/blend.wgsl`.
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct SourceLayout {
    camera: CameraLayout,
    placement: PlacementLayout,
    gain: [f32; 4],
    size: [u32; 2],
    layer: u32,
    padding: u32,
}

/// `Levels` in `shaders/shared/levels.wgsl`.
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct LevelsLayout {
    pub fine: [u32; 2],
    pub coarse: [u32; 2],
    pub first_fine: u32,
    pub first_coarse: u32,
    padding_0: u32,
    padding_1: u32,
}

/// All sources of one picture.
pub(crate) type SourcesLayout = [SourceLayout; MAX_SOURCES];

impl From<CameraPose> for ParticleLayout {
    fn from(pose: CameraPose) -> Self {
        Self {
            x_m: pose.x_m as f32,
            y_m: pose.y_m as f32,
            yaw_rad: pose.yaw_rad as f32,
            height_m: pose.height_m as f32,
            pitch_rad: pose.pitch_rad as f32,
            roll_rad: pose.roll_rad as f32,
            padding_0: 0.0,
            padding_1: 0.0,
        }
    }
}

impl From<ParticleLayout> for CameraPose {
    fn from(particle: ParticleLayout) -> Self {
        Self {
            x_m: particle.x_m.into(),
            y_m: particle.y_m.into(),
            yaw_rad: particle.yaw_rad.into(),
            height_m: particle.height_m.into(),
            pitch_rad: particle.pitch_rad.into(),
            roll_rad: particle.roll_rad.into(),
        }
    }
}

impl From<&KernelCamera> for CameraLayout {
    fn from(camera: &KernelCamera) -> Self {
        let mut lens_parameters = [0.0; 16];
        match camera.lens {
            Lens::Radial { coefficients, scale, offset } => {
                lens_parameters[..RADIAL_TERMS].copy_from_slice(&coefficients);
                lens_parameters[RADIAL_TERMS..RADIAL_TERMS + 2].copy_from_slice(&[scale, offset]);
            }
            Lens::Perspective { distortion } => {
                lens_parameters[..distortion.len()].copy_from_slice(&distortion);
            }
        }
        let [u, v, radius_squared] = camera.circle.unwrap_or([0.0, 0.0, -1.0]);
        Self {
            focal_px: [camera.fx, camera.fy],
            centre_px: [camera.cx, camera.cy],
            largest_px: [camera.max_u, camera.max_v],
            min_cos: camera.min_cos,
            is_radial: u32::from(matches!(camera.lens, Lens::Radial { .. })),
            circle: [u, v, radius_squared, 0.0],
            lens_parameters,
        }
    }
}

impl From<CameraFromGround> for PoseLayout {
    fn from(pose: CameraFromGround) -> Self {
        let row =
            |axis: usize, last: f32| [pose.linear[axis][0], pose.linear[axis][1], pose.offset[axis], last];
        Self { x: row(0, pose.height_m), y: row(1, 0.0), z: row(2, 0.0) }
    }
}

impl SettingsLayout {
    pub fn new(blocks: u32, scale: ContrastScale) -> Self {
        Self {
            blocks,
            poses: 0,
            groups_along_x: 1,
            per_contrast: scale.per_contrast,
            dark_level: scale.dark_level,
            min_width_px: scale.min_width_px,
            per_width_px: scale.per_width_px,
            relative_area: scale.relative_area,
        }
    }
}

impl From<&LineBlock> for BlockLayout {
    fn from(block: &LineBlock) -> Self {
        let LineBlock { samples, nodes, limits, centre, radius_m } = block;
        Self {
            largest_nearness: limits.largest_nearness,
            min_cos: limits.min_cos,
            samples: samples.len() as f32,
            radius: *radius_m,
            centre: *centre,
            padding: [0.0; 2],
            nodes: *nodes,
            points: std::array::from_fn(|lane| samples.get(lane).copied().unwrap_or_default()),
        }
    }
}

/// Appends an unused fourth number.
fn padded([x, y, z]: [f32; 3]) -> [f32; 4] {
    [x, y, z, 0.0]
}

impl From<&Placement> for PlacementLayout {
    fn from(placement: &Placement) -> Self {
        let [right, down, forward] = placement.axes_in_world.map(padded);
        Self { right, down, forward, position: padded(placement.position_in_world) }
    }
}

impl From<Billboard> for BillboardLayout {
    fn from(billboard: Billboard) -> Self {
        Self {
            x: billboard.x_m as f32,
            half_width: billboard.half_width_m as f32,
            top: billboard.height_m as f32,
            opening_half_width: billboard.opening_half_width_m as f32,
            opening_top: billboard.opening_height_m as f32,
            padding_0: 0,
            padding_1: 0,
            padding_2: 0,
        }
    }
}

impl From<&ProxyGeometry> for ProxyGeometryLayout {
    fn from(proxy: &ProxyGeometry) -> Self {
        Self {
            low: padded(proxy.min_in_world.as_vec3().to_array()),
            high: padded(proxy.max_in_world.as_vec3().to_array()),
            billboards: proxy.billboards.map(BillboardLayout::from),
        }
    }
}

impl DrawingLayout {
    pub fn new(target: &Target, sources: usize, weights: &BlendWeights) -> Self {
        Self {
            eye: PlacementLayout::from(&target.placement),
            proxy: ProxyGeometryLayout::from(target.proxy),
            width: target.rays.width,
            height: target.rays.height,
            sources: sources as u32,
            angle_on_ground: weights.angle_on_ground,
            angle_above: weights.angle_above,
            resolution: weights.resolution,
            border_px: weights.border_px,
            softness: weights.softness,
            disagreement: weights.disagreement,
            padding_0: 0,
            padding_1: 0,
            padding_2: 0,
        }
    }
}

impl SourceLayout {
    /// Describes a source whose picture is in this layer of the texture.
    pub fn new(source: &Source, layer: u32) -> Self {
        Self {
            camera: CameraLayout::from(source.camera),
            placement: PlacementLayout::from(&source.placement),
            gain: padded(source.gain),
            size: [source.picture.width, source.picture.height],
            layer,
            padding: 0,
        }
    }
}

impl LevelsLayout {
    /// Describes a picture of this size and the first level.
    pub fn first(size: [u32; 2]) -> Self {
        let coarse = size.map(|pixels| pixels.div_ceil(2));
        Self { fine: size, coarse, first_fine: 0, first_coarse: 0, padding_0: 0, padding_1: 0 }
    }

    /// Describes the coarser level and the one after it.
    pub fn next(self) -> Self {
        let [width, height] = self.coarse;
        Self {
            first_fine: self.first_coarse,
            first_coarse: self.first_coarse + width * height,
            ..Self::first(self.coarse)
        }
    }
}

#[cfg(test)]
mod tests {
    use std::mem::{offset_of, size_of};

    use naga::TypeInner;

    use super::*;
    use crate::shader::source;

    /// Returns the names and offsets of a struct's members, and its size, as a shader declares them.
    fn in_shader(shader: &str, name: &str) -> (Vec<(String, u32)>, u32) {
        let module = naga::front::wgsl::parse_str(&source(shader).unwrap()).unwrap();
        let (_, found) = module.types.iter().find(|(_, kind)| kind.name.as_deref() == Some(name)).unwrap();
        let TypeInner::Struct { members, span } = &found.inner else { panic!("{name} is no struct") };
        (members.iter().map(|member| (member.name.clone().unwrap(), member.offset)).collect(), *span)
    }

    macro_rules! assert_same_layout {
        ($rust:ident in $shader:literal as $name:literal: $($member:ident)+) => {
            // The pattern has no `..`, so it does not compile when a member is missing from the list.
            let _ = |$rust { $($member: _),+ }: $rust| ();
            let expected = vec![$((stringify!($member).to_owned(), offset_of!($rust, $member) as u32)),+];
            assert_eq!(in_shader($shader, $name), (expected, size_of::<$rust>() as u32), $name);
        };
    }

    #[test]
    fn every_shared_struct_has_one_layout() {
        assert_same_layout!(CameraLayout in "contrast_along_lines.wgsl" as "Camera":
            focal_px centre_px largest_px min_cos is_radial circle lens_parameters);
        assert_same_layout!(PoseLayout in "contrast_along_lines.wgsl" as "CameraFromGround": x y z);
        assert_same_layout!(SettingsLayout in "contrast_along_lines.wgsl" as "Settings":
            blocks poses groups_along_x per_contrast dark_level min_width_px per_width_px relative_area);
        assert_same_layout!(PictureLayout in "pack.wgsl" as "Picture":
            width height row_words mask_columns blur_radius nearness_cap padding_0 padding_1);
        assert_same_layout!(ParticleLayout in "diffuse.wgsl" as "Particle":
            x_m y_m yaw_rad height_m pitch_rad roll_rad padding_0 padding_1);
        assert_same_layout!(FrameLayout in "diffuse.wgsl" as "Frame":
            seed number particles resampling estimator rest_shift forward_m left_m turn_rad predict_sigma_m
            predict_sigma_rad diffuse_sigma_m diffuse_sigma_rad height_m pitch_rad roll_rad height_sigma_m
            angle_sigma_rad per_value per_seen padding_0 padding_1 padding_2);
        assert_same_layout!(IterationLayout in "diffuse.wgsl" as "Iteration": number scale padding_0 padding_1);
        assert_same_layout!(OutcomeLayout in "summarise.wgsl" as "Outcome":
            best estimate alternatives alternative_count best_log_weight effective_sample_size spread_m);
        assert_same_layout!(CameraLayout in "blend.wgsl" as "Camera":
            focal_px centre_px largest_px min_cos is_radial circle lens_parameters);
        assert_same_layout!(PlacementLayout in "blend.wgsl" as "Placement": right down forward position);
        assert_same_layout!(BillboardLayout in "blend.wgsl" as "Billboard":
            x half_width top opening_half_width opening_top padding_0 padding_1 padding_2);
        assert_same_layout!(ProxyGeometryLayout in "blend.wgsl" as "ProxyGeometry": low high billboards);
        assert_same_layout!(DrawingLayout in "blend.wgsl" as "Drawing":
            eye proxy width height sources angle_on_ground angle_above resolution border_px softness disagreement
            padding_0 padding_1 padding_2);
        assert_same_layout!(SourceLayout in "blend.wgsl" as "Source":
            camera placement gain size layer padding);
        assert_same_layout!(LevelsLayout in "halved.wgsl" as "Levels":
            fine coarse first_fine first_coarse padding_0 padding_1);
    }
}
