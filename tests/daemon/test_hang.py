"""Who hangs is found, whatever it is doing, and who is slow is waited for. The bounds are small here; none is one of the clock for
what works."""
import os
import signal
import subprocess
import sys
import unittest

import wire
from fakes import FakeCase, endless, pattern, render
from wire import pb

BOUNDS = ("--hang", "1", "--answer", "1")


class HangCase(FakeCase):
    arguments = BOUNDS

    def answers_after_a_loss(self, why, **fields):
        """A render is answered as if nothing had been, by a second worker."""
        connection = self.with_box()
        replies = connection.follow(connection.send(wire.RENDER, render(samples=10, seed=4, **fields)))
        self.assertEqual(replies[-1].kind, wire.DONE, replies[-1])
        self.assertEqual(bytes(wire.images(replies)[-1][1]), pattern(64, 4))
        self.assertEqual(connection.stats().worker_starts, 2)
        self.assertIn(why, self.daemon.log_text())
        return replies[-1].body


class Sleeps(HangCase):
    environment = {"FAKE_HANG": "sleep", "FAKE_HANG_ON": "step"}

    def test_in_a_step(self):
        self.assertEqual(self.answers_after_a_loss("neither worked nor waited").retries, 1)


class Stopped(HangCase):
    environment = {"FAKE_HANG": "stop", "FAKE_HANG_ON": "step"}

    def test_in_a_step(self):
        self.assertEqual(self.answers_after_a_loss("neither worked nor waited").retries, 1)


class Burns(HangCase):
    environment = {"FAKE_HANG": "burn", "FAKE_HANG_ON": "step"}

    def test_in_a_step(self):
        self.assertEqual(self.answers_after_a_loss("without an end").retries, 1)


class SleepsInBegin(HangCase):
    environment = {"FAKE_HANG": "sleep", "FAKE_HANG_ON": "begin"}

    def test_in_a_beginning(self):
        self.assertEqual(self.answers_after_a_loss("neither worked nor waited").retries, 1)


class StoppedInRead(HangCase):
    environment = {"FAKE_HANG": "stop", "FAKE_HANG_ON": "read"}

    def test_while_it_encodes(self):
        self.assertEqual(self.answers_after_a_loss("neither worked nor waited").retries, 1)


class BurnsInRead(HangCase):
    environment = {"FAKE_HANG": "burn", "FAKE_HANG_ON": "read"}

    def test_while_it_encodes(self):
        self.assertEqual(self.answers_after_a_loss("one image without an end").retries, 1)


class SleepsAtStart(HangCase):
    environment = {"FAKE_HANG": "sleep", "FAKE_HANG_ON": "ready"}

    def test_before_it_is_ready(self):
        self.answers_after_a_loss("neither worked nor waited")


class StoppedTwice(HangCase):
    environment = {"FAKE_HANG": "stop", "FAKE_HANG_ON": "step", "FAKE_DIE_TIMES": "2"}

    def test_the_second_loss_is_told(self):
        connection = self.with_box()
        reply = connection.follow(connection.send(wire.RENDER, render()))[-1]
        self.assert_error(reply, "worker-lost")
        self.assertIn("it hung", reply.body.message)
        # Who is stopped is no victim of a scene.
        self.assertEqual(connection.follow(connection.send(wire.RENDER, render()))[-1].kind, wire.DONE)


class StoppedInPilot(HangCase):
    environment = {"FAKE_HANG": "stop", "FAKE_HANG_ON": "pilot"}

    def test_the_quote_is_answered(self):
        connection = self.with_box()
        reply = connection.receive_for(connection.send(wire.QUOTE, pb.Quote(render=render(technique=pb.TECHNIQUE_AUTO), pilot_ms=10)))
        self.assertEqual(reply.kind, wire.QUOTE_REPLY, reply)
        wire.wait_for(lambda: connection.stats().worker_starts == 2, "another worker is started")


class AnswerCase(FakeCase):
    """The worker hangs, and nobody ends it here: what is answered is answered without it."""

    def tearDown(self):
        with self.daemon.connect() as other:
            self.assertEqual(other.stats().worker_starts, 1)

    def send(self, **fields):
        connection = self.with_box()
        wire.wait_for(lambda: connection.stats().device, "the worker is ready")
        return connection, connection.send(wire.RENDER, endless(**fields))


class InStep(AnswerCase):
    environment = {"FAKE_HANG": "sleep", "FAKE_HANG_ON": "step"}

    def test_a_deadline(self):
        connection, job = self.send(deadline_ms=300)
        replies = connection.follow(job)
        self.assert_error(replies[-1], "deadline")
        self.assertEqual([reply.kind for reply in replies].count(wire.ERROR), 1)
        self.assertEqual(connection.stats().jobs, 0)
        self.assert_error(connection.follow(connection.send(wire.RENDER, render(deadline_ms=100)))[-1], "deadline")

    def test_a_cancel(self):
        connection, job = self.send()
        self.assertEqual(connection.ask(wire.CANCEL, pb.Cancel(request=job)).kind, wire.OK)
        self.assert_error(connection.follow(job)[-1], "cancelled")
        self.assertEqual(connection.stats().jobs, 0)

    def test_progress_goes_on(self):
        connection, job = self.send()
        told = []
        while len(told) < 3:
            reply = connection.receive_for(job)
            if reply.kind == wire.PROGRESS:
                told.append(reply.body.elapsed_us)
                self.assertEqual(reply.body.stage, "render")
        self.assertEqual(told, sorted(set(told)))

    def test_a_sweep(self):
        connection = self.with_box()
        replies = connection.follow(connection.send(wire.SWEEP, pb.Sweep(render=endless(deadline_ms=300), cameras=[pb.Camera()] * 3)))
        self.assert_error(replies[-1], "deadline")
        self.assertEqual(connection.stats().jobs, 0)

    def test_others_are_served(self):
        connection, _ = self.send()
        other = self.connect()
        other.load("another", self.scenes, "box.gltf")
        self.assertEqual(len(other.ask(wire.LIST_SCENES).body.scenes), 2)
        other.ask(wire.UNLOAD, pb.Unload(name="another"))
        connection.close()


class InBurningStep(InStep):
    environment = {"FAKE_HANG": "burn", "FAKE_HANG_ON": "step"}


class InBegin(AnswerCase):
    environment = {"FAKE_HANG": "sleep", "FAKE_HANG_ON": "begin"}

    def test_a_deadline(self):
        connection, job = self.send(deadline_ms=300)
        reply = connection.follow(job)[-1]
        self.assert_error(reply, "deadline")
        self.assertIn("compiled", reply.body.message)

    def test_a_cancel(self):
        connection, job = self.send()
        self.assertEqual(connection.ask(wire.CANCEL, pb.Cancel(request=job)).kind, wire.OK)
        self.assert_error(connection.follow(job)[-1], "cancelled")

    def test_progress_is_told(self):
        connection, job = self.send()
        told = [connection.receive_for(job) for _ in range(2)]
        self.assertEqual([reply.kind for reply in told], [wire.PROGRESS] * 2)
        self.assertEqual(told[0].body.stage, "begin")


class InRead(AnswerCase):
    environment = {"FAKE_HANG": "stop", "FAKE_HANG_ON": "read"}

    def test_a_deadline(self):
        connection, job = self.send(deadline_ms=300)
        reply = connection.follow(job)[-1]
        self.assert_error(reply, "deadline")
        self.assertEqual(connection.stats().image_bytes, 0)

    def test_a_cancel(self):
        connection = self.with_box()
        job = connection.send(wire.RENDER, render())
        self.assertEqual(connection.ask(wire.CANCEL, pb.Cancel(request=job)).kind, wire.OK)
        self.assert_error(connection.follow(job)[-1], "cancelled")


class InPilot(AnswerCase):
    environment = {"FAKE_HANG": "stop", "FAKE_HANG_ON": "pilot"}

    def test_a_deadline_behind_it(self):
        connection, asker = self.with_box(), self.connect()
        wire.wait_for(lambda: connection.stats().device, "the worker is ready")
        asker.send(wire.QUOTE, pb.Quote(render=render(technique=pb.TECHNIQUE_AUTO), pilot_ms=10))
        asker.ask(wire.PING)  # by now the pilot is out
        self.assert_error(connection.follow(connection.send(wire.RENDER, render(deadline_ms=100)))[-1], "deadline")


class Later(AnswerCase):
    """The worker is stopped in the middle, and goes on when all is answered."""

    def test_the_last_picture_is_sent(self):
        connection, job = self.send(progressive=True, deadline_ms=5000)
        while connection.receive_for(job).kind != wire.IMAGE:
            pass
        worker = self.connect().stats().worker_pid
        os.kill(worker, signal.SIGSTOP)
        replies = connection.follow(job)
        images = [reply.body for reply in replies if reply.kind == wire.IMAGE]
        done = replies[-1].body
        self.assertEqual(replies[-1].kind, wire.DONE, replies[-1])
        self.assertEqual([image.final for image in images].count(True), 1)
        self.assertTrue(images[-1].final)
        self.assertEqual((done.reason, done.samples), ("time", images[-1].samples))
        self.assertIn("intermediate", done.notes[0])
        self.assertAlmostEqual(done.estimated_relmse * done.samples, 1)  # of this picture, not of what was done since
        os.kill(worker, signal.SIGCONT)
        self.assertEqual(connection.follow(connection.send(wire.RENDER, render()))[-1].kind, wire.DONE)
        self.assertEqual((connection.stats().jobs, connection.stats().image_bytes), (0, 0))


class Innocent(FakeCase):
    """Who was answered by his deadline is blamed for the hang, and not who waits behind him."""
    arguments = ("--hang", "3")
    environment = {"FAKE_HANG": "sleep", "FAKE_HANG_ON": "step", "FAKE_DIE_TIMES": "2"}

    def test_a_job_behind_one_that_has_gone(self):
        connection = self.with_box()
        self.write("other.gltf", "ok 4096")  # a scene of its own: two workers over one scene would quarantine that
        connection.load("other", self.scenes, "other.gltf")
        wire.wait_for(lambda: connection.stats().device, "the worker is ready")
        gone = connection.send(wire.RENDER, endless(deadline_ms=1200))
        self.assertEqual(connection.receive_for(gone).kind, wire.ACCEPTED)
        behind = connection.send(wire.RENDER, render("other"))
        self.assert_error(connection.follow(gone)[-1], "deadline")
        done = connection.follow(behind)[-1]
        self.assertEqual(done.kind, wire.DONE, done)


class Slow(FakeCase):
    """A step takes more processor time than a worker may be still, and there are others that are preferred."""
    arguments = ("--hang", "1")
    environment = {"FAKE_BURN_US": "1200000"}

    def test_slow_is_not_hung(self):
        connection = self.with_box()
        worker = wire.wait_for(lambda: connection.stats().worker_pid, "a worker runs")
        os.setpriority(os.PRIO_PROCESS, worker, 5)
        for _ in range(os.cpu_count()):
            other = subprocess.Popen([sys.executable, "-c", "while True: pass"])
            self.addCleanup(other.wait)
            self.addCleanup(other.kill)
        replies = connection.follow(connection.send(wire.RENDER, render(samples=1)))
        self.assertEqual(replies[-1].kind, wire.DONE, replies[-1])
        self.assertEqual((replies[-1].body.retries, connection.stats().worker_starts), (0, 1))


class IdleIsNotHung(HangCase):
    def test_a_worker_without_orders_may_be_stopped(self):
        connection = self.with_box()
        connection.follow(connection.send(wire.RENDER, render()))
        worker = connection.stats().worker_pid
        os.kill(worker, signal.SIGSTOP)
        # A load takes longer than its loader may be still: the worker's bound has passed by then.
        self.write("slow.gltf", "hang")
        self.assert_error(connection.receive_for(connection.send_load("slow", self.scenes, "slow.gltf")), "scene-limit")
        os.kill(worker, signal.SIGCONT)
        self.assertEqual(connection.follow(connection.send(wire.RENDER, render()))[-1].kind, wire.DONE)
        self.assertEqual(connection.stats().worker_starts, 1)


class Loader(FakeCase):
    arguments = ("--hang", "1")

    def load(self, orders):
        self.write("odd.gltf", orders)
        connection = self.connect()
        return connection.receive_for(connection.send_load("odd", self.scenes, "odd.gltf"))

    def test_one_that_sleeps(self):
        reply = self.load("hang")
        self.assert_error(reply, "scene-limit")
        self.assertIn("the loader hung", reply.body.message)

    def test_one_that_is_stopped(self):
        self.assert_error(self.load("stop"), "scene-limit")

    def test_slow_is_not_hung(self):
        self.assertEqual(self.load("burn 1200000").kind, wire.SCENE_INFO)


if __name__ == "__main__":
    unittest.main()
