"""Imports logs that other packages have written, and compares what comes out with the sequence that went in.

    python3 scripts/formats/check_import.py PROGRAM [SEQUENCE]
"""

import csv
import json
import math
import pathlib
import subprocess
import sys
import tempfile
import tomllib

import walk_logs

PROGRAM = sys.argv[1]
SEQUENCE = pathlib.Path(sys.argv[2] if len(sys.argv) > 2 else "assets/walk")


def run(*arguments):
    done = subprocess.run([PROGRAM, *map(str, arguments)], capture_output=True, text=True, check=False)
    if done.returncode != 0:
        raise SystemExit(f"{arguments}: {done.stderr}")
    return done.stdout


def table(folder):
    with open(folder / "frames.csv", newline="") as file:
        return [(row["image"], [float(row[name]) for name in row if name != "image"]) for row in csv.DictReader(file)]


def camera(folder):
    camera = tomllib.loads((folder / "camera.toml").read_text())
    camera.pop("photometry", None)
    return camera


def poses(file):
    lines = [line.split() for line in file.read_text().splitlines() if not line.startswith("#")]
    return [[float(field) for field in line] for line in lines]


def compare(folder, report):
    before, after = table(SEQUENCE), table(folder)
    assert report["frames"] == len(before) and report["unmatched"] == 0, report
    assert not report["salvaged"] and report["clock_jumps"] == 0, report
    for (old_name, old), (new_name, new) in zip(before, after, strict=True):
        assert all(math.isclose(a, b, abs_tol=1e-9) for a, b in zip(old, new, strict=True)), (old, new)
        assert (SEQUENCE / old_name).read_bytes() == (folder / new_name).read_bytes(), new_name
    assert camera(SEQUENCE) == camera(folder), camera(folder)


def tagged(folder, out):
    """Poses with the same start for both: an imported log has none."""
    start = tomllib.loads((SEQUENCE / "sequence.toml").read_text())["start"]
    start = f"{start['x_m']},{start['y_m']},{start['yaw_rad']}"
    run("tag", folder, "--start", start, "--out", out)
    return poses(out)


def largest_difference(a, b):
    return max(abs(x - y) for p, q in zip(a, b, strict=True) for x, y in zip(p, q, strict=True))


def main():
    walk = walk_logs.Walk(SEQUENCE)
    with tempfile.TemporaryDirectory() as name:
        scratch = pathlib.Path(name)
        logs = {}
        for compression, kind in walk_logs.COMPRESSIONS.items():
            logs[f"MCAP, {compression}"] = scratch / f"{compression}.mcap"
            walk_logs.write_mcap(walk, logs[f"MCAP, {compression}"], kind)
        for what, plugin, version in [
            ("db3 of Humble", walk_logs.StoragePlugin.SQLITE3, 8),
            ("db3 of Iron", walk_logs.StoragePlugin.SQLITE3, 9),
            ("rosbag2 with MCAP", walk_logs.StoragePlugin.MCAP, 9),
        ]:
            logs[what] = scratch / what.replace(" ", "_")
            walk_logs.write_bag(walk, logs[what], plugin, version)
        by_tf = walk_logs.Walk(SEQUENCE, by_tf=True)
        logs["MCAP with tf"] = scratch / "tf.mcap"
        walk_logs.write_mcap(by_tf, logs["MCAP with tf"], walk_logs.COMPRESSIONS["zstd"])
        logs["db3 with tf"] = scratch / "tf_bag"
        walk_logs.write_bag(by_tf, logs["db3 with tf"])
        height = ["--height-m", str(walk.camera["mount"]["height_m"])]
        expected = tagged(SEQUENCE, scratch / "expected.tum")
        for what, log in logs.items():
            folder = scratch / f"{log.name}.sequence"
            report = run("import", log, "--out", folder, "--field", SEQUENCE / "field.toml", "--json",
                         *([] if "tf" in what else height))
            compare(folder, json.loads(report))
            difference = largest_difference(expected, tagged(folder, scratch / "found.tum"))
            assert difference <= 1e-6, (what, difference)
            print(f"{what}: {len(expected)} frames as before, poses within {difference:.1e}")


main()
