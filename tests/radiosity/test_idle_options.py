"""Options that are given and do nothing: told in notes, of every technique, and the picture is the same without them."""
import os
import unittest

import numpy

import make
from common import RadiosityDaemon

daemon = RadiosityDaemon()


def setUpModule():
    unittest.enterModuleContext(daemon)


def render(technique, *arguments, **options):
    named = {(name if "." in name else technique + "." + name): value for name, value in options.items()}
    return daemon.render(make.cornell(daemon.folder), size=(8, 8), spp=1, options=named,
                         arguments=["--technique", technique, *arguments])


def idle(picture):
    return [note for note in picture.report["notes"] if " nothing without " in note]


FEW = {"patches": 60, "rays": 16}


class Idle(unittest.TestCase):
    def check(self, technique, expected, given, **rest):
        """`given` does nothing beside `rest`, and the notes say so."""
        with self.subTest(technique=technique, given=given, rest=rest):
            picture = render(technique, **rest, **given)
            self.assertEqual(idle(picture), expected)
            numpy.testing.assert_array_equal(picture.radiance, render(technique, **rest).radiance)

    def test_radiosity(self):
        self.check("radiosity", ["radiosity.gather, direct.samples and direct.shadows do nothing without radiosity.display=gather"],
                   {"gather": 3, "direct.samples": 4, "direct.shadows": "none"}, **FEW)
        self.check("radiosity", ["radiosity.display and direct.samples do nothing without radiosity.show=none"],
                   {"display": "gather", "direct.samples": 4}, show="albedo", **FEW)
        self.check("radiosity", ["radiosity.hemicube and radiosity.origins do nothing without radiosity.factors=hemicube"],
                   {"hemicube": 16, "origins": 2}, **FEW)
        self.check("radiosity", ["radiosity.rays does nothing without radiosity.factors=hemisphere or analytic"],
                   {"rays": 32}, factors="hemicube", patches=30, hemicube=16, origins=1)
        self.check("radiosity", ["radiosity.patches does nothing without radiosity.edge=0"], {"patches": 99}, edge=1, rays=16)
        self.check("radiosity", ["radiosity.bounces does nothing without mirrors"], {"bounces": 3}, **FEW)

    def test_radiosity_with_a_file(self):
        """Of form factors the light is found anew; of a solution nothing is."""
        for kind in ("mtx", "ply"):
            path = os.path.join(daemon.folder, "idle." + kind)
            daemon.candil("render", make.cornell(daemon.folder), "-o", path, "--technique", "radiosity", "--set", "radiosity.patches=60",
                          "--set", "radiosity.rays=16", "--no-default-light")
            made = {"factors": "hemicube", "rays": 64, "hemicube": 16, "origins": 2, "mirrors": "off", "bounces": 3, "project": "sums"}
            found = {"points": 1, "emitters": "factors", "solver": "jacobi", "residual": .05} if kind == "ply" else {}
            given = {**made, **found}
            picture = render("radiosity", "--set", "radiosity.import=" + path, patches=60, **given)
            for name in given:
                self.assertIn("radiosity." + name, " ".join(idle(picture)), kind)
            self.assertTrue(all(note.endswith("imported") for note in idle(picture)), idle(picture))
            plain = render("radiosity", "--set", "radiosity.import=" + path, patches=60)
            self.assertEqual(idle(plain), [])
            numpy.testing.assert_array_equal(picture.radiance, plain.radiance)

    def test_pt(self):
        self.check("pt", ["pt.light_tree does nothing without pt.lights=mis or nee"], {"light_tree": "on"}, lights="none")
        self.assertEqual(idle(render("pt", light_tree="on", lights="nee")), [])

    def test_what_does_something_is_not_told(self):
        for options in ({"display": "gather", "gather": 1, "direct.samples": 1, "direct.shadows": "map", "direct.map": 256}, {},
                        {"factors": "hemicube", "hemicube": 16, "origins": 1}):
            picture = render("radiosity", patches=30, **options)
            self.assertEqual(idle(picture), [], options)

    def test_direct_and_vct(self):
        self.check("direct", ["direct.map does nothing without direct.shadows=map"], {"direct.map": 256})
        self.check("vct", ["vct.shadow_aperture does nothing without vct.shadows=cones", "vct.ao does nothing without vct.ambient"],
                   {"shadow_aperture": 20, "ao": 2}, resolution=16)
        self.check("vct", ["vct.axis does nothing without vct.slice", "vct.detail does nothing without vct.show=none"],
                   {"axis": "y", "detail": "full"}, resolution=16, show="albedo")
        self.assertEqual(idle(render("vct", resolution=16, shadows="cones", shadow_aperture=20)), [])

    def test_rays_and_cones_of_vct(self):
        marched = {"step": 1, "start": 2, "dither": 1, "pyramid": "isotropic", "cover": "product", "own": "in"}
        told = ("vct.step, vct.start, vct.dither, vct.pyramid, vct.cover and vct.own do nothing without cones: vct.gather=cones, "
                "glossy surfaces, glass, or vct.shadows through the voxels")
        self.check("vct", ["vct.rays does nothing without vct.gather=rays"], {"rays": 8}, resolution=16)
        self.check("vct", ["vct.cones does nothing without vct.gather=cones"], {"cones": 32}, resolution=16, gather="rays")
        self.check("vct", ["vct.cones does nothing without vct.show=none"], {"cones": 32}, resolution=16, show="radiance")
        self.check("vct", [told], marched, resolution=16, gather="rays")
        for options in ({"gather": "rays", "rays": 8, "shadows": "march", **marched}, {"cones": 16, **marched},
                        {"gather": "rays", "show": "coverage", "level": 1, **marched}):
            self.assertEqual(idle(render("vct", resolution=16, **options)), [], options)


if __name__ == "__main__":
    unittest.main()
