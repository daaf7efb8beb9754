"""Patches that a body stands on: what is beneath it is no part of their light."""
import math
import unittest

import numpy

from common import WHITE, RadiosityDaemon
from radiosity import standing_block
from writers import Gltf, box, quad

daemon = RadiosityDaemon()
ABOVE = (0, 5, 0, 0, 0, 0, 0, 0, -1, 40)
SIZE = 32
FLOOR = numpy.array([[max(abs(x - 15.5), abs(y - 15.5)) > 8 for x in range(SIZE)] for y in range(SIZE)])


def setUpModule():
    unittest.enterModuleContext(daemon)


def block_on_floor(name, closed, sun):
    """A floor of 4 m², and in its middle a black block that covers a quarter of it, with or without a lower side."""
    g = Gltf()
    g.place(*quad((-1, 0, 1), (1, 0, 1), (1, 0, -1), (-1, 0, -1)), g.material("floor", (.5,) * 3))
    g.place(*(box((-.5, 0, -.5), (.5, .6, .5)) if closed else standing_block(.5, .6)), g.material("block", (0, 0, 0)))
    if sun:
        g.light("directional", math.pi, (0, 3, 0), (0, 0, 0), up=(0, 0, -1))
    return g.save(daemon.folder, name)


def floor_of(scene, arguments=(), **options):
    """Radiance of what is seen of the floor from above."""
    picture = daemon.radiosity(scene, size=(SIZE, SIZE), camera=ABOVE, display="constant",
                               arguments=["--orthographic", "2", *arguments], **options)
    return picture.radiance[FLOOR].astype(float)


class Blocks(unittest.TestCase):
    def test_light_from_above(self):
        """ρ E / π of the open floor, whose shadow is the block's foot, whatever the size of patches."""
        for closed in (True, False):
            for edge in (2, .5, .3):
                light = floor_of(block_on_floor(f"sun_{closed}.gltf", closed, True), edge=edge, points=1024)
                print(f"edge {edge}: {light.min():.4f} to {light.max():.4f}, expected 0.5")
                numpy.testing.assert_allclose(light, .5, rtol=.03 if edge == .3 else 1e-4)

    def test_light_of_the_sky(self):
        """The mean of a patch that has all of the floor is that of many which have none of the foot."""
        for closed in (True, False):
            scene = block_on_floor(f"sky_{closed}.gltf", closed, False)
            fine, whole = (floor_of(scene, WHITE, edge=edge, rays=rays).mean() for edge, rays in ((.125, 4096), (2, 65536)))
            print(f"fine {fine:.4f}, whole {whole:.4f}")
            self.assertLess(abs(whole / fine - 1), .01)


if __name__ == "__main__":
    unittest.main()
