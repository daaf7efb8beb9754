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
COVERAGE = os.path.join(SOURCE, "build-coverage")
FOUND = os.path.join(BUILD, "found")
TARGETS = ("front", "request", "session", "children", "quotes", "client", "blob", "gltf", "obj", "patches", "image", "study")
PARTS = ("server/front", "server/scene", "server/loader")


def build():
    programs = ["fuzz_" + target for target in TARGETS] + ["candil-loader", "candil-images", "candil_messages"]
    for command in (["cmake", "--preset", "fuzz"], ["cmake", "--build", BUILD, "--target", *programs],
                    ["ctest", "--test-dir", BUILD, "-R", "^fuzz_corpus$"]):
        subprocess.run(command, cwd=SOURCE, check=True, stdout=subprocess.DEVNULL)


def target_command(build_folder, target, *options):
    """What was found comes first: new inputs go there."""
    return [os.path.join(build_folder, "tests", "fuzz_" + target), *options, os.path.join(FOUND, target), os.path.join(BUILD, "tests", "corpus", target)]


def fuzz(target, seconds):
    """Processor seconds, runs and whether it went well."""
    os.makedirs(os.path.join(FOUND, target), exist_ok=True)
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    log = os.path.join(FOUND, target + ".log")
    with open(log, "wb") as out:
        code = subprocess.run(target_command(BUILD, target, f"-max_total_time={seconds}", "-timeout=300", "-rss_limit_mb=6144", "-print_final_stats=1",
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


def tell_coverage():
    """Of the lines that were compiled into the targets, those that seeds and found inputs reach, without sanitizers."""
    flags = "-O1 -fprofile-instr-generate -fcoverage-mapping"
    subprocess.run(["cmake", "-S", SOURCE, "-B", COVERAGE, "-G", "Ninja", "-DCMAKE_BUILD_TYPE=Debug", "-DCMAKE_C_COMPILER=clang",
                    "-DCMAKE_CXX_COMPILER=clang++", "-DCMAKE_C_FLAGS=" + flags, "-DCMAKE_CXX_FLAGS=" + flags], check=True, stdout=subprocess.DEVNULL)
    programs = ["fuzz_" + target for target in TARGETS]
    subprocess.run(["cmake", "--build", COVERAGE, "--target", *programs], check=True, stdout=subprocess.DEVNULL)
    profiles = []
    for target in TARGETS:
        profiles.append(os.path.join(COVERAGE, target + ".profraw"))
        subprocess.run(target_command(COVERAGE, target, "-runs=0"), env={**os.environ, "LLVM_PROFILE_FILE": profiles[-1]}, check=True,
                       stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    merged = os.path.join(COVERAGE, "all.profdata")
    subprocess.run(["llvm-profdata", "merge", "-o", merged, *profiles], check=True)
    objects = [os.path.join(COVERAGE, "tests", program) for program in programs]
    told = subprocess.run(["llvm-cov", "export", "-summary-only", "-instr-profile=" + merged, *["-object=" + o for o in objects[1:]], objects[0]],
                          check=True, capture_output=True).stdout
    files = {os.path.relpath(f["filename"], SOURCE): f["summary"] for f in json.loads(told)["data"][0]["files"]}
    print("\n| part | functions reached | lines reached |\n| --- | --- | --- |")
    for part in PARTS:
        ours = [summary for path, summary in files.items() if path.startswith(part + "/")]
        sums = {kind: [sum(s[kind][key] for s in ours) for key in ("covered", "count")] for kind in ("functions", "lines")}
        print(f"| `{part}` | " + " | ".join(f"{reached} of {count}, {100 * reached / max(count, 1):.0f} %" for reached, count in sums.values()) + " |")


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
