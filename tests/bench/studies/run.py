#!/usr/bin/env python3
"""Render an experiment of a thesis, and print its table with the thesis's figures beside ours.

    run.py PLAN -o FOLDER [--short] [--scene NAME=FILE]... [--connect ADDR]

PLAN is a file of this folder; its README says what is in it. FOLDER gets a study for each scene and size; started again, what is
there is not rendered again. CANDIL_BUILD is the folder `build` of the current one if it is not set."""
import argparse
import contextlib
import importlib
import json
import os
import statistics
import subprocess
import sys

sys.path.insert(0, os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
import bench  # it finds the build and the tests' modules

import gallery
from render import Daemon

CANDIL = os.path.join(bench.BUILD, "bin", "candil")
BUILD_STAGES = ("voxelise", "voxel-light", "pyramid", "voxel-gather")


def shorten(plan, experiment):
    """The plan for small pictures, as "short" of the experiment has it."""
    short = experiment.get("short", {})
    for key in ("size", "seeds", "repeats"):
        plan[key] = short.get(key, plan.get(key))
    for key in ("scenes", "sizes"):
        experiment[key] = short.get(key, experiment.get(key))
    if plan.get("reference") and "relmse" in short:
        plan["reference"]["relmse"] = short["relmse"]
    for point in plan["points"]:
        settings = point["settings"]
        for key, values in short.get("drop", {}).items():
            if isinstance(settings.get(key), list):
                settings[key] = [value for value in settings[key] if value not in values]
        settings.update({key: value for key, value in short.get("set", {}).items() if key in settings})
    return {key: value for key, value in plan.items() if value is not None}


def scene_of(name, folder, own):
    """(what the table calls it, its file, options) of "gallery cube"."""
    if name in own:
        return os.path.basename(own[name]), own[name], []
    module, function = name.split()
    made = getattr(importlib.import_module(module), function)(folder)
    return name, made, gallery.arguments(function) if module == "gallery" else []


def stage_ms(line, name):
    names = BUILD_STAGES if name == "build" else (name,)
    return sum(stage["us"] for stage in line["report"]["stages"] if stage["name"] in names) / 1e3


def number(value):
    return "%.0f" % value if value >= 1000 else "%.3g" % value


def megabytes(line):
    figures = [figure["value"] for figure in line["report"]["figures"] if figure["name"] == "bytes.all"]
    return (figures[0] if figures else line["report"]["job_bytes"]) / 2 ** 20


def value_of(column, lines, cold, relmse, from_cold):
    """One cell: the median of a point's warm runs; of what is made once, of its cold run. The error is the report's."""
    if column == "relmse":
        return relmse
    if column == "ms":
        return number(statistics.median(line["report"]["elapsed_us"] / 1e3 for line in lines))
    if column == "MB":
        return number(megabytes(lines[0]))
    return number(statistics.median(stage_ms(line, column) for line in (cold if column in from_cold and cold else lines)))


def rows_of(folder, scene, size, experiment):
    """{("make cornell", "256"): {"ms": "12.3", …}} of a study's folder."""
    with open(os.path.join(folder, "runs.jsonl"), encoding="utf-8") as file:
        lines = [json.loads(line) for line in file]
    def name_of(settings):
        settings = dict(settings, scene=scene, size=size)
        return tuple(str(settings.get(row, "")) for row in experiment["rows"])

    groups, colds = {}, {}
    for line in lines:
        if line["failed"] or line["kind"] == "reference":
            continue
        (colds if line["kind"] == "cold" else groups).setdefault(name_of(line["settings"]), []).append(line)
    # The reference's own error is off there.
    errors = {}
    if os.path.exists(os.path.join(folder, "results.json")):
        with open(os.path.join(folder, "results.json"), encoding="utf-8") as file:
            for point in (point for technique in json.load(file)["techniques"] for point in technique["points"]):
                if point["relmse"] is not None:
                    errors[name_of(point["settings"])] = "%.2e%s" % (point["relmse"], "" if point["resolved"] else " *")
    return {name: {column: value_of(column, group, colds.get(name), errors.get(name, "–"), experiment.get("cold", ()))
                   for column in experiment["columns"]} for name, group in groups.items()}


def figures_there(theirs, name):
    """Others' figures of a row: by all of its words, or, where they have but one scene, by those behind the scene."""
    return theirs.get(" ".join(filter(None, name))) or theirs.get(" ".join(filter(None, name[1:])), {})


def study(plan_file, scene, size, arguments, folder, address):
    command = [CANDIL, "--connect", address, "study", scene, "-o", folder, "--plan", plan_file, "--size", size, *arguments]
    done = subprocess.run(command, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, check=False)
    if done.returncode != 0:
        sys.stderr.write(done.stdout.decode())
    return done.returncode


def order(name):
    """Numbers by what they are, sizes by their width, words by their letters."""
    heads = [word.split("x")[0] if word[:1].isdigit() else word for word in name]
    return [(0, float(word), "") if word.replace(".", "", 1).isdigit() else (1, 0, word) for word in heads]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("plan")
    parser.add_argument("-o", "--output", required=True)
    parser.add_argument("--short", action="store_true")
    parser.add_argument("--scene", action="append", default=[])
    parser.add_argument("--connect")
    options = parser.parse_args()
    with open(options.plan, encoding="utf-8") as file:
        plan = json.load(file)
    experiment = plan.pop("experiment")
    if options.short:
        plan = shorten(plan, experiment)
    own = dict(pair.split("=", 1) for pair in options.scene)
    scenes = os.path.join(options.output, "scenes")
    os.makedirs(scenes, exist_ok=True)
    plan_file = os.path.join(options.output, os.path.basename(options.plan))
    with open(plan_file, "w", encoding="utf-8") as file:
        json.dump(plan, file, indent=1)
    found, status = {}, 0
    with contextlib.ExitStack() as stack:
        address = options.connect or stack.enter_context(Daemon()).socket
        for named in experiment["scenes"]:
            for width, height in experiment.get("sizes") or [plan["size"]]:
                size = f"{width}x{height}"
                scene, path, arguments = scene_of(named, scenes, own)
                folder = os.path.join(options.output, f"{named.replace(' ', '-')}-{size}")
                status = max(status, study(plan_file, path, size, arguments, folder, address))
                if os.path.exists(os.path.join(folder, "runs.jsonl")):
                    found.update(rows_of(folder, scene, size, experiment))
                    with open(os.path.join(folder, "study.json"), encoding="utf-8") as file:
                        device = json.load(file)["device"]
    bench.header(device)
    print(f"Beside: {experiment['source']}.\n")
    theirs = experiment["theirs"]
    told = {column for row in theirs.values() for column in row}
    others = [c for c in experiment["columns"] if c in told] + sorted(told - set(experiment["columns"]))
    bench.table([*experiment["rows"], *(">" + c for c in experiment["columns"]), *(f">{c} there" for c in others)],
                [[*name, *(row[c] for c in experiment["columns"]), *(figures_there(theirs, name).get(c, "") for c in others)]
                 for name, row in sorted(found.items(), key=lambda item: order(item[0]))])
    if any(str(row.get("relmse", "")).endswith("*") for row in found.values()):
        print("\n\\* within the reference's own error.")
    return status


if __name__ == "__main__":
    sys.exit(main())
