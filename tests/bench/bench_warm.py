"""A warm daemon beside `blender -b`: both render our Cornell box, 16 x 16, one sample, as PNG, in turns, in one run.

Candil: libcandil over an open connection, scene loaded; from the request to the last byte of the picture, encoding included.
Blender: `blender -b FILE.blend -f 1`, Cycles on the processors, one sample; from its start to its end. It is Debian's package
`blender`; where it is not there, this says so and ends."""
import argparse
import os
import shutil
import subprocess
import sys

import bench
import make
from render import Daemon

PREPARE = """
import bpy, math, sys
obj, blend = sys.argv[sys.argv.index("--") + 1:]
bpy.ops.wm.read_factory_settings(use_empty=True)
bpy.ops.import_scene.obj(filepath=obj)
scene = bpy.context.scene
camera = bpy.data.objects.new("camera", bpy.data.cameras.new("camera"))
scene.collection.objects.link(camera)
camera.location, camera.rotation_euler = (0, -3.9, 1), (math.radians(90), 0, 0)
camera.data.angle = math.radians(39)
scene.camera = camera
scene.render.engine = "CYCLES"
scene.cycles.device = "CPU"
scene.cycles.samples = 1
scene.cycles.use_adaptive_sampling = False
scene.cycles.use_denoising = False
scene.cycles.max_bounces = 8
scene.render.resolution_x = scene.render.resolution_y = 16
scene.render.resolution_percentage = 100
scene.render.image_settings.file_format = "PNG"
bpy.ops.wm.save_as_mainfile(filepath=blend)
"""


def run(command):
    done = subprocess.run(command, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, check=False)
    if done.returncode != 0:
        sys.exit(f"bench_warm: {command[0]} failed:\n{done.stdout.decode(errors='replace')}")
    return done.stdout.decode(errors="replace")


def prepare(blender, folder):
    script, blend = os.path.join(folder, "prepare.py"), os.path.join(folder, "cornell.blend")
    with open(script, "w", encoding="ascii") as file:
        file.write(PREPARE)
    run([blender, "-b", "--python", script, "--", make.cornell_obj(folder), blend])
    return blend


def blender_frame(blender, blend, folder):
    for name in os.listdir(folder):
        if name.startswith("frame"):
            os.remove(os.path.join(folder, name))
    seconds, _ = bench.timed(run, [blender, "-b", blend, "-o", os.path.join(folder, "frame####"), "-f", "1"])
    if not os.path.exists(os.path.join(folder, "frame0001.png")):
        sys.exit("bench_warm: blender wrote no picture")
    return seconds * 1e3


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--turns", type=int, default=15, help="of one blender and 100 requests each (default %(default)s)")
    turns = parser.parse_args().turns
    blender = shutil.which("blender")
    if not blender:
        sys.exit("bench_warm: there is no blender here to compare with: install the package `blender`")
    with Daemon() as daemon:
        blend, scene = prepare(blender, daemon.folder), make.cornell(daemon.folder)
        latency = [os.path.join(bench.BUILD, "tests", "bench_latency"), "--least", "100", daemon.socket, scene]
        run(latency)
        bench.header(daemon.stats()["device"])
        theirs, ours = [], []
        for _ in range(turns):
            theirs.append(blender_frame(blender, blend, daemon.folder))
            ours += [float(line) for line in run(latency).split()]
    version = run([blender, "--version"]).splitlines()[0]
    bench.table(["16 x 16, 1 sample", ">runs", ">median ms", ">p95 ms"],
                [(name, len(ms), f"{bench.median(ms):.2f}", f"{bench.percentile(ms, .95):.2f}")
                 for name, ms in ((version + ", `blender -b`", theirs), ("candil, warm", ours))])
    print(f"ratio of the medians: {bench.median(theirs) / bench.median(ours):.0f}")


if __name__ == "__main__":
    main()
