"""What all share is shared between processes, however many connections and requests one of them has."""
import os
import unittest

import wire
from fakes import FakeCase, render
from wire import pb

SAMPLES = 20


class PeersCase(FakeCase):
    arguments = ("--hang", "600")  # a loader that is to wait for ever is not to be found out while a busy machine takes its time

    def prepare(self):
        self.trace_file = os.path.join(self.daemon.folder, "trace")
        self.daemon.environment["FAKE_TRACE"] = self.trace_file

    def pipe(self, name):
        os.mkfifo(os.path.join(self.scenes, name))

    def let_it_come(self, name):
        with open(os.path.join(self.scenes, name), "w", encoding="ascii") as file:
            file.write("ok")


class Jobs(PeersCase):
    """Everything is asked for while its scene is still to come, so nothing ends meanwhile."""

    def setUp(self):
        super().setUp()
        self.pipe("late.gltf")
        self.loading = self.connect(elsewhere=True)
        self.load = self.loading.send_load("late", self.scenes, "late.gltf")
        wire.wait_for(lambda: self.loading.stats().loader_pid, "the scene is on its way")

    def ask(self, connection, count, kind=wire.RENDER, **fields):
        request = render("late", samples=SAMPLES, **fields)
        if kind == wire.SWEEP:
            request = pb.Sweep(render=request, cameras=[pb.Camera()] * 3)
        return [(connection, connection.send(kind, request)) for _ in range(count)]

    def finish(self):
        self.let_it_come("late.gltf")
        self.assertEqual(self.loading.receive_for(self.load).kind, wire.SCENE_INFO)

    def test_one_leaves_a_quarter_to_others(self):
        mine = [self.connect() for _ in range(13)]
        asked = [one for connection in mine[:12] for one in self.ask(connection, 16)]
        refused = mine[12].ask(wire.RENDER, render("late"))
        self.assert_error(refused, "too-many-jobs")
        self.assertIn("192 of this process", refused.body.message)
        self.assert_error(mine[12].ask(wire.SWEEP, pb.Sweep(render=render("late"), cameras=[pb.Camera()])), "too-many-jobs")
        for _ in range(8):
            asked += self.ask(self.connect(elsewhere=True), 4)
        wire.wait_for(lambda: self.loading.stats().jobs == 224, "others have theirs")
        self.finish()
        for connection, request in asked:
            self.assertEqual(connection.follow(request)[-1].kind, wire.DONE)
        self.assertEqual(self.loading.stats().jobs, 0)

    def test_sweeps_beyond_their_share_come_to_their_end(self):
        asked = [one for _ in range(12) for one in self.ask(self.connect(), 16, wire.SWEEP)]
        asked += self.ask(self.connect(elsewhere=True), 16)
        self.finish()
        for connection, request in asked:
            self.assertEqual(connection.follow(request)[-1].kind, wire.DONE)

    def test_ten_jobs_hold_up_anothers_one_no_more_than_one(self):
        asked = self.ask(self.connect(), 10)
        asked += self.ask(self.connect(elsewhere=True), 1)
        self.finish()
        for connection, request in asked:
            self.assertEqual(connection.follow(request)[-1].kind, wire.DONE)
        with open(self.trace_file, encoding="ascii") as file:
            steps = file.read().split()
        own = max(set(steps), key=int)  # the last that was asked for
        at = [i for i, step in enumerate(steps) if step == own]
        self.assertEqual(len(at), SAMPLES)
        # One is begun before it, and has a slice while it is begun itself.
        self.assertLessEqual(at[0], 2)
        self.assertLessEqual(max(b - a for a, b in zip(at, at[1:])), 2)


class Loads(PeersCase):
    def test_the_next_loader_is_another_s(self):
        mine, other = self.connect(), self.connect(elsewhere=True)
        for name in ("one", "two", "three"):
            self.pipe(name)
        loads = [mine.send_load(name, self.scenes, name) for name in ("one", "two", "three")]
        wire.wait_for(lambda: mine.stats().loader_starts == 2, "both loaders are at work")
        theirs = other.send_load("box", self.scenes, "box.gltf")
        other.ask(wire.PING)
        self.let_it_come("one")
        self.assertEqual(other.receive_for(theirs).kind, wire.SCENE_INFO)
        for name in ("two", "three"):
            self.let_it_come(name)
        for load in loads:
            self.assertEqual(mine.receive_for(load).kind, wire.SCENE_INFO)


if __name__ == "__main__":
    unittest.main()
