"""Studies recordings from a shell: ``python -m reality_sim.studies RECORDING... --settings FILE --out FOLDER``."""

from __future__ import annotations

import argparse
import json
import multiprocessing
import os
import sys
from functools import partial
from pathlib import Path
from typing import Any

from .worker import StudyWorker

_worker: StudyWorker | None = None


def main() -> int:
    """Runs the program. Returns 1 where a recording could not be fetched, or a row not be written."""
    parser = argparse.ArgumentParser(prog="python -m reality_sim.studies", description=__doc__)
    parser.add_argument("recordings", nargs="+", metavar="RECORDING", help="folder of a recording, or its address for pyarrow")
    parser.add_argument("--settings", required=True, metavar="FILE", help="JSON: one dict, or a list of them")
    parser.add_argument("--out", required=True, metavar="FOLDER", help="folder of the tables; what is there is not done again")
    parser.add_argument("--processes", type=int, default=1, metavar="N", help="number of processes (default: 1)")
    parser.add_argument("--threads", type=int, metavar="N", help="threads of each process (default: its share of the cores)")
    arguments = parser.parse_args()
    try:
        settings = json.loads(Path(arguments.settings).read_text())
    except (OSError, ValueError) as error:
        print(f"error: {arguments.settings}: {error}: give a JSON file with settings", file=sys.stderr)
        return 1
    processes = max(1, min(arguments.processes, len(arguments.recordings)))
    threads = arguments.threads or max(1, len(os.sched_getaffinity(0)) // processes)
    start = partial(_start, settings, arguments.out, threads)
    if processes == 1:
        start()
        return _report(map(_study, arguments.recordings), len(arguments.recordings))
    # A forked process would have the locks, but not the threads, of this one.
    with multiprocessing.get_context("spawn").Pool(processes, start) as pool:
        return _report(pool.imap_unordered(_study, arguments.recordings), len(arguments.recordings))


def _start(settings: Any, out: str, threads: int) -> None:
    global _worker
    _worker = StudyWorker(settings, out, threads)


def _study(uri: str) -> dict[str, Any]:
    assert _worker is not None, "each process begins with one"
    try:
        return _worker.study_one(uri)
    except OSError as error:
        return {"uri": uri, "written": 0, "present": 0, "error": str(error)}


def _report(told: Any, count: int) -> int:
    failed = 0
    for number, one in enumerate(told, start=1):
        if one["error"]:
            failed += 1
            print(f"error: {one['uri']}: {one['error']}", file=sys.stderr)
        else:
            print(f"{number} of {count}: {one['uri']}: {one['written']} written, {one['present']} there already")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
