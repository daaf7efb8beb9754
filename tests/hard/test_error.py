"""The estimated error: near the true one, which lies in its interval, falling as one over the samples; no upper end where light may not
have been found; and a render that ends at it ends at the same sample with the same bits, whatever the slices are."""
import hashlib
import json
import math
import os
import unittest

import numpy

import hidden
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


def interval(picture):
    """(low, high), infinity where there is no upper end."""
    low, high = picture.report["relmse_low"], picture.report["relmse_high"]
    return low, math.inf if high is None else high


def reference(path, samples, more=(), size=SIZE, seeds=(901, 902)):
    """Its mean and what its own noise adds to a relMSE."""
    parts = [daemon.render(path, size, samples, arguments=[*more, "--seed", str(s)]).radiance.astype(numpy.float64) for s in seeds]
    mean = sum(parts) / len(parts)
    return mean, relmse(parts[0], parts[1]) / 4


class Estimate(unittest.TestCase):
    def test_it_is_near_the_true_one(self):
        for path, more in ((make.cornell(daemon.folder), []), (make.stage(daemon.folder), []),
                           (make.ggx_furnace(daemon.folder, roughness=0.4), ["--background", "1,1,1"])):
            reference = daemon.render(path, SIZE, 512, arguments=[*more, "--seed", "99"]).radiance.astype(numpy.float64)
            for spp in (4, 16, 31):
                picture = daemon.render(path, SIZE, spp, arguments=more)
                true = relmse(picture.radiance.astype(numpy.float64), reference)
                ratio = estimate(picture) / true
                low, high = interval(picture)
                print(f"{os.path.basename(path)}, {spp} samples: relMSE {true:.2e} in {low:.2e} … {high:.2e}, estimated over true {ratio:.2f}")
                self.assertLess(max(ratio, 1 / ratio), 1.5)
                self.assertTrue(low <= true <= high)
                self.assertLess(high / low, 2.5)

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
        flat = ["--background", "1,1,1", "--camera", "0,0,4,0,0,8,0,1,0,40", "--error", "1e-9", "--technique", "pt"]
        report = daemon.render(path, SIZE, 4096, arguments=flat).report
        self.assertEqual((report["estimated_relmse"], report["samples"], report["reason"]), (0, 8, "error"))
        self.assertEqual((report["relmse_low"], report["relmse_high"]), (0, 0))


class Fireflies(unittest.TestCase):
    """What few samples find is much brighter than what is around: a pixel's own mean would hide that."""
    SIZE = (24, 24)

    def frames(self, path, spp, seeds, truth, noise):
        """(pictures, mean estimate over mean true error, how many true errors lie in the interval)"""
        pictures = [daemon.render(path, self.SIZE, spp, arguments=["--seed", str(s)]) for s in seeds]
        true = [relmse(p.radiance.astype(numpy.float64), truth) - noise for p in pictures]
        inside = sum(low <= t <= high for (low, high), t in zip(map(interval, pictures), true))
        ratio = sum(map(estimate, pictures)) / sum(true)
        print(f"{os.path.basename(path)}, {spp} samples: {inside} of {len(true)} inside, mean estimate over mean true error {ratio:.2f}")
        return pictures, ratio, inside

    def believable(self, path, spp, reference_spp):
        """The pictures of twelve seeds, whose estimates are near the truth in the mean, and intervals around it."""
        truth, noise = reference(path, reference_spp, size=self.SIZE)
        pictures, ratio, inside = self.frames(path, spp, range(1, 13), truth, noise)
        self.assertLess(max(ratio, 1 / ratio), 1.5)
        self.assertGreaterEqual(inside, 10)
        return pictures

    def test_a_small_lamp_in_a_glossy_room(self):
        self.believable(hidden.brushed(daemon.folder), 8, 768)

    def test_a_lamp_in_a_shade(self):
        path = hidden.shade(daemon.folder)
        pictures = self.believable(path, 4, 1024)
        # Most light came by luck, so no number bounds the error, and none is reached.
        self.assertGreaterEqual(sum(p.report["relmse_high"] is None for p in pictures), 8)
        for picture in (p for p in pictures if p.report["relmse_high"] is None):
            self.assertTrue(any("no upper end" in note for note in picture.report["notes"]), picture.report["notes"])
        picture = daemon.render(path, self.SIZE, 12, arguments=["--error", "100", "--technique", "pt"])
        self.assertEqual((picture.report["samples"], picture.report["reason"]), (12, "samples"))
        self.assertTrue(any("no target" in note for note in picture.report["notes"]), picture.report["notes"])

    def test_a_lamp_that_nothing_finds(self):
        """The black room has a lamp outside, the black stage none at all: of the second it is known that nothing is missing."""
        path = make.sealed_room(daemon.folder)
        picture = daemon.render(path, self.SIZE, 24, arguments=["--error", "0.1", "--technique", "pt"])
        self.assertEqual((picture.report["samples"], picture.report["reason"]), (24, "samples"))
        for key in ("estimated_relmse", "relmse_low", "relmse_high"):
            self.assertIsNone(picture.report[key], key)
        self.assertTrue(any("no sample has found light" in note for note in picture.report["notes"]), picture.report["notes"])
        picture = daemon.render(make.unlit(daemon.folder), self.SIZE, 24, arguments=["--error", "0.1", "--technique", "pt"])
        self.assertEqual((picture.report["samples"], picture.report["reason"]), (8, "error"))
        self.assertEqual((estimate(picture), picture.report["relmse_high"]), (0, 0))

    def test_a_camera_that_looks_away(self):
        """No pixel shows a surface, so no light can have been missed: the target is reached at once."""
        path = make.cornell(daemon.folder)
        picture = daemon.render(path, self.SIZE, 64, (0, 0, 50, 0, 0, 90, 0, 1, 0, 40), arguments=["--error", "0.1", "--technique", "pt"])
        self.assertEqual((picture.report["samples"], picture.report["reason"]), (8, "error"))
        self.assertEqual((estimate(picture), picture.report["relmse_high"]), (0, 0))

    def test_a_lamps_rim_is_no_firefly(self):
        """Where a lamp's rim crosses a pixel, its halves differ as a firefly's do: by what is around alone, the estimate is a thousand
        times too high."""
        g = Gltf()
        g.place(*quad((-3, -3, -1), (3, -3, -1), (3, 3, -1), (-3, 3, -1)), g.material("wall", (.5,) * 3))
        g.place(*quad((-.31, -.22, 0), (.33, -.27, 0), (.29, .3, 0), (-.28, .26, 0)), g.material("lamp", (0, 0, 0), (15,) * 3))
        g.light("point", 20, (0, 1, 3))
        g.camera((0, 0, 6), (0, 0, 0), 30)
        path = g.save(daemon.folder, "rim.gltf")
        truth, noise = reference(path, 512, size=self.SIZE)
        for spp in (4, 16):
            _, ratio, inside = self.frames(path, spp, range(1, 7), truth, noise)
            self.assertLess(max(ratio, 1 / ratio), 3)
            self.assertGreaterEqual(inside, 4)


class Told(unittest.TestCase):
    def test_as_text_and_in_the_file(self):
        path = make.cornell(daemon.folder)
        picture = daemon.render(path, SIZE, 8)
        for key in ("estimated_relmse", "relmse_low", "relmse_high"):
            self.assertAlmostEqual(float(picture.metadata["candil/" + key]) / picture.report[key], 1, delta=1e-5)
        _, out, _ = daemon.candil("render", path, "-o", os.path.join(daemon.folder, "told.exr"), "--size", "48x48", "--spp", "8")
        low, high = (f"{x:.2e}" for x in interval(picture))
        self.assertIn(f"about {estimate(picture):.2e} ({low} … {high}, 90 %), measured", out)
        self.assertEqual(picture.metadata["candil/error_kind"], "measured")
        self.assertEqual(picture.report["error_kind"], "measured")
        self.assertNotIn("upper end", out)
        _, out, _ = daemon.candil("render", hidden.shade(daemon.folder), "-o", os.path.join(daemon.folder, "told.exr"), "--size", "24x24",
                                  "--spp", "4")
        self.assertIn("light may not have been found", out)

    def test_of_a_sweep(self):
        """The means of its images, and no upper end if one of them has none."""
        path, shade = make.stage(daemon.folder), hidden.shade(daemon.folder)
        for scene, sided in ((path, False), (shade, True)):
            _, out, _ = daemon.candil("sweep", scene, "-o", os.path.join(daemon.folder, os.path.basename(scene) + "{index}.exr"), "--orbit", "2",
                                      "--size", "24x24", "--spp", "4", "--json")
            summary = json.loads(out)
            self.assertEqual(summary["relmse_high"] is None, sided)
            # Of one image in the shade nothing is known, and so of the mean.
            self.assertEqual(summary["error_kind"], "unknown" if sided else "measured")
            self.assertEqual([summary[k] is None for k in ("estimated_relmse", "relmse_low", "relmse_high")], [sided] * 3)

    def test_techniques_without_noise(self):
        """What they have wrong is the same in all samples, so that no number of these tells it: edges, above all."""
        path = make.cornell(daemon.folder)
        for technique in ("direct", "vct", "radiosity"):
            for spp in (1, 4):
                picture = daemon.render(path, SIZE, spp, arguments=["--technique", technique])
                self.assert_unknown(picture)

    def test_one_sample_tells_nothing(self):
        picture = daemon.render(make.cornell(daemon.folder), SIZE, 1)
        self.assert_unknown(picture)
        _, out, _ = daemon.candil("render", make.cornell(daemon.folder), "-o", os.path.join(daemon.folder, "told.exr"), "--size", "24x24",
                                  "--spp", "1")
        self.assertIn("error      unknown\n", out)

    def assert_unknown(self, picture):
        """Nowhere a 0 that could be taken for no error."""
        self.assertEqual([picture.report[k] for k in ("estimated_relmse", "relmse_low", "relmse_high")], [None] * 3)
        self.assertEqual(picture.report["error_kind"], "unknown")
        self.assertEqual((picture.metadata["candil/error_kind"], float(picture.metadata["candil/estimated_relmse"])), ("unknown", -1))


class Target(unittest.TestCase):
    def test_the_same_sample_and_the_same_bits(self):
        path = make.cornell(daemon.folder)
        ends = set()
        for milliseconds in (1, 50):
            with Daemon("--slice", str(milliseconds)) as other:
                for odd in ("0", "3"):
                    picture = other.render(path, SIZE, 512, arguments=["--technique", "pt", "--error", "0.02", "--first-sample", odd])
                    self.assertEqual(picture.report["reason"], "error")
                    self.assertLessEqual(interval(picture)[1], 0.02)
                    ends.add((odd, picture.report["samples"], picture.radiance.tobytes()))
        self.assertEqual(len(ends), 2)
        for odd, samples, bits in ends:
            self.assertIn(samples, FIXED)
            plain = daemon.render(path, SIZE, samples, arguments=["--first-sample", odd])
            self.assertEqual(plain.radiance.tobytes(), bits)
            # It did not pass a point where it could have ended.
            before = max(s for s in FIXED if s < samples)
            self.assertGreater(interval(daemon.render(path, SIZE, before, arguments=["--first-sample", odd]))[1], 0.02)


class Deadline(unittest.TestCase):
    def test_exit_status_and_picture(self):
        path = make.cornell(daemon.folder)
        daemon.render(path, SIZE, 1)  # whatever is compiled at first use
        output = os.path.join(daemon.folder, "late.exr")
        status, out, _ = daemon.candil("render", path, "-o", output, "--size", "48x48", "--technique", "pt", "--time", "2000", "--json",
                                       check=False)
        report = json.loads(out)
        self.assertEqual((status, report["reason"]), (7, "time"))
        self.assertGreater(report["samples"], 0)
        with open(output, "rb") as file:
            data = file.read()
        self.assertEqual(len(data), report["bytes"])
        print(f"{report['samples']} samples in {report['elapsed_us']} us, {hashlib.sha256(data).hexdigest()[:8]}")


if __name__ == "__main__":
    unittest.main()
