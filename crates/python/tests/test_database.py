"""Pictures by pose."""

import subprocess
import sys
import threading
from pathlib import Path

import numpy as np
import pytest

import reality_sim

POSE = (-2.3, 0.2, 1.6)


def test_pictures_have_the_shape_of_arrays(database: reality_sim.Database) -> None:
    picture = database.render(POSE)
    assert picture.dtype == np.uint8 and picture.flags.c_contiguous
    assert picture.shape == (database.lens.height, database.lens.width, 3)
    assert picture.std() > 10


def test_a_picture_is_the_recorded_one_where_one_was_recorded(database: reality_sim.Database) -> None:
    recorded = database.render(database.poses[7], "nearest")
    assert np.array_equal(database.render(tuple(database.poses[7]), "auto"), recorded)


def test_a_picture_is_drawn_into_memory_of_the_caller(database: reality_sim.Database) -> None:
    out = np.zeros((480, 640, 3), np.uint8)
    assert database.render(POSE, "plane", out=out) is out
    assert np.array_equal(out, database.render(POSE, "plane"))
    with pytest.raises(ValueError, match="shape"):
        database.render(POSE, out=out[:10])
    with pytest.raises(ValueError, match="contiguous"):
        database.render(POSE, out=np.zeros((480, 1280, 3), np.uint8)[:, ::2])
    with pytest.raises(ValueError, match="contiguous"):
        database.render(POSE, out=np.zeros((480, 640, 3), np.uint8, order="F"))
    out.flags.writeable = False
    with pytest.raises(ValueError, match="read-only"):
        database.render(POSE, out=out)


@pytest.mark.parametrize("pose", [(1, 2), (1, 2, 3, 4), (float("nan"), 0, 0), (0, 0, 0, float("inf"), 0, 0)])
def test_wrong_poses_are_refused(database: reality_sim.Database, pose: tuple) -> None:
    with pytest.raises(ValueError, match="pose"):
        database.render(pose)


def test_a_pose_far_from_all_pictures_has_no_picture(database: reality_sim.Database) -> None:
    with pytest.raises(reality_sim.NoPicture):
        database.render((4.0, 2.5, -3.0))


def test_names_of_methods_are_checked(database: reality_sim.Database) -> None:
    with pytest.raises(ValueError, match="plane"):
        database.render(POSE, "spline")


def test_a_missing_file_is_named(tmp_path: Path) -> None:
    with pytest.raises(reality_sim.Error, match="nothing.db"):
        reality_sim.Database(tmp_path / "nothing.db")


def test_other_threads_work_while_a_picture_is_drawn(database: reality_sim.Database) -> None:
    """Counts how often another thread gets to work during many pictures: not at all if the interpreter stayed locked."""
    turns, is_done = 0, threading.Event()

    def count() -> None:
        nonlocal turns
        while not is_done.wait(0.0002):
            turns += 1

    thread = threading.Thread(target=count)
    before = sys.getswitchinterval()
    # Nobody is interrupted in Python: a turn comes only where the interpreter was released.
    sys.setswitchinterval(1000)
    try:
        thread.start()
        for _ in range(20):
            database.render(POSE, "blend")
    finally:
        is_done.set()
        thread.join()
        sys.setswitchinterval(before)
    assert turns >= 20


def test_lenses_project_and_unproject(database: reality_sim.Database) -> None:
    lens = database.lens
    pixels = np.random.default_rng(3).uniform((0, 0), (lens.width - 1, lens.height - 1), (500, 2))
    rays = lens.unproject(pixels)
    seen = np.isfinite(rays).all(axis=1)
    assert seen.mean() > 0.9
    assert np.allclose(np.linalg.norm(rays[seen], axis=1), 1)
    assert np.allclose(lens.project(3.0 * rays[seen]), pixels[seen], atol=1e-6)


def test_the_package_imports_nothing_heavy() -> None:
    script = "import sys, reality_sim; print(sorted({'mujoco', 'pyarrow', 'ray'} & set(sys.modules)))"
    assert subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True).stdout.strip() == "[]"
