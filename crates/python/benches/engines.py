"""Studies of 200 recordings with 4 settings: by Ray Data against a plain loop over two processes, and with everything killed.

    python crates/python/benches/engines.py [rate|killed] [--recordings 200] [--work FOLDER]

``rate`` prints studies a second from the first to the last table, and the whole time with the start of the engine. ``killed`` kills a
worker every 20 seconds until everything is done, and the driver twice, and compares the table with that of an undisturbed loop. The
recordings are pieces of the demonstration walk.
"""

from __future__ import annotations

import argparse
import contextlib
import json
import os
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import pyarrow as pa
from pyarrow import parquet

from reality_sim import studies

WALK = Path(__file__).parents[3] / "assets" / "walk"
PICTURES = 6
SETTINGS = [{"job": "tag", "seed": seed} for seed in range(2)] + [{"job": "tag", "observation": "distance", "seed": seed} for seed in range(2)]
KILL_EVERY_S = 20.0
DRIVER_KILLS = 2


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("what", choices=["rate", "killed", "drive"], nargs="?", default="rate")
    parser.add_argument("--recordings", type=int, default=200)
    parser.add_argument("--work", type=Path)
    parser.add_argument("--tables")
    arguments = parser.parse_args()
    work = arguments.work or Path(tempfile.mkdtemp())
    recordings = [recording(work / "recordings" / f"{number:04}", number) for number in range(arguments.recordings)]
    if arguments.what == "drive":
        drive(recordings, arguments.tables)
        return 0
    settings = work / "settings.json"
    settings.write_text(json.dumps(SETTINGS))
    by_loop = [sys.executable, "-m", "reality_sim.studies", *map(str, recordings), "--settings", str(settings), "--processes", "2", "--out"]
    by_ray = [sys.executable, __file__, "drive", "--recordings", str(len(recordings)), "--work", str(work), "--tables"]
    if arguments.what == "rate":
        loop, engine = rate("loop", by_loop, work / "rate_loop"), rate("Ray Data", by_ray, work / "rate_ray")
        print(f"Ray Data / loop: {engine / loop:.3f}")
        same = table_bytes(work / "rate_loop") == table_bytes(work / "rate_ray")
    else:
        run([*by_loop, str(work / "undisturbed")])
        disturbed([*by_ray, str(work / "disturbed")], work / "disturbed", len(recordings) * len(SETTINGS))
        same = table_bytes(work / "undisturbed") == table_bytes(work / "disturbed")
    print("the tables are the same, byte for byte" if same else "the tables DIFFER")
    return 0 if same else 1


def recording(folder: Path, number: int) -> Path:
    """Makes a recording of some pictures of the walk, if it is not there; its number makes it different from all others."""
    if folder.exists():
        return folder
    header, *rows = (WALK / "frames.csv").read_text().splitlines()
    first = number % (len(rows) - PICTURES)
    making = folder.with_name(f".{folder.name}")
    (making / "images").mkdir(parents=True)
    for name in ("camera.toml", "field.toml", "groundtruth.tum"):
        shutil.copy(WALK / name, making)
    text = (WALK / "sequence.toml").read_text()
    # The start is that of the whole walk.
    (making / "sequence.toml").write_text(text[: text.index("[start]")] + f'robot = "number {number}"\n')
    rows = rows[first : first + PICTURES]
    (making / "frames.csv").write_text("\n".join([header, *rows]) + "\n")
    for row in rows:
        picture = row.split(",")[1]
        shutil.copy(WALK / picture, making / picture)
    making.rename(folder)
    return folder


def drive(recordings: list[Path], tables: str) -> None:
    """Runs all studies by Ray Data, as docs/scale.md does."""
    import ray

    ray.init(num_cpus=2, include_dashboard=False, log_to_driver=False)
    uris = ray.data.from_items([{"uri": str(one)} for one in recordings], override_num_blocks=len(recordings))
    told = uris.map_batches(
        studies.StudyWorker,
        fn_constructor_kwargs={"settings": SETTINGS, "tables": tables, "threads": 1},
        batch_size=1,
        batch_format="pyarrow",
        num_cpus=1,
        concurrency=2,
        max_restarts=-1,
        max_task_retries=-1,
    )
    failed = [one for one in told.take_all() if one["error"]]
    assert not failed, failed


def rate(name: str, command: list[str], tables: Path) -> float:
    """Runs a command that writes tables, and returns how many it writes in a second from the first to the last."""
    shutil.rmtree(tables, ignore_errors=True)
    start = time.time()
    run([*command, str(tables)])
    whole_s = time.time() - start
    written = sorted(file.stat().st_mtime for file in tables.glob("*.parquet"))
    found = (len(written) - 1) / (written[-1] - written[0])
    print(f"{name}: {len(written)} studies, {found:.2f} a second; {whole_s:.1f} s with its start and end", flush=True)
    return found


def run(command: list[str]) -> None:
    done = subprocess.run(command, capture_output=True, text=True)
    if done.returncode:
        raise SystemExit(f"{command[:4]}: {done.stdout[-2000:]}\n{done.stderr[-4000:]}")


def disturbed(command: list[str], tables: Path, count: int) -> None:
    """Runs the driver again and again until it ends, and kills its workers, and itself twice: with a third and with two thirds done."""
    shutil.rmtree(tables, ignore_errors=True)
    driver_kills = worker_kills = starts = 0
    while True:
        starts += 1
        driver = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, start_new_session=True)
        next_kill = time.monotonic() + KILL_EVERY_S
        while driver.poll() is None:
            time.sleep(0.2)
            done = len(list(tables.glob("*.parquet")))
            if driver_kills < DRIVER_KILLS and done >= count * (driver_kills + 1) // (DRIVER_KILLS + 1):
                driver_kills += 1
                os.killpg(driver.pid, signal.SIGKILL)
                driver.wait()
                print(f"the driver is killed at {done} of {count}", flush=True)
            elif time.monotonic() >= next_kill and (workers := actors()):
                next_kill = time.monotonic() + KILL_EVERY_S
                worker_kills += 1
                os.kill(workers[worker_kills % len(workers)], signal.SIGKILL)
                print(f"a worker is killed at {done} of {count}", flush=True)
        subprocess.run(["ray", "stop", "--force"], capture_output=True, env={**os.environ, "PATH": f"{Path(sys.executable).parent}:{os.environ['PATH']}"})
        if driver.returncode == 0:
            print(f"{starts} starts, {driver_kills} drivers and {worker_kills} workers killed")
            return
        if starts > DRIVER_KILLS + 5:
            raise SystemExit(f"the driver fails without being killed: {driver.returncode}")


def actors() -> list[int]:
    """Returns the processes of Ray's actors that study."""
    found = []
    for process in Path("/proc").iterdir():
        with contextlib.suppress(OSError):
            if process.name.isdigit() and b"StudyWorker" in (process / "cmdline").read_bytes().split(b"\0")[0] and b"ray::" in (process / "cmdline").read_bytes():
                found.append(int(process.name))
    return sorted(found)


def table_bytes(tables: Path) -> bytes:
    sink = pa.BufferOutputStream()
    parquet.write_table(studies.read_tables(str(tables)), sink)
    return sink.getvalue().to_pybytes()


if __name__ == "__main__":
    sys.exit(main())
