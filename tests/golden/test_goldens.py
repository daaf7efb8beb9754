"""Pictures of our own scenes against converged ones that were rendered once and looked at (goldens/*.exr).

Goldens tell of change where no closed form reaches; tolerances allow for other devices' rounding and for the noise of a short
render: each is compared at a few samples by its mean, and by relMSE against what so many samples must have.

    test_goldens.py --update            render them anew (8,192 samples; then look at them before you commit them)
    test_goldens.py --update-gallery    those of the gallery
"""
import os
import shutil
import sys
import unittest

import numpy

import gallery
import make
from render import Daemon, Picture

FOLDER = os.path.join(os.path.dirname(os.path.abspath(__file__)), "goldens")
GOLDEN_SPP = 8192
SPP = 64
SIZE = (64, 64)
# The gallery's pictures are smaller and coarser: there are fourteen, some of light that comes by rare ways.
GALLERY_SIZE = (40, 30)
GALLERY_SPP = 2048


def spot(folder):
    return make.lit_floor(folder, "spot", 8.0)


# name: (scene, arguments, relMSE of a 64-sample render: measured, and then doubled)
CASES = {
    "cornell": (make.cornell, [], 8e-3),
    "cornell_obj": (make.cornell_obj, ["--camera", "0,1,3.9,0,1,0,0,1,0,39"], 8e-3),
    "spot": (spot, [], 1e-6),
    "textured": (make.textured_quad, ["--background", "1,0.5,0.25"], 4e-6),
    "hierarchy": (make.hierarchy, ["--background", "0.8,0.9,1"], 4e-6),
    "negative_scale": (make.negative_scale, [], 8e-5),
}


# name: (relMSE, relative difference of the means) of a 64-sample render: measured, and then doubled
GALLERY = {
    "cube": (1e-04, 0.01),
    "cut_out": (9e-04, 0.01),
    "mirror_cube": (1e-03, 0.01),
    "village": (1e-03, 0.01),
    "mirror_floor": (8e-03, 0.02),
    "cornell_original": (6e-03, 0.01),
    "cornell_mirror": (1e-02, 0.01),
    "cornell_spheres": (4e-02, 0.02),
    "cornell_saturated": (1e-02, 0.01),
    "cornell_glossy": (3e-02, 0.01),
    "cornell_weekend": (2e-02, 0.01),
    "cornell_empty": (2e-03, 0.01),
    "cornell_orange_blue": (3e-03, 0.01),
    "cornell_white": (5e-03, 0.01),
}


def render(daemon, name, spp):
    scene, arguments, _ = CASES[name]
    return daemon.render(scene(daemon.folder), size=SIZE, spp=spp, arguments=arguments)


def render_gallery(daemon, name, spp, *more):
    return daemon.render(gallery.SCENES[name](daemon.folder), size=GALLERY_SIZE, spp=spp, arguments=[*gallery.arguments(name), *more])


def relmse(picture, reference):
    r = reference.radiance.astype(numpy.float64)
    return float(((picture.radiance - r) ** 2 / (r * r + 0.01)).mean())


class Goldens(unittest.TestCase):
    def test_all(self):
        with Daemon() as daemon:
            for name, (_, _, tolerance) in CASES.items():
                with self.subTest(scene=name):
                    golden = Picture(os.path.join(FOLDER, name + ".exr"), None)
                    picture = render(daemon, name, SPP)
                    error = relmse(picture, golden)
                    mean = float(picture.radiance.mean(dtype=numpy.float64) / golden.radiance.mean(dtype=numpy.float64) - 1)
                    print(f"{name}: relMSE {error:.2e} (at most {tolerance:.0e}), mean {100 * mean:+.3f} %, estimated relMSE "
                          f"{picture.report['estimated_relmse']:.2e}")
                    self.assertLess(error, tolerance)
                    self.assertLess(abs(mean), 0.01)

    def test_the_gallery(self):
        with Daemon() as daemon:
            for name in gallery.SCENES:
                with self.subTest(scene=name):
                    golden = Picture(os.path.join(FOLDER, "gallery", name + ".exr"), None)
                    picture = render_gallery(daemon, name, SPP)
                    error = relmse(picture, golden)
                    mean = float(picture.radiance.mean(dtype=numpy.float64) / golden.radiance.mean(dtype=numpy.float64) - 1)
                    print(f"{name}: relMSE {error:.2e}, mean {100 * mean:+.3f} %")
                    self.assertEqual(picture.report["non_finite_samples"], 0)
                    most, apart = GALLERY[name]
                    self.assertLess(error, most)
                    self.assertLess(abs(mean), apart)

    def test_the_error_is_known(self):
        """What the two half sequences estimate is what the golden says, within a factor of 1.5, averaged over seeds."""
        with Daemon() as daemon:
            golden = Picture(os.path.join(FOLDER, "cornell.exr"), None)
            scene = make.cornell(daemon.folder)
            estimated = actual = 0
            for seed in range(4):
                picture = daemon.render(scene, size=SIZE, spp=32, arguments=["--seed", str(seed)])
                estimated += picture.report["estimated_relmse"]
                actual += relmse(picture, golden)
            print(f"estimated over true relMSE: {estimated / actual:.2f}")
            self.assertLess(estimated / actual, 1.5)
            self.assertGreater(estimated / actual, 1 / 1.5)


def update(names):
    os.makedirs(FOLDER, exist_ok=True)
    with Daemon() as daemon:
        for name in names or CASES:
            scene, arguments, _ = CASES[name]
            path = os.path.join(daemon.folder, name + ".exr")
            daemon.candil("render", scene(daemon.folder), "-o", path, "--half", "--size", "%dx%d" % SIZE, "--spp", str(GOLDEN_SPP),
                          "--seed", "1000", *arguments)
            shutil.copy(path, FOLDER)
            print("wrote", name)


def update_gallery(names):
    target = os.path.join(FOLDER, "gallery")
    os.makedirs(target, exist_ok=True)
    with Daemon() as daemon:
        for name in names or gallery.SCENES:
            path = os.path.join(daemon.folder, name + ".exr")
            daemon.candil("render", gallery.SCENES[name](daemon.folder), "-o", path, "--half", "--size", "%dx%d" % GALLERY_SIZE, "--spp",
                          str(GALLERY_SPP), "--seed", "1000", *gallery.arguments(name))
            shutil.copy(path, target)
            print("wrote", name)


if __name__ == "__main__":
    if sys.argv[1:2] == ["--update"]:
        update(sys.argv[2:])
    elif sys.argv[1:2] == ["--update-gallery"]:
        update_gallery(sys.argv[2:])
    else:
        unittest.main()
