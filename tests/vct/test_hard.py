"""Scenes that voxels do not like: of any size, far away, flat, thin, empty, or around the camera."""
import math
import unittest

import numpy

import make
from common import WHITE, VctDaemon
from table import HardCase
from writers import Gltf, box, quad

daemon = VctDaemon()


def setUpModule():
    unittest.enterModuleContext(daemon)


def triangle(name, *corners, lit=True):
    g = Gltf()
    g.place([list(c) for c in corners], [(0, 1, 2)], g.material("triangle", (0.5,) * 3))
    if lit:
        g.light("directional", 1.0, (0, 0, 2), (0, 0, 0), up=(0, 1, 0))
    g.camera((0, 0, 3), (0, 0, 0), 40)
    return g.save(daemon.folder, name)


class Scales(HardCase):
    def room(self, scale=1.0, offset=(0, 0, 0)):
        g = Gltf()
        for part, colour, corners in make.CORNELL:
            g.place(*quad(*[[scale * c for c in corner] for corner in corners]), g.material(part, colour), translation=list(offset))
        lamp = [[scale * c for c in corner] for corner in ((-.3, 1.9, -.3), (.3, 1.9, -.3), (.3, 1.9, .3), (-.3, 1.9, .3))]
        g.place(*quad(*lamp), g.material("lamp", (0, 0, 0), (10,) * 3), translation=list(offset))
        g.camera([scale * c + o for c, o in zip((0.1, 1, 3.9), offset)], [scale * c + o for c, o in zip((0, 1, 0), offset)], 39)
        return daemon.vct(g.save(daemon.folder, f"scale_{scale}_{offset[0]}.gltf"), size=(48, 48), render=daemon.twice)

    def test_any_scale_and_offset_is_the_same_picture(self):
        """To the rounding of a coordinate: a sample or a triangle's border may fall on the other side of a voxel's."""
        usual = self.room().radiance
        self.assertGreater(float(usual.mean()), 0.05)
        for scale, offset in ((1e-3, (0, 0, 0)), (1e3, (0, 0, 0)), (1e6, (0, 0, 0)), (1.0, (1e5, 0, 0))):
            picture = self.room(scale, offset)
            error = numpy.abs(picture.radiance - usual) / (usual + 0.01)
            case = f"a room, {offset[0] / 1000:g} km from the origin" if offset[0] else f"a room of {2 * scale:g} m"
            for what, value, tolerance in (("mean error", error.mean(), 1e-3), ("99th percentile of the error", numpy.percentile(error, 99), 0.01)):
                self.row("place" if offset[0] else "size", f"{case}, {what}", picture, value, 0, "the room of 2 m at the origin", tolerance)


class Shapes(unittest.TestCase):
    def finite(self, scene, **more):
        radiance = daemon.vct(scene, **more).radiance
        self.assertTrue(bool(numpy.isfinite(radiance).all()))
        self.assertGreaterEqual(float(radiance.min()), 0)
        return radiance

    def test_one_triangle(self):
        lit = self.finite(triangle("one.gltf", (-1, -1, 0), (1, -1, 0), (0, 1, 0)))
        self.assertLess(abs(float(lit[16, 16].mean()) * math.pi / 0.5 - 1), 1e-3)

    def test_needle(self):
        for width in (1e-3, 1e-6):
            self.finite(triangle("needle.gltf", (-1, 0, 0), (1, 0, 0), (1, width, 0)), arguments=WHITE)

    def test_no_area_at_all(self):
        self.finite(triangle("point.gltf", (0, 0, 0), (0, 0, 0), (0, 0, 0)), arguments=WHITE)

    def test_flat_scene_along_each_axis(self):
        corners = ((-1, -1), (1, -1), (1, 1), (-1, 1))
        for axis in range(3):
            g = Gltf()
            flat = [[*c[:axis], 0.25, *c[axis:]] for c in corners]
            g.place(*quad(*flat), g.material("flat", (0.5,) * 3, both_sides=True))
            g.camera((2, 2.1, 2.2), (0, 0, 0), 40)
            radiance = self.finite(g.save(daemon.folder, f"flat_{axis}.gltf"), arguments=WHITE)
            self.assertLess(abs(float(radiance[16, 16].mean()) / 0.5 - 1), 1e-3)

    def test_empty_scene(self):
        g = Gltf()
        g.camera((0, 0, 3), (0, 0, 0), 40)
        status, _, _ = daemon.candil("load", g.save(daemon.folder, "empty.gltf"), "--name", "empty", check=False)
        if status == 0:
            self.assertEqual(float(self.finite("empty", arguments=WHITE).min()), 1.0)
        else:
            self.assertEqual(status, 4)

    def test_nothing_in_view(self):
        self.assertEqual(float(self.finite(make.cornell(daemon.folder), camera=(0, 1, 9, 0, 1, 20, 0, 1, 0, 40)).max()), 0)

    def test_camera_within_a_wall(self):
        """In the middle of a block's side, which is in a voxel; and of a solid, all of whose backs are seen."""
        g = Gltf()
        g.place(*box((-2, -2, -2), (2, 2, 2), inward=True), g.material("room", (0.7,) * 3, (0.3,) * 3))
        g.place(*box((-.5, -.5, -.5), (.5, .5, .5)), g.material("block", (0.7,) * 3))
        scene = g.save(daemon.folder, "wall.gltf")
        for z in (0.5, 0.4999, 0.0, 2.0, 2.05):
            self.finite(scene, camera=(0.01, 0.02, z, 0.1, 0.3, -1.5, 0, 1, 0, 60))


if __name__ == "__main__":
    unittest.main()
