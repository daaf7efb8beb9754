"""The same request gives the same bits; what does not fit is refused with what would; effects that are not called for are inert."""
import re
import tempfile
import unittest

import numpy

import make
from common import VctDaemon
from render import Failed


def render(daemon, scene, size=(48, 48), **more):
    return daemon.vct(scene, size=size, **more)


class SameBits(unittest.TestCase):
    def test_twice_after_others_and_with_any_slice(self):
        with tempfile.TemporaryDirectory(prefix="candil-scenes-") as folder:
            scene, other = make.cornell(folder), make.alpha_mask(folder)
            seen, slices = set(), []
            for milliseconds in (1, 50):
                with VctDaemon("--slice", str(milliseconds)) as daemon:
                    daemon.candil("load", scene, "--name", "box")
                    daemon.candil("load", other, "--name", "other")
                    for between in (None, "box", "other"):
                        if between:
                            render(daemon, between, (24, 24), resolution=64, bounces=1)
                        picture = render(daemon, "box")
                        seen.add(picture.radiance.tobytes())
                        slices.append(picture.report["slices"])
            self.assertEqual(len(seen), 1)
            self.assertGreater(slices[0], slices[3], "the slices did not differ: this proves nothing")


class Memory(unittest.TestCase):
    def test_what_does_not_fit_is_refused_with_what_does(self):
        with VctDaemon("--memory-budget", "64") as daemon:
            daemon.candil("load", make.cornell(daemon.folder), "--name", "box")
            with self.assertRaises(Failed) as refused:
                render(daemon, "box", resolution=512)
            self.assertEqual(refused.exception.status, 6)
            print(refused.exception.text.strip())
            fits = re.search(r"resolution\D*(\d+)", refused.exception.text)
            self.assertIsNotNone(fits, refused.exception.text)
            self.assertGreater(float(render(daemon, "box", resolution=int(fits.group(1))).radiance.mean()), 0.01)


class Effects(unittest.TestCase):
    def test_forced_effects_change_nothing(self):
        with VctDaemon() as daemon:
            for scene, more in ((make.cornell(daemon.folder), []), (make.textured_quad(daemon.folder), ["--background", "1,1,1"])):
                auto, forced = (render(daemon, scene, arguments=[*more, *effects]) for effects in ([], ["--effects", "all"]))
                self.assertIn("forced", {e["state"] for e in forced.report["effects"]})
                scale = numpy.maximum(auto.radiance, 1e-3)
                self.assertLessEqual(float((numpy.abs(forced.radiance - auto.radiance) / scale).max()), 1e-5)

    def test_switched_off_they_draw_their_substitute(self):
        with VctDaemon() as daemon:
            box = make.cornell(daemon.folder)
            off = render(daemon, box, arguments=["--effects", "-bounces"])
            direct = daemon.render(box, size=(48, 48), spp=1, arguments=["--technique", "direct"])
            numpy.testing.assert_array_equal(off.radiance, direct.radiance)
            for scene, effect in ((box, "emitters"), (make.lit_floor(daemon.folder, "spot"), "lights")):
                self.assertEqual(float(render(daemon, scene, arguments=["--effects", "-" + effect]).radiance.max()), 0)


if __name__ == "__main__":
    unittest.main()
