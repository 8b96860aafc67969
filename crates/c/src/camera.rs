//! The camera.

use std::{
    ffi::{CStr, c_char},
    path::Path,
    ptr, slice,
    sync::Arc,
};

use reality_sim::{
    Archive, CameraPose, SynthesisError, Synthesizer,
    glam::DVec3,
    simulator::{self, Frame, Layer},
    synthesis::{MethodKind, SynthesisConfig},
    warp::CpuWarper,
};

use crate::{
    pose::Pose,
    scene::Scene,
    seen::SeenObject,
    status::{Failure, Status, outcome},
};

/// Camera that a simulator moves over a recorded field.
#[derive(Debug)]
pub struct Camera {
    camera: simulator::Camera,
    has_labels: bool,
    frame: Frame,
}

/// How pictures are made.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(C)]
pub struct Options {
    /// Memory for decoded pictures, bytes.
    pub cache_bytes: usize,
    /// Number of recorded pictures that are mixed, 1 to 8.
    pub neighbours: usize,
    /// Whether the camera gives labels.
    pub labels: bool,
    /// Whether people, robots and balls that stood there while recording are left out.
    pub clean: bool,
    /// Whether there is a picture however far away the nearest recorded one is.
    pub best_effort: bool,
}

/// Memory for what a camera sees, a value for every pixel. What is NULL is left out.
#[derive(Debug, Clone, Copy)]
#[repr(C)]
pub struct Buffers {
    /// Picture: three bytes a pixel, red, green and blue, sRGB.
    pub rgb: *mut u8,
    /// Classes, see RsClass. This and what follows needs a camera with labels.
    pub classes: *mut u8,
    /// Thing that a pixel shows: 0 for none, 1 and 2 for the goals at -x and +x, then the balls and the robots in their order, from 3.
    pub instances: *mut u16,
    /// Distance along the pixel's ray, metres; infinite where the lens leaves the pixel black.
    pub distance_m: *mut f32,
    /// How far a pixel can be trusted, 0 to 255.
    pub trust: *mut u8,
}

/// Returns the options that are usual: 1 GiB for pictures, six neighbours, labels.
#[unsafe(no_mangle)]
pub extern "C" fn rs_options() -> Options {
    Options { cache_bytes: 1 << 30, neighbours: 6, labels: true, clean: false, best_effort: false }
}

/// Opens a database, a file that `reality-sim build` makes, and makes a camera like the one that recorded it. It has to be closed by
/// rs_camera_close(). Without options (NULL) it has the usual ones.
///
/// # Safety
///
/// `path` is a text that ends with a zero, `options` NULL or valid, and `camera` can be written to.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rs_camera_open(
    path: *const c_char,
    options: *const Options,
    camera: *mut *mut Camera,
) -> Status {
    outcome(|| {
        if path.is_null() || camera.is_null() {
            return Err(Failure::argument("path or camera is NULL"));
        }
        // SAFETY: the caller says so, and it is not NULL.
        let path = unsafe { CStr::from_ptr(path) };
        let path = path.to_str().map_err(|_| Failure::argument("path: is not UTF-8"))?;
        // SAFETY: the caller says so.
        let options = unsafe { options.as_ref() }.copied().unwrap_or_else(|| rs_options());
        let opened = Box::into_raw(Box::new(Camera::open(Path::new(path), options)?));
        // SAFETY: the caller says so, and it is not NULL.
        unsafe { *camera = opened };
        Ok(())
    })
}

/// Closes a camera. NULL is no camera, and ignored.
///
/// # Safety
///
/// `camera` is NULL or of rs_camera_open(), and is not used afterwards.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rs_camera_close(camera: *mut Camera) {
    if !camera.is_null() {
        // SAFETY: the caller says so.
        drop(unsafe { Box::from_raw(camera) });
    }
}

/// Tells the number of columns and rows of a camera's pictures.
///
/// # Safety
///
/// `camera` is of rs_camera_open(), and the others can be written to.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rs_camera_size(camera: *const Camera, width: *mut u32, height: *mut u32) -> Status {
    outcome(|| {
        // SAFETY: the caller says so.
        let camera = unsafe { referenced(camera)? };
        let lens = camera.camera.synthesizer().camera();
        // SAFETY: the caller says so.
        unsafe {
            store("width", width, lens.width)?;
            store("height", height, lens.height)
        }
    })
}

/// Tells the pose over the field's centre with the height, pitch and roll that most recorded pictures have.
///
/// # Safety
///
/// `camera` is of rs_camera_open(), and `pose` can be written to.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rs_camera_usual_pose(camera: *const Camera, pose: *mut Pose) -> Status {
    outcome(|| {
        // SAFETY: the caller says so.
        let camera = unsafe { referenced(camera)? };
        // SAFETY: the caller says so.
        unsafe { store("pose", pose, camera.camera.synthesizer().archive().usual_pose().into()) }
    })
}

/// Draws what the camera sees: the recorded scene with balls and robots in it, through the true lens, and with the light and the shadows of
/// the hall. Without a scene (NULL) nothing is added. `time_s` decides the noise of what is added.
///
/// # Safety
///
/// `camera` is of rs_camera_open() and used by no other thread, `scene` is NULL or holds what it says, and what is not NULL in `buffers` has
/// room for a value, or three, for every pixel.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rs_camera_look(
    camera: *mut Camera,
    pose: Pose,
    scene: *const Scene,
    time_s: f64,
    buffers: Buffers,
) -> Status {
    outcome(|| {
        // SAFETY: the caller says so.
        let camera = unsafe { camera.as_mut() }.ok_or_else(|| Failure::argument("camera is NULL"))?;
        // SAFETY: the caller says so.
        let layers = match unsafe { scene.as_ref() } {
            // SAFETY: the caller says so.
            Some(scene) => unsafe { scene.layers()? },
            None => Vec::new(),
        };
        if !time_s.is_finite() {
            return Err(Failure::argument("time_s: is not finite"));
        }
        if buffers.wants_labels() && !camera.has_labels {
            return Err(Failure::argument(
                "buffers: asks for labels, which the camera was opened without: set labels in the options",
            ));
        }
        camera.look(pose.try_into()?, &layers, time_s)?;
        // SAFETY: the caller says so.
        unsafe { buffers.fill(&camera.frame) };
        Ok(())
    })
}

/// Tells how the last picture shows the balls and the robots, in this order. Writes as many as there is room for, and their whole number into
/// `count`.
///
/// # Safety
///
/// `camera` is of rs_camera_open(), there is room for `capacity` objects at `objects`, and `count` can be written to.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rs_camera_seen(
    camera: *const Camera,
    objects: *mut SeenObject,
    capacity: usize,
    count: *mut usize,
) -> Status {
    outcome(|| {
        // SAFETY: the caller says so.
        let camera = unsafe { referenced(camera)? };
        let seen = &camera.frame.objects;
        if objects.is_null() && capacity > 0 {
            return Err(Failure::argument("objects is NULL, but has a capacity"));
        }
        for (place, object) in seen.iter().take(capacity).enumerate() {
            // SAFETY: the caller says so, and `place` is below the capacity.
            unsafe { objects.add(place).write(object.into()) };
        }
        // SAFETY: the caller says so.
        unsafe { store("count", count, seen.len()) }
    })
}

/// Tells at which pixel a camera at a pose sees a point in the world: column and row, whole numbers at the centres of pixels. It may be outside
/// the picture, or behind something. Fails where the lens sees no such direction.
///
/// # Safety
///
/// `camera` is of rs_camera_open(), three numbers are at `point_m`, and two can be written to `pixel`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn rs_camera_project(
    camera: *const Camera,
    pose: Pose,
    point_m: *const f64,
    pixel: *mut f64,
) -> Status {
    outcome(|| {
        // SAFETY: the caller says so.
        let camera = unsafe { referenced(camera)? };
        if point_m.is_null() || pixel.is_null() {
            return Err(Failure::argument("point_m or pixel is NULL"));
        }
        // SAFETY: the caller says so, and it is not NULL.
        let point = DVec3::from_slice(unsafe { slice::from_raw_parts(point_m, 3) });
        let pose = CameraPose::try_from(pose)?;
        let lens = camera.camera.synthesizer().camera();
        let seen = lens
            .project(pose.camera_from_world(point))
            .map_err(|error| Failure { status: Status::NoPicture, message: format!("point_m: {error}") })?;
        // SAFETY: the caller says so, and it is not NULL.
        unsafe { ptr::copy_nonoverlapping(seen.to_array().as_ptr(), pixel, 2) };
        Ok(())
    })
}

impl Camera {
    fn open(path: &Path, options: Options) -> Result<Self, Failure> {
        let limit = reality_sim::warp::MAX_SOURCES;
        if !(1..=limit).contains(&options.neighbours) {
            return Err(Failure::argument(format!(
                "neighbours: is {}: give 1 to {limit}",
                options.neighbours
            )));
        }
        let archive = Arc::new(Archive::open(path, options.cache_bytes)?);
        if options.clean && !archive.has_clean_stage() {
            return Err(SynthesisError::NoCleanStage { database: path.display().to_string() }.into());
        }
        let mut config = SynthesisConfig::new(&archive).with_sources(options.neighbours);
        if options.best_effort {
            config = config.best_effort();
        }
        let lens = archive.setup().camera.clone();
        let synthesizer =
            Synthesizer::with(archive, lens, Arc::new(CpuWarper), config).with_clean(options.clean);
        let camera =
            simulator::Camera::with(synthesizer.into(), MethodKind::Auto).with_labels(options.labels);
        Ok(Self { camera, has_labels: options.labels, frame: Frame::default() })
    }

    fn look(&mut self, pose: CameraPose, layers: &[Box<dyn Layer>], time_s: f64) -> Result<(), Failure> {
        let layers: Vec<&dyn Layer> = layers.iter().map(AsRef::as_ref).collect();
        self.camera.set_time_s(time_s);
        Ok(self.camera.look(pose, &layers, &mut self.frame)?)
    }
}

impl Buffers {
    fn wants_labels(&self) -> bool {
        let bytes = [self.classes, self.trust];
        bytes.iter().any(|pointer| !pointer.is_null())
            || !self.instances.is_null()
            || !self.distance_m.is_null()
    }

    /// Copies a frame.
    ///
    /// # Safety
    ///
    /// What is not NULL has room for the frame.
    unsafe fn fill(&self, frame: &Frame) {
        let labels = &frame.labels;
        // SAFETY: the caller says so.
        unsafe {
            copy(frame.picture.as_raw(), self.rgb);
            copy(&labels.instances, self.instances);
            copy(&labels.distance_m, self.distance_m);
            copy(&labels.trust, self.trust);
            // A class is a byte with the class's number.
            copy(&labels.classes, self.classes.cast::<simulator::Class>());
        }
    }
}

/// Copies values to where they are wanted, if they are.
///
/// # Safety
///
/// There is room for them where the pointer is not NULL.
unsafe fn copy<T: Copy>(values: &[T], to: *mut T) {
    if !to.is_null() {
        // SAFETY: the caller says so, and memory of the caller's is not the library's.
        unsafe { ptr::copy_nonoverlapping(values.as_ptr(), to, values.len()) };
    }
}

/// # Safety
///
/// The pointer is NULL or valid.
unsafe fn referenced<'a>(camera: *const Camera) -> Result<&'a Camera, Failure> {
    // SAFETY: the caller says so.
    unsafe { camera.as_ref() }.ok_or_else(|| Failure::argument("camera is NULL"))
}

/// # Safety
///
/// The pointer is NULL or can be written to.
unsafe fn store<T>(name: &str, to: *mut T, value: T) -> Result<(), Failure> {
    if to.is_null() {
        return Err(Failure::argument(format!("{name} is NULL")));
    }
    // SAFETY: the caller says so, and it is not NULL.
    unsafe { to.write(value) };
    Ok(())
}
