"""The program ``python -m reality_sim.studies``.

It is no part of ``__main__``: processes that begin anew could not import it from there.
"""

from __future__ import annotations

import argparse
import json
import multiprocessing
import os
import sys
from concurrent.futures import ProcessPoolExecutor, as_completed
from concurrent.futures.process import BrokenProcessPool
from functools import partial
from pathlib import Path
from typing import Any

from .worker import StudyWorker

_worker: StudyWorker | None = None


def main() -> int:
    """Runs the program. Returns 1 where a recording could not be fetched, a row not be written, or a process died."""
    parser = argparse.ArgumentParser(prog="python -m reality_sim.studies", description="Studies recordings, and writes tables.")
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
    threads = arguments.threads or max(1, _cores() // processes)
    start = partial(_start, settings, arguments.out, threads)
    if processes == 1:
        start()
        return _report(map(_study, arguments.recordings), len(arguments.recordings))
    # A forked process would have the locks, but not the threads, of this one.
    anew = multiprocessing.get_context("spawn")
    try:
        with ProcessPoolExecutor(processes, anew, start) as pool:
            jobs = [pool.submit(_study, one) for one in arguments.recordings]
            return _report((job.result() for job in as_completed(jobs)), len(jobs))
    except BrokenProcessPool:
        print("error: a process has died; what is written stays: call this again for the rest", file=sys.stderr)
        return 1


def _cores() -> int:
    """Returns how many cores this process may use, where the system tells."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def _start(settings: Any, out: str, threads: int) -> None:
    global _worker
    _worker = StudyWorker(settings, out, threads)


def _study(uri: str) -> dict[str, Any]:
    assert _worker is not None, "each process begins with one"
    return _worker.study_one(uri)


def _report(told: Any, count: int) -> int:
    failed = 0
    for number, one in enumerate(told, start=1):
        if one["error"]:
            failed += 1
            print(f"error: {one['uri']}: {one['error']}", file=sys.stderr)
        else:
            print(f"{number} of {count}: {one['uri']}: {one['written']} written, {one['present']} there already")
    return 1 if failed else 0

