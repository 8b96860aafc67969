"""MuJoCo's bodies in recorded pictures.

:class:`Renderer` has the shape of ``mujoco.Renderer``, but its scene is a recorded one: what a camera saw on the real field. The model's
bodies that can move are drawn by MuJoCo as pinhole pictures on the sides of a cube around the camera, brought through the real
camera's lens and composed with the recorded scene by depth:

>>> renderer = reality_sim.mujoco.Renderer(model, database, height=480, width=640)
>>> renderer.update_scene(data, "head_camera")
>>> picture = renderer.render()

MuJoCo's world is the field's: origin at its centre, x towards the opponent's goal, z up. The lens is that of the database, whatever
the field of view of MuJoCo's camera. What the model welds to the world (carpet, lines, goals, walls) is not drawn: the recorded
pictures show it.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence

import mujoco
import numpy as np

from . import NO_OBJECT, Cube, Database, Frame, Renderer as _Camera

__all__ = ["Renderer", "classes_by_name"]

#: Right, down and forward axes of each side of the cube, in the camera's axes: x right, y down, z forward.
_SIDES = {
    "forward": ((1, 0, 0), (0, 1, 0), (0, 0, 1)),
    "left": ((0, 0, 1), (0, 1, 0), (-1, 0, 0)),
    "right": ((0, 0, -1), (0, 1, 0), (1, 0, 0)),
    "up": ((1, 0, 0), (0, 0, 1), (0, -1, 0)),
    "down": ((1, 0, 0), (0, 0, -1), (0, 1, 0)),
    "backward": ((-1, 0, 0), (0, 1, 0), (0, 0, -1)),
}

#: Near and far planes of the cube's pictures, metres.
_NEAR_M, _FAR_M = 0.02, 60.0

#: Group into which geoms are put that are not drawn, while the scene is made.
_HIDDEN_GROUP = mujoco.mjNGROUP - 1

#: Pixels around a body's bounding sphere: edges lie inside its window.
_MARGIN_PX = 2


def classes_by_name(name: str) -> str:
    """Returns ``"ball"`` for bodies with this word in their name, else ``"robot"``."""
    return "ball" if "ball" in name.lower() else "robot"


class Renderer:
    """Draws recorded pictures with a model's bodies in them; used as ``mujoco.Renderer``.

    It belongs to the thread that made it, as its graphics context does.
    """

    def __init__(
        self,
        model: mujoco.MjModel,
        database: Database,
        height: int = 480,
        width: int = 640,
        max_geom: int = 10000,
        *,
        method: str = "auto",
        labels: bool = False,
        face_size: int | None = None,
        hidden: Sequence[str] = (),
        classes: Callable[[str], str] = classes_by_name,
    ) -> None:
        """Makes a renderer.

        Args:
          model: the model whose bodies are drawn.
          database: recorded pictures, and the lens of their camera.
          height, width: size of the pictures, in the proportions of the database's camera.
          max_geom: largest number of geoms in a scene.
          method: how the recorded scene is made, as in :meth:`reality_sim.Database.render`.
          labels: whether :attr:`frame` has labels of every pixel.
          face_size: columns and rows of the whole side of the cube; by default as fine as the picture's centre.
          hidden: names of bodies that are not drawn, with everything attached to them: the robot that carries the camera, say.
          classes: returns the class of a body of the world, "ball" or "robot", from its name.
        """
        self._gl_context = self._mjr_context = None
        self._model, self._height, self._width = model, height, width
        self._camera = _Camera(database, method=method, labels=labels, size=(width, height))
        # Distances and segmentation need no good picture.
        self._labelling = _Camera(database, method="nearest", labels=True, size=(width, height))
        lens = self._camera.lens
        self._widest_rad = lens.widest_angle_rad
        self._face_size = face_size or round(2 * max(lens.focal_lengths))
        self._roots, names = _roots(model)
        self._objects = [(classes(name), name) for name in names]
        self._geom_objects = [("robot", _name(model, mujoco.mjtObj.mjOBJ_GEOM, geom)) for geom in range(model.ngeom)]
        unknown = [name for name in hidden if mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_BODY, name) < 0]
        if unknown:
            raise ValueError(f'hidden: the model has no body "{unknown[0]}"')
        self._is_hidden = _is_under(model, [model.body(name).id for name in hidden]) | (model.body_weldid == 0)
        self._scene = mujoco.MjvScene(model, maxgeom=max_geom)
        self._scene_option = mujoco.MjvOption()
        # Marks of the model's author: they are no bodies.
        self._scene_option.sitegroup[:] = 0
        self._make_context()
        self._pose: tuple[float, ...] | None = None
        self._occluders: list[list[float]] = []
        self._depth_rendering = self._segmentation_rendering = False
        self.frame: Frame | None = None

    def _make_context(self) -> None:
        model, size = self._model, self._face_size
        self._gl_context = mujoco.GLContext(size, size)
        self._gl_context.make_current()
        buffer, quality = model.vis.global_, model.vis.quality
        before = buffer.offwidth, buffer.offheight, quality.offsamples
        # Every pixel belongs to one body: edges are smoothed when the pixels go through the lens.
        buffer.offwidth, buffer.offheight, quality.offsamples = max(before[0], size), max(before[1], size), 0
        try:
            self._mjr_context = mujoco.MjrContext(model, mujoco.mjtFontScale.mjFONTSCALE_150)
        finally:
            buffer.offwidth, buffer.offheight, quality.offsamples = before
        mujoco.mjr_setBuffer(mujoco.mjtFramebuffer.mjFB_OFFSCREEN, self._mjr_context)
        self._mjr_context.readDepthMap = mujoco.mjtDepthMap.mjDEPTH_ZEROFAR
        flags = self._scene.flags
        for flag in ("mjRND_SKYBOX", "mjRND_SHADOW", "mjRND_REFLECTION", "mjRND_FOG", "mjRND_HAZE"):
            flags[getattr(mujoco.mjtRndFlag, flag)] = 0

    @property
    def model(self) -> mujoco.MjModel:
        """The model."""
        return self._model

    @property
    def scene(self) -> mujoco.MjvScene:
        """MuJoCo's scene: geoms and flags."""
        return self._scene

    @property
    def height(self) -> int:
        """Number of rows."""
        return self._height

    @property
    def width(self) -> int:
        """Number of columns."""
        return self._width

    @property
    def pose(self) -> tuple[float, ...] | None:
        """Pose of the camera in the scene: x, y, yaw, height, pitch and roll."""
        return self._pose

    def enable_depth_rendering(self) -> None:
        """Lets :meth:`render` return distances."""
        self._depth_rendering, self._segmentation_rendering = True, False

    def disable_depth_rendering(self) -> None:
        """Lets :meth:`render` return colours again."""
        self._depth_rendering = False

    def enable_segmentation_rendering(self) -> None:
        """Lets :meth:`render` return what each pixel shows."""
        self._depth_rendering, self._segmentation_rendering = False, True

    def disable_segmentation_rendering(self) -> None:
        """Lets :meth:`render` return colours again."""
        self._segmentation_rendering = False

    def update_scene(
        self,
        data: mujoco.MjData,
        camera: int | str | mujoco.MjvCamera = -1,
        scene_option: mujoco.MjvOption | None = None,
    ) -> None:
        """Takes bodies and camera from the simulation, as ``mujoco.Renderer.update_scene`` does."""
        model = self._model
        option = scene_option or self._scene_option
        groups, shown = model.geom_group.copy(), option.geomgroup[_HIDDEN_GROUP]
        is_hidden = self._is_hidden[model.geom_bodyid]
        # Geoms of the hidden group that are drawn move to another one that is.
        try:
            if not shown:
                is_hidden = is_hidden | (groups == _HIDDEN_GROUP)
            visible = np.asarray(option.geomgroup[: _HIDDEN_GROUP])
            model.geom_group[(groups == _HIDDEN_GROUP) & ~is_hidden] = int(np.argmax(visible))
            model.geom_group[is_hidden] = _HIDDEN_GROUP
            option.geomgroup[_HIDDEN_GROUP] = 0
            camera = _mjv_camera(model, camera)
            mujoco.mjv_updateScene(model, data, option, None, camera, mujoco.mjtCatBit.mjCAT_ALL, self._scene)
        finally:
            model.geom_group[:], option.geomgroup[_HIDDEN_GROUP] = groups, shown
        self._pose, self._axes, self._eye = _pose(self._scene)
        self._occluders = _occluders(model, data, ~is_hidden)

    def render(self, *, out: np.ndarray | None = None) -> np.ndarray:
        """Draws the scene.

        Returns:
          Colours, uint8, rows x columns x 3. With depth rendering, distances in metres along each pixel's ray, float32, rows x
          columns: a lens that sees beyond 90 degrees has no depths. With segmentation rendering, id and type of each pixel's geom,
          int32, rows x columns x 2: -1, -1 where it shows the recorded scene.

        Raises:
          RuntimeError: after :meth:`close`, or before :meth:`update_scene`.
          reality_sim.NoPicture: where too little was recorded near the pose.
        """
        if self._mjr_context is None:
            raise RuntimeError("render cannot be called after close.")
        if self._pose is None:
            raise RuntimeError("render needs a scene: call update_scene first.")
        by_geom = self._segmentation_rendering
        objects = self._geom_objects if by_geom else self._objects
        layer = Cube(self._pose, self._faces(by_geom), objects, self._occluders)
        if self._depth_rendering:
            result = self._labelling.look(self._pose, [layer]).labels.distance_m
        elif by_geom:
            geoms = self._labelling.look(self._pose, [layer]).object_of.astype(np.int32)
            geoms[geoms == NO_OBJECT] = -1
            result = np.stack([geoms, np.where(geoms < 0, -1, int(mujoco.mjtObj.mjOBJ_GEOM))], axis=-1).astype(np.int32)
        else:
            self.frame = self._camera.look(self._pose, [layer])
            result = self.frame.picture
        if out is None:
            return result
        if out.shape != result.shape:
            raise ValueError(f"Expected `out.shape == {result.shape}`. Got `out.shape={out.shape}` instead.")
        out[:] = result
        return out

    def _faces(self, by_geom: bool) -> list[tuple]:
        """Draws the windows of the cube's sides in which there are bodies."""
        self._gl_context.make_current()
        scene, flags = self._scene, self._scene.flags.copy()
        centers, radii = _spheres(scene, self._model)
        in_camera = (centers - self._eye) @ self._axes.T
        objects = self._objects_of_segments(by_geom)
        faces = []
        for side, axes in _SIDES.items():
            window = self._window(in_camera @ np.array(axes, float).T, in_camera, radii)
            if window is None:
                continue
            left, top, right, bottom = window
            self._aim(np.array(axes, float) @ self._axes, window)
            rect = mujoco.MjrRect(0, 0, right - left, bottom - top)
            color = np.empty((bottom - top, right - left, 3), np.uint8)
            segments, depth = np.empty_like(color), np.empty(color.shape[:2], np.float32)
            try:
                mujoco.mjr_render(rect, scene, self._mjr_context)
                mujoco.mjr_readPixels(color, None, rect, self._mjr_context)
                flags_of_segments = mujoco.mjtRndFlag.mjRND_SEGMENT, mujoco.mjtRndFlag.mjRND_IDCOLOR
                for flag in flags_of_segments:
                    scene.flags[flag] = 1
                mujoco.mjr_render(rect, scene, self._mjr_context)
                mujoco.mjr_readPixels(segments, depth, rect, self._mjr_context)
            finally:
                np.copyto(scene.flags, flags)
            numbers = segments.astype(np.int32) @ np.array([1, 1 << 8, 1 << 16], np.int32)
            # Rows come from the bottom.
            shown = objects[np.minimum(numbers, len(objects) - 1)]
            faces.append((side, self._face_size, [left, top], color[::-1], _metres(depth)[::-1], shown[::-1]))
        return faces

    def _objects_of_segments(self, by_geom: bool) -> np.ndarray:
        """Returns the object, or the geom, of every number of MuJoCo's segmentation; -1 for none."""
        scene = self._scene
        objects = np.full(scene.ngeom + 2, -1, np.int32)
        for geom in scene.geoms[: scene.ngeom]:
            if geom.segid >= 0 and geom.objtype == mujoco.mjtObj.mjOBJ_GEOM:
                body = self._model.geom_bodyid[geom.objid]
                objects[geom.segid + 1] = geom.objid if by_geom else self._roots[body]
        return objects

    def _window(self, in_side: np.ndarray, in_camera: np.ndarray, radii: np.ndarray) -> tuple[int, int, int, int] | None:
        """Returns the pixels of a side in which bodies may be: left, top, right, bottom."""
        size, window = self._face_size, None
        for (x, y, z), point, radius in zip(in_side, in_camera, radii):
            distance = float(np.linalg.norm(point))
            if distance > radius:
                off_axis = math.acos(np.clip(point[2] / distance, -1.0, 1.0)) - math.asin(radius / distance)
                if off_axis > self._widest_rad:
                    continue
            columns, rows = _slopes(x, z, radius), _slopes(y, z, radius)
            if columns is None or rows is None:
                continue
            pixels = [math.floor((1 + slope) * size / 2) for slope in (columns[0], rows[0])]
            pixels += [math.ceil((1 + slope) * size / 2) for slope in (columns[1], rows[1])]
            found = [max(pixel - _MARGIN_PX, 0) for pixel in pixels[:2]]
            found += [min(pixel + _MARGIN_PX, size) for pixel in pixels[2:]]
            if window is None:
                window = found
            else:
                window = [*map(min, window[:2], found[:2]), *map(max, window[2:], found[2:])]
        return None if window is None else tuple(window)

    def _aim(self, axes_in_world: np.ndarray, window: tuple[int, int, int, int]) -> None:
        """Lets the scene's cameras look at a window of a side."""
        left, top, right, bottom = (2 * pixel / self._face_size - 1 for pixel in window)
        for camera in self._scene.camera:
            camera.pos, camera.forward, camera.up = self._eye, axes_in_world[2], -axes_in_world[1]
            camera.orthographic = 0
            camera.frustum_near, camera.frustum_far = _NEAR_M, _FAR_M
            camera.frustum_center = _NEAR_M * (left + right) / 2
            camera.frustum_width = 0
            camera.frustum_bottom, camera.frustum_top = -_NEAR_M * bottom, -_NEAR_M * top

    def close(self) -> None:
        """Frees MuJoCo's graphics; nothing can be drawn afterwards."""
        if self._gl_context:
            self._gl_context.free()
        if self._mjr_context:
            self._mjr_context.free()
        self._gl_context = self._mjr_context = None

    def __enter__(self) -> "Renderer":
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def __del__(self) -> None:
        self.close()


def _name(model: mujoco.MjModel, kind: mujoco.mjtObj, number: int) -> str:
    return mujoco.mj_id2name(model, kind, number) or f"{kind.name[5:].lower()}{number}"


def _roots(model: mujoco.MjModel) -> tuple[np.ndarray, list[str]]:
    """Returns for each body the number of the body of the world that it is attached to, from 0, and the names of those."""
    bodies = np.unique(model.body_rootid[1:]) if model.nbody > 1 else np.empty(0, int)
    numbers = np.searchsorted(bodies, model.body_rootid).astype(np.int32)
    return numbers, [_name(model, mujoco.mjtObj.mjOBJ_BODY, int(body)) for body in bodies]


def _is_under(model: mujoco.MjModel, roots: list[int]) -> np.ndarray:
    """Returns for each body whether it is one of these or attached to one."""
    is_under = np.zeros(model.nbody, bool)
    for body in range(model.nbody):
        is_under[body] = body in roots or (body > 0 and is_under[model.body_parentid[body]])
    return is_under


def _mjv_camera(model: mujoco.MjModel, camera: int | str | mujoco.MjvCamera) -> mujoco.MjvCamera:
    if isinstance(camera, mujoco.MjvCamera):
        return camera
    number = camera
    if isinstance(camera, str):
        number = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_CAMERA, camera)
        if number < 0:
            raise ValueError(f'The camera "{camera}" does not exist.')
    if not -1 <= number < model.ncam:
        raise ValueError(f"The camera id {number} is out of range [-1, {model.ncam}).")
    made = mujoco.MjvCamera()
    made.fixedcamid = number
    if number < 0:
        made.type = mujoco.mjtCamera.mjCAMERA_FREE
        mujoco.mjv_defaultFreeCamera(model, made)
    else:
        made.type = mujoco.mjtCamera.mjCAMERA_FIXED
    return made


def _pose(scene: mujoco.MjvScene) -> tuple[tuple[float, ...], np.ndarray, np.ndarray]:
    """Returns the pose of a scene's camera, its right, down and forward axes in the world, and its place."""
    # A camera has two eyes.
    eye = np.mean([camera.pos for camera in scene.camera], axis=0, dtype=float)
    forward, up = (np.array(vector, float) for vector in (scene.camera[0].forward, scene.camera[0].up))
    forward /= np.linalg.norm(forward)
    right = np.cross(forward, up)
    right /= np.linalg.norm(right)
    down = np.cross(forward, right)
    yaw, pitch = math.atan2(forward[1], forward[0]), -math.asin(np.clip(forward[2], -1.0, 1.0))
    level = np.array([math.sin(yaw), -math.cos(yaw), 0.0])
    roll = math.atan2(right @ np.cross(forward, level), right @ level)
    x, y, z = map(float, eye)
    return (x, y, yaw, z, pitch, roll), np.stack([right, down, forward]), eye


def _slopes(across: float, along: float, radius: float) -> tuple[float, float] | None:
    """Returns the range of slopes, within -1 to 1, at which a sphere is seen in a plane; `None` where it is not."""
    distance = math.hypot(across, along)
    if distance <= radius:
        return -1.0, 1.0
    angle, half = math.atan2(across, along), math.asin(radius / distance)
    low, high = angle - half, angle + half
    if low >= math.pi / 4 or high <= -math.pi / 4:
        return None
    return math.tan(max(low, -math.pi / 4)), math.tan(min(high, math.pi / 4))


def _spheres(scene: mujoco.MjvScene, model: mujoco.MjModel) -> tuple[np.ndarray, np.ndarray]:
    """Returns centres and radii of spheres around a scene's geoms, metres."""
    geoms = scene.geoms[: scene.ngeom]
    centers = np.array([geom.pos for geom in geoms], float).reshape(-1, 3)
    radius = lambda geom: (
        model.geom_rbound[geom.objid]
        if geom.objtype == mujoco.mjtObj.mjOBJ_GEOM
        else float(np.linalg.norm(geom.size))
    )
    return centers, np.array([radius(geom) for geom in geoms], float)


def _occluders(model: mujoco.MjModel, data: mujoco.MjData, is_drawn: np.ndarray) -> list[list[float]]:
    """Returns spheres that stand for geoms where these take light from the ground: a row of them along the longest side."""
    spheres = []
    for geom in np.flatnonzero(is_drawn):
        center, half = model.geom_aabb[geom, :3], model.geom_aabb[geom, 3:]
        longest = int(np.argmax(half))
        radius = float(np.sqrt(np.prod(np.delete(half, longest))))
        if not 0 < radius < 10 or model.geom_rgba[geom, 3] == 0:
            continue
        count = max(1, min(4, round(half[longest] / radius)))
        turn = data.geom_xmat[geom].reshape(3, 3)
        for step in (np.arange(count) - (count - 1) / 2) * 2 * half[longest] / count:
            place = center + step * np.eye(3)[longest]
            spheres.append([*(data.geom_xpos[geom] + turn @ place), radius])
    return spheres


def _metres(depth: np.ndarray) -> np.ndarray:
    """Returns depths along the axis, metres, of MuJoCo's depth buffer, in which 0 is far and 1 near."""
    near, far = _NEAR_M, _FAR_M
    return (near * far / (near + depth.astype(np.float64) * (far - near))).astype(np.float32)
