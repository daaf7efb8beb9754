"""Many cameras in one request: order, limits, cancel, a worker that dies, a client that does not read."""
import signal
import unittest

import wire
from fakes import FakeCase, endless, pattern, render
from wire import pb

SAMPLES = 1 << 24


def camera(x=0, **fields):
    values = dict(eye=pb.Vec3(x=x, z=-5), target=pb.Vec3(x=x), vfov_degrees=40)
    values.update(fields)
    return pb.Camera(**values)


def sweep(count, seed=0, **fields):
    """Camera i's picture is pattern(pixels, seed + i)."""
    return pb.Sweep(render=render(seed=seed, **fields), cameras=[camera(i) for i in range(count)])


def forever(count=2):
    return pb.Sweep(render=endless(), cameras=[camera(i) for i in range(count)])


class SweepCase(FakeCase):
    def check(self, replies, count, pixels=64, seed=0):
        kinds = [reply.kind for reply in replies]
        self.assertEqual(kinds[-1], wire.DONE, replies[-1])
        self.assertEqual((kinds.count(wire.ACCEPTED), kinds.count(wire.DONE), kinds[0]), (1, 1, wire.ACCEPTED))
        # Stages are summed up, figures are the last image's.
        self.assertEqual([(f.name, f.value) for f in replies[-1].body.figures], [("pixels", 16)])
        found = wire.images(replies)
        self.assertEqual([(frame.index, frame.final) for frame, _ in found], [(i, True) for i in range(count)])
        for i, (_, data) in enumerate(found):
            self.assertEqual(bytes(data), pattern(pixels, seed + i))
        return replies[-1].body


class Frames(SweepCase):
    def test_in_order_with_one_account(self):
        connection = self.with_box()
        replies = connection.follow(connection.send(wire.SWEEP, sweep(256, seed=3, progress_ms=1)))
        done = self.check(replies, 256, seed=3)
        self.assertEqual((done.samples, done.slices, done.retries, done.device), (4, 4 * 256, 0, "fake"))
        self.assertEqual([stage.name for stage in done.stages], ["queue", "wait", "trace", "send"])
        progress = [reply.body for reply in replies if reply.kind == wire.PROGRESS]
        self.assertGreater(len(progress), 0)
        self.assertEqual({p.samples for p in progress}, {4 * 256})
        fractions = [p.fraction for p in progress]
        self.assertEqual(fractions, sorted(fractions))
        self.assertLessEqual(fractions[-1], 1)
        stats = connection.stats()
        self.assertEqual((stats.jobs, stats.jobs_done, stats.jobs_failed), (0, 256, 0))

    def test_one_camera(self):
        connection = self.with_box()
        self.check(connection.follow(connection.send(wire.SWEEP, sweep(1))), 1)

    def test_previews_stay_in_order(self):
        connection = self.with_box()
        found = wire.images(connection.follow(connection.send(wire.SWEEP, sweep(20, samples=16, progressive=True))))
        order = [(frame.index, frame.final) for frame, _ in found]
        self.assertEqual(order, sorted(order))
        self.assertEqual([index for index, final in order if final], list(range(20)))

    def test_many_at_once_on_one_connection(self):
        connection = self.with_box()
        jobs = [connection.send(wire.SWEEP, sweep(20, seed=i)) for i in range(8)]
        renders = [connection.send(wire.RENDER, render(seed=i)) for i in range(8)]
        for i, job in enumerate(jobs):
            self.check(connection.follow(job), 20, seed=i)
        for job in renders:
            self.assertEqual(connection.follow(job)[-1].kind, wire.DONE)
        late = connection.send(wire.SWEEP, sweep(2))  # every place is free again
        self.check(connection.follow(late), 2)

    def test_others_are_served(self):
        connection, other = self.with_box(), self.connect()
        job = connection.send(wire.SWEEP, forever())
        connection.receive_for(job)
        for _ in range(5):
            self.assertEqual(other.follow(other.send(wire.RENDER, render()))[-1].kind, wire.DONE)
        self.assertEqual(other.stats().jobs, 1)

    def test_scene_unloaded_and_loading(self):
        connection, other = self.with_box(), self.connect()
        job = connection.send(wire.SWEEP, sweep(100, samples=20))
        connection.receive_for(job)
        self.assertEqual(other.ask(wire.UNLOAD, pb.Unload(name="box")).kind, wire.OK)
        replies = connection.follow(job)
        self.assertEqual((len(wire.images(replies)), replies[-1].kind), (100, wire.DONE))
        wire.wait_for(lambda: other.stats().scenes == 0, "the scene is gone")


class Refused(FakeCase):
    def refuse(self, name, message):
        connection = self.with_box()
        self.assert_error(connection.ask(wire.SWEEP, message), name)
        stats = connection.stats()
        self.assertEqual((stats.jobs, stats.slices), (0, 0))

    def test_no_camera(self):
        self.refuse("bad-argument", sweep(0))

    def test_too_many_cameras(self):
        self.refuse("limit", sweep(257))

    def test_too_much_work(self):
        self.refuse("limit", sweep(256, width=1 << 12, height=1 << 12, samples=1 << 16))

    def test_one_bad_camera(self):
        message = sweep(256)
        message.cameras[255].vfov_degrees = 200
        self.refuse("bad-argument", message)

    def test_camera_in_the_render(self):
        message = sweep(2)
        message.render.camera.CopyFrom(camera())
        self.refuse("bad-argument", message)

    def test_the_render_is_checked(self):
        self.refuse("limit", sweep(2, width=1 << 20))

    def test_no_scene(self):
        self.refuse("scene-not-found", pb.Sweep(render=render("none"), cameras=[camera()]))

    def test_longest_message(self):
        connection = self.with_box()
        far = pb.Vec3(x=1e11, y=1e11, z=1e11)
        message = pb.Sweep(render=render(), cameras=[camera(name="n" * 63, up=far, eye=far)] * 256)
        self.assertLess(len(message.SerializeToString()), 64 * 1024)
        self.assertEqual(connection.follow(connection.send(wire.SWEEP, message))[-1].kind, wire.DONE)

    def test_id_in_use(self):
        connection = self.with_box()
        job = connection.send(wire.SWEEP, forever())
        connection.receive_for(job)
        connection.send(wire.PING, pb.Ping(), request=job)
        self.assert_error(connection.receive_for(0), "duplicate-request")


class Ends(SweepCase):
    def test_cancel_in_the_middle(self):
        connection = self.with_box()
        job = connection.send(wire.SWEEP, sweep(256, samples=50))
        while connection.receive_for(job).kind != wire.IMAGE:
            pass
        self.assertEqual(connection.ask(wire.CANCEL, pb.Cancel(request=job)).kind, wire.OK)
        self.assert_error(connection.follow(job)[-1], "cancelled")
        stats = connection.stats()
        self.assertEqual((stats.jobs, stats.jobs_cancelled), (0, 1))
        self.check(connection.follow(connection.send(wire.SWEEP, sweep(3))), 3)

    def test_disconnect(self):
        connection, other = self.with_box(), self.connect()
        for _ in range(4):
            connection.receive_for(connection.send(wire.SWEEP, forever()))
        connection.close()
        wire.wait_for(lambda: other.stats().jobs == 0, "its jobs are gone")

    def test_shutdown(self):
        connection = self.with_box()
        job = connection.send(wire.SWEEP, forever())
        connection.receive_for(job)
        self.daemon.process.send_signal(signal.SIGTERM)
        self.assert_error(connection.follow(job)[-1], "shutting-down")


class WorkerDies(SweepCase):
    environment = {"FAKE_DIE_STEP": "39"}

    def test_finished_images_are_kept(self):
        connection = self.with_box()
        done = self.check(connection.follow(connection.send(wire.SWEEP, sweep(20))), 20)
        stats = connection.stats()
        self.assertEqual((stats.worker_starts, stats.loader_starts), (2, 1))
        # The 39th step was the third of the tenth image: it and no other is begun again, but one that was being encoded.
        self.assertIn(done.retries, (1, 2))
        self.assertLessEqual(stats.slices, 38 + 44 + 4)


class WorkerDiesTwice(SweepCase):
    environment = {"FAKE_DIE_STEP": "3", "FAKE_DIE_TIMES": "2"}

    def test_worker_lost(self):
        connection = self.with_box()
        replies = connection.follow(connection.send(wire.SWEEP, sweep(20)))
        self.assert_error(replies[-1], "worker-lost")
        self.assertEqual(connection.stats().jobs, 0)
        self.check(connection.follow(connection.send(wire.SWEEP, sweep(2, samples=1))), 2)


class Memory(SweepCase):
    environment = {"FAKE_MEMORY_JOBS": "1"}

    def test_one_image_at_a_time(self):
        connection = self.with_box()
        self.check(connection.follow(connection.send(wire.SWEEP, sweep(30))), 30)


class Stalled(SweepCase):
    def test_no_third_image_is_begun(self):
        stalled, other = self.with_box(), self.connect()
        job = stalled.send(wire.SWEEP, sweep(30, width=2000, height=2000, samples=1))
        wire.wait_for(lambda: other.stats().slices == 2, "two images are traced")
        for _ in range(5):
            self.assertEqual(other.follow(other.send(wire.RENDER, render()))[-1].kind, wire.DONE)
        stats = other.stats()
        self.assertEqual((stats.slices, stats.jobs), (2 + 5 * 4, 2))
        self.assertLessEqual(stats.buffered_bytes, 256 * 1024 + 64 * 1024 + 20 * 1024)
        self.check(stalled.follow(job), 30, pixels=4000000)

    def test_images_beyond_what_may_wait(self):
        """Two sweeps whose images do not fit the room together: neither holds what the other needs."""
        connection = self.with_box()
        jobs = [connection.send(wire.SWEEP, sweep(3, seed=i, width=4096, height=4096, samples=1)) for i in range(2)]
        for i, job in enumerate(jobs):
            found = wire.images(connection.follow(job))
            self.assertEqual([(frame.index, bytes(data[:50])) for frame, data in found],
                             [(k, pattern(50, i + k)) for k in range(3)])


if __name__ == "__main__":
    unittest.main()
