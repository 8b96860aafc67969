#!/usr/bin/env python3
"""Checks what `reality-sim export` writes against the packages of others: pycolmap, evo, mcap, mcap-ros2-support and pyarrow.

    python3 -m venv venv && venv/bin/pip install pycolmap evo mcap mcap-protobuf-support mcap-ros2-support pyarrow numpy
    cargo build --release && venv/bin/python scripts/formats/check_export.py target/release/reality-sim assets/walk

The truth about pixels is the program's own: a model's keypoints are where its camera sees the points of the field's lines.
"""

import csv
import json
import math
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

PIXEL_TOLERANCE = 0.01
ERROR_TOLERANCE = 1e-6


def run(program, *arguments):
    """Runs the program and returns the JSON object that it prints."""
    command = [program, *map(str, arguments), "--json"]
    return json.loads(subprocess.run(command, check=True, capture_output=True, text=True).stdout)


def check(name, good, what):
    print(f"{'ok  ' if good else 'FAIL'} {name}: {what}")
    if not good:
        raise SystemExit(1)


LENSES = {
    "OPENCV_FISHEYE": None,
    "OPENCV": "[-0.11, 0.013, 0.0012, -0.0023]",
    "OPENCV, k3": "[-0.11, 0.013, 0.0012, -0.0023, 0.0017]",
    "PINHOLE": "[]",
}


def with_lens(sequence, folder, name, distortion):
    """Returns a copy of the sequence whose camera claims to have another lens."""
    copy = folder / name
    shutil.copytree(sequence, copy)
    if distortion is not None:
        camera = copy / "camera.toml"
        text = re.sub(r"^model\s*=.*$", f'model = "{name.split(",")[0]}"', camera.read_text(), flags=re.M)
        text = re.sub(r"^max_angle_rad.*$", "", text, flags=re.M)
        camera.write_text(re.sub(r"^distortion\s*=\s*\[[^\]]*\]", f"distortion = {distortion}", text, flags=re.M))
    return copy


def check_colmap(program, sequence, folder):
    """pycolmap loads both kinds of files and projects every point to its keypoint, whatever the lens."""
    import pycolmap

    for name, distortion in LENSES.items():
        changed = with_lens(sequence, folder, name, distortion)
        for kind in ("text", "binary"):
            out = folder / f"colmap-{kind}-{name}"
            report = run(program, "export", changed, "--format", "colmap", f"--{kind}", "--out", out)
            model = pycolmap.Reconstruction(str(out / "sparse/0"))
            worst, count, behind = 0.0, 0, 0
            for image in model.images.values():
                for keypoint in image.points2D:
                    pixel = image.project_point(model.points3D[keypoint.point3D_id].xyz)
                    # A fisheye lens sees beyond 90°; pycolmap projects what lies in front of the camera.
                    if pixel is None:
                        behind += 1
                        continue
                    worst = max(worst, math.dist(pixel, keypoint.xy))
                    count += 1
            lens = next(iter(model.cameras.values())).model.name
            good = model.num_images() == report["pictures"] and count > 1000 and worst < PIXEL_TOLERANCE
            check(f"pycolmap, {kind}, {lens}", good, f"{count} points, worst {worst:.2e} px; {behind} beyond 90°")


def check_tum(program, sequence, folder):
    """evo, on the ground (`evo_ape --project_to_plane xy`), finds the errors that `tag` reports."""
    from evo.core import metrics, sync
    from evo.core.trajectory import Plane
    from evo.tools import file_interface

    poses = folder / "poses.tum"
    reported = run(program, "tag", sequence, "--out", poses)["error"]
    truth = folder / "truth.tum"
    run(program, "export", sequence, "--format", "tum", "--out", truth)
    pair = sync.associate_trajectories(
        file_interface.read_tum_trajectory_file(str(truth)), file_interface.read_tum_trajectory_file(str(poses))
    )
    for trajectory in pair:
        trajectory.project(Plane.XY)
    ape = metrics.APE(metrics.PoseRelation.translation_part)
    ape.process_data(pair)
    found = ape.get_all_statistics()
    for ours, theirs in (("mean_m", "mean"), ("median_m", "median"), ("rmse_m", "rmse"), ("max_m", "max")):
        difference = abs(reported[ours] - found[theirs])
        check(f"evo, {theirs}", difference < ERROR_TOLERANCE, f"{reported[ours]:.9f} m here, {found[theirs]:.9f} m there")


def check_mcap(program, sequence, folder):
    """mcap reads the log, and every message decodes by the schema that the log brings."""
    from mcap_protobuf.reader import read_protobuf_messages

    path = folder / "walk.mcap"
    report = run(program, "export", sequence, "--format", "mcap", "--out", path)
    counts, images = {}, 0
    for message in read_protobuf_messages(str(path)):
        counts[message.topic] = counts.get(message.topic, 0) + 1
        proto = message.proto_msg
        if message.topic == "/camera/image":
            images += proto.data[:2] == b"\xff\xd8" or proto.data[:4] == b"\x89PNG"
        if message.topic == "/camera/calibration":
            assert len(proto.K) == 9 and len(proto.P) == 12, proto
        if message.topic == "/tf":
            rotation = proto.rotation
            norm = math.hypot(rotation.x, rotation.y, rotation.z, rotation.w)
            assert abs(norm - 1) < 1e-9 and proto.parent_frame_id == "world", proto
    whole = all(count == report["pictures"] for count in counts.values())
    check("mcap", whole and images == report["pictures"] and len(counts) == 6, counts)


def check_ros2(program, sequence, folder):
    """mcap's decoder of ROS 2 reads what a camera streams by the definitions in the log; boxes, labels, lens and tf agree on where a ball is."""
    import numpy as np
    from mcap_ros2.reader import read_ros2_messages

    database, path, log = folder / "walk.db", folder / "path.tum", folder / "stream.mcap"
    run(program, "build", sequence, "--poses", sequence / "groundtruth.tum", "--out", database)
    path.write_text("".join((sequence / "groundtruth.tum").read_text().splitlines(keepends=True)[:12]))
    ball = (-2.3, 1.2, 0.1)
    report = run(program, "stream", database, "--path", path, "--ball", f"{ball[0]},{ball[1]},{ball[2]}", "--out", log)
    shots = {}
    for message in read_ros2_messages(str(log)):
        shots.setdefault(message.log_time_ns, {})[message.channel.topic] = message.ros_msg
    whole = all(len(shot) == 7 for shot in shots.values())
    check("mcap-ros2, messages", whole and len(shots) == report["pictures"], f"{len(shots)} times 7 messages")
    largest, seen = 0.0, 0
    for shot in shots.values():
        boxes = [one for one in shot["/camera/objects"].detections if one.results[0].hypothesis.class_id == "ball"]
        if not boxes:
            continue
        seen += 1
        box, info, transform = boxes[0].bbox, shot["/camera/camera_info"], shot["/tf"].transforms[0].transform
        instances = pixels_of(shot["/camera/instances"], "<u2")
        rows, columns = np.nonzero(instances == int(boxes[0].id))
        # The box is the instance's.
        assert columns.min() == box.center.position.x - box.size_x / 2, boxes
        assert rows.max() + 1 == box.center.position.y + box.size_y / 2, boxes
        assert (pixels_of(shot["/camera/classes"], "u1")[rows, columns] == 4).all()
        # The middle of the ball's pixels is where the lens sees its centre, and their depths are its front's.
        in_camera = rotated(transform.rotation, np.array(ball) - vector(transform.translation))
        pixel = equidistant(info, in_camera)
        if 0 < columns.min() and columns.max() + 1 < info.width and rows.max() + 1 < info.height:
            largest = max(largest, math.hypot(pixel[0] - columns.mean(), pixel[1] - rows.mean()))
        depths = pixels_of(shot["/camera/depth"], "<f4")[rows, columns]
        assert in_camera[2] - ball[2] - 0.01 < depths.min() and depths.max() < in_camera[2] + ball[2] + 0.01, depths
        assert shot["/camera/image_raw"].encoding == "rgb8" and len(shot["/camera/image_raw"].data) == 3 * info.width * info.height
    check("mcap-ros2, ball", seen >= 3 and largest < 1.0, f"{seen} pictures of the ball, {largest:.2f} px from its centre")


def pixels_of(image, kind):
    import numpy as np

    return np.frombuffer(bytes(image.data), kind).reshape(image.height, image.width)


def vector(xyz):
    return [xyz.x, xyz.y, xyz.z]


def rotated(q, point):
    """Rotates a vector of the world into the camera, by the quaternion of the camera in the world."""
    import numpy as np

    u, s = np.array([-q.x, -q.y, -q.z]), q.w
    return 2 * np.dot(u, point) * u + (s * s - np.dot(u, u)) * point + 2 * s * np.cross(u, point)


def equidistant(info, point):
    """Projects by ROS's fisheye model."""
    assert info.distortion_model == "equidistant" and len(info.d) == 4, info
    radius = math.hypot(point[0], point[1])
    t = math.atan2(radius, point[2])
    bent = t * (1 + sum(k * t ** (2 * power + 2) for power, k in enumerate(info.d)))
    return info.k[0] * bent * point[0] / radius + info.k[2], info.k[4] * bent * point[1] / radius + info.k[5]


def check_parquet(program, sequence, folder):
    """pyarrow reads the table, with the values of the CSV file that it was made from."""
    import pyarrow.parquet

    details, path = folder / "frames.csv", folder / "frames.parquet"
    run(program, "tag", sequence, "--details", details)
    run(program, "export", sequence, "--details", details, "--format", "parquet", "--out", path)
    rows = pyarrow.parquet.read_table(path).to_pylist()
    with open(details, newline="", encoding="utf-8") as file:
        expected = list(csv.DictReader(file))
    same = len(rows) == len(expected)
    for row, line in zip(rows, expected):
        for name, text in line.items():
            value = row[name]
            if text == "":
                same &= value is None
            elif isinstance(value, bool):
                same &= str(value).lower() == text
            else:
                same &= float(value) == float(text)
    check("pyarrow", same and all(row["image"] for row in rows), f"{len(rows)} rows")


def main():
    program, sequence = str(Path(sys.argv[1]).resolve()), Path(sys.argv[2]).resolve()
    with tempfile.TemporaryDirectory() as folder:
        folder = Path(folder)
        check_colmap(program, sequence, folder)
        check_tum(program, sequence, folder)
        check_mcap(program, sequence, folder)
        check_ros2(program, sequence, folder)
        check_parquet(program, sequence, folder)
    print("all is as it should be")


if __name__ == "__main__":
    main()
