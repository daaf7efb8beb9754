"""Shader code that no driver has compiled yet: one client waits for it, others do not, and a second daemon finds it."""
import os
import tempfile
import unittest

import make
import rooms
import wire
from render import Daemon
from wire import pb


def compiles(daemon):
    """Does a process compile for this daemon?"""
    for pid in filter(str.isdigit, os.listdir("/proc")):
        try:
            with open(f"/proc/{pid}/status") as status, open(f"/proc/{pid}/cmdline", "rb") as line:
                if f"PPid:\t{daemon}\n" in status.read() and b"--compile" in line.read():
                    return True
        except OSError:
            pass  # it has gone
    return False


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
        return connection.send(wire.RENDER, pb.Render(scene="room", width=127, height=100, samples=1, technique=technique))

    def read_log(self, daemon):
        """What a small picture has had compiled is all that a larger one needs: the worker compiles nothing."""
        log = daemon.read_log()
        self.assertNotIn("the worker compiles", log)
        return log

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
            self.assertIn("compiler of", self.read_log(daemon))
        # What has been compiled once is found by the next daemon, which makes it in moments and needs no compiler.
        with self.daemon() as daemon:
            daemon.candil("load", self.scene, "--name", "room")
            with wire.Connection(daemon.socket) as one:
                for technique in (pb.TECHNIQUE_PT, pb.TECHNIQUE_DIRECT):
                    self.assertEqual(one.follow(self.ask(one, technique))[-1].kind, wire.DONE)
            self.assertNotIn("compiler of", daemon.read_log())

    def test_it_takes_no_more_than_its_share_of_the_budget(self):
        with self.daemon("--scene", f"room={self.scene}", "--memory-budget", "24") as daemon, wire.Connection(daemon.socket) as one:
            # With an option it is compiled as it is, and takes more than a third of what there is: the worker finds no code.
            render = pb.Render(scene="room", width=512, height=512, samples=1, technique=pb.TECHNIQUE_DIRECT,
                               options=[pb.Option(name="direct.samples", value="1")])
            replies = one.follow(one.send(wire.RENDER, render))
            self.assertEqual(replies[-1].kind, wire.DONE, replies[-1])
            accepted = next(reply.body for reply in replies if reply.kind == wire.ACCEPTED)
            self.assertGreater(accepted.job_bytes, 8 << 20)
            log = daemon.read_log()
            self.assertIn("compiler of", log)
            self.assertIn("the worker compiles", log)

    def test_scenes_of_all_sizes_need_the_same(self):
        """One whose nodes are 64 bytes, and others whose are kilobytes: what the driver keeps of the first is enough for them."""
        kept = []
        for subdivisions in (None, 2, 3):
            path = rooms.plane(self.scenes.name, 1) if subdivisions is None else make.furnace(self.scenes.name, 1, subdivisions)
            with self.daemon() as daemon:
                daemon.candil("render", path, "-o", os.path.join(daemon.folder, "x.exr"), "--size", "16x16", "--spp", "1")
            kept.append(sorted(name for _, _, names in os.walk(os.path.join(self.cache.name, "mesa_shader_cache")) for name in names))
        self.assertGreater(len(kept[0]), 1)
        self.assertEqual(kept[1:], kept[:1] * 2)

    def test_a_refusal_for_code_is_not_the_next_ones(self):
        """Code that a job had to wait for is forgotten with it: what is wrong with another request is told at once."""
        with self.daemon("--scene", f"room={self.scene}") as daemon, wire.Connection(daemon.socket) as one:
            job = self.ask(one, pb.TECHNIQUE_PT)
            wire.wait_for(lambda: compiles(daemon.process.pid), "a compiler runs")
            self.assertEqual(one.ask(wire.CANCEL, pb.Cancel(request=job)).kind, wire.OK)
            wrong = pb.Render(scene="room", width=16, height=16, samples=1, technique=pb.TECHNIQUE_PT, camera=pb.Camera(name="none such"))
            reply = one.follow(one.send(wire.RENDER, wrong))[-1]
            self.assertEqual((reply.kind, reply.body.name), (wire.ERROR, "bad-argument"), reply)

    def test_the_first_client_finds_it_warm(self):
        with self.daemon("--warm", f"room={self.scene}") as daemon, wire.Connection(daemon.socket) as one:
            for technique in (pb.TECHNIQUE_VCT, pb.TECHNIQUE_PT, pb.TECHNIQUE_DIRECT):
                render = pb.Render(scene="room", width=512, height=512, samples=1, technique=technique)
                done = one.follow(one.send(wire.RENDER, render))[-1]
                self.assertEqual((done.kind, done.body.cold_us), (wire.DONE, 0), done)
            self.assertIn("compiler of", self.read_log(daemon))


if __name__ == "__main__":
    unittest.main()
