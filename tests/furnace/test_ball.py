"""Smooth balls of glass under a smooth sky against geometrical optics in closed form, the rim above all.

A ray that passes a ball's centre at b radii meets every boundary at the angles that Snell's law gives it, sin = b / (n r),
again and again. So each way that light takes through a ball, or through a shell with a bubble in it, turns the view by a sum
of those angles, within one plane, and has a product of reflectances for its weight: all ways up to the depth of the request
are summed here, over a grid of points in each pixel. Radiance's η² cancels, for all ends outside.

What a picture may differ by, in radiances of which the sky's mean is 1:
- noise, whose deviation is known, for the ways' weights are the chances by which a sample takes them; Sobol's points have less;
- what the ball's triangles are off the sphere, though they have its normals. The middle of an edge h lies h²/8 inside of it, 4e-5 where
  the icosahedron was divided six times, 1.5e-4 where five times, and directions are off by as much over the cosine. That is below
  0.002 but within 0.002 of the rim, where six times divided ones were seen to be 0.007 off; each further division brought a quarter;
- 0.001, of the grid's sum over a pixel that the rim goes through.
"""
import functools
import math
import os
import unittest

import numpy

import images
import skies
from render import Daemon
from writers import Gltf, icosphere

daemon = Daemon()
SIDE = 48


def setUpModule():
    global sky
    unittest.enterModuleContext(daemon)
    sky = os.path.join(daemon.folder, "sky.exr")
    images.write(sky, radiance(skies.directions(512, 256)))


@functools.lru_cache
def sphere(subdivisions):
    return icosphere(subdivisions)


def radiance(w):
    """The sky's, of unit vectors: another polynomial in each channel, between 0.3 and 2."""
    x, y, z = w[..., 0], w[..., 1], w[..., 2]
    return numpy.stack([1 + 0.7 * y, 1 + 0.6 * x - 0.2 * z, 0.7 + 0.9 * z * z + 0.5 * x * y - 0.4 * z], axis=-1)


def reflectance(i, t):
    """Fresnel's of angles on both sides; t is nan where all is reflected."""
    across = (numpy.sin(i - t) / numpy.maximum(numpy.sin(i + t), 1e-12)) ** 2
    along = (numpy.tan(i - t) / numpy.maximum(numpy.abs(numpy.tan(i + t)), 1e-12)) ** 2
    return numpy.where(numpy.isnan(t), 1.0, 0.5 * (across + along))


class Ways:
    """The ways through a ball of index n and radius 1, with a bubble of radius `hollow` (0: none), for the impact parameters
    b, all above 0. add(weight, turn) is called with each: how far the view is turned, towards the centre."""

    def __init__(self, b, n, hollow, depth, add):
        with numpy.errstate(invalid="ignore"):
            self.out, self.glass = numpy.arcsin(b), numpy.arcsin(b / n)
            self.meets = b < n * hollow
            a = hollow if hollow else 1.0
            self.above, self.within = numpy.arcsin(b / (n * a)), numpy.arcsin(b / a)
        self.depth, self.add = depth, add
        self.outer = reflectance(self.out, self.glass)
        self.inner = numpy.where(self.meets, reflectance(self.above, self.within), 0.0)
        self.hollow = hollow > 0
        add(self.outer, -(math.pi - 2 * self.out))
        self.down(1 - self.outer, numpy.nan_to_num(self.out - self.glass), 1)

    def down(self, weight, turn, events):
        """From the outer boundary inwards, through the glass."""
        if events >= self.depth or not weight.any():
            return
        passes = weight * ~self.meets if self.hollow else weight
        self.up(passes, turn, events)
        if self.hollow:
            weight = weight * self.meets
            self.up(weight * self.inner, turn - (math.pi - 2 * numpy.nan_to_num(self.above)), events + 1)
            self.bubble(weight * (1 - self.inner), turn + numpy.nan_to_num(self.above - self.within), events + 1)

    def up(self, weight, turn, events):
        """Through the glass to the outer boundary."""
        if events >= self.depth or not weight.any():
            return
        glass = numpy.nan_to_num(self.glass)
        self.add(weight * (1 - self.outer), turn + numpy.nan_to_num(self.out - self.glass))
        self.down(weight * self.outer, turn + math.pi - 2 * glass, events + 1)

    def bubble(self, weight, turn, events):
        if events >= self.depth or not weight.any():
            return
        within = numpy.nan_to_num(self.within)
        self.up(weight * (1 - self.inner), turn + numpy.nan_to_num(self.above - self.within), events + 1)
        self.bubble(weight * self.inner, turn + math.pi - 2 * within, events + 1)


def view_rays(camera, grid):
    """Unit directions to a grid x grid of points in each pixel, and whether they are seen: (pixels, points, 3)."""
    eye, target, up = (numpy.array(camera[i:i + 3], float) for i in (0, 3, 6))
    ahead = (target - eye) / numpy.linalg.norm(target - eye)
    right = numpy.cross(ahead, up)
    right /= numpy.linalg.norm(right)
    at = ((numpy.arange(SIDE * grid) + 0.5) / (SIDE * grid) * 2 - 1) * math.tan(math.radians(camera[9]) / 2)
    w = ahead + at[None, :, None] * right - at[:, None, None] * numpy.cross(right, ahead)
    w /= numpy.linalg.norm(w, axis=2, keepdims=True)
    return w.reshape(SIDE, grid, SIDE, grid, 3).swapaxes(1, 2).reshape(SIDE * SIDE, grid * grid, 3)


def closed_form(camera, n, hollow, depth, grid):
    """Each pixel's mean radiance, the variance of one sample of it, and its middle's impact parameter."""
    eye, w = numpy.array(camera[:3], float), view_rays(camera, grid)
    to_centre = -eye - (w @ -eye)[..., None] * w
    b = numpy.linalg.norm(to_centre, axis=2)
    hits = b < 1
    view, across, impact = w[hits], (to_centre / b[..., None])[hits], numpy.maximum(b[hits], 1e-9)
    first, second = numpy.zeros((len(impact), 3)), numpy.zeros((len(impact), 3))

    def add(weight, turn):
        seen = radiance(numpy.cos(turn)[:, None] * view + numpy.sin(turn)[:, None] * across)
        first[:] += weight[:, None] * seen
        second[:] += weight[:, None] * seen ** 2
    Ways(impact, n, hollow, depth, add)
    sums = numpy.stack([radiance(w), radiance(w) ** 2])
    sums[:, hits] = [first, second]
    mean, square = sums.mean(axis=2)
    return (mean.reshape(SIDE, SIDE, 3), numpy.maximum(square - mean ** 2, 0).reshape(SIDE, SIDE, 3),
            b.mean(axis=1).reshape(SIDE, SIDE))


WHOLE = (0, 0, 8, 0, 0, 0, 0, 1, 0, 16)                # the ball, and a little of the sky around
RIM = (0, 0, 8, 0.7016, 0.7016, 0.126, 0, 1, 0, 0.4)   # a piece of its rim, a pixel a thousandth of its radius


class Ball(unittest.TestCase):
    def picture(self, camera, subdivisions, ior, hollow, depth, spp):
        g = Gltf()
        # One set of vertices for both balls, and their positions are their normals.
        number = g.mesh(*sphere(subdivisions))
        shape = g.json["meshes"][number]["primitives"][0]
        shape["attributes"]["NORMAL"] = shape["attributes"]["POSITION"]
        for radius, index in ((1, ior), (hollow, 1.0)):
            if radius:
                body = g.material(f"index {index}", roughness=0, ior=index, clear=1, volume={"thicknessFactor": 1})
                g.node(mesh=g.add("meshes", {"primitives": [dict(shape, material=body)]}), scale=[radius] * 3)
        return daemon.render(g.save(daemon.folder, "ball.glb"), size=(SIDE, SIDE), spp=spp, camera=camera,
                             options={"pt.depth": depth}, arguments=["--background", sky]).radiance

    def check(self, name, camera, edges, subdivisions=5, ior=1.5, hollow=0.0, depth=8, spp=64):
        """Pixel by pixel, and in the mean over rings, whose noise is less, left half and right half."""
        expected, variance, b = closed_form(camera, ior, hollow, depth, 8)
        error = self.picture(camera, subdivisions, ior, hollow, depth, spp) - expected
        shape = numpy.where((b > 0.998) & (b < 1.002), 0.01, 0.003)[..., None]
        worst = float((numpy.abs(error) / (shape + numpy.sqrt(variance / spp))).max())
        print(f"{name}: pixels at most {worst:.2f} deviations off")
        self.assertLess(worst, 5, name)
        left = numpy.arange(SIDE)[None, :] * 2 < SIDE
        for low, high in zip(edges, edges[1:]):
            for half in (left, ~left):
                ring = (b >= low) & (b < high) & half
                if ring.sum() < 20:
                    continue
                off = numpy.abs(error[ring].mean(axis=0))
                noise = numpy.sqrt(variance[ring].sum(axis=0) / spp) / ring.sum()
                print(f"  b from {low} to {high}: {off.max():.5f} off, noise {noise.max():.5f}")
                self.assertLess(float((off / (shape[ring].max() + 3 * noise)).max()), 1, (name, low))

    def test_whole(self):
        edges = (0, .3, .6, .8, .9, .94, .97, 1.0, 1.04, 1.2)
        self.check("glass", WHOLE, edges)
        self.check("bubble", WHOLE, edges, ior=0.75)
        self.check("shell", WHOLE, edges, hollow=0.8, depth=7)

    def test_rim(self):
        edges = (.97, .98, .985, .99, .994, .996, .998, .999, 1, 1.001, 1.002, 1.01)
        self.check("rim", RIM, edges, 6, spp=192)
        self.check("rim of a shell", RIM, edges, 6, hollow=0.8, depth=7, spp=192)


if __name__ == "__main__":
    unittest.main()
