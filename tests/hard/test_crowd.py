"""Sixty-four connections at once on a real device: each gets its own picture, whatever others do, and nothing is left of it."""
import os
import sys
import tempfile
import unittest

import numpy

import crowd
import images
import make
import wire
from wire import pb

ROUNDS = 3
SEEDS = 4


def request(**fields):
    values = dict(width=16, height=16, samples=2, format=pb.FORMAT_EXR_FLOAT)
    values.update(fields)
    return pb.Render(scene="box", **values)


class Crowd(unittest.TestCase):
    def connect(self):
        connection = self.daemon.connect()
        self.addCleanup(connection.close)
        return connection

    def radiance(self, replies):
        self.assertEqual(replies[-1].kind, wire.DONE, replies[-1])
        (_, data), = wire.images(replies)
        path = os.path.join(self.daemon.folder, "picture.exr")
        with open(path, "wb") as file:
            file.write(data)
        channels = images.channels(path)
        return numpy.stack([channels[c] for c in "RGB"])

    def render(self, connection, **fields):
        return self.radiance(connection.follow(connection.send(wire.RENDER, request(**fields))))

    def load(self, folder):
        """The scene, on the connection that is returned; skips where there is no device."""
        first = self.connect()
        first.load("box", folder, os.path.basename(make.cornell(folder)))
        replies = first.follow(first.send(wire.RENDER, request()))
        if replies[-1].kind == wire.ERROR and replies[-1].body.name == "device":
            self.skipTest(replies[-1].body.message)
        return first

    def test_each_gets_its_own_picture(self):
        with tempfile.TemporaryDirectory(prefix="candil-scenes-") as folder, wire.Daemon() as self.daemon:
            first = self.load(folder)
            expected = [self.render(first, seed=seed) for seed in range(SEEDS)]
            self.assertFalse(numpy.array_equal(expected[0], expected[1]))
            stalled = request(width=512, height=512, samples=1)
            people = crowd.Crowd(self.daemon, self.connect, [stalled],
                                 crowd.slow_render(scene="box", width=16, height=16, samples=2, format=pb.FORMAT_EXR_FLOAT))
            worker = people.observer.stats().worker_pid
            for number in range(ROUNDS):
                for i, replies in people.ask_all(lambda i: request(seed=(number + i) % SEEDS)):
                    self.assertTrue(numpy.array_equal(self.radiance(replies), expected[(number + i) % SEEDS]))
                now = (people.held(), wire.descriptors(worker))
                memory = self.daemon.rss_kib(), wire.rss_kib(worker)
                if number == 0:
                    first_held, first_memory = now, memory
            self.assertEqual(now, first_held)
            self.assertLess(memory[0] - first_memory[0], crowd.growth_allowed_kib())
            self.assertLess(memory[1] - first_memory[1], 16 * crowd.growth_allowed_kib())
            self.assertGreater(float(self.radiance(people.finish_slow()).max()), 0)
            self.assertEqual(people.observer.stats().worker_starts, 1)


if __name__ == "__main__":
    outcome = unittest.main(exit=False).result
    sys.exit(77 if outcome.skipped else not outcome.wasSuccessful())
