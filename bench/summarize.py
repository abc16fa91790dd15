"""Writes the results of a run of the benchmarks, bench/results.json, to standard output.

    summarize.py BENCH.json SPLINECAST_BENCH

BENCH.json is what `splinecast_bench --blocks=N --out=BENCH.json` has written. SPLINECAST_BENCH is that program:
valgrind counts its instructions. The results are an object:

    date       day of the run in UTC, YYYY-MM-DD
    version    version of splinecast
    commit     commit of the checkout, with -dirty if files are changed
    machine    object of cpu, cores, is_virtual, caches (list of level, type, bytes), kernel, compiler, and load: the
               load average at the end of the run
    blocks     number of blocks
    runs       number of runs of a benchmark
    cut_short  number of runs that are left out, because they measured too little CPU time
    rows       object: name of a benchmark, and an object of its measured values. A value is a list of median, least
               value, largest value and number of blocks.
    ratios     object: name of a target of targets.py, and the same kind of list of its ratios
    profile    object: benchmark of a path of profile_paths.py, and an object of purpose and instructions per call
"""

import datetime
import json
import platform
import re
import statistics
import subprocess
import sys
from collections import defaultdict
from pathlib import Path

import profile_paths
from targets import TARGETS

PROJECT = Path(__file__).resolve().parent.parent

# Google Benchmark ends a run early if other programs use the processor; a run with less CPU time than this measured
# only cold caches.
LEAST_MEASURED_NS = 1e6

# A run with one of these keys measured something other than its own CPU time.
OTHER_MEASURES = {"p50_ns", "core_percent", "region_bytes"}

# Keys of a run that are not measured values of its row.
NOT_VALUES = {"name", "group", "block", "iterations", "real_ns", "cpu_ns", "times"}


def read_runs(document):
    """Returns name → runs by group and block, and the number of runs that were cut short, which are left out. `ns`
    of a run is p50 if it measured single trips, else its CPU time per operation (for `sample_many` per sampled time).
    """
    runs = defaultdict(dict)
    cut_short = 0
    for run in document["runs"]:
        if not OTHER_MEASURES & run.keys() and run["iterations"] * run["cpu_ns"] < LEAST_MEASURED_NS:
            cut_short += 1
            continue
        name = run["name"].replace("/iterations:1", "").replace("/iterations:3", "").replace("/manual_time", "")
        run["ns"] = run.get("p50_ns", run["cpu_ns"] / run.get("times", 1))
        runs[name][run["group"], run["block"]] = run
    return runs, cut_short


def spread(values):
    """Median, least value, largest value and number."""
    rounded = (float(f"{value:.9g}") for value in (statistics.median(values), min(values), max(values)))
    return [*rounded, len(values)]


def rows_of(runs):
    rows = {}
    for name, blocks in sorted(runs.items()):
        values = defaultdict(list)
        for _, run in sorted(blocks.items()):
            for key in run.keys() - NOT_VALUES:
                values[key].append(run[key])
        rows[name] = {key: spread(values[key]) for key in sorted(values)}
    return rows


def ratios_of(runs):
    found = {target.name: target.ratios(runs) for target in TARGETS}
    return {name: spread(ratios) for name, ratios in found.items() if ratios}


def output_of(*command):
    return subprocess.run(command, capture_output=True, text=True, check=False).stdout.strip()


def machine_of(document):
    """The machine of the run, which is also the one that runs this program."""
    with open("/proc/cpuinfo", encoding="utf-8") as info:
        text = info.read()
    model = re.search(r"^model name\s*:\s*(.*)$", text, re.M)
    machine = document["machine"]
    return {"cpu": model[1] if model else platform.processor(), "cores": machine["cores"],
            "is_virtual": "hypervisor" in text, "caches": machine["caches"],
            "kernel": f"{platform.system()} {platform.release()}",
            "compiler": f"g++ {output_of('g++', '-dumpfullversion')}",
            "load": round(machine["load"][0], 1) if machine["load"] else 0}


def version():
    return re.search(r"project\(splinecast VERSION (\S+)", (PROJECT / "CMakeLists.txt").read_text(encoding="utf-8"))[1]


def summary_of(document, profile):
    runs, cut_short = read_runs(document)
    return {"date": datetime.datetime.now(datetime.timezone.utc).strftime("%Y-%m-%d"),
            "version": version(),
            "commit": output_of("git", "-C", str(PROJECT), "describe", "--always", "--dirty", "--abbrev=12"),
            "machine": machine_of(document), "blocks": document["blocks"], "runs": len(document["runs"]),
            "cut_short": cut_short, "rows": rows_of(runs), "ratios": ratios_of(runs), "profile": profile}


def text_of(summary):
    """JSON with a line for each row, ratio and path."""
    lines = []
    for key, value in summary.items():
        if key in ("rows", "ratios", "profile"):
            inner = ",\n".join(f"  {json.dumps(name)}: {json.dumps(one, ensure_ascii=False)}"
                               for name, one in value.items())
            lines.append(f' "{key}": {{\n{inner}\n }}')
        else:
            lines.append(f' "{key}": {json.dumps(value, ensure_ascii=False)}')
    return "{\n" + ",\n".join(lines) + "\n}\n"


def main(bench, program):
    with open(bench, encoding="utf-8") as file:
        document = json.load(file)
    sys.stdout.write(text_of(summary_of(document, profile_paths.count_all(program))))


if __name__ == "__main__":
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    main(*sys.argv[1:])
