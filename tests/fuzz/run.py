#!/usr/bin/env python3
"""Fuzz for a while, and tell what came of it.

    run.py [SECONDS [TARGET ...]]     SECONDS for each target, 60 without; all targets without a name

Builds the fuzz preset (clang) and its seeds. Each target goes on where it was left: what it has found lies in
build-fuzz/found/TARGET, and the figures of all runs so far in build-fuzz/found/totals.json. Prints them as a table, and what
the inputs reach of the front and of the scene. 1: a target crashed, hung or ran out of memory; its input lies in
build-fuzz/found.
"""
import fcntl
import json
import os
import re
import resource
import subprocess
import sys

SOURCE = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
BUILD = os.path.join(SOURCE, "build-fuzz")
FOUND = os.path.join(BUILD, "found")
TARGETS = ("front", "request", "session", "children", "client", "blob", "gltf", "obj", "image", "study")
PARTS = ("server/front", "server/scene", "server/loader")
FUNCTION = re.compile(r"COVERED_FUNC: hits: \d+ edges: (\d+)/(\d+) (\S+) (\S+?):\d+")


def build():
    programs = ["fuzz_" + target for target in TARGETS] + ["candil-loader", "candil-images", "candil_messages"]
    for command in (["cmake", "--preset", "fuzz"], ["cmake", "--build", BUILD, "--target", *programs],
                    ["ctest", "--test-dir", BUILD, "-R", "^fuzz_corpus$"]):
        subprocess.run(command, cwd=SOURCE, check=True, stdout=subprocess.DEVNULL)


def target_command(target, *options):
    """Its own inputs come first: new ones go there."""
    return [os.path.join(BUILD, "tests", "fuzz_" + target), *options, os.path.join(FOUND, target), os.path.join(BUILD, "tests", "corpus", target)]


def fuzz(target, seconds):
    """Processor seconds, runs and whether it went well."""
    os.makedirs(os.path.join(FOUND, target), exist_ok=True)
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    log = os.path.join(FOUND, target + ".log")
    with open(log, "wb") as out:
        code = subprocess.run(target_command(target, f"-max_total_time={seconds}", "-timeout=60", "-rss_limit_mb=6144", "-print_final_stats=1",
                                             f"-artifact_prefix={FOUND}/{target}-"), stdout=out, stderr=out, check=False).returncode
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    with open(log, errors="replace") as f:
        runs = re.findall(r"stat::number_of_executed_units: (\d+)", f.read())
    if code:
        print(f"{target}: failed, see {log}", file=sys.stderr)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime, int(runs[-1]) if runs else 0, code == 0


def add_to_totals(target, processor, runs):
    """Another run.py may do so meanwhile."""
    with open(os.path.join(FOUND, "totals.json"), "a+") as f:
        fcntl.flock(f, fcntl.LOCK_EX)
        f.seek(0)
        totals = json.loads(f.read() or "{}")
        old = totals.get(target, [0, 0])
        totals[target] = [old[0] + processor, old[1] + runs]
        f.truncate(0)
        json.dump(totals, f)
    return totals


def coverage(target):
    """The edges of each function of ours: {(file, name): (reached, all)}."""
    done = subprocess.run(target_command(target, "-runs=0", "-print_coverage=1"), capture_output=True, check=False)
    functions = {}
    for reached, edges, name, path in FUNCTION.findall((done.stdout + done.stderr).decode(errors="replace")):
        functions[os.path.relpath(os.path.realpath(path), SOURCE), name] = (int(reached), int(edges))
    return functions


def tell_coverage():
    """Of a function that several targets reach, the one that reaches most counts: together they reach no less."""
    best = {}
    for target in TARGETS:
        for function, (reached, edges) in coverage(target).items():
            best[function] = max(best.get(function, (0, edges)), (reached, edges))
    print("\n| part | functions reached | edges reached |\n| --- | --- | --- |")
    for part in PARTS:
        ours = [counts for (path, _), counts in best.items() if path.startswith(part + "/")]
        called, reached, edges = sum(r > 0 for r, _ in ours), sum(r for r, _ in ours), sum(e for _, e in ours)
        print(f"| `{part}` | {called} of {len(ours)} | {reached} of {edges}, {100 * reached / max(edges, 1):.0f} % |")


def main():
    seconds = int(sys.argv[1]) if len(sys.argv) > 1 else 60
    wanted = sys.argv[2:] or TARGETS
    if not set(wanted) <= set(TARGETS):
        sys.exit(__doc__)
    os.nice(19)
    os.environ["UBSAN_OPTIONS"] = "print_stacktrace=1"
    build()
    good = True
    for target in wanted:
        processor, runs, well = fuzz(target, seconds)
        totals = add_to_totals(target, processor, runs)
        good &= well
    print("| target | processor min | runs | inputs kept |\n| --- | --- | --- | --- |")
    for target, (processor, runs) in totals.items():
        print(f"| `fuzz_{target}` | {processor / 60:.1f} | {runs} | {len(os.listdir(os.path.join(FOUND, target)))} |")
    print(f"| all | {sum(t[0] for t in totals.values()) / 60:.1f} | {sum(t[1] for t in totals.values())} | |")
    tell_coverage()
    return 0 if good else 1


if __name__ == "__main__":
    sys.exit(main())
