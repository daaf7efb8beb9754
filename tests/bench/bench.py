"""What the benchmark programs in Python share. Import it before anything else of ours: it finds the build and the tests' modules.

    CANDIL_BUILD=build /usr/bin/python3 tests/bench/bench_….py [OPTIONS]

CANDIL_BUILD is the folder `build` in the current one if it is not set; CANDIL_SCENES may name a folder of public scenes."""
import datetime
import os
import statistics
import sys
import time

SOURCE = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
os.environ.setdefault("CANDIL_BUILD", os.path.abspath("build"))
os.environ.setdefault("CANDIL_SOURCE", SOURCE)
BUILD = os.environ["CANDIL_BUILD"]
sys.path[:0] = [os.path.join(SOURCE, "tests", part) for part in ("support", "scenes")] + [os.path.join(BUILD, "protocol")]


def header(device):
    """What figures are worth nothing without."""
    load = os.getloadavg()[0]
    print(f"{device}, {os.cpu_count()} processors, {datetime.date.today()}, load before {load:.1f}\n", flush=True)


def table(columns, rows):
    """A Markdown table; a column that begins with '>' is flush right."""
    print("| " + " | ".join(column.lstrip(">") for column in columns) + " |")
    print("| " + " | ".join("---:" if column.startswith(">") else "---" for column in columns) + " |")
    for row in rows:
        print("| " + " | ".join(str(cell) for cell in row) + " |", flush=True)
    print()


def timed(call, *arguments, **keywords):
    """(seconds, result)"""
    start = time.monotonic()
    result = call(*arguments, **keywords)
    return time.monotonic() - start, result


def median(values):
    return statistics.median(values)


def percentile(values, part):
    """The smallest value that at least this part of them does not pass."""
    ordered = sorted(values)
    return ordered[min(len(ordered) - 1, int(len(ordered) * part))]
