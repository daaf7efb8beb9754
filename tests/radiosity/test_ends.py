"""A solution that is under way can be left at any time: by a cancel, a deadline or a client that goes. Nothing of it is left, and
progress tells how far it is."""
import os
import unittest

import numpy

import images
import make
import wire
from common import RadiosityDaemon
from wire import pb

LONG = {"radiosity.patches": "12000", "radiosity.rays": "4096"}
SHORT = {"radiosity.patches": "2000", "radiosity.rays": "512"}


def setUpModule():
    global daemon, connection
    daemon = unittest.enterModuleContext(RadiosityDaemon("--slice", "5"))
    daemon.candil("load", make.cornell(daemon.folder), "--name", "box")
    connection = unittest.enterModuleContext(wire.Connection(daemon.socket))
    usual()


def usual():
    """All code is compiled; the same picture each time."""
    return daemon.radiosity("box", 300, rays=64).radiance


def submit(options=LONG, size=32, to=None, **fields):
    options = [pb.Option(name=name, value=value) for name, value in options.items()]
    request = pb.Render(scene="box", width=size, height=size, samples=1, technique=pb.TECHNIQUE_RADIOSITY, format=pb.FORMAT_EXR_FLOAT,
                        options=options, progress_ms=1, **fields)
    return (to or connection).send(wire.RENDER, request)


def under_way(request, to=None):
    """Until some of its factors are made."""
    while True:
        reply = (to or connection).receive_for(request)
        assert reply.kind in (wire.ACCEPTED, wire.PROGRESS), reply
        if reply.kind == wire.PROGRESS and reply.body.fraction > .1:
            return reply.body


class Ends(unittest.TestCase):
    def load_again(self):
        """What was made of it goes with the scene."""
        daemon.candil("unload", "box")
        daemon.candil("load", make.cornell(daemon.folder), "--name", "box")

    def picture(self, replies):
        path = os.path.join(daemon.folder, "picture.exr")
        with open(path, "wb") as file:
            file.write(wire.images(replies)[-1][1])
        return images.rgb(path)

    def setUp(self):
        self.before, self.held = usual(), daemon.stats()["device_bytes"]

    def tearDown(self):
        # Patches without any rows may be kept, for whoever comes next.
        wire.wait_for(lambda: daemon.stats()["device_bytes"] <= self.held + (4 << 20), "no rows of it are left")
        numpy.testing.assert_array_equal(usual(), self.before)
        self.assertEqual(daemon.stats()["worker_starts"], 1)

    def test_cancelled_while_factors_are_made(self):
        request = submit()
        under_way(request)
        self.assertEqual(connection.ask(wire.CANCEL, pb.Cancel(request=request)).kind, wire.OK)
        last = connection.follow(request)[-1]
        self.assertEqual((last.kind, last.body.name), (wire.ERROR, "cancelled"))

    def test_a_deadline_while_factors_are_made(self):
        """There is nothing that could be shown."""
        replies = connection.follow(submit(deadline_ms=500))
        self.assertEqual((replies[-1].kind, replies[-1].body.name), (wire.ERROR, "deadline"))
        self.assertEqual(wire.images(replies), [])

    def test_a_client_that_goes(self):
        with wire.Connection(daemon.socket) as other:
            under_way(submit(to=other), other)

    def test_two_at_once_and_one_of_them_is_left(self):
        """They share what is made: who stays gets it, as if it were alone."""
        first, second = submit(SHORT), submit(SHORT)
        under_way(first)
        self.assertEqual(connection.ask(wire.CANCEL, pb.Cancel(request=first)).kind, wire.OK)
        self.assertEqual(connection.follow(first)[-1].kind, wire.ERROR)
        replies = connection.follow(second)
        self.assertEqual(replies[-1].kind, wire.DONE)
        pictures = [self.picture(replies)]
        self.load_again()
        pictures.append(self.picture(connection.follow(submit(SHORT))))
        numpy.testing.assert_array_equal(*pictures)
        self.load_again()

    def test_progress_goes_on(self):
        replies = connection.follow(submit(SHORT))
        self.assertEqual(replies[-1].kind, wire.DONE)
        told = [r.body for r in replies if r.kind == wire.PROGRESS]
        fractions = [p.fraction for p in told]
        self.assertEqual(fractions, sorted(fractions))
        self.assertGreater(len(set(fractions)), 5)
        self.assertLessEqual(fractions[-1], 1)
        # While there is no picture there is no error of it.
        self.assertTrue(all(p.estimated_relmse < 0 for p in told if p.samples_done == 0))
        self.load_again()


if __name__ == "__main__":
    unittest.main()
