"""The simulator's camera."""

import numpy as np
import pytest

import reality_sim

POSE = (-2.3, 0.2, 1.6, 0.5, 0.35, 0.0)
BALL = (-2.3, 1.2, 0.065)


def in_camera(pose: tuple, points: np.ndarray) -> np.ndarray:
    """Returns points of the world in the camera's axes, by the definition of the pose."""
    x, y, yaw, height, pitch, roll = pose
    forward = np.array([np.cos(yaw) * np.cos(pitch), np.sin(yaw) * np.cos(pitch), -np.sin(pitch)])
    level = np.array([np.sin(yaw), -np.cos(yaw), 0.0])
    down = np.cross(forward, level)
    right = np.cos(roll) * level + np.sin(roll) * down
    down = np.cos(roll) * down - np.sin(roll) * level
    return (np.asarray(points, float) - (x, y, height)) @ np.stack([right, down, forward]).T


def test_without_layers_the_picture_is_the_databases(database: reality_sim.Database) -> None:
    frame = reality_sim.Renderer(database, method="blend").look(POSE)
    assert np.array_equal(frame.picture, database.render(POSE, "blend"))
    assert frame.pose == POSE and frame.labels is None and not frame.objects
    assert 0.4 < frame.covered <= 1


def test_a_ball_is_where_the_lens_projects_it(database: reality_sim.Database) -> None:
    renderer = reality_sim.Renderer(database, labels=True)
    frame = renderer.look(POSE, [reality_sim.Ball(*BALL, radius_m=0.065, color=(255, 0, 0))])
    (ball,) = frame.objects
    assert (ball.name, ball.class_name, ball.visibility) == ("ball", "ball", 1)
    rows, columns = np.nonzero(frame.object_of == 0)
    middle = database.lens.project(in_camera(POSE, [BALL]))[0]
    # A sphere's outline is not centred at its centre's image, by less than this.
    assert np.hypot(columns.mean() - middle[0], rows.mean() - middle[1]) < 0.7
    distance = np.linalg.norm(in_camera(POSE, [BALL]))
    assert frame.object_distance_m[rows, columns].min() == pytest.approx(distance - 0.065, abs=0.005)
    assert np.isinf(frame.object_distance_m[frame.object_of == reality_sim.NO_OBJECT]).all()
    assert (frame.labels.classes[rows, columns] == 4).mean() > 0.9
    before = database.render(POSE)[rows, columns].astype(int)
    assert (frame.picture[rows, columns, 0].astype(int) - before[:, 0]).mean() > 20


def test_labels_are_those_of_the_field(database: reality_sim.Database) -> None:
    labels = reality_sim.Renderer(database, labels=True).look(POSE).labels
    # The ground is where the pose and the lens say.
    v, u = np.nonzero(np.isin(labels.classes, (1, 2)))
    rays = database.lens.unproject(np.stack([u, v], axis=1).astype(float))
    down = in_camera((0, 0, *POSE[2:3], 0, *POSE[4:]), [(0, 0, -1)])[0]
    assert np.allclose(labels.distance_m[v, u], POSE[3] / (rays @ down), rtol=1e-3)
    assert {kind for kind, _ in labels.lines} <= {
        "touch_line", "goal_line", "halfway_line", "goal_area", "penalty_area", "center_circle",
    }
    assert labels.lines and labels.crossings
    for _, place, pixel, _ in labels.crossings:
        if pixel is not None:
            assert np.allclose(database.lens.project(in_camera(POSE, [(*place, 0.0)]))[0], pixel, atol=1e-6)


def test_pictures_of_another_size_show_the_same(database: reality_sim.Database) -> None:
    small = reality_sim.Renderer(database, size=(320, 240), method="plane").look(POSE).picture
    large = database.render(POSE, "plane").reshape(240, 2, 320, 2, 3).mean(axis=(1, 3))
    assert small.shape == (240, 320, 3)
    assert np.abs(small - large).mean() < 6
    with pytest.raises(ValueError, match="proportions"):
        reality_sim.Renderer(database, size=(640, 640))


def test_a_cube_around_the_camera_goes_through_the_lens(database: reality_sim.Database) -> None:
    """Spheres painted on the sides of a cube by their own formula are where those drawn as meshes are."""
    side_axes = {
        "forward": ((1, 0, 0), (0, 1, 0), (0, 0, 1)),
        "left": ((0, 0, 1), (0, 1, 0), (-1, 0, 0)),
        "right": ((0, 0, -1), (0, 1, 0), (1, 0, 0)),
        "up": ((1, 0, 0), (0, 0, 1), (0, -1, 0)),
        "down": ((1, 0, 0), (0, 0, -1), (0, 1, 0)),
    }
    size = 480
    for place in [(-2.3, 1.2, 0.1), (-1.6, 0.9, 0.1), (-3.0, 0.6, 0.1), (-2.32, 0.6, 0.1), (-2.0, 1.0, 0.6)]:
        center = in_camera(POSE, [place])[0]
        slopes = (np.arange(size) + 0.5) * 2 / size - 1
        faces = []
        for side, axes in side_axes.items():
            rays = np.stack(np.broadcast_arrays(slopes[None, :], slopes[:, None], 1.0), axis=-1) @ np.array(axes, float)
            rays /= np.linalg.norm(rays, axis=-1, keepdims=True)
            along = rays @ center
            inside = along**2 - center @ center + 0.1**2
            hit = (along > 0) & (inside > 0)
            distance = np.where(hit, along - np.sqrt(np.maximum(inside, 0)), 0)
            depth = (distance * (rays @ np.array(axes[2], float))).astype(np.float32)
            color = np.full((size, size, 3), 200, np.uint8)
            faces.append((side, size, [0, 0], color, depth, np.where(hit, 0, -1).astype(np.int32)))
        renderer = reality_sim.Renderer(database)
        cube = renderer.look(POSE, [reality_sim.Cube(POSE, faces, [("ball", "cube")])])
        mesh = renderer.look(POSE, [reality_sim.Ball(*place, radius_m=0.1)])
        seen = cube.object_of == 0, mesh.object_of == 0
        assert seen[1].sum() > 100
        assert (seen[0] ^ seen[1]).sum() <= 0.02 * seen[1].sum() + 4
        both = seen[0] & seen[1]
        error = np.abs(cube.object_distance_m[both] - mesh.object_distance_m[both])
        assert np.median(error) < 0.002


def test_layers_are_checked() -> None:
    with pytest.raises(ValueError, match="radius_m"):
        reality_sim.Ball(0, 0, radius_m=-1)
    with pytest.raises(ValueError, match="Humanoid"):
        reality_sim.Humanoid(0, float("nan"), 0)
    with pytest.raises(ValueError, match="class"):
        reality_sim.Cube(POSE, [], [("sheep", "a")])
