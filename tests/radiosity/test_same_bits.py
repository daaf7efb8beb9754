"""The same request gives the same bits; effects that are not called for are inert, and what radiosity cannot show is said; what is
dark stays dark, and a scene of any size is the same picture."""
import tempfile
import unittest

import numpy

import make
from common import WHITE, RadiosityDaemon, figures
from table import HardCase
from writers import Gltf, box, quad

FEW = dict(patches=300, rays=64)


class SameBits(unittest.TestCase):
    def test_twice_after_others_and_with_any_slice(self):
        with tempfile.TemporaryDirectory(prefix="candil-scenes-") as folder:
            scene, other = make.cornell(folder), make.alpha_mask(folder)
            seen, slices = {}, []
            for milliseconds in (1, 50):
                with RadiosityDaemon("--slice", str(milliseconds)) as daemon:
                    daemon.candil("load", scene, "--name", "box")
                    daemon.candil("load", other, "--name", "other")
                    for between in (None, "box", "other"):
                        if between:
                            daemon.radiosity(between, 200, (24, 24), rays=32)
                            daemon.render(between, (24, 24), 1)
                        for more in ({}, {"display": "gather"}, {"solver": "gauss-seidel"}, {"solver": "gradient"}):
                            picture = daemon.radiosity("box", size=(48, 48), **FEW, **more)
                            seen.setdefault(str(more), set()).add(picture.radiance.tobytes())
                            slices.append(picture.report["slices"])
            self.assertEqual([len(s) for s in seen.values()], [1] * 4)
            self.assertGreater(slices[0], slices[12], "the slices did not differ: this proves nothing")

    def test_in_other_pieces_and_of_samples_alone(self):
        with RadiosityDaemon() as daemon:
            scene = make.cornell(daemon.folder)
            for display in ("vertex", "gather"):
                picture = daemon.radiosity(scene, size=(40, 40), spp=2, display=display, **FEW, render=daemon.twice)
                self.assertTrue(picture.same_bits)


def effects(picture):
    return {e["name"]: e for e in picture.report["effects"]}


class Effects(unittest.TestCase):
    def test_forced_effects_change_nothing(self):
        with RadiosityDaemon() as daemon:
            for scene, more in ((make.cornell(daemon.folder), []), (make.textured_quad(daemon.folder), WHITE)):
                for display in ("vertex", "gather"):
                    auto, forced = (daemon.radiosity(scene, display=display, **FEW, arguments=[*more, *a]) for a in ([], ["--effects", "all"]))
                    self.assertIn("forced", {e["state"] for e in forced.report["effects"]})
                    scale = numpy.maximum(auto.radiance, 1e-3)
                    self.assertLessEqual(float((numpy.abs(forced.radiance - auto.radiance) / scale).max()), 1e-5)

    def test_switched_off_they_draw_their_substitute(self):
        with RadiosityDaemon() as daemon:
            box = make.cornell(daemon.folder)
            off = daemon.radiosity(box, size=(48, 48), spp=64, display="gather", arguments=["--effects", "-bounces"], **FEW)
            direct = daemon.render(box, size=(48, 48), spp=64, arguments=["--technique", "direct"])
            # Shadows have points of their own in each.
            self.assertLess(float((numpy.abs(off.radiance - direct.radiance) / (direct.radiance + .1)).mean()), 5e-3)
            self.assertLess(abs(off.mean() / direct.mean() - 1), 1e-3)
            for scene, effect in ((box, "emitters"), (make.lit_floor(daemon.folder, "spot"), "lights")):
                self.assertEqual(float(daemon.radiosity(scene, arguments=["--effects", "-" + effect], **FEW).radiance.max()), 0)

    def test_what_is_unsupported_is_named_with_what_is_shown_instead(self):
        with RadiosityDaemon() as daemon:
            told = effects(daemon.radiosity(make.cornell_glass(daemon.folder), **FEW))
            self.assertEqual(told["glass"]["state"], "unsupported")
            self.assertIn("opaque", told["glass"]["why"])
            for effect in ("normal-maps", "alpha-blend", "clearcoat", "rough-diffuse", "caustics"):
                self.assertEqual(told[effect]["state"], "unsupported" if effect == "caustics" else "absent", effect)
                self.assertTrue(told[effect]["why"])

    def test_glossy_materials_are_told(self):
        with RadiosityDaemon() as daemon:
            g = Gltf()
            for i, more in enumerate((dict(specular=1, roughness=.4), dict(metallic=1, roughness=.4), dict(metallic=1, roughness=0), {})):
                g.place(*quad((i, 0, 0), (i + 1, 0, 0), (i + 1, 1, 0), (i, 1, 0)), g.material(f"m{i}", (.5,) * 3, **more))
            g.camera((2, .5, 5), (2, .5, 0), 40)
            notes = daemon.radiosity(g.save(daemon.folder, "glossy.gltf"), arguments=WHITE, **FEW).report["notes"]
            self.assertEqual([note for note in notes if "2 materials are drawn diffuse" in note], notes)
            self.assertEqual(daemon.radiosity(make.cornell(daemon.folder), **FEW).report["notes"], [])


class Hard(HardCase):
    def test_a_dark_room_beside_a_bright_one(self):
        """A closed room, a thousandth of its size away from a lamp of a million: nothing comes in."""
        with RadiosityDaemon() as daemon:
            for scale in (1e-3, 1.0, 1e3):
                scene = make.sealed_room(daemon.folder, scale)
                for display in ("vertex", "gather"):
                    picture = daemon.radiosity(scene, 300, rays=256, display=display, render=daemon.twice)
                    self.row("away", f"a closed room beside a lamp of radiance 1e6, {2 * scale:g} m, {display}", picture,
                             numpy.abs(picture.radiance).max(), 0, "no light comes in", 0)

    def test_any_scale_is_the_same_picture(self):
        with RadiosityDaemon() as daemon:
            def box_of(scale):
                g = Gltf()
                for part, colour, corners in make.CORNELL:
                    g.place(*quad(*[[scale * c for c in corner] for corner in corners]), g.material(part, colour))
                lamp = ((-.3, 1.9, -.3), (.3, 1.9, -.3), (.3, 1.9, .3), (-.3, 1.9, .3))
                g.place(*quad(*[[scale * c for c in corner] for corner in lamp]), g.material("lamp", (0, 0, 0), (10,) * 3))
                points, triangles = box([scale * c for c in (-.5, .2, -.5)], [scale * c for c in (0, .7, 0)])
                g.place(points, triangles, g.material("block", (.6,) * 3))
                g.camera([scale * c for c in (.1, 1, 3.9)], [scale * c for c in (0, 1, 0)], 39)
                return daemon.radiosity(g.save(daemon.folder, f"scale_{scale}.gltf"), size=(48, 48), edge=.17 * scale, rays=256, render=daemon.twice)
            usual = box_of(1.0)
            for scale in (1e-3, 1e3, 1e6):
                picture = box_of(scale)
                self.assertEqual(figures(picture)["patches"], figures(usual)["patches"])
                error = numpy.abs(picture.radiance - usual.radiance) / (usual.radiance + .01)
                self.row("size", f"radiosity of a box of {2 * scale:g} m, mean error", picture, error.mean(), 0, "the box of 2 m", 1e-3)


if __name__ == "__main__":
    unittest.main()
