"""Patches that a body stands on: what is beneath it is no part of their light. Jobs that share patches find the same."""
import math
import os
import unittest

import numpy

import images
import wire
from common import WHITE, RadiosityDaemon
from radiosity import standing_block
from wire import pb
from writers import Gltf, box, quad

daemon = RadiosityDaemon("--slice", "1")
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

    def test_rows_see_the_sky_that_light_comes_from(self):
        """A background comes by rows, and the same radiance of a picture straight from it: of one patch they have the same mean,
        whichever way rows are made. Where hemicubes or contour integrals make them both are of all of the patch."""
        sky = os.path.join(daemon.folder, "even.exr")
        images.write(sky, numpy.ones((8, 16, 3)))
        scene = block_on_floor("even.gltf", False, False)
        for factors, more in (("hemisphere", dict(rays=16384)), ("hemicube", dict(hemicube=128, origins=256)), ("analytic", {})):
            rows, light = (floor_of(scene, arguments, edge=2, points=256, factors=factors, **more).mean()
                           for arguments in (WHITE, ["--background", sky]))
            print(f"{factors}: {rows:.4f} by rows, {light:.4f} straight")
            self.assertLess(abs(rows / light - 1), .02, factors)


class OtherWay(unittest.TestCase):
    def test_furniture_in_a_room_wound_outward(self):
        """To a block's top the room's walls show their backs, and a beam above it its front: what sees walls alone is inside of
        nothing, so that the light of a lamp is that which it is where rows are of whole patches, and nothing is looked for."""
        g = Gltf()
        g.place(*box((-2, 0, -2), (2, 3, 2)), g.material("walls", (.5,) * 3))
        g.place(*box((-1, .2, -1), (1, .6, 1)), g.material("block", (.5,) * 3))
        g.place(*box((.7, .65, -.8), (.95, .8, .8)), g.material("beam", (.5,) * 3))
        g.light("point", 5, (-1.2, 2.5, .3))
        scene = g.save(daemon.folder, "outward.gltf")
        for edge in (3, .7):
            seen = [daemon.radiosity(scene, size=(SIZE, SIZE), camera=(0, 2.9, 0, 0, 0, 0, 0, 0, -1, 60), display="constant", edge=edge,
                                     points=256, factors=factors, arguments=["--effects=-bounces"]).radiance
                    for factors in ("hemisphere", "hemicube")]
            self.assertGreater(float(seen[0].mean()), .01)
            numpy.testing.assert_array_equal(*seen)


class Shared(unittest.TestCase):
    """Jobs of different lights share patches, and what is covered of them."""
    @classmethod
    def setUpClass(cls):
        g = Gltf()
        g.place(*quad((-1, 0, 1), (1, 0, 1), (1, 0, -1), (-1, 0, -1)), g.material("floor", (.5,) * 3))
        block = g.mesh(*standing_block(.05, .1), g.material("block", (0, 0, 0)))
        for i in range(100):
            g.node(mesh=block, translation=[.2 * (i % 10) - .9, 0, .2 * (i // 10) - .9])
        cls.file = g.save(daemon.folder, "shared.gltf")
        cls.connection = cls.enterClassContext(wire.Connection(daemon.socket))

    def setUp(self):
        daemon.candil("load", self.file, "--name", "shared")

    def tearDown(self):
        daemon.candil("unload", "shared")

    def again(self):
        self.tearDown()
        self.setUp()

    def submit(self, colour, edge=.06):
        options = {"edge": str(edge), "rays": "256", "display": "constant"}
        options = [pb.Option(name="radiosity." + name, value=value) for name, value in options.items()]
        camera = pb.Camera(eye=pb.Vec3(y=5), target=pb.Vec3(), up=pb.Vec3(z=-1), vfov_degrees=40)
        return self.connection.send(wire.RENDER, pb.Render(
            scene="shared", width=SIZE, height=SIZE, samples=1, technique=pb.TECHNIQUE_RADIOSITY, format=pb.FORMAT_EXR_FLOAT,
            options=options, camera=camera, background=pb.Vec3(x=colour[0], y=colour[1], z=colour[2]), progress_ms=1))

    def picture(self, request):
        replies = self.connection.follow(request)
        self.assertEqual(replies[-1].kind, wire.DONE, replies[-1])
        path = os.path.join(daemon.folder, "picture.exr")
        with open(path, "wb") as file:
            file.write(wire.images(replies)[-1][1])
        return images.rgb(path)

    def until(self, request, least):
        """Its progress, once it is so far."""
        while True:
            reply = self.connection.receive_for(request)
            self.assertIn(reply.kind, (wire.ACCEPTED, wire.PROGRESS))
            if reply.kind == wire.PROGRESS and reply.body.fraction >= least:
                return reply.body.fraction

    def test_one_beside_another(self):
        """Begun at once, and while the first makes rows: each picture is that which it is alone."""
        colours = (1, 1, 1), (.3, .6, .9)
        alone = []
        for colour in colours:
            alone.append(self.picture(self.submit(colour)))
            self.again()
        self.assertGreater(float(numpy.abs(alone[0] - alone[1]).max()), .01)
        for late in (False, True):
            first = self.submit(colours[0])
            if late:
                self.assertLess(self.until(first, .2), .9, "it was too far: this proves nothing")
            second = self.submit(colours[1])
            for request, expected in zip((first, second), alone):
                numpy.testing.assert_array_equal(self.picture(request), expected)
            self.again()

    def test_one_is_cancelled(self):
        """In its first stage, with the rows of another made or not: what comes after it is what it is alone."""
        alone = self.picture(self.submit((1, 1, 1)))
        for made in (False, True):
            self.again()
            if made:
                self.picture(self.submit((.3, .6, .9)))
            request = self.submit((.9, .2, .1))
            far = self.until(request, 0 if made else 1e-4)
            self.assertTrue(made or far < .02, "it was beyond its first stage: this proves nothing")
            self.connection.ask(wire.CANCEL, pb.Cancel(request=request))
            self.connection.follow(request)
            numpy.testing.assert_array_equal(self.picture(self.submit((1, 1, 1))), alone)


if __name__ == "__main__":
    unittest.main()
