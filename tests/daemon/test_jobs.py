"""Renders from their acceptance to their end."""
import unittest

import wire
from fakes import FakeCase, endless, pattern, render
from wire import pb


class Render(FakeCase):
    def test_whole_life(self):
        connection = self.with_box()
        replies = connection.follow(connection.send(wire.RENDER, render(width=300, height=500, seed=7)))
        kinds = [reply.kind for reply in replies]
        self.assertEqual(kinds[0], wire.ACCEPTED)
        self.assertEqual(kinds[-1], wire.DONE)
        self.assertEqual(kinds.count(wire.ACCEPTED), 1)
        (frame, data), = wire.images(replies)
        self.assertTrue(frame.final)
        self.assertEqual((frame.width, frame.height, frame.samples, frame.bytes), (300, 500, 4, 150000))
        self.assertEqual(bytes(data), pattern(150000, 7))
        done = replies[-1].body
        self.assertEqual(done.samples, 4)
        self.assertEqual(done.slices, 4)
        self.assertEqual(done.retries, 0)
        self.assertEqual(done.reason, "samples")
        self.assertEqual([stage.name for stage in done.stages], ["queue", "wait", "trace", "send"])
        self.assertGreater(done.elapsed_us, 0)
        self.assertEqual(connection.stats().jobs_done, 1)

    def test_chunks_are_within_their_limit(self):
        connection = self.with_box()
        replies = connection.follow(connection.send(wire.RENDER, render(width=1000, height=1000)))
        sizes = [len(reply.raw) for reply in replies if reply.kind == wire.FRAME_CHUNK]
        self.assertEqual(sum(sizes), 1000000)
        self.assertLessEqual(max(sizes), 64 * 1024)
        self.assertGreater(min(sizes), 0)

    def test_progressive(self):
        connection = self.with_box()
        request = render(width=100, height=100, samples=64, progressive=True, seed=3)
        replies = connection.follow(connection.send(wire.RENDER, request))
        pictures = wire.images(replies)
        self.assertGreaterEqual(len(pictures), 2)
        self.assertEqual([frame.final for frame, _ in pictures], [False] * (len(pictures) - 1) + [True])
        samples = [frame.samples for frame, _ in pictures]
        self.assertEqual(samples, sorted(set(samples)))
        self.assertEqual(samples[-1], 64)
        for _, data in pictures:
            self.assertEqual(bytes(data), pattern(10000, 3))

    def test_not_progressive(self):
        connection = self.with_box()
        replies = connection.follow(connection.send(wire.RENDER, render(samples=64)))
        self.assertEqual(len(wire.images(replies)), 1)

    def test_progress_is_told(self):
        connection = self.with_box()
        replies = connection.follow(connection.send(wire.RENDER, render(samples=200, progress_ms=1)))
        told = [reply.body for reply in replies if reply.kind == wire.PROGRESS]
        self.assertGreater(len(told), 1)
        done = [progress.samples_done for progress in told]
        self.assertEqual(done, sorted(done))
        self.assertTrue(all(0 < progress.fraction <= 1 and progress.samples == 200 for progress in told))

    def test_many_at_once(self):
        connection = self.with_box()
        jobs = {connection.send(wire.RENDER, render(width=50 + i, height=40, seed=i)): i for i in range(16)}
        for job, i in jobs.items():
            (_, data), = wire.images(connection.follow(job))
            self.assertEqual(bytes(data), pattern((50 + i) * 40, i))

    def test_a_small_job_does_not_wait_for_a_large_one(self):
        first, second = self.with_box(), self.connect()
        large = first.send(wire.RENDER, endless())
        first.receive(wire.ACCEPTED, large)
        for _ in range(3):
            replies = second.follow(second.send(wire.RENDER, render(samples=8)))
            self.assertEqual(replies[-1].kind, wire.DONE)
        self.assertEqual(second.stats().jobs, 1)

    def test_a_small_job_of_the_same_connection_too(self):
        connection = self.with_box()
        connection.send(wire.RENDER, endless())
        self.assertEqual(connection.follow(connection.send(wire.RENDER, render()))[-1].kind, wire.DONE)


class Ends(FakeCase):
    def assert_device_is_free(self, connection):
        wire.wait_for(lambda: connection.stats().jobs == 0, "the job is gone")
        slices = connection.stats().slices
        # A job of four steps takes four slices: nothing else is being stepped but what was under way.
        connection.follow(connection.send(wire.RENDER, render()))
        self.assertLessEqual(connection.stats().slices, slices + 5)

    def test_cancel(self):
        connection = self.with_box()
        job = connection.send(wire.RENDER, endless())
        connection.receive(wire.ACCEPTED, job)
        cancel = connection.send(wire.CANCEL, pb.Cancel(request=job))
        self.assert_error(connection.follow(job)[-1], "cancelled")
        self.assertEqual(connection.receive_for(cancel).kind, wire.OK)
        self.assertEqual(connection.stats().jobs_cancelled, 1)
        self.assert_device_is_free(connection)

    def test_cancel_at_once(self):
        connection = self.with_box()
        for _ in range(20):
            job = connection.send(wire.RENDER, endless())
            cancel = connection.send(wire.CANCEL, pb.Cancel(request=job))
            self.assert_error(connection.follow(job)[-1], "cancelled")
            self.assertEqual(connection.receive_for(cancel).kind, wire.OK)
        self.assert_device_is_free(connection)

    def test_cancel_while_the_image_is_sent(self):
        connection = self.with_box()
        job = connection.send(wire.RENDER, render(width=4000, height=4000))
        while connection.receive_for(job).kind != wire.FRAME_CHUNK:
            pass
        cancel = connection.send(wire.CANCEL, pb.Cancel(request=job))
        self.assert_error(connection.follow(job)[-1], "cancelled")
        self.assertEqual(connection.receive_for(cancel).kind, wire.OK)
        self.assert_serves()

    def test_client_goes(self):
        connection = self.connect()
        with self.with_box() as leaving:
            jobs = [leaving.send(wire.RENDER, endless(progressive=True)) for _ in range(5)]
            leaving.receive(wire.ACCEPTED, jobs[0])
        self.assert_device_is_free(connection)
        self.assertEqual(connection.stats().jobs_cancelled, 5)

    def test_client_goes_without_reading(self):
        connection = self.connect()
        leaving = self.with_box()
        leaving.send(wire.RENDER, render(width=2000, height=2000))
        wire.wait_for(lambda: connection.stats().buffered_bytes > 0, "the image waits")
        leaving.close()
        self.assert_device_is_free(connection)

    def test_unload_does_not_disturb(self):
        connection = self.with_box()
        job = connection.send(wire.RENDER, render(samples=300, width=20, height=20))
        connection.receive(wire.ACCEPTED, job)
        self.assertEqual(connection.ask(wire.UNLOAD, pb.Unload(name="box")).kind, wire.OK)
        self.assert_error(connection.ask(wire.RENDER, render()), "scene-not-found")
        replies = connection.follow(job)
        self.assertEqual(replies[-1].kind, wire.DONE)
        self.assertEqual(connection.stats().scene_bytes, 0)
        self.assertEqual(connection.stats().worker_starts, 1)


class StepFails(FakeCase):
    environment = {"FAKE_FAIL_STEP": "1"}

    def test_the_error_is_the_workers(self):
        connection = self.with_box()
        self.assert_error(connection.follow(connection.send(wire.RENDER, render()))[-1], "device")
        self.assertEqual(connection.stats().jobs_failed, 1)
        self.assertEqual(connection.stats().worker_starts, 1)


class ImageFails(FakeCase):
    environment = {"FAKE_FAIL_IMAGE": "1"}

    def test_the_error_is_the_workers(self):
        connection = self.with_box()
        self.assert_error(connection.follow(connection.send(wire.RENDER, render()))[-1], "encode")


class LittleMemory(FakeCase):
    environment = {"FAKE_MEMORY_JOBS": "2"}

    def test_jobs_wait_for_memory(self):
        connection = self.with_box()
        jobs = [connection.send(wire.RENDER, render(samples=20)) for _ in range(10)]
        for job in jobs:
            self.assertEqual(connection.follow(job)[-1].kind, wire.DONE)


class LittleMemoryLater(FakeCase):
    environment = {"FAKE_STEP_MEMORY_JOBS": "1"}

    def test_jobs_that_lack_memory_in_their_midst_begin_again(self):
        connection = self.with_box()
        jobs = [connection.send(wire.RENDER, render(samples=20)) for _ in range(6)]
        for job in jobs:
            replies = connection.follow(job)
            self.assertEqual(replies[-1].kind, wire.DONE)
            self.assertEqual(sum(r.kind == wire.ACCEPTED for r in replies), 1)


class NoMemoryLater(FakeCase):
    environment = {"FAKE_STEP_MEMORY_JOBS": "0"}

    def test_a_job_alone_is_refused(self):
        connection = self.with_box()
        self.assert_error(connection.follow(connection.send(wire.RENDER, render()))[-1], "memory")


class NoMemory(FakeCase):
    environment = {"FAKE_MEMORY_JOBS": "0"}

    def test_a_job_alone_is_refused(self):
        connection = self.with_box()
        self.assert_error(connection.follow(connection.send(wire.RENDER, render()))[-1], "memory")


if __name__ == "__main__":
    unittest.main()
