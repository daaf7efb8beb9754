"""What cones are worth: our Cornell box against the path tracer with as many scattering events."""
import unittest

import judge
import make
import rooms
from render import Daemon

SIZE = (128, 128)
BOUNCES = 2


class Reference(unittest.TestCase):
    def test_error_is_at_most_half_of_what_a_constant_leaves(self):
        with Daemon() as daemon:
            scene = make.cornell(daemon.folder)
            reference = daemon.render(scene, size=SIZE, spp=192, options={"pt.depth": BOUNCES + 1}).radiance
            first = daemon.render(scene, size=SIZE, spp=4, arguments=["--technique", "direct", "--aov", "albedo,id"])
            # The lamp is the one thing brighter than 4.
            mask = (first.channels["id"] > 0) & (first.radiance.max(axis=2) < 4)
            flat, constant = judge.fitted(first.radiance, judge.albedo(first), reference, mask)
            bar = judge.relmse(flat, reference, mask)
            print(f"direct: relMSE {judge.relmse(first.radiance, reference, mask):.4f}; + {constant:.3f} x albedo: {bar:.4f}, "
                  f"mean {100 * judge.mean_error(flat, reference, mask):+.1f} %")
            errors = {}
            for resolution in (64, 128):
                picture = daemon.render(scene, size=SIZE, spp=4, arguments=["--technique", "vct"],
                                        options={"vct.resolution": resolution, "vct.bounces": BOUNCES}).radiance
                errors[resolution] = judge.relmse(picture, reference, mask)
                mean = judge.mean_error(picture, reference, mask)
                print(f"vct, {resolution}: relMSE {errors[resolution]:.4f}, mean {100 * mean:+.1f} %")
            self.assertLess(errors[128], 0.5 * bar)
            self.assertLess(abs(mean), 0.05)
            self.assertLess(errors[128], errors[64])

    def test_lamps_of_thousands_of_triangles_keep_their_colours(self):
        """Of so many, voxels see a few points each: were they the same few for all, whole lamps would light too little."""
        with Daemon() as daemon:
            scene, size = rooms.light_box(daemon.folder), (48, 48)
            reference = daemon.render(scene, size, spp=64, options={"pt.depth": BOUNCES + 1}).radiance
            mask = reference.max(axis=2) < 0.45
            for emitters, tolerance in (("points", 0.12), ("cones", 0.25)):
                picture = daemon.render(scene, size, spp=4, arguments=["--technique", "vct"],
                                        options={"vct.resolution": 64, "vct.bounces": BOUNCES, "vct.emitters": emitters}).radiance
                ratio = picture[mask].mean(axis=0) / reference[mask].mean(axis=0)
                print(f"light box by {emitters}: {ratio.round(3)} of the path tracer's")
                self.assertLess(float(abs(ratio - 1).max()), tolerance)


if __name__ == "__main__":
    unittest.main()
