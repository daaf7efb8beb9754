"""What of a texture is seen at a place: repeated, mirrored and held at the edge, at sides of every kind, by every technique."""
import math
import unittest

import numpy

from render import Daemon
from writers import Gltf, png

daemon = Daemon()
REPEAT, CLAMP, MIRROR = 10497, 33071, 33648
NEAREST, LINEAR = 9728, 9729


def setUpModule():
    unittest.enterModuleContext(daemon)


def linear(byte):
    return ((byte / 255 + 0.055) / 1.055) ** 2.4 if byte > 10 else byte / 255 / 12.92


def wrapped(i, side, wrap):
    """Which texel stands at place i: what the specification says, by Python's own remainder."""
    if wrap == CLAMP:
        return min(max(i, 0), side - 1)
    if wrap == REPEAT:
        return i % side
    m = i % (2 * side)
    return m if m < side else 2 * side - 1 - m


class Wrap(unittest.TestCase):
    def strip(self, sides, u, v, wraps=(REPEAT, REPEAT), filtered=NEAREST):
        """An unlit square over the coordinates u[0]…u[1] and v[0]…v[1], left to right and top to bottom."""
        values = [[40 + (83 * x + 131 * y) % 200 for x in range(sides[0])] for y in range(sides[1])]
        g = Gltf()
        texture = g.image(png(*sides, lambda x, y: (values[y][x],) * 3), magFilter=filtered, minFilter=filtered, wrapS=wraps[0], wrapT=wraps[1])
        corners = [(-1, -1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0)]
        g.node(mesh=g.mesh(corners, [(0, 1, 2), (0, 2, 3)], g.material("strip", texture=texture, unlit=True),
                           uvs=[(u[0], v[1]), (u[1], v[1]), (u[1], v[0]), (u[0], v[0])]))
        return g.save(daemon.folder, "strip.gltf"), numpy.array([[linear(b) for b in row] for row in values])

    def check(self, sides, u, v, size, wraps=(REPEAT, REPEAT), filtered=NEAREST, techniques=("pt", "direct")):
        scene, texels = self.strip(sides, u, v, wraps, filtered)
        expected = numpy.empty((size[1], size[0]))
        for y in range(size[1]):
            for x in range(size[0]):
                at = [(a[0] + (a[1] - a[0]) * (i + 0.5) / n) * side for a, i, n, side in zip((u, v), (x, y), size, sides)]
                if filtered == NEAREST:
                    parts = [[(math.floor(c), 1.0)] for c in at]
                else:
                    low = [math.floor(c - 0.5) for c in at]
                    parts = [[(l, 1 - (c - 0.5 - l)), (l + 1, c - 0.5 - l)] for l, c in zip(low, at)]
                expected[y, x] = sum(wx * wy * texels[wrapped(j, sides[1], wraps[1]), wrapped(i, sides[0], wraps[0])]
                                     for i, wx in parts[0] for j, wy in parts[1])
        for technique in techniques:
            # `pt` looks anywhere in a pixel, so that it is held to places where a pixel shows one texel.
            if technique == "pt" and filtered == LINEAR:
                continue
            with self.subTest(technique=technique, sides=sides, u=u, v=v, wraps=wraps, filtered=filtered):
                picture = daemon.render(scene, size, 1, (0, 0, 5, 0, 0, 0, 0, 1, 0, 40),
                                        arguments=["--technique", technique, "--orthographic", "2"])
                self.assertLess(float(numpy.abs(picture.radiance[:, :, 0] - expected).max()), 2e-3)

    def test_negative_coordinates_repeat_a_texture_of_any_side(self):
        for side in (1, 2, 3, 5, 6, 7, 9, 11, 13):
            self.check((side, side), (-1, 0), (-1, 0), (side, side))

    def test_many_turns_below_zero(self):
        for side, turns in ((3, 7), (5, 12), (6, 40), (7, 33), (10, 8)):
            self.check((side, side), (-turns, 1 - turns), (-turns, 1 - turns), (side, side))

    def test_across_zero(self):
        for side in (3, 5, 7):
            self.check((side, side), (-1, 2), (-2, 1), (3 * side, 3 * side), techniques=("pt", "direct", "vct"))

    def test_the_edge_of_a_filtered_texture_is_that_of_the_other_end(self):
        """Left of its first texel's middle, a texture that repeats is read at texel −1, with coordinates that are never negative."""
        for side in (3, 4, 5, 6, 7, 12):
            self.check((side, side), (0, 1), (0, 1), (8 * side, 8 * side), filtered=LINEAR)

    def test_mirrored_and_held(self):
        for side in (3, 5, 6):
            for wraps in ((MIRROR, MIRROR), (CLAMP, CLAMP), (MIRROR, REPEAT), (REPEAT, CLAMP)):
                for filtered in (NEAREST, LINEAR):
                    self.check((side, side), (-3, 0), (-3, 0), (3 * side, 3 * side), wraps, filtered)


if __name__ == "__main__":
    unittest.main()
