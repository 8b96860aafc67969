"""The models of the RoboCup 3D simulation server in recorded pictures."""

import os

os.environ.setdefault("MUJOCO_GL", "osmesa")

import numpy as np
import pytest
from test_renderer import in_camera

import reality_sim

mujoco = pytest.importorskip("mujoco")
spec_provider = pytest.importorskip("rcsssmj.resources.spec_provider")
import reality_sim.mujoco  # noqa: E402

#: Heights at which the robots' torsos are when they stand.
TORSO_M = {"T1": 0.665, "K1": 0.52}


@pytest.fixture(scope="module")
def model() -> "mujoco.MjModel":
    """Makes a game as the server does: its world, and a robot of each make; the first one carries the camera."""
    provider = spec_provider.ModelSpecProvider()
    world = provider.load_environment_spec("soccer", "world")
    for make, name in [("T1", "carrier/"), ("T1", "left/"), ("K1", "right/")]:
        frame = world.worldbody.add_frame()
        frame.attach_body(provider.load_robot_spec(make).body("torso"), name, "")
    site = world.site("carrier/camera")
    site.parent.add_camera(name="head", pos=site.pos, xyaxes=[0, -1, 0, 0.34, 0, 0.94])
    return world.compile()


@pytest.fixture
def data(model: "mujoco.MjModel") -> "mujoco.MjData":
    data = mujoco.MjData(model)
    place(data, "carrier/torso", (-2.3, 0.2, TORSO_M["T1"]), 1.6)
    place(data, "left/torso", (-1.7, 1.7, TORSO_M["T1"]), -1.8)
    place(data, "right/torso", (-2.9, 1.6, TORSO_M["K1"]), 0.4)
    place(data, "ball", (-2.3, 1.2, 0.11), 0.0)
    mujoco.mj_forward(data.model, data)
    return data


def place(data: "mujoco.MjData", body: str, position: tuple[float, float, float], yaw: float) -> None:
    start = data.model.jnt_qposadr[data.model.body(body).jntadr[0]]
    data.qpos[start : start + 7] = (*position, np.cos(yaw / 2), 0, 0, np.sin(yaw / 2))


@pytest.fixture
def renderer(model: "mujoco.MjModel", database: reality_sim.Database):
    with reality_sim.mujoco.Renderer(model, database, 480, 640, hidden=["carrier/torso"], labels=True) as renderer:
        yield renderer


def test_the_robots_and_the_ball_are_where_the_simulation_has_them(renderer, model, data, database) -> None:
    renderer.update_scene(data, "head")
    picture = renderer.render()
    assert picture.shape == (480, 640, 3)
    things = {thing.name: thing for thing in renderer.frame.objects}
    assert {name: thing.class_name for name, thing in things.items()} == {
        "ball": "ball",
        "carrier/torso": "robot",
        "left/torso": "robot",
        "right/torso": "robot",
    }
    assert things["carrier/torso"].visible is None
    renderer.enable_segmentation_rendering()
    segments = renderer.render()
    # The ball's outline, by the lens alone.
    middle = in_camera(renderer.pose, data.body("ball").xpos[None])[0]
    random = np.random.default_rng(3).normal(size=(4000, 3))
    surface = middle + 0.11 * random / np.linalg.norm(random, axis=1, keepdims=True)
    outline = database.lens.project(surface)
    rows, columns = np.nonzero(segments[..., 0] == model.geom("ball").id)
    shown = (columns.min(), rows.min(), columns.max(), rows.max())
    # The outermost pixels lie within the outline, up to one pixel; half of one is the pixel itself.
    assert np.allclose(shown, (*outline.min(axis=0), *outline.max(axis=0)), atol=1.5)
    # All parts of a robot are in its box, and nearly all of them are seen.
    for name in ("left/torso", "right/torso"):
        parts = np.flatnonzero((model.body_rootid[model.geom_bodyid] == model.body(name).id) & (model.geom_group == 2))
        left, top, right, bottom = things[name].visible
        places = database.lens.project(in_camera(renderer.pose, data.geom_xpos[parts]))
        assert ((places >= (left, top)) & (places <= (right, bottom))).all()
        assert np.isin(parts, segments[..., 0]).mean() > 0.6


def test_the_camera_goes_with_its_robot(renderer, model, data) -> None:
    """Nothing is kept from one picture to the next."""
    renderer.update_scene(data, "head")
    before, start = renderer.render().copy(), renderer.pose
    for _ in range(100):
        mujoco.mj_step(model, data)
    renderer.update_scene(data, "head")
    assert np.allclose(np.array(renderer.pose)[[0, 1, 3]], data.cam("head").xpos, atol=1e-5)
    assert np.linalg.norm(np.subtract(renderer.pose, start)) > 0.01
    assert (renderer.render() != before).mean() > 0.1
