"""Projected form factors: other factors, which the scene's own know nothing of, with the sums and the reciprocity that is known of
all; and the light that they make."""
import unittest

import numpy

import rooms
from common import RadiosityDaemon, figures, stages
from writers import Gltf, box, quad

daemon = RadiosityDaemon()
FEW = {"patches": 200, "rays": 64}


def setUpModule():
    unittest.enterModuleContext(daemon)


def white_box(name, albedo=.95, low=.1):
    """A closed box with a lamp, whose whole ceiling shines a little, and a block."""
    g = Gltf()
    positions, triangles = box((-1, 0, -1), (1, 2, 1), inward=True)
    g.place(positions, triangles, g.material("walls", (albedo,) * 3))
    g.place(*box((-.5, low, -.3), (0, low + .7, .2)), g.material("block", (albedo,) * 3))
    g.place(*quad((-.9, 1.9, -.9), (.9, 1.9, -.9), (.9, 1.9, .9), (-.9, 1.9, .9)), g.material("lamp", (.3,) * 3, (1,) * 3))
    g.camera((0, 1, .95), (0, .7, -1), 80)
    path = g.save(daemon.folder, name + ".gltf")
    daemon.candil("load", path, "--name", name)
    return name


class Projected(unittest.TestCase):
    def test_figures(self):
        scene = white_box("figures")
        raw, sums, both = (daemon.radiosity(scene, show="b", project=project, **FEW) for project in ("none", "sums", "both"))
        self.assertNotIn("reciprocity.projected", figures(raw))
        self.assertNotIn("project", stages(raw))
        self.assertIn("project", stages(both))
        # The rows themselves are those of all.
        for name, value in figures(raw).items():
            if name.startswith(("check.", "sum.", "values.", "reciprocity.")):
                self.assertEqual((figures(sums)[name], figures(both)[name]), (value, value), name)
        self.assertEqual(figures(both)["rows.made"], 0)
        self.assertGreater(figures(raw)["reciprocity.mean"], .3)
        # Rays hit as often as there are rays, so that their sums need no scaling.
        self.assertAlmostEqual(figures(sums)["reciprocity.projected"], figures(raw)["reciprocity.mean"], delta=1e-4)
        self.assertLess(figures(both)["reciprocity.projected"], .2 * figures(raw)["reciprocity.mean"])

    def test_whatever_was_asked_for_before(self):
        """The same bits after others and before them, and theirs too."""
        fresh, used = white_box("fresh"), white_box("used")
        light = ["--light", "point:at=0,1.2,.5,intensity=1"]
        first = daemon.radiosity(fresh, project="both", arguments=light, **FEW)
        raw = daemon.radiosity(used, **FEW)
        daemon.radiosity(used, project="sums", arguments=light, **FEW)
        second = daemon.radiosity(used, project="both", arguments=light, **FEW)
        numpy.testing.assert_array_equal(first.radiance, second.radiance)
        numpy.testing.assert_array_equal(raw.radiance, daemon.radiosity(fresh, **FEW).radiance)
        self.assertGreater(float(numpy.abs(raw.radiance - daemon.radiosity(used, project="both", **FEW).radiance).max()), 1e-3)

    def test_furnace(self):
        """All is 1 whatever the factors, as long as their sums are."""
        picture = daemon.radiosity(rooms.uniform_room(daemon.folder, .9), 54, rays=64, project="both")
        self.assertLess(float(numpy.abs(picture.radiance - 1).max()), 2e-3)

    def test_it_is_nearer_the_light_of_many_rays(self):
        scene = white_box("white")
        options = dict(patches=200, emitters="factors", display="constant")
        right = daemon.radiosity(scene, rays=65536, **options).radiance

        def error(rays, project):
            return float(numpy.sqrt(((daemon.radiosity(scene, rays=rays, project=project, **options).radiance - right) ** 2).mean()))

        # Of patches whose areas differ little it is as twice the rays would have it, if all noise were of pairs. What lies above
        # the lamp is covered, of some patches in part: what is open of them is what pairs exchange light by.
        part = {rays: error(rays, "both") / error(rays, "none") for rays in (64, 96, 128, 192, 256)}
        print(part)
        self.assertLess(max(part.values()), .95)
        self.assertLess(sum(part.values()) / len(part), .85)
        none = error(64, "none")
        self.assertAlmostEqual(error(64, "sums"), none, delta=1e-3 * none)

    def test_where_mirrors_are_it_does_nothing_and_says_so(self):
        g = Gltf()
        positions, triangles = box((-1, 0, -1), (1, 2, 1), inward=True)
        g.place(positions, triangles, g.material("walls", (.5,) * 3))
        g.place(*quad((-.3, 1.98, -.3), (.3, 1.98, -.3), (.3, 1.98, .3), (-.3, 1.98, .3)), g.material("lamp", (.3,) * 3, (12,) * 3))
        g.place(*quad((-.5, .5, -.9), (.5, .5, -.9), (.5, 1.5, -.9), (-.5, 1.5, -.9)), g.material("mirror", (.9,) * 3, metallic=1, roughness=0))
        g.camera((0, 1, .95), (0, .7, -1), 80)
        scene = g.save(daemon.folder, "mirror.gltf")
        with_it = daemon.radiosity(scene, project="both", **FEW)
        self.assertTrue([note for note in with_it.report["notes"] if "radiosity.project" in note])
        numpy.testing.assert_array_equal(with_it.radiance, daemon.radiosity(scene, **FEW).radiance)


if __name__ == "__main__":
    unittest.main()
