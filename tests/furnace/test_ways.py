"""The ways of sampling that can be chosen to be compared: each gives the same picture in the mean, none the same bits; and what
a clamp takes away is told."""
import unittest

import numpy

import make
from images import blurred, luminance, relmse
from render import Daemon, Failed

daemon = Daemon()
SIZE = (48, 48)
WAYS = (("pt.sampler", "independent", 0.02), ("pt.sampler", "blue", 0.02), ("pt.hemisphere", "uniform", 0.02), ("pt.lights", "nee", 0.02),
        ("pt.lights", "none", 0.08), ("pt.roulette", "off", 0.02), ("pt.light_tree", "on", 0.02))


def setUpModule():
    unittest.enterModuleContext(daemon)


def mean(picture):
    return float(picture.radiance.mean(dtype=numpy.float64))


class Ways(unittest.TestCase):
    def test_the_same_light_by_other_samples(self):
        path = make.cornell(daemon.folder)
        usual = daemon.render(path, SIZE, 64)
        self.assertEqual(usual.radiance.tobytes(), daemon.render(path, SIZE, 64, options={
            "pt.sampler": "sobol", "pt.hemisphere": "cosine", "pt.lights": "mis", "pt.roulette": "on",
            "pt.clamp": "0"}).radiance.tobytes())
        for name, value, tolerance in WAYS:
            picture = daemon.render(path, SIZE, 64, options={name: value})
            print(f"{name}={value}: mean {mean(picture) / mean(usual):.4f} of the usual, estimated error "
                  f"{picture.report['estimated_relmse'] / usual.report['estimated_relmse']:.2f} times")
            self.assertLess(abs(mean(picture) / mean(usual) - 1), tolerance)
            self.assertNotEqual(picture.radiance.tobytes(), usual.radiance.tobytes())

    def test_a_tree_over_the_lamps(self):
        """It changes which lamps are asked, not what they send: the same picture with less noise, lamps met by chance included."""
        path = make.many_lamps(daemon.folder, 12)
        reference = daemon.render(path, SIZE, 512, options={"pt.light_tree": "off"}, arguments=["--seed", "9"]).radiance
        errors, means = {}, {}
        for tree in ("off", "on", "auto"):
            picture = daemon.render(path, SIZE, 32, options={"pt.light_tree": tree})
            self.assertEqual(picture.report["non_finite_samples"], 0)
            errors[tree], means[tree] = relmse(picture.radiance, reference), mean(picture)
        print(f"relMSE by power {errors['off']:.2e}, by the tree {errors['on']:.2e}")
        self.assertEqual(errors["on"], errors["auto"])
        self.assertLess(errors["on"], 0.7 * errors["off"])
        # Both see the same lamps by the same samples, and they are the most of the mean.
        self.assertAlmostEqual(means["on"] / means["off"], 1, delta=0.005)
        few = make.cornell(daemon.folder)
        self.assertEqual(daemon.render(few, SIZE, 4).radiance.tobytes(),
                         daemon.render(few, SIZE, 4, options={"pt.light_tree": "off"}).radiance.tobytes())

    def test_a_sun_that_does_not_reach_the_room(self):
        """It would send more than all lamps there, if the walls let it: they keep nine tenths of the samples all the same."""
        path = make.many_lamps(daemon.folder, 4, "hall.gltf")
        sun = ["--light", "directional:direction=.2,-1,.1,intensity=1e4"]
        told = {tree: daemon.render(path, SIZE, 32, options={"pt.light_tree": tree, "pt.depth": 1}, arguments=sun).report["estimated_relmse"]
                for tree in ("off", "on")}
        print(f"estimated relMSE by power {told['off']:.2e}, by the tree {told['on']:.2e}")
        self.assertLess(told["on"], 1.5 * told["off"])

    def test_neighbours_errors_cancel(self):
        """By `blue` a pixel is as wrong as by `sobol`, and what a filter leaves of the error is less."""
        path = make.cornell(daemon.folder)
        reference = daemon.render(path, SIZE, 512, arguments=["--seed", "9"]).radiance.astype(numpy.float64)
        inner = slice(4, -4)
        errors = {}
        for way in ("sobol", "blue"):
            pictures = [daemon.render(path, SIZE, 2, options={"pt.sampler": way}, arguments=["--seed", str(i)]).radiance for i in range(8)]
            errors[way] = [numpy.mean([relmse(blurred(p, s)[inner, inner] if s else p, blurred(reference, s)[inner, inner] if s else reference)
                                       for p in pictures]) for s in (0, 1.5)]
        plain, filtered = numpy.divide(errors["blue"], errors["sobol"])
        print(f"relMSE by blue over that by sobol: {plain:.2f}, behind a Gaussian {filtered:.2f}")
        self.assertAlmostEqual(plain, 1, delta=0.1)
        self.assertLess(filtered, 0.85)

    def test_closed_sphere(self):
        # Radiance 1 by the series, cut after eight events at 1 - 2^-9.
        path = make.closed_sphere(daemon.folder, rho=0.5)
        for name, value, _ in WAYS:
            picture = daemon.render(path, (32, 32), 64, options={name: value})
            self.assertLess(abs(mean(picture) / (1 - 0.5 ** 9) - 1), 0.01, (name, value))

    def test_unknown_words(self):
        for name, value in (("pt.sampler", "halton"), ("pt.lights", "all"), ("pt.clamp", "-1"), ("pt.clamp", "nan")):
            with self.assertRaises(Failed) as failure:
                daemon.render(make.furnace(daemon.folder), (8, 8), 1, options={name: value})
            self.assertEqual(failure.exception.status, 2)


class Clamp(unittest.TestCase):
    def test_what_it_takes_is_told(self):
        path = make.cornell(daemon.folder)
        for segment in ("9", "2"):
            whole = daemon.render(path, SIZE, 24, options={"pt.segment": segment})
            cut = daemon.render(path, SIZE, 24, options={"pt.segment": segment, "pt.clamp": "1"})
            self.assertLessEqual(float(cut.radiance.max()), 1.0)
            figures = {f["name"]: f["value"] for f in cut.report["figures"]}
            lost = float((luminance(whole.radiance) - luminance(cut.radiance)).mean())
            print(f"clamped: {figures}, lost {lost:.5f} of {float(luminance(whole.radiance).mean()):.5f}")
            self.assertGreater(lost, 0)
            self.assertLess(abs(figures["clamp.removed"] / lost - 1), 0.02)
            self.assertLess(abs(figures["clamp.share"] / (lost / float(luminance(whole.radiance).mean())) - 1), 0.02)
            self.assertGreater(figures["clamp.samples"], 0)

    def test_the_summary_says_it(self):
        command = ["render", make.cornell(daemon.folder), "-o", daemon.folder + "/clamped.png", "--size", "16x16", "--spp", "4"]
        self.assertNotIn("clamped  ", daemon.candil(*command)[1])
        self.assertRegex(daemon.candil(*command, "--set", "pt.clamp=1")[1], r"clamped    [1-9][0-9.]* % of the light")

    def test_what_is_dim_stays(self):
        path = make.cornell(daemon.folder)
        whole, kept = (daemon.render(path, (16, 16), 8, options=o) for o in ({}, {"pt.clamp": "1e6"}))
        self.assertEqual(whole.radiance.tobytes(), kept.radiance.tobytes())
        self.assertEqual([f["value"] for f in kept.report["figures"]], [0, 0, 0])


if __name__ == "__main__":
    unittest.main()
