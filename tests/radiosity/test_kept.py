"""What is kept from request to request: rows of form factors outlive cameras, lights and materials, and of those that a moved node
cannot have changed each. Stages and figures tell what was made again; each picture has the bits that it has by itself."""
import unittest

import numpy

import make
from common import RadiosityDaemon, figures, stages
from writers import Gltf, box, quad

daemon = RadiosityDaemon()
SOLVING = {"surfaces", "patch-light", "factors", "solve", "corners"}
MANY = dict(patches=300, rays=64)
LIGHT = ["--light", "point:at=-.5,1.5,.3,intensity=3"]
RED = ["--material", "block:color=.9,.1,.1"]
MOVED = ["--node", "block:translate=.3,.4,0"]
BESIDE = ["--camera", "0,1,3,0,1,0,0,1,0,39"]


def room():
    """A block under a lamp."""
    g = Gltf()
    for part, colour, corners in make.CORNELL:
        g.place(*quad(*corners), g.material(part, colour))
    g.place(*box((-.2, -.2, -.2), (.2, .2, .2)), g.material("block", (.6,) * 3), name="block", translation=[0, .4, 0])
    g.place(*quad((-.25, 1.98, -.25), (.25, 1.98, -.25), (.25, 1.98, .25), (-.25, 1.98, .25)), g.material("lamp", (.3,) * 3, (15, 12, 9)))
    g.camera((0, 1, 3.9), (0, 1, 0), 39)
    return g.save(daemon.folder, "room.gltf")


def beside_a_box():
    """A lit floor goes on smoothly into one that a box covers, but for a gap that no ray finds: what is inside is dark."""
    g = Gltf()
    white = g.material("white", (.6,) * 3)
    g.place(*quad((-1, 0, .5), (0, 0, .5), (0, 0, -.5), (-1, 0, -.5)), white)
    g.place(*quad((0, 0, .5), (1, 0, .5), (1, 0, -.5), (0, 0, -.5)), white)
    points, triangles = box((1e-5, 0, -.5), (1, .5, .5))
    g.place(points, [t for t in triangles if any(points[i][1] > 0 for i in t)], white)
    g.place(*quad((-.9, 1, -.4), (-.3, 1, -.4), (-.3, 1, .4), (-.9, 1, .4)), g.material("lamp", (.3,) * 3, (15, 12, 9)))
    g.camera((-1.5, 1, 1.5), (-.2, 0, 0), 50)
    return g.save(daemon.folder, "beside_a_box.gltf")


def setUpModule():
    unittest.enterModuleContext(daemon)


class Kept(unittest.TestCase):
    def setUp(self):
        daemon.candil("load", room(), "--name", "room")

    def tearDown(self):
        daemon.candil("unload", "room")

    def render(self, *arguments, **options):
        return daemon.radiosity("room", arguments=arguments, **{**MANY, **options})

    def test_another_camera_makes_nothing(self):
        first = self.render()
        self.assertLessEqual(SOLVING - {"patch-light"}, stages(first))
        self.assertGreater(figures(first)["rows.made"], 100)
        for more in ((), BESIDE, ("--size", "40x24"), ("--spp", "4")):
            again = self.render(*more)
            self.assertEqual(stages(again) & SOLVING, set(), more)
            self.assertEqual((figures(again)["rows"], figures(again)["rows.made"]), (figures(first)["rows"], 0))

    def test_another_display_makes_nothing(self):
        self.render()
        for options in (dict(display="constant"), dict(display="gather"), dict(show="b"), dict(show="row", row=3), dict(show="normal")):
            self.assertEqual(stages(self.render(**options)) & SOLVING, set(), options)

    def test_other_lights_and_materials_make_no_rows(self):
        rows = figures(self.render())["rows"]
        for more in (LIGHT, RED, RED + LIGHT, ["--material", "lamp:emission=1,2,3"], ["--effects=-bounces"]):
            again = self.render(*more)
            self.assertEqual(figures(again)["rows.made"], 0, more)
            self.assertEqual(figures(again)["rows"], rows)
            self.assertIn("solve", stages(again))

    def test_another_solver_makes_no_rows(self):
        first = self.render(solver="gradient", residual=1e-6)
        for solver in ("gauss-seidel", "jacobi"):
            again = self.render(solver=solver, residual=1e-6)
            self.assertIn("solve", stages(again))
            self.assertEqual(figures(again)["rows.made"], 0)
            numpy.testing.assert_allclose(again.radiance, first.radiance, rtol=1e-3, atol=1e-4)

    def test_other_patches_or_rays_are_made_anew(self):
        self.render()
        for options in (dict(rays=128), dict(patches=200), dict(edge=.5)):
            self.assertGreater(figures(self.render(**options))["rows.made"], 0, options)

    def test_new_light_makes_the_rows_that_it_reaches(self):
        """Behind the back wall nothing is lit, until a light is there: its rows are made, and no other."""
        rows = figures(self.render())["rows"]
        behind = self.render("--light", "point:at=0,1,-2,intensity=3")
        self.assertGreater(figures(behind)["rows.made"], 0)
        self.assertEqual(figures(behind)["rows"], rows + figures(behind)["rows.made"])

    def test_a_moved_node_makes_fewer_rows_than_all(self):
        """Those of the block, and of what sees it or could: the walls' backs and the lamp's cannot."""
        rows = figures(self.render("--background", ".1,.1,.1"))["rows"]
        moved = self.render("--background", ".1,.1,.1", *MOVED)
        made = figures(moved)["rows.made"]
        print(f"{made:.0f} of {rows:.0f} rows are made again")
        self.assertGreater(made, 0)
        self.assertLess(made, rows)
        self.assertEqual(figures(moved)["rows"], rows)

    def test_each_has_the_bits_that_it_has_alone(self):
        every = ((), LIGHT, MOVED, [*MOVED, *LIGHT], RED, [*RED, *MOVED], ["--background", ".1,.2,.3"], LIGHT)
        together = [self.render(*arguments).radiance for arguments in every]
        self.assertGreater(min(float(numpy.abs(together[0] - other).max()) for other in together[1:]), 1e-3)
        for arguments, picture in zip(every, together):
            self.tearDown()
            self.setUp()
            numpy.testing.assert_array_equal(self.render(*arguments).radiance, picture, str(arguments))

    def test_rows_that_others_wanted_change_nothing(self):
        """The light of another request reaches more. What is asked for afterwards is what it would have been before."""
        def asked(**options):
            return daemon.radiosity("beside", arguments=(), size=(64, 48), **{**MANY, **options})
        every = [dict(display="vertex"), dict(display="gather"), dict(solver="jacobi"), dict(solver="gauss-seidel"), dict(show="b"),
                 *(dict(show="row", row=row) for row in range(0, 600, 40))]
        for options in every:
            seen = []
            for before in ((), ["--light", "point:at=.5,.25,0,intensity=3"], ["--background", "1,1,1"]):
                daemon.candil("load", beside_a_box(), "--name", "beside")
                rows = 0
                if before:
                    rows = figures(daemon.radiosity("beside", arguments=before, **MANY))["rows"]
                seen.append(asked(**options))
                daemon.candil("unload", "beside")
                self.assertGreaterEqual(rows, figures(seen[0])["rows"] if before else 0)
            self.assertGreater(rows, figures(seen[0])["rows"], "the others wanted no more: this proves nothing")
            for picture in seen[1:]:
                self.assertEqual(picture.radiance.tobytes(), seen[0].radiance.tobytes(), options)

    def test_factors_outlive_the_edit_that_they_were_made_for(self):
        """More edits than a worker keeps: the moved scene goes, and its factors, which other lights use meanwhile, stay."""
        self.render(*MOVED)
        for i in range(6):
            self.render("--light", f"point:at=-.5,1.5,.{i},intensity=3")
        for options in ({}, dict(display="constant"), dict(show="row", row=3)):
            again = self.render(*MOVED, *LIGHT, **options)
            daemon.candil("unload", "room")
            daemon.candil("load", room(), "--name", "room")
            self.assertEqual(again.radiance.tobytes(), self.render(*MOVED, *LIGHT, **options).radiance.tobytes(), options)

    def test_the_seed_changes_nothing(self):
        """A solution serves requests of any seed."""
        first = self.render(*LIGHT, "--seed", "1")
        daemon.candil("unload", "room")
        daemon.candil("load", room(), "--name", "room")
        self.assertEqual(first.radiance.tobytes(), self.render(*LIGHT, "--seed", "2").radiance.tobytes())

    def test_edits_do_not_add_up_in_memory(self):
        def held():
            return daemon.stats()["device_bytes"]
        moves = [["--node", f"block:translate={.05 * i},.4,0"] for i in range(12)]
        lights = [["--light", f"point:at=0,1,{.05 * i},intensity=3"] for i in range(6)]
        self.render()
        for more in (moves[:4], lights[:4]):
            for edit in more:
                self.render(*edit)
        before = held()
        for more in (moves[4:], lights[4:], moves[:2]):
            for edit in more:
                self.render(*edit)
        print(f"{before} bytes after 8 edits, {held()} after 12 more")
        self.assertLessEqual(held(), 1.05 * before)


if __name__ == "__main__":
    unittest.main()
