"""Who needs shader code that has to be compiled waits for it alone: a process of its own compiles it, and whatever becomes of that,
each request is answered once."""
import os
import signal
import tempfile
import unittest

import wire
from fakes import FakeCase, pattern, render
from wire import pb

COLD = 7  # the seed of what needs code


class ColdCase(FakeCase):
    def prepare(self):
        self.folder = tempfile.TemporaryDirectory(dir=self.daemon.folder)
        self.addCleanup(self.folder.cleanup)
        self.daemon.environment["FAKE_COLD"] = self.folder.name

    def path(self, name):
        return os.path.join(self.folder.name, name)

    def go(self):
        open(self.path("go"), "w").close()

    def compilers(self):
        return os.path.getsize(self.path("compilers")) if os.path.exists(self.path("compilers")) else 0

    def wait_for_compiler(self, count=1):
        wire.wait_for(lambda: self.compilers() == count, "a compiler runs")

    def begin_cold(self, connection, **fields):
        job = connection.send(wire.RENDER, render(seed=COLD, **fields))
        self.wait_for_compiler()
        return job

    def done(self, connection, job):
        """Its picture is as it should be, and all of its time has a name."""
        replies = connection.follow(job)
        self.assertEqual(replies[-1].kind, wire.DONE, replies[-1])
        self.assertEqual([reply.kind for reply in replies].count(wire.ACCEPTED), 1)
        self.assertEqual(bytes(wire.images(replies)[-1][1]), pattern(64, COLD))
        body = replies[-1].body
        self.assertEqual((body.retries, connection.stats().worker_starts), (0, 1))
        self.assertAlmostEqual(sum(stage.us for stage in body.stages), body.elapsed_us, delta=0.05 * body.elapsed_us + 2000)
        return body


class Compiled(ColdCase):
    def test_others_are_served_meanwhile(self):
        connection, other = self.with_box(), self.connect()
        job = self.begin_cold(connection)
        for seed in range(5):
            replies = other.follow(other.send(wire.RENDER, render(seed=seed)))
            self.assertEqual(bytes(wire.images(replies)[-1][1]), pattern(64, seed))
        self.assertEqual(other.stats().jobs, 1)
        self.go()
        body = self.done(connection, job)
        self.assertGreater(body.cold_us, 0)
        self.assertIn("compile", [stage.name for stage in body.stages])
        self.assertNotIn("lost", [stage.name for stage in body.stages])
        self.assertEqual(self.done(connection, connection.send(wire.RENDER, render(seed=COLD))).cold_us, 0)

    def test_one_compiler_for_all_that_need_the_same(self):
        connections = [self.with_box()] + [self.connect() for _ in range(5)]
        jobs = [self.begin_cold(c) for c in connections]
        wire.wait_for(lambda: connections[0].stats().jobs == 6, "all are there")
        self.go()
        for connection, job in zip(connections, jobs):
            self.done(connection, job)
        self.assertEqual(self.compilers(), 1)

    def test_one_client_leaves_a_compiler_to_others(self):
        connection = self.with_box()
        jobs = [connection.send(wire.RENDER, render(seed=1000 + i)) for i in range(5)]
        self.wait_for_compiler(2)
        for seed in range(3):
            connection.follow(connection.send(wire.RENDER, render(seed=seed)))
        self.assertEqual(self.compilers(), 2)
        self.go()
        for job in jobs:
            self.assertEqual(connection.follow(job)[-1].kind, wire.DONE)

    def test_a_deadline_is_kept(self):
        connection = self.with_box()
        replies = connection.follow(self.begin_cold(connection, deadline_ms=300))
        self.assert_error(replies[-1], "deadline")
        self.assertFalse(os.path.exists(self.path("compiled")))
        # What was compiled for it serves the next.
        self.go()
        self.done(connection, connection.send(wire.RENDER, render(seed=COLD)))
        self.assertEqual(self.compilers(), 1)

    def test_it_can_be_cancelled(self):
        connection, other = self.with_box(), self.connect()
        job = self.begin_cold(connection)
        self.assertEqual(connection.ask(wire.CANCEL, pb.Cancel(request=job)).kind, wire.OK)
        self.assert_error(connection.follow(job)[-1], "cancelled")
        self.assertEqual(other.stats().jobs, 0)
        self.go()
        self.done(other, other.send(wire.RENDER, render(seed=COLD)))

    def test_the_worker_may_be_lost_meanwhile(self):
        connection, other = self.with_box(), self.connect()
        job = self.begin_cold(connection)
        first = other.stats().worker_pid
        os.kill(first, signal.SIGKILL)
        wire.wait_for(lambda: other.stats().worker_pid not in (0, first), "another runs")
        self.go()
        self.assertEqual(connection.follow(job)[-1].kind, wire.DONE)

    def test_the_daemon_may_end_meanwhile(self):
        self.begin_cold(self.with_box())  # and FakeCase.stop looks at its end


class WithinItsShare(ColdCase):
    environment = {"FAKE_HELD": str(5 << 20)}

    def test_a_large_picture_is_compiled_as_a_small_one(self):
        """Of sides that are powers of two, or whose halves are, or neither, each as it was: code may differ by that alone."""
        pt, direct, option = pb.TECHNIQUE_PT, pb.TECHNIQUE_DIRECT, pb.Option(name="direct.rows", value="64")
        for asked, least, fields in (((4096, 4095), "8x7", dict(technique=pt)), ((1280, 5), "12x5", dict(technique=direct)),
                                     ((1280, 8), "12x8", dict(technique=pt, options=[pb.Option(name="pt.depth", value="2")])),
                                     ((1280, 720), "1280x720", dict(technique=direct, options=[option]))):
            with self.subTest(asked):
                for name in filter(os.path.exists, map(self.path, ("compilers", "compiled", "go"))):
                    os.remove(name)
                connection = self.with_box()
                connection.follow(connection.send(wire.RENDER, render()))
                self.begin_cold(connection, width=asked[0], height=asked[1], **fields)
                with open(self.path("asked")) as file:
                    self.assertEqual(file.read().split(), [least, "5"])  # MiB that the worker says it has
                connection.close()
                self.go()
                wire.wait_for(lambda: os.path.exists(self.path("compiled")), "it has compiled")


class OnASoftwareDevice(ColdCase):
    environment = {"FAKE_SOFTWARE": "1"}

    def test_frames_beside_a_compiler_tell_no_speed(self):
        connection, other = self.with_box(), self.connect()
        asked = render(width=100, height=100, samples=16)

        def time_of_three_frames():
            for _ in range(3):
                self.assertEqual(other.follow(other.send(wire.RENDER, asked))[-1].kind, wire.DONE)
            return other.ask(wire.QUOTE, pb.Quote(render=asked)).body.choice.time_ms
        first = other.ask(wire.QUOTE, pb.Quote(render=asked)).body.choice.time_ms  # by a pilot: 10 ms a sample
        job = self.begin_cold(connection)
        self.assertGreater(time_of_three_frames(), first / 2)
        self.go()
        self.done(connection, job)
        self.assertLess(time_of_three_frames(), first / 2)  # by frames, which say that it takes none


class ForAPilot(ColdCase):
    def quote(self, connection):
        job = connection.send(wire.QUOTE, pb.Quote(render=render(seed=COLD), pilot_ms=10))
        self.wait_for_compiler()
        return job

    def test_others_are_served_meanwhile(self):
        connection, other = self.with_box(), self.connect()
        quote = self.quote(connection)
        self.assertEqual(other.follow(other.send(wire.RENDER, render()))[-1].kind, wire.DONE)
        self.go()
        reply = connection.receive_for(quote)
        self.assertEqual((reply.kind, getattr(reply.body, "from")), (wire.QUOTE_REPLY, "pilot"))
        self.assertEqual((self.compilers(), connection.stats().worker_starts), (1, 1))

    def test_a_job_needs_the_same(self):
        connection, other = self.with_box(), self.connect()
        quote, job = self.quote(connection), self.begin_cold(other)
        self.go()
        self.done(other, job)
        self.assertEqual(connection.receive_for(quote).kind, wire.QUOTE_REPLY)
        self.assertEqual(self.compilers(), 1)

    def test_who_asked_may_go(self):
        connection, other = self.with_box(), self.connect()
        self.quote(connection)
        connection.close()
        self.assertEqual(other.follow(other.send(wire.RENDER, render()))[-1].kind, wire.DONE)


class CompilerDiesForAPilot(ColdCase):
    environment = {"FAKE_COMPILER": "die"}

    def test_the_worker_compiles(self):
        connection = self.with_box()
        quote = connection.send(wire.QUOTE, pb.Quote(render=render(seed=COLD), pilot_ms=10))
        self.assertEqual(connection.receive_for(quote).kind, wire.QUOTE_REPLY)
        self.assertEqual(self.compilers(), 1)


class CompiledInAStep(ColdCase):
    environment = {"FAKE_COLD_STEP": "1"}

    def test_it_begins_again(self):
        connection, other = self.with_box(), self.connect()
        job = self.begin_cold(connection)
        self.assertEqual(other.follow(other.send(wire.RENDER, render()))[-1].kind, wire.DONE)
        self.go()
        self.done(connection, job)


class CompilerDies(ColdCase):
    environment = {"FAKE_COMPILER": "die"}

    def test_the_worker_compiles(self):
        connection = self.with_box()
        self.done(connection, self.begin_cold(connection))
        self.assertEqual(self.compilers(), 1)


class CompilerCrashes(ColdCase):
    environment = {"FAKE_COMPILER": "crash"}

    def test_it_is_not_tried_again_in_the_worker(self):
        connection = self.with_box()
        reply = connection.follow(self.begin_cold(connection))[-1]
        self.assert_error(reply, "worker-lost")
        self.assertIn("compiler", reply.body.message)
        self.assertEqual(connection.follow(connection.send(wire.RENDER, render()))[-1].kind, wire.DONE)
        self.assertEqual((connection.stats().worker_starts, self.compilers()), (1, 1))


class CompilerMakesNothing(ColdCase):
    environment = {"FAKE_COMPILER": "nothing"}

    def test_the_worker_compiles(self):
        connection = self.with_box()
        self.done(connection, self.begin_cold(connection))
        self.assertEqual(self.compilers(), 1)


class CompilerHangs(ColdCase):
    environment = {"FAKE_COMPILER": "stop"}
    arguments = ("--hang", "1")

    def test_it_is_ended(self):
        connection = self.with_box()
        self.done(connection, self.begin_cold(connection))


if __name__ == "__main__":
    unittest.main()
