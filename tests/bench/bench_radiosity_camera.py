"""What another camera costs when the radiosity of a scene is known: two cameras in turns, so that each picture is of another one than
that before, and the first of each are not counted. Wall clock is the sum of a picture's stages but for waiting, encoding and sending; the
processors' time is that of all the worker's threads, encoding included, for the kernel tells threads and not stages.

    bench_radiosity_camera.py [--scene FILE --cameras CAMERA CAMERA]     without a scene: our Cornell box, and the theses' room
"""
import argparse
import glob
import os
import sys

import bench
import make
import radiosity
from render import Daemon

# Eye, target, up, degrees: of make.py's Cornell box, and of the room, which is as large.
CAMERAS = ("0,1,3.9,0,1,0,0,1,0,39", "0.4,1.2,3.7,0,1,0,0,1,0,39")
NOT_COUNTED = ("queue", "wait", "encoder", "encode", "send")


def worker_of(daemon):
    """The process id of the daemon's worker."""
    for path in glob.glob("/proc/[0-9]*/stat"):
        try:
            with open(path, encoding="ascii", errors="replace") as f:
                pid, rest = f.read().split(" (", 1)
        except OSError:
            continue
        name, _, fields = rest.rpartition(") ")
        if name.startswith("candil-worker") and int(fields.split()[1]) == daemon.process.pid:
            return int(pid)
    sys.exit("bench_radiosity_camera: the daemon has no worker")


def processors_ms(pid):
    """Of all threads that there are."""
    nanoseconds = 0
    for path in glob.glob(f"/proc/{pid}/task/*/schedstat"):
        with open(path, encoding="ascii") as f:
            nanoseconds += int(f.read().split()[0])
    return nanoseconds / 1e6


def stages_ms(picture):
    stages = {}
    for stage in picture.report["stages"]:
        stages[stage["name"]] = stages.get(stage["name"], 0) + stage["us"] / 1e3
    return stages


def frames(daemon, scene, given, cameras, options):
    """(stages, processors' ms) of each picture but the first of each camera."""
    # A scene that is loaded by name stays, and with it the solution.
    daemon.candil("load", scene, "--name", "scene")

    def render(i):
        return daemon.render("scene", (given.size, given.size), given.spp, cameras[i % 2], options,
                             ["--technique", "radiosity"])
    for i in range(4):
        picture = render(i)
    pid = worker_of(daemon)
    found = []
    for i in range(given.frames):
        before = processors_ms(pid)
        picture = render(i)
        found.append((stages_ms(picture), processors_ms(pid) - before))
    daemon.candil("unload", "scene")
    return picture, found


def row(name, display, found):
    wall = [sum(ms for stage, ms in stages.items() if stage not in NOT_COUNTED) for stages, _ in found]
    processors = [ms for _, ms in found]
    names = list(dict.fromkeys(stage for stages, _ in found for stage in stages))
    each = ", ".join(f"{stage} {bench.median([stages.get(stage, 0) for stages, _ in found]):.1f}" for stage in names)
    return (name, display, f"{min(wall):.1f}", f"{bench.median(wall):.1f}", f"{min(processors):.1f}",
            f"{bench.median(processors):.1f}", each)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--scene")
    parser.add_argument("--cameras", nargs=2, default=CAMERAS, metavar="CAMERA", help="names, or ten numbers with commas")
    parser.add_argument("--display", default="vertex,constant")
    parser.add_argument("--size", type=int, default=512)
    parser.add_argument("--spp", type=int, default=1)
    parser.add_argument("--frames", type=int, default=40)
    given = parser.parse_args()
    cameras = [c if "," not in c else [float(n) for n in c.split(",")] for c in given.cameras]
    rows = []
    with Daemon() as daemon:
        if given.scene:
            scenes = [(os.path.basename(given.scene), given.scene, {})]
        else:
            scenes = [("make.py cornell", make.cornell(daemon.folder), {}),
                      ("radiosity.py room", radiosity.room(daemon.folder), {"radiosity.edge": radiosity.EDGE})]
        for name, scene, options in scenes:
            for display in given.display.split(","):
                picture, found = frames(daemon, scene, given, cameras, dict(options, **{"radiosity.display": display}))
                rows.append(row(name, display, found))
        bench.header(picture.report["device"])
    bench.table([f"{given.size} x {given.size}, {given.spp} samples, {given.frames} pictures", "display", ">wall ms, least", ">median",
                 ">processors' ms, least", ">median", "stages, median ms"], rows)


if __name__ == "__main__":
    main()
