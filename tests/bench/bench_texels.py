#!/usr/bin/env python3
"""Lamps with emissive textures by two builds, side by side: the error of a picture and the time that tracing takes, the least of some turns.

    /usr/bin/python3 tests/bench/bench_texels.py --old BUILD --new BUILD

A panel of 1 m, 1 m over a floor of which a square metre is seen, 32 x 32 pixels, 256 samples, pt.depth 1: with one bright texel of
256, with smooth waves, and without a texture. Errors are relative RMSE against 16,384 samples of the new build. `equal time` is the old
error over the new one times the root of their times' ratio, that is how many times less error the same time leaves."""
import argparse
import os
import statistics
import sys

HERE = os.path.dirname(os.path.abspath(__file__))
parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
parser.add_argument("--old", required=True)
parser.add_argument("--new", required=True)
parser.add_argument("--turns", type=int, default=7)
arguments = parser.parse_args()
os.environ.setdefault("CANDIL_BUILD", os.path.abspath(arguments.new))
os.environ.setdefault("CANDIL_SOURCE", os.path.join(HERE, "..", ".."))
sys.path += [os.path.join(HERE, "..", folder) for folder in ("support", "scenes", "furnace")]

import numpy
import test_texels
from render import Daemon
from writers import Gltf

WAVES = (128 + 127 * numpy.sin(numpy.arange(64) / 64 * 2 * numpy.pi)[None, :] * numpy.sin(numpy.arange(64) / 64 * 4 * numpy.pi)[:, None]).astype(numpy.uint8)
PANELS = {"one bright texel of 256": (test_texels.one_bright(16, 5, 11), test_texels.NEAREST), "smooth waves": (WAVES, test_texels.LINEAR), "no texture": None}


def scene_of(folder, name):
    g = Gltf()
    test_texels.floor(g)
    values, filtered = PANELS[name] or (numpy.full((1, 1), 255, numpy.uint8), test_texels.NEAREST)
    test_texels.panel(g, values, filtered)
    if PANELS[name] is None:
        del g.json["materials"][-1]["emissiveTexture"]
    return g.save(folder, name.replace(" ", "_") + ".gltf")


def render(daemon, scene, spp, seed=0):
    picture = daemon.render(scene, (32, 32), spp, (0, 0.5, 0, 0, 0, 0, 0, 0, -1, 40), {"pt.depth": 1}, ["--orthographic", "1", "--seed", str(seed)])
    stages = {s["name"]: s["us"] for s in picture.report["stages"]}
    return picture.radiance[:, :, 1].astype(float), stages["trace"]


with Daemon(build=arguments.old) as old, Daemon(build=arguments.new) as new:
    print("| panel | error before | after | time, after / before | equal time |\n| --- | ---: | ---: | ---: | ---: |")
    for name in PANELS:
        scene = scene_of(new.folder, name)
        reference, _ = render(new, scene, 16384, 1)
        errors, times = ([], []), ([], [])
        render(old, scene, 2), render(new, scene, 2)
        for turn in range(arguments.turns):
            for daemon, found, took in zip((old, new), errors, times):
                picture, us = render(daemon, scene, 256, turn + 2)
                found.append(numpy.sqrt(((picture - reference) ** 2).mean()) / reference.mean())
                took.append(us)
        before, after, ratio = statistics.mean(errors[0]), statistics.mean(errors[1]), min(times[1]) / min(times[0])
        print(f"| {name} | {100 * before:.2f} % | {100 * after:.2f} % | {ratio:.2f} | {before / after / ratio ** 0.5:.2f} × |", flush=True)
