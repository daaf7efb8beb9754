"""The estimated error: near the true one, falling as one over the samples, and a render that ends at it ends at the same sample
with the same bits, whatever the slices are."""
import hashlib
import json
import os
import unittest

import numpy

import make
from images import relmse
from render import Daemon
from writers import Gltf, icosphere, quad

daemon = Daemon()
SIZE = (48, 48)
FIXED = {8, 12, 16, 24, 32, 48, 64, 96, 128, 192, 256, 384, 512}


def setUpModule():
    unittest.enterModuleContext(daemon)


def estimate(picture):
    return picture.report["estimated_relmse"]


class Estimate(unittest.TestCase):
    def test_it_is_near_the_true_one(self):
        for path, more in ((make.cornell(daemon.folder), []), (make.stage(daemon.folder), []),
                           (make.ggx_furnace(daemon.folder, roughness=0.4), ["--background", "1,1,1"])):
            reference = daemon.render(path, SIZE, 512, arguments=[*more, "--seed", "99"]).radiance.astype(numpy.float64)
            for spp in (4, 16, 31):
                picture = daemon.render(path, SIZE, spp, arguments=more)
                true = relmse(picture.radiance.astype(numpy.float64), reference)
                ratio = estimate(picture) / true
                print(f"{os.path.basename(path)}, {spp} samples: relMSE {true:.2e}, estimated over true {ratio:.2f}")
                self.assertLess(max(ratio, 1 / ratio), 1.5)

    def test_what_is_small_and_bright_before_the_dark(self):
        """The mean of a block is far too little for a ball of two pixels' breadth: by it alone the first ratio is 4.0."""
        g = Gltf()
        ball = g.mesh(*icosphere(2), g.material("ball", (.7, .7, .7)))
        for i in range(64):
            g.node(mesh=ball, translation=[.7 * (i % 8) - 2.4, .7 * (i // 8) - 2.5, 0], scale=[.12] * 3)
        g.place(*quad((-2, 3, -2), (2, 3, -2), (2, 3, 2), (-2, 3, 2)), g.material("lamp", (0, 0, 0), (20,) * 3))
        g.camera((0, 0, 8), (0, 0, 0), 40)
        path = g.save(daemon.folder, "small.gltf")
        reference = daemon.render(path, SIZE, 1024, arguments=["--seed", "99"]).radiance.astype(numpy.float64)
        for spp in (8, 32):
            pictures = [daemon.render(path, SIZE, spp, arguments=["--seed", str(seed)]) for seed in range(4)]
            true = sum(relmse(p.radiance.astype(numpy.float64), reference) for p in pictures)
            ratio = sum(map(estimate, pictures)) / true
            print(f"small and bright, {spp} samples: relMSE {true / 4:.2e}, estimated over true {ratio:.2f}")
            self.assertLess(max(ratio, 1 / ratio), 3)

    def test_radiance_whose_square_is_no_number(self):
        path = make.cornell(daemon.folder, radiance=1e19)
        usual, bright = (daemon.render(p, SIZE, 16).report["estimated_relmse"] for p in (make.cornell(daemon.folder), path))
        self.assertIsNotNone(bright)
        self.assertLess(abs(bright / usual - 1), 0.5)

    def test_it_falls_as_one_over_the_samples(self):
        path = make.cornell(daemon.folder)
        few, many = (estimate(daemon.render(path, SIZE, spp)) for spp in (8, 128))
        print(f"8 samples: {few:.2e}, 128: {many:.2e}, sixteen times less would be {few / 16:.2e}")
        self.assertLess(abs(numpy.log2(few / many) - 4), 1)

    def test_one_sample_tells_nothing_and_a_flat_field_has_none(self):
        path = make.furnace(daemon.folder)
        report = daemon.render(path, SIZE, 1, arguments=["--background", "1,1,1"]).report
        self.assertIsNone(report["estimated_relmse"])
        flat = ["--background", "1,1,1", "--camera", "0,0,4,0,0,8,0,1,0,40", "--error", "1e-9"]
        report = daemon.render(path, SIZE, 4096, arguments=flat).report
        self.assertEqual((report["estimated_relmse"], report["samples"], report["reason"]), (0, 8, "error"))


class Target(unittest.TestCase):
    def test_the_same_sample_and_the_same_bits(self):
        path = make.cornell(daemon.folder)
        ends = set()
        for milliseconds in (1, 50):
            with Daemon("--slice", str(milliseconds)) as other:
                for odd in ("0", "3"):
                    picture = other.render(path, SIZE, 512, arguments=["--error", "0.02", "--first-sample", odd])
                    self.assertEqual(picture.report["reason"], "error")
                    self.assertLessEqual(estimate(picture), 0.02)
                    ends.add((odd, picture.report["samples"], picture.radiance.tobytes()))
        self.assertEqual(len(ends), 2)
        for odd, samples, bits in ends:
            self.assertIn(samples, FIXED)
            plain = daemon.render(path, SIZE, samples, arguments=["--first-sample", odd])
            self.assertEqual(plain.radiance.tobytes(), bits)
            # It did not pass a point where it could have ended.
            before = max(s for s in FIXED if s < samples)
            self.assertGreater(estimate(daemon.render(path, SIZE, before, arguments=["--first-sample", odd])), 0.02)


class Deadline(unittest.TestCase):
    def test_exit_status_and_picture(self):
        path = make.cornell(daemon.folder)
        daemon.render(path, SIZE, 1)  # whatever is compiled at first use
        output = os.path.join(daemon.folder, "late.exr")
        status, out, _ = daemon.candil("render", path, "-o", output, "--size", "48x48", "--time", "400", "--json", check=False)
        report = json.loads(out)
        self.assertEqual((status, report["reason"]), (7, "time"))
        self.assertGreater(report["samples"], 0)
        with open(output, "rb") as file:
            data = file.read()
        self.assertEqual(len(data), report["bytes"])
        print(f"{report['samples']} samples in {report['elapsed_us']} us, {hashlib.sha256(data).hexdigest()[:8]}")


if __name__ == "__main__":
    unittest.main()
