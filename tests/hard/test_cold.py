"""Shader code that no driver has compiled yet: one client waits for it, others do not, and a second daemon finds it."""
import os
import subprocess
import tempfile
import unittest

import make
import wire
from render import Daemon
from wire import pb


class Cold(unittest.TestCase):
    def setUp(self):
        self.cache = tempfile.TemporaryDirectory()
        self.addCleanup(self.cache.cleanup)
        self.scenes = tempfile.TemporaryDirectory()
        self.addCleanup(self.scenes.cleanup)
        self.scene = make.SCENES["furnace"](self.scenes.name)

    def daemon(self, *arguments):
        return Daemon(*arguments, environment={"MESA_SHADER_CACHE_DIR": self.cache.name, "CANDIL_LOG": "info"})

    @staticmethod
    def ask(connection, technique):
        return connection.send(wire.RENDER, pb.Render(scene="room", width=16, height=16, samples=1, technique=technique))

    def test_it_is_compiled_beside_the_worker(self):
        with self.daemon() as daemon:
            daemon.candil("load", self.scene, "--name", "room")
            with wire.Connection(daemon.socket) as one, wire.Connection(daemon.socket) as two:
                first = two.follow(self.ask(two, pb.TECHNIQUE_DIRECT))[-1].body
                self.assertGreater(first.cold_us, 0)
                cold = self.ask(one, pb.TECHNIQUE_PT)
                # The worker is free to draw for another client: however slow the machine, compiling is longer than this.
                other = two.follow(self.ask(two, pb.TECHNIQUE_DIRECT))[-1].body
                self.assertEqual(other.cold_us, 0)
                stats = two.stats()
                self.assertEqual((stats.jobs, stats.worker_starts), (1, 1))
                done = one.follow(cold)[-1]
                self.assertEqual(done.kind, wire.DONE, done)
                self.assertGreater(done.body.cold_us, 0)
                self.assertEqual(done.body.non_finite_samples, 0)
                self.assertEqual(one.follow(self.ask(one, pb.TECHNIQUE_PT))[-1].body.cold_us, 0)
            self.assertIn("compiler of", daemon.read_log())
        # What has been compiled once is found by the next daemon, which makes it in moments and needs no compiler.
        with self.daemon() as daemon:
            daemon.candil("load", self.scene, "--name", "room")
            with wire.Connection(daemon.socket) as one:
                for technique in (pb.TECHNIQUE_PT, pb.TECHNIQUE_DIRECT):
                    self.assertEqual(one.follow(self.ask(one, technique))[-1].kind, wire.DONE)
            self.assertNotIn("compiler of", daemon.read_log())

    def test_the_first_client_finds_it_warm(self):
        with self.daemon("--warm", f"room={self.scene}") as daemon, wire.Connection(daemon.socket) as one:
            for technique in (pb.TECHNIQUE_VCT, pb.TECHNIQUE_PT, pb.TECHNIQUE_DIRECT):
                render = pb.Render(scene="room", width=512, height=512, samples=1, technique=technique)
                done = one.follow(one.send(wire.RENDER, render))[-1]
                self.assertEqual((done.kind, done.body.cold_us), (wire.DONE, 0), done)


if __name__ == "__main__":
    unittest.main()
