"""What ends a render before its samples do: a target error, a deadline. The stand-in's error is one over its samples."""
import unittest

import wire
from fakes import FakeCase, endless, render
from wire import pb


class TargetError(FakeCase):
    def test_it_ends_there(self):
        connection = self.with_box()
        replies = connection.follow(connection.send(wire.RENDER, endless(target_error=0.1)))
        (frame, _), = wire.images(replies)
        done = replies[-1].body
        self.assertEqual((frame.final, frame.samples, done.samples, done.reason), (True, 10, 10, "error"))

    def test_samples_come_first(self):
        connection = self.with_box()
        done = connection.follow(connection.send(wire.RENDER, render(samples=4, target_error=0.1)))[-1].body
        self.assertEqual((done.samples, done.reason), (4, "samples"))

    def test_progress_tells_the_error(self):
        connection = self.with_box()
        told = [r.body for r in connection.follow(connection.send(wire.RENDER, endless(target_error=0.005)))
                if r.kind == wire.PROGRESS]
        self.assertGreater(len(told), 1)
        for progress in filter(lambda p: p.samples_done, told):
            self.assertEqual(progress.estimated_relmse, 1 / progress.samples_done)
            self.assertEqual(progress.error_kind, pb.ERROR_KIND_MEASURED)

    def test_of_a_sweep(self):
        connection = self.with_box()
        sweep = pb.Sweep(render=endless(target_error=0.1), cameras=[pb.Camera()] * 3)
        sweep.render.samples = 1000
        replies = connection.follow(connection.send(wire.SWEEP, sweep))
        self.assertEqual([frame.samples for frame, _ in wire.images(replies)], [10] * 3)
        self.assertEqual(replies[-1].body.reason, "error")


class Deadline(FakeCase):
    environment = {"FAKE_STEP_US": "1000"}

    def test_it_ends_with_what_is_there(self):
        connection = self.with_box()
        replies = connection.follow(connection.send(wire.RENDER, endless(deadline_ms=100)))
        (frame, data), = wire.images(replies)
        done = replies[-1].body
        self.assertTrue(frame.final)
        self.assertEqual(len(data), frame.bytes)
        self.assertEqual(done.reason, "time")
        self.assertEqual(done.samples, frame.samples)
        self.assertGreater(done.samples, 0)
        self.assertEqual(connection.stats().jobs_done, 1)

    def test_a_first_sample_is_taken_however_late(self):
        connection = self.with_box()
        replies = connection.follow(connection.send(wire.RENDER, endless(deadline_ms=1)))
        # Unless it could not even be begun.
        if replies[-1].kind == wire.ERROR:
            self.assert_error(replies[-1], "deadline")
        else:
            self.assertGreater(replies[-1].body.samples, 0)
            self.assertEqual(replies[-1].body.reason, "time")

    def test_samples_come_first(self):
        connection = self.with_box()
        done = connection.follow(connection.send(wire.RENDER, render(deadline_ms=1 << 24)))[-1].body
        self.assertEqual((done.samples, done.reason), (4, "samples"))

    def test_a_job_that_waits_fails(self):
        connection = self.connect()
        self.write("hang.gltf", "hang")
        connection.send_load("hang", self.scenes, "hang.gltf")
        waiting = connection.send(wire.RENDER, render("hang", deadline_ms=50))
        self.assert_error(connection.follow(waiting)[-1], "deadline")
        self.assertEqual(connection.stats().jobs_failed, 1)
        self.assert_serves()

    def test_each_image_of_a_sweep_has_its_own(self):
        connection = self.with_box()
        sweep = pb.Sweep(render=endless(deadline_ms=60), cameras=[pb.Camera()] * 3)
        replies = connection.follow(connection.send(wire.SWEEP, sweep))
        self.assertEqual(len(wire.images(replies)), 3)
        self.assertEqual(replies[-1].body.reason, "time")

    def test_many_together(self):
        connection = self.with_box()
        jobs = [connection.send(wire.RENDER, endless(deadline_ms=200)) for _ in range(8)]
        for job in jobs:
            self.assertEqual(connection.follow(job)[-1].body.reason, "time")


class LostWorker(FakeCase):
    environment = {"FAKE_DIE_STEP": "5"}

    def test_the_error_begins_anew(self):
        connection = self.with_box()
        done = connection.follow(connection.send(wire.RENDER, endless(target_error=0.1)))[-1].body
        self.assertEqual((done.samples, done.reason, done.retries), (10, "error", 1))


if __name__ == "__main__":
    unittest.main()
