"""The public Cornell box against the reference image published with it. Needs that scene: CANDIL_SCENES names the folder that
holds ref-cornell-box/ (cornell-box.gltf, camera.json, reference.exr)."""
import json
import os
import subprocess
import sys

from render import CANDIL, Daemon

folder = os.path.join(os.environ["CANDIL_SCENES"], "ref-cornell-box")
with open(os.path.join(folder, "camera.json")) as f:
    c = json.load(f)
camera = [*c["eye"], *c["target"], *c["up"], c["yfov_degrees"]]


def compare(picture, *arguments):
    done = subprocess.run([CANDIL, "compare", picture, os.path.join(folder, c["reference"]), "--json", *arguments],
                          stdout=subprocess.PIPE, check=True)
    return json.loads(done.stdout)


with Daemon() as daemon:
    picture = os.path.join(daemon.folder, "picture.exr")
    daemon.candil("render", os.path.join(folder, "cornell-box.gltf"), "-o", picture, "--size", "256x256", "--spp", "256",
                  "--camera", ",".join(map(str, camera)), "--set", "pt.depth=65")
    whole = compare(picture)
    # The lamp's pixels and those into which the reference's wider filter spread its light.
    masked = compare(picture, "--mask-above", "0.5")
print(f"relMSE {whole['relmse']:.2e} (at most 2e-3), mean outside the lamp {100 * masked['mean_difference_relative']:+.3f} % (at most 0.5)")
sys.exit(0 if whole["relmse"] <= 2e-3 and abs(masked['mean_difference_relative']) <= 0.005 and whole["non_finite_a"] == 0 else 1)
