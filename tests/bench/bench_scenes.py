"""Samples per second, time by stage and memory, by scene and size. Scenes: those of the project, the files given as arguments, and
what CANDIL_SCENES has of a list of public ones. Each size is rendered four times: the first, whose upload and compilation are
shown by themselves, and three whose medians are shown. A scene without any light gets a white surrounding."""
import argparse
import json
import os
import tempfile

import bench
import make
from render import Daemon

PUBLIC = ("ref-cornell-box/cornell-box.gltf", "ref-veach-mis/veach-mis.gltf", "kitchen/kitchen.obj", "sponza/Sponza.gltf",
          "dragon/dragon.obj", "gltf/DamagedHelmet/DamagedHelmet.gltf")
SIZES = ((128, 64), (256, 16), (512, 4), (1024, 1))  # side, samples: as many samples in each
COLUMNS = ["scene", ">triangles", ">load s", ">size", ">samples", ">first: upload + compile ms", ">trace ms", ">resolve ms", ">encode ms",
           ">M samples/s", ">M rays/s", ">job MiB", ">device MiB", ">worker's peak MiB"]
MIB = 1 << 20


def own_scenes(folder):
    yield make.cornell(folder)
    yield make.textured_quad(folder)
    yield make.plates(folder)
    yield os.path.join(bench.SOURCE, "deploy", "first.gltf")


def public_scenes():
    root = os.environ.get("CANDIL_SCENES")
    return [path for path in (os.path.join(root, name) for name in PUBLIC) if os.path.exists(path)] if root else []


def peak_mib(pid, forget=False):
    if forget:
        with open(f"/proc/{pid}/clear_refs", "w", encoding="ascii") as file:
            file.write("5")
    with open(f"/proc/{pid}/status", encoding="ascii") as status:
        return next(int(line.split()[1]) for line in status if line.startswith("VmHWM:")) / 1024


def stages(report):
    return {stage["name"]: stage["us"] / 1e3 for stage in report["stages"]}


def render(daemon, side, samples, arguments):
    path = os.path.join(daemon.folder, "picture.exr")
    command = ["render", "scene", "-o", path, "--json", "--size", f"{side}x{side}", "--spp", str(samples)]
    return json.loads(daemon.candil(*command, *arguments)[1])


def measure(daemon, side, samples, arguments):
    """(a row's cells from the size on)"""
    worker = daemon.stats()["worker_pid"]
    peak_mib(worker, forget=True)
    first = stages(render(daemon, side, samples, arguments))
    reports = [render(daemon, side, samples, arguments) for _ in range(3)]
    middle = {name: bench.median([stages(report).get(name, 0) for report in reports]) for name in ("trace", "resolve", "encode")}
    seconds = middle["trace"] / 1e3
    return (f"{side}²", samples, f"{first.get('upload', 0):.1f} + {first.get('compile', 0):.1f}", f"{middle['trace']:.0f}",
            f"{middle['resolve']:.1f}", f"{middle['encode']:.1f}", f"{side * side * samples / seconds / 1e6:.2f}",
            f"{reports[0]['rays'] / seconds / 1e6:.2f}", f"{reports[0]['job_bytes'] / MIB:.1f}",
            f"{daemon.stats()['device_bytes'] / MIB:.1f}", f"{peak_mib(worker):.0f}")


def rows(path):
    # A daemon a scene: its peak of memory is its own.
    with Daemon() as daemon:
        seconds, _ = bench.timed(daemon.candil, "load", path, "--name", "scene")
        found = json.loads(daemon.candil("describe", "scene", "--json")[1])
        lit = {"emitters", "lights"} & set(found["facts"])
        for side, samples in SIZES:
            row = measure(daemon, side, samples, () if lit else ("--background", "1,1,1"))
            yield (os.path.basename(path), f"{found['triangles']:,}", f"{seconds:.2f}", *row)


def device():
    with Daemon() as daemon:
        while not daemon.stats()["device"]:
            pass
        return daemon.stats()["device"]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scenes", nargs="*", metavar="SCENE")
    given = parser.parse_args().scenes
    bench.header(device())
    with tempfile.TemporaryDirectory(prefix="candil-bench-") as folder:
        files = given or [*own_scenes(folder), *public_scenes()]
        bench.table(COLUMNS, (row for path in files for row in rows(path)))


if __name__ == "__main__":
    main()
