"""MuJoCo's bodies in recorded pictures."""

import os

os.environ.setdefault("MUJOCO_GL", "osmesa")

import numpy as np
import pytest
from test_renderer import in_camera

import reality_sim

mujoco = pytest.importorskip("mujoco")
import reality_sim.mujoco  # noqa: E402

MODEL = """
<mujoco>
  <asset>
    <mesh name="pyramid" vertex="-.1 -.1 0  .1 -.1 0  .1 .1 0  -.1 .1 0  0 0 .3"/>
  </asset>
  <worldbody>
    <light pos="0 0 3"/>
    <geom name="carpet" type="plane" size="5 4 .1" rgba="0 .5 0 1"/>
    <body name="ball" pos="-2.3 1.2 .1"><freejoint/><geom name="ball" type="sphere" size=".1" rgba="1 .4 0 1"/></body>
    <body name="player" pos="-1.6 1.1 0">
      <freejoint/>
      <geom name="body" type="mesh" mesh="pyramid" rgba=".2 .2 .8 1"/>
      <body name="box" pos="0 0 .4"><geom name="box" type="box" size=".05 .08 .06" euler="10 20 30"/></body>
    </body>
    <body name="carrier" pos="-2.3 .2 .5">
      <freejoint/>
      <geom name="head" type="sphere" size=".08"/>
      <camera name="head" pos="0 0 0" xyaxes="1 0 0 0 .342898 .939373"/>
    </body>
  </worldbody>
</mujoco>
"""


@pytest.fixture(scope="module")
def model() -> "mujoco.MjModel":
    return mujoco.MjModel.from_xml_string(MODEL)


@pytest.fixture
def data(model: "mujoco.MjModel") -> "mujoco.MjData":
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    return data


@pytest.fixture
def renderer(model: "mujoco.MjModel", database: reality_sim.Database):
    with reality_sim.mujoco.Renderer(model, database, 480, 640, hidden=["carrier"], labels=True) as renderer:
        yield renderer


def vertices(model: "mujoco.MjModel", data: "mujoco.MjData", geom: str) -> np.ndarray:
    """Returns points on a geom's surface, in the world."""
    number, size = model.geom(geom).id, model.geom(geom).size
    match model.geom(geom).type[0]:
        case mujoco.mjtGeom.mjGEOM_SPHERE:
            points = np.random.default_rng(1).normal(size=(1000, 3))
            points *= size[0] / np.linalg.norm(points, axis=1, keepdims=True)
        case mujoco.mjtGeom.mjGEOM_BOX:
            points = np.array([(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]) * size
        case _:
            mesh = model.geom(geom).dataid[0]
            start = model.mesh_vertadr[mesh]
            points = model.mesh_vert[start : start + model.mesh_vertnum[mesh]]
    return points @ data.geom_xmat[number].reshape(3, 3).T + data.geom_xpos[number]


def hull(points: np.ndarray) -> np.ndarray:
    """Returns the corners of the convex hull of points in a plane, counter-clockwise (Andrew, 1979)."""
    ordered = sorted(map(tuple, points))

    def half(points: list) -> list:
        chain: list = []
        for point in points:
            while len(chain) >= 2 and np.linalg.det([np.subtract(chain[-1], chain[-2]), np.subtract(point, chain[-1])]) <= 0:
                chain.pop()
            chain.append(point)
        return chain[:-1]

    return np.array(half(ordered) + half(ordered[::-1]))


def sees(lens: reality_sim.Lens, points: np.ndarray, pixels: np.ndarray) -> np.ndarray:
    """Returns at which pixels a ray meets a convex body, given by points in the camera's axes."""
    middle = points.mean(axis=0) / np.linalg.norm(points.mean(axis=0))
    across = np.cross(middle, (0.1, 1, 0.2))
    across /= np.linalg.norm(across)
    axes = np.stack([across, np.cross(middle, across)])
    corners = hull(points @ axes.T / (points @ middle)[:, None])
    rays = lens.unproject(pixels)
    places = rays @ axes.T / (rays @ middle)[:, None]
    edges = np.roll(corners, -1, axis=0) - corners
    to_places = places[:, None] - corners
    inside = edges[:, 0] * to_places[..., 1] - edges[:, 1] * to_places[..., 0] >= 0
    return inside.all(axis=1) & (rays @ middle > 0)


def test_pixels_of_a_body_are_those_that_its_vertices_enclose(renderer, model, data, database) -> None:
    """A pixel shows a body if it lies in the projection of its vertices, up to one pixel beside the outline."""
    random = np.random.default_rng(5)
    compared = 0
    for _ in range(12):
        data.qpos[0:2] = (-2.3, 1.2) + random.uniform(-0.8, 0.8, 2)
        data.qpos[7:9] = (-1.6, 1.1) + random.uniform(-0.7, 0.7, 2)
        turn = random.normal(size=4)
        data.qpos[9:14] = (0.4, *(turn / np.linalg.norm(turn)))
        mujoco.mj_forward(model, data)
        renderer.enable_segmentation_rendering()
        renderer.update_scene(data, "head")
        segments = renderer.render()
        assert segments.dtype == np.int32 and segments.shape == (480, 640, 2)
        for geom in ("ball", "body", "box"):
            points = in_camera(renderer.pose, vertices(model, data, geom))
            places = database.lens.project(points)
            if not np.isfinite(places).all() or (places < 3).any() or (places > (636, 476)).any():
                continue
            low, high = np.floor(places.min(axis=0)).astype(int) - 3, np.ceil(places.max(axis=0)).astype(int) + 4
            window = segments[low[1] : high[1], low[0] : high[0]]
            shown = (window[..., 0] == model.geom(geom).id) & (window[..., 1] == mujoco.mjtObj.mjOBJ_GEOM)
            if ((window[..., 0] >= 0) & ~shown).any():
                continue  # Something else may stand before it.
            pixels = np.stack(np.meshgrid(*map(np.arange, low, high)), axis=-1).reshape(-1, 2).astype(float)
            around = [(u, v) for u in (-1, 0, 1) for v in (-1, 0, 1)]
            enclosed = np.stack([sees(database.lens, points, pixels + step) for step in around])
            shown = shown.ravel()
            assert shown.sum() > 10
            assert enclosed[:, shown].any(axis=0).all(), geom
            assert shown[enclosed.all(axis=0)].all(), geom
            compared += 1
    assert compared >= 12


def test_the_pose_is_that_of_the_camera(renderer, model, data) -> None:
    renderer.update_scene(data, "head")
    x, y, yaw, height, pitch, roll = renderer.pose
    assert np.allclose((x, y, height), data.cam("head").xpos, atol=1e-6)
    axes = data.cam("head").xmat.reshape(3, 3)
    points = np.random.default_rng(2).normal(size=(20, 3)) + (x, y, height)
    # MuJoCo's cameras look along -z, with y up.
    by_mujoco = (points - (x, y, height)) @ axes * (1, -1, -1)
    assert np.allclose(in_camera(renderer.pose, points), by_mujoco, atol=1e-5)
    assert pitch == pytest.approx(0.35, abs=1e-3) and roll == pytest.approx(0, abs=1e-6)


def test_distances_are_those_of_bodies_and_ground(renderer, model, data) -> None:
    renderer.enable_depth_rendering()
    renderer.update_scene(data, "head")
    distances = renderer.render()
    assert distances.dtype == np.float32 and distances.shape == (480, 640)
    renderer.enable_segmentation_rendering()
    segments = renderer.render()
    ball = distances[segments[..., 0] == model.geom("ball").id]
    expected = np.linalg.norm(data.geom("ball").xpos - data.cam("head").xpos) - 0.1
    assert ball.min() == pytest.approx(expected, abs=0.01)


def test_the_scene_is_the_recorded_one(renderer, model, data, database) -> None:
    renderer.update_scene(data, "head")
    picture = renderer.render()
    recorded = database.render(renderer.pose)
    assert [thing.name for thing in renderer.frame.objects] == ["ball", "player", "carrier"]
    assert [thing.class_name for thing in renderer.frame.objects] == ["ball", "robot", "robot"]
    assert renderer.frame.objects[2].visible is None
    untouched = renderer.frame.object_of == reality_sim.NO_OBJECT
    untouched &= np.abs(picture.astype(int) - recorded).max(axis=2) <= 1
    # All but bodies, their edges and their shadows.
    assert untouched.mean() > 0.9
    assert (renderer.frame.object_of != reality_sim.NO_OBJECT).mean() > 0.001


def test_it_is_used_as_mujocos_renderer(renderer, model, data) -> None:
    with pytest.raises(ValueError, match="does not exist"):
        renderer.update_scene(data, "nowhere")
    with pytest.raises(ValueError, match="out of range"):
        renderer.update_scene(data, 7)
    groups = model.geom_group.copy()
    renderer.update_scene(data, 0)
    assert np.array_equal(model.geom_group, groups)
    out = np.zeros((480, 640, 3), np.uint8)
    assert renderer.render(out=out) is out and out.any()
    with pytest.raises(ValueError, match="shape"):
        renderer.render(out=out[:5])
    renderer.close()
    with pytest.raises(RuntimeError, match="close"):
        renderer.render()


def test_bodies_that_are_out_of_view_are_not_drawn(renderer, model, data) -> None:
    data.qpos[0:3], data.qpos[7:10] = (-2.3, -2.5, 0.1), (-2.0, -2.5, 0.0)
    mujoco.mj_forward(model, data)
    renderer.update_scene(data, "head")
    assert renderer._faces(False) == []
    assert renderer.render().shape == (480, 640, 3)
