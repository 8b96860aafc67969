"""Writes the table of criterion's results in a folder, with the names of processor, adapter and driver.

    python3 scripts/benchmark_table.py FOLDER > TABLE

FOLDER is what criterion wrote (CRITERION_HOME), and holds adapters.json, the answer of `reality-sim doctor --json`.
"""

import json
import os
import pathlib
import sys

# Published by Beluga for its likelihood field with 100 beams a particle, on one thread of an Intel i9-9900 and with all of its 16: median
# latencies of 0.17 s and 75 ms for 200,000 particles, read off the plot, within 20 %. Its repository,
# beluga_benchmark/docs/reports/2023-09-02/likelihood_beluga_vs_beluga_vs_amcl.png, commit 947326f.
BELUGA = [
    ("Beluga, likelihood field, one thread of an Intel i9-9900 (published)", 200_000 * 100 / 0.17),
    ("Beluga, likelihood field, 16 threads of an Intel i9-9900 (published)", 200_000 * 100 / 0.075),
]
# Groups that look samples up in a picture, and how many of these a sample of each model takes.
LOOKUPS = {"gauss": 1, "distance": 1, "contrast": 3}


class Result:
    """Benchmark with its median time."""

    def __init__(self, folder):
        benchmark = json.loads((folder / "benchmark.json").read_text())
        median = json.loads((folder / "estimates.json").read_text())["median"]
        self.group = benchmark["group_id"]
        self.name = "/".join(part for part in (benchmark["function_id"], benchmark["value_str"]) if part)
        self.seconds = median["point_estimate"] / 1e9
        bounds = median["confidence_interval"]
        self.low, self.high = bounds["lower_bound"] / 1e9, bounds["upper_bound"] / 1e9
        throughput = benchmark["throughput"] or {}
        self.elements = next((count for count in throughput.values() if isinstance(count, int)), None)

    def per_second(self):
        return self.elements / self.seconds if self.elements else None


def shown(seconds):
    """Returns a time with three digits and its unit."""
    for factor, unit in ((1, "s"), (1e3, "ms"), (1e6, "µs")):
        if seconds * factor >= 1:
            return f"{seconds * factor:.3g} {unit}"
    return f"{seconds * 1e9:.3g} ns"


def counted(number):
    """Returns a number with three digits, in words where it is large."""
    number = float(f"{number:.3g}")
    for unit, word in ((1e9, " billion"), (1e6, " million"), (1e3, " thousand"), (1, "")):
        if number >= unit:
            return f"{number / unit:.3g}{word}"
    return f"{number:.2g}"


def processor():
    """Returns the processor's name and its number of cores."""
    name = "an unknown processor"
    try:
        lines = pathlib.Path("/proc/cpuinfo").read_text().splitlines()
        name = next(line.split(":", 1)[1].strip() for line in lines if line.startswith("model name"))
    except (OSError, StopIteration):
        pass
    return f"{name}, {os.cpu_count()} cores"


def adapter(folder):
    """Returns the names of the best adapter and of its driver."""
    try:
        adapters = json.loads((folder / "adapters.json").read_text())["adapters"]
    except (OSError, ValueError, KeyError):
        adapters = []
    if not adapters:
        return "none"
    best = adapters[0]
    words = [str(best[key]) for key in ("name", "driver", "backend") if best.get(key)]
    return ", ".join(words)


def main():
    folder = pathlib.Path(sys.argv[1])
    results = sorted(
        (Result(path.parent) for path in folder.rglob("new/benchmark.json")), key=lambda one: (one.group, one.name)
    )
    if not results:
        sys.exit(f"{folder}: holds no results of criterion")
    print("# Benchmarks\n")
    print("Made by `bash scripts/benchmarks`. Medians; in brackets the interval of 95 % of the median.\n")
    print(f"| processor | {processor()} |\n|---|---|\n| graphics adapter | {adapter(folder)} |\n")
    on_processor = {one.group: one.seconds for one in results if one.name.split("/")[0] == "cpu"}
    print("| stage | what | time | a second | against the processor |\n|---|---|---|---|---|")
    for one in results:
        rate = one.per_second()
        ratio = ""
        if one.group in on_processor and one.name.split("/")[0] != "cpu":
            ratio = f"{on_processor[one.group] / one.seconds:.2g} times as fast"
        print(
            f"| {one.group} | {one.name} | {shown(one.seconds)} ({shown(one.low)} to {shown(one.high)}) "
            f"| {counted(rate) if rate else ''} | {ratio} |"
        )
    scored = [
        (f"{one.group}, {one.name}", LOOKUPS.get(one.name, 1) * one.per_second())
        for one in results
        if one.group == "scoring" or one.group.startswith("one_iteration")
    ]
    if scored:
        print("\n## Look-ups a second: particles × samples\n\n| what | look-ups a second |\n|---|---|")
        for name, rate in scored + BELUGA:
            print(f"| {name} | {counted(rate)} |")


if __name__ == "__main__":
    main()
