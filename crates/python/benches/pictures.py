"""How long the package takes to be imported, and for a picture: beside the Rust program, and with MuJoCo's ball in it.

    python crates/python/benches/pictures.py CAMERA_SPEED [DATABASE PROBES]

CAMERA_SPEED is the program of ``cargo build --release --example camera_speed``; the package must be built for use, too. Without a
database, one is made of the demonstration walk, whose own poses are then looked at.
"""

from __future__ import annotations

import os
import re
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

os.environ.setdefault("MUJOCO_GL", "osmesa")

import mujoco
import numpy as np

import reality_sim
import reality_sim.mujoco

WALK = Path(__file__).parents[3] / "assets" / "walk"
#: Rounds in which both programs take turns.
ROUNDS = 5
#: Times that a pose is looked at in a round; the same as in the Rust program.
LOOKS = 8
#: Frames of the path along which MuJoCo's ball is seen.
FRAMES = 150

BALL = """
<mujoco>
  <worldbody>
    <light pos="0 0 3"/>
    <body name="ball">
      <freejoint/>
      <geom type="sphere" size=".1" rgba="1 .4 0 1"/>
    </body>
    <body name="head" mocap="true"><camera name="head" xyaxes="0 -1 0 .34 0 .94"/></body>
  </worldbody>
</mujoco>
"""


def main() -> None:
    program, *rest = sys.argv[1:]
    print_import()
    with tempfile.TemporaryDirectory() as folder:
        if not rest:
            rest = [f"{folder}/walk.db", str(WALK)]
            reality_sim.build([WALK], rest[0])
        database_file, probes = rest
        database = reality_sim.Database(database_file, best_effort=True)
        print_pictures(program, database, database_file, probes)
        print_mujoco(database)


def print_import() -> None:
    """Prints the time that a new interpreter takes longer with the package, and with numpy, which the first picture asks for, than with nothing."""
    times = {code: [] for code in ("pass", "import numpy", "import reality_sim")}
    for _ in range(ROUNDS):
        for code, taken in times.items():
            taken.append(seconds(lambda code=code: subprocess.run([sys.executable, "-c", code], check=True)))
    nothing, numpy, package = (statistics.median(taken) for taken in times.values())
    print(f"import reality_sim: {1e3 * (package - nothing):.0f} ms; import numpy: {1e3 * (numpy - nothing):.0f} ms")


def print_pictures(program: str, database: reality_sim.Database, file: str, probes: str) -> None:
    """Prints the median time of a blended picture by Python and by Rust, in turns."""
    poses = true_poses(Path(probes) / "groundtruth.tum")
    camera = reality_sim.Renderer(database, method="blend")
    ratios = []
    for _ in range(ROUNDS):
        told = subprocess.run([program, file, probes], capture_output=True, text=True, check=True).stdout
        rust_ms = float(re.search(r"^blend ([\d.]+) ms$", told, re.MULTILINE)[1])
        python_ms = median_ms(camera, poses)
        ratios.append(python_ms / rust_ms)
        print(f"blend: Rust {rust_ms:.2f} ms, Python {python_ms:.2f} ms")
    print(f"Python / Rust: {statistics.median(ratios):.3f} (median of {ROUNDS} rounds)")


def median_ms(camera: reality_sim.Renderer, poses: np.ndarray) -> float:
    """Times pictures whose neighbours are decoded; the camera jumps from pose to pose."""
    times = []
    for pose in poses:
        camera.look(pose)
        for _ in range(LOOKS):
            camera.forget_path()
            times.append(1e3 * seconds(lambda pose=pose: camera.look(pose)))
    return statistics.median(times)


def true_poses(file: Path) -> np.ndarray:
    """Reads x, y, yaw, height, pitch and roll of the camera (world from camera: x right, y down, z forward)."""
    rows = np.loadtxt(file)
    poses = []
    for _, x, y, z, qx, qy, qz, qw in rows:
        right, down, forward = rotation(qx, qy, qz, qw).T
        yaw, pitch = np.arctan2(forward[1], forward[0]), -np.arcsin(forward[2])
        level = np.array([np.sin(yaw), -np.cos(yaw), 0.0])
        poses.append((x, y, yaw, z, pitch, np.arctan2(right @ np.cross(forward, level), right @ level)))
    return np.array(poses)


def rotation(x: float, y: float, z: float, w: float) -> np.ndarray:
    matrix = np.empty(9)
    mujoco.mju_quat2Mat(matrix, np.array([w, x, y, z]))
    return matrix.reshape(3, 3)


def print_mujoco(database: reality_sim.Database) -> None:
    """Prints how many frames a second there are with MuJoCo's ball before a camera that walks, and where the time goes."""
    model = mujoco.MjModel.from_xml_string(BALL)
    data = mujoco.MjData(model)
    first, last = database.poses[0], database.poses[len(database) // 2]
    with reality_sim.mujoco.Renderer(model, database, height=480, width=640) as renderer:
        parts = {"simulation": [], "scene": [], "MuJoCo's pictures": [], "all of render": []}
        for frame in range(FRAMES):
            place(data, first + (last - first) * frame / FRAMES, frame)
            parts["simulation"].append(seconds(lambda: mujoco.mj_forward(model, data)))
            parts["scene"].append(seconds(lambda: renderer.update_scene(data, "head")))
            # Once for itself, to know its share.
            parts["MuJoCo's pictures"].append(seconds(lambda: renderer._faces(by_geom=False)))
            parts["all of render"].append(seconds(renderer.render))
            assert renderer.frame.objects[0].visible, "the ball is in view"
    mean_ms = {name: 1e3 * statistics.fmean(taken) for name, taken in parts.items()}
    whole_ms = mean_ms["simulation"] + mean_ms["scene"] + mean_ms["all of render"]
    recorded_ms = mean_ms.pop("all of render") - mean_ms["MuJoCo's pictures"]
    print(f"MuJoCo's ball: {1e3 / whole_ms:.0f} frames a second of {renderer.width} x {renderer.height}")
    for name, taken_ms in {**mean_ms, "recorded picture and composition": recorded_ms}.items():
        print(f"  {name}: {taken_ms:.2f} ms, {taken_ms / whole_ms:.0%}")


def place(data: mujoco.MjData, pose: np.ndarray, frame: int) -> None:
    """Puts the camera at a pose, without its tilt, and the ball a metre before it, rolling to and fro."""
    x, y, yaw, height = pose[:4]
    data.mocap_pos[0] = x, y, height
    data.mocap_quat[0] = np.cos(yaw / 2), 0, 0, np.sin(yaw / 2)
    ahead, aside = 1.0, 0.2 * np.sin(frame / 10)
    data.qpos[:3] = x + ahead * np.cos(yaw) - aside * np.sin(yaw), y + ahead * np.sin(yaw) + aside * np.cos(yaw), 0.1


def seconds(work: Callable[[], object]) -> float:
    start = time.perf_counter()
    work()
    return time.perf_counter() - start


if __name__ == "__main__":
    main()
