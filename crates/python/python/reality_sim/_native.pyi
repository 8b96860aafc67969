"""Native part of the package.

Metres, radians and seconds everywhere. A pose is ``(x_m, y_m, yaw_rad)``, or these and ``height_m, pitch_rad, roll_rad``; without the
last three, the database's usual ones count. Arrays of pictures have rows, columns and, for colours, red, green and blue.
"""

from collections.abc import Sequence
from os import PathLike
from typing import Literal

import numpy as np
import numpy.typing as npt

VERSION: str
SOURCES: str
#: Mark in :attr:`Frame.object_of` of a pixel that shows no object.
NO_OBJECT: int

Pose = Sequence[float] | npt.NDArray[np.float64]
SixNumbers = tuple[float, float, float, float, float, float]
Method = Literal["auto", "nearest", "quadratic", "plane", "blend"]

class Error(RuntimeError):
    """Something that Reality Sim cannot do; the message names the file or the pose, the fault and the remedy."""

class NoPicture(Error):
    """No picture at a pose, because too little was recorded near it."""

def build(
    recordings: Sequence[str | PathLike[str]],
    out: str | PathLike[str],
    *,
    poses: str | PathLike[str] | None = None,
    tag: bool = False,
    hall: bool = True,
    clean: bool = True,
    seed: int = 0,
) -> int:
    """Stores recordings in a database by pose; one that is there is extended. Returns the number of its pictures.

    Args:
      recordings: folders of sequences, and databases, whose pictures are added.
      out: file of the database.
      poses: TUM file with the poses of the only recording.
      tag: whether the particle filter finds the poses even where a recording has reference poses.
      hall: whether the walls around the field are measured, on which pictures of what stands beside the field are drawn.
      clean: whether the carpet is found without the people, robots and balls that stood on it.
      seed: of the particle filter.
    """

class TagErrors:
    """Errors of poses against the recording's reference poses: distances on the ground, angles of the heading."""

    frames: int
    mean_m: float
    median_m: float
    p95_m: float
    max_m: float
    mean_yaw_rad: float
    #: Frames that are off by more than half a metre or half a radian.
    lost_frames: int

class Tags:
    """Poses of a recording's N pictures."""

    #: N, float64.
    timestamps_s: npt.NDArray[np.float64]
    #: N x 6: x, y, yaw, height, pitch and roll.
    poses: npt.NDArray[np.float64]
    #: N x 6 x 6, of the same; NaN where a picture was not fitted.
    covariances: npt.NDArray[np.float64]
    #: N: whether the filter was sure of the pose.
    is_sure: npt.NDArray[np.bool_]
    #: N: whether no other pose but the mirror one fits as well.
    is_settled: npt.NDArray[np.bool_]
    #: Mean share of the white lines that the poses explain within 5 pixels, JaC@5.
    lines_within_5px: float
    #: The same within 10 pixels.
    lines_within_10px: float
    #: Share of the pictures with a settled pose.
    completeness: float
    #: The three in a sentence, with whether they are good.
    verdict: str
    #: Errors, where the recording has reference poses.
    error: TagErrors | None

def tag(recording: str | PathLike[str], settings: str) -> Tags: ...

class Database:
    """Pictures by pose, in one file. It can be used from several threads at once."""

    def __init__(
        self,
        path: str | PathLike[str],
        cache_bytes: int = 1 << 30,
        *,
        clean: bool = False,
        best_effort: bool = False,
        neighbours: int = 6,
        model: str | PathLike[str] | None = None,
    ) -> None:
        """Opens a database, as :func:`build` makes it.

        Args:
          path: its file.
          cache_bytes: memory for decoded pictures.
          clean: whether what stood there while recording is left out.
          best_effort: whether there is a picture however far away the nearest recorded one is.
          neighbours: number of pictures that ``blend`` mixes, 1 to 8.
          model: model.toml, by which the light of the pictures is evened out.
        """

    def render(
        self, pose: Pose, method: Method = "auto", *, out: npt.NDArray[np.uint8] | None = None
    ) -> npt.NDArray[np.uint8]:
        """Returns what the camera sees at a pose: uint8, rows x columns x 3. The interpreter is released meanwhile.

        Args:
          pose: of the camera.
          method: ``auto`` takes a recorded picture where there is one, else mixes several; ``nearest`` takes the nearest as it is;
            ``quadratic`` is the paper's Eq. 4; ``plane`` warps one picture over the ground, goals and walls; ``blend`` several.
          out: array into which the picture is drawn, and which is returned then.

        Raises:
          NoPicture: where too little was recorded near the pose.
          ValueError: for a pose that is none, or an unknown method.
        """

    @property
    def poses(self) -> npt.NDArray[np.float64]:
        """Poses of all pictures: a row of x, y, yaw, height, pitch and roll for each."""

    @property
    def usual_pose(self) -> SixNumbers:
        """Pose with the usual height, pitch and roll."""

    @property
    def lens(self) -> Lens:
        """Lens of the pictures."""

    @property
    def field_size(self) -> tuple[float, float]:
        """Length and width of the field, between the centres of its lines."""

    @property
    def cached_bytes(self) -> int:
        """Memory that decoded pictures take now."""

    @property
    def path(self) -> PathLike[str]:
        """File of the database."""

    def __len__(self) -> int: ...

class Lens:
    """Lens and size of a camera's pictures. A pixel's centre has whole coordinates; the first one's is (0, 0)."""

    @property
    def model(self) -> str:
        """COLMAP's name of the model: ``PINHOLE``, ``OPENCV`` or ``OPENCV_FISHEYE``."""

    @property
    def width(self) -> int: ...
    @property
    def height(self) -> int: ...
    @property
    def focal_lengths(self) -> tuple[float, float]:
        """fx and fy, pixels."""

    @property
    def principal_point(self) -> tuple[float, float]:
        """cx and cy, pixels."""

    @property
    def distortion(self) -> list[float]:
        """Parameters of the model, in its order."""

    @property
    def widest_angle_rad(self) -> float:
        """Largest angle from the optical axis that a corner of the picture shows."""

    def project(self, points_in_camera: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
        """Projects points (N x 3; x right, y down, z forward) to pixels (N x 2), also beside the picture; NaN where the lens sees
        nothing."""

    def unproject(self, pixels: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
        """Returns the unit directions (N x 3) that are seen at pixels (N x 2); NaN where the lens sees nothing."""

class Layer:
    """Something that is drawn over the recorded scene, through the camera's lens and effects."""

class Ball(Layer):
    def __init__(
        self,
        x_m: float,
        y_m: float,
        z_m: float | None = None,
        *,
        radius_m: float = 0.065,
        color: Sequence[int] = (255, 128, 0),
        gloss: float = 0.0,
        velocity_m_s: Sequence[float] = (0.0, 0.0, 0.0),
        name: str = "ball",
    ) -> None:
        """Makes a ball around a point of the world; without ``z_m`` it lies on the ground. The colour is sRGB, 0 to 255."""

class Humanoid(Layer):
    def __init__(
        self,
        x_m: float,
        y_m: float,
        yaw_rad: float,
        *,
        height_m: float = 0.58,
        color: Sequence[int] = (40, 90, 220),
        gait_rad: float | None = None,
        velocity_m_s: Sequence[float] = (0.0, 0.0),
        name: str = "robot",
    ) -> None:
        """Makes a robot of simple parts above a point of the ground; it stands, or walks in a phase of its gait."""

class Cube(Layer):
    def __init__(
        self,
        pose: Pose,
        faces: Sequence[
            tuple[str, int, Sequence[int], npt.NDArray[np.uint8], npt.NDArray[np.float32], npt.NDArray[np.int32]]
        ],
        objects: Sequence[tuple[str, str]],
        occluders: Sequence[Sequence[float]] = (),
    ) -> None:
        """Makes a layer of pinhole pictures on the sides of a cube around the camera, as :mod:`reality_sim.mujoco` draws them.

        Args:
          pose: six numbers, from which they were drawn.
          faces: for each side its name (forward, left, right, up, down or backward), the columns of the whole side, the first column
            and row that are given, and of these pixels the colours (sRGB), the depths along the side's axis and the numbers of the
            objects, -1 for none.
          objects: class (ball, robot, …) and name of each object.
          occluders: spheres that take light from the ground: x, y, z and radius.
        """

class SeenObject:
    """Thing in a picture. Boxes are left, top, right and bottom; right and bottom are the first pixels outside."""

    name: str
    class_name: str
    visible: tuple[int, int, int, int] | None
    whole: tuple[int, int, int, int] | None
    visible_pixels: int
    visibility: float
    truncation: float

class FrameLabels:
    """Labels of a picture, exact for pose, lens and field."""

    #: Class of every pixel, uint8: 0 outside, 1 carpet, 2 line, 3 goal, 4 ball, 5 robot.
    classes: npt.NDArray[np.uint8]
    #: Thing that every pixel shows, uint16: 0 for none, else its place in :attr:`things`, from 1.
    instances: npt.NDArray[np.uint16]
    #: Distance along every pixel's ray, float32; infinite where the lens leaves the picture black.
    distance_m: npt.NDArray[np.float32]
    #: How far every pixel can be trusted, uint8: 255 fully.
    trust: npt.NDArray[np.uint8]
    #: Kind of each white line in view, and points of its centre in pixels.
    lines: list[tuple[str, list[tuple[float, float]]]]
    #: Kind, place on the field, pixel (None outside the picture) and visibility of each crossing and mark.
    crossings: list[tuple[str, tuple[float, float], tuple[float, float] | None, bool]]
    #: Both goals, then the objects.
    things: list[SeenObject]

class Frame:
    """Picture of a :class:`Renderer` with what is known of its pixels."""

    pose: SixNumbers
    #: uint8, rows x columns x 3.
    picture: npt.NDArray[np.uint8]
    #: Share of the pixels that some recorded picture shows.
    covered: float
    #: Objects of all layers, in their order.
    objects: list[SeenObject]
    #: Object that every pixel shows, uint16, or :data:`NO_OBJECT`.
    object_of: npt.NDArray[np.uint16]
    #: Distance of the object that every pixel shows, float32; infinite where it shows none.
    object_distance_m: npt.NDArray[np.float32]
    #: Labels, if they are wanted.
    labels: FrameLabels | None

class Renderer:
    """Camera that a simulator moves over a recorded field. Where it moves smoothly, a picture costs less. Give each thread its own."""

    def __init__(
        self,
        database: Database,
        *,
        method: Method = "auto",
        size: Sequence[int] | None = None,
        labels: bool = False,
        decoding_ahead: bool = True,
    ) -> None:
        """Makes a camera.

        Args:
          database: recorded pictures.
          method: as in :meth:`Database.render`.
          size: width and height of the pictures, in the proportions of the database's; its own by default.
          labels: whether frames have labels.
          decoding_ahead: whether a thread decodes the pictures that are about to be needed.
        """

    @property
    def lens(self) -> Lens:
        """Lens of the pictures."""

    def look(self, pose: Pose, layers: Sequence[Layer] = (), *, time_s: float = 0.0) -> Frame:
        """Returns what the camera sees at a pose: the recorded scene with the layers in it. The interpreter is released meanwhile.

        Raises:
          NoPicture: where too little was recorded near the pose.
        """

    def forget_path(self) -> None:
        """Lets the next picture be made as if it were the first."""

def study_settings(settings: str) -> str:
    """Completes the settings of a study, in JSON, by the default values.

    Raises:
      ValueError: for settings that there are not.
    """

def study(recording: str | PathLike[str], settings: list[str]) -> list[tuple[str, bytes | None]]:
    """Studies a recording with each of some settings, in JSON. Returns for each what was found, or the error and whether it is the machine's, in JSON, and a JPEG file, if there is one.

    Raises:
      ValueError: for settings that there are not.
    """

def use_threads(threads: int) -> bool:
    """Sets how many threads work at once in this process. Returns false if another number was set, or used, before."""

def gap(recording: str | PathLike[str], settings: str) -> tuple[str, str, str]:
    """Compares a recording with a model of its camera, with settings in JSON. Returns report.json, model.toml and report.html.

    Raises:
      ValueError: for settings that there are not.
      Error: where the recording cannot be read, or does not suffice.
    """

def dataset(database: Database, out: str | PathLike[str], settings: str) -> tuple[int, int, int, int]:
    """Makes pictures with labels, with settings in JSON. Returns the numbers of pictures, of those made, of those there before, and of annotations.

    Raises:
      ValueError: for settings that there are not.
      Error: where the folder holds something else, or no pictures can be made.
    """
