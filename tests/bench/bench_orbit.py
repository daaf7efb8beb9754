"""An orbit by one `candil sweep` beside as many runs of `candil render`, each with a private daemon of its own, for the same
cameras. The sweep runs before and after the single ones, with a private daemon, too. Every picture of the one is compared with
that of the other."""
import argparse
import json
import os
import subprocess
import sys
import tempfile

import bench
import make
import numpy
from render import CANDIL, Picture


def candil(folder, *arguments):
    # Nobody's daemon is found there, so that each call starts its own.
    environment = dict(os.environ, XDG_RUNTIME_DIR=folder)
    done = subprocess.run([CANDIL, *arguments, "--json"], stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                          env=environment, check=False)
    if done.returncode != 0:
        sys.exit(f"bench_orbit: {' '.join(arguments)}: {done.stderr.decode(errors='replace')}")
    return json.loads(done.stdout)


def sweep(folder, scene, frames, picture, name):
    return candil(folder, "sweep", scene, "-o", os.path.join(folder, name + "{index}.exr"), "--orbit", str(frames), *picture)


def singles(folder, scene, cameras, picture):
    for i, camera in enumerate(cameras):
        numbers = camera["eye"] + camera["target"] + camera["up"] + [camera["vfov_degrees"]]
        report = candil(folder, "render", scene, "-o", os.path.join(folder, f"single{i}.exr"), "--camera",
                        ",".join(map(repr, numbers)), *picture)
    return report


def check(folder, images):
    for i, image in enumerate(images):
        same = numpy.array_equal(Picture(image["image"], None).radiance,
                                 Picture(os.path.join(folder, f"single{i}.exr"), None).radiance)
        if not same:
            sys.exit(f"bench_orbit: picture {i} differs")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--frames", type=int, default=360)
    parser.add_argument("--size", type=int, default=64)
    parser.add_argument("--spp", type=int, default=4)
    parser.add_argument("--scene", help="default: our Cornell box")
    options = parser.parse_args()
    picture = ["--size", f"{options.size}x{options.size}", "--spp", str(options.spp)]
    with tempfile.TemporaryDirectory(prefix="candil-bench-") as folder:
        scene = options.scene or make.cornell(folder)
        first, report = bench.timed(sweep, folder, scene, options.frames, picture, "first")
        images = report["images"]
        apart, last = bench.timed(singles, folder, scene, [image["camera"] for image in images], picture)
        second, _ = bench.timed(sweep, folder, scene, options.frames, picture, "second")
        check(folder, images)
        bench.header(last["device"])
    together = (first + second) / 2
    bench.table([f"{options.frames} frames, {options.size} x {options.size}, {options.spp} samples", ">seconds", ">ms a frame"],
                [(name, f"{s:.2f}", f"{s / options.frames * 1e3:.1f}") for name, s in
                 (("one sweep, first", first), ("one sweep, again", second), ("single runs of the program", apart))])
    print(f"ratio: {apart / together:.1f}; all {len(images)} pictures have the same bits either way")


if __name__ == "__main__":
    main()
