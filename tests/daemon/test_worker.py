"""A worker that dies, never starts, or has no device."""
import os
import signal
import unittest

import wire
from fakes import FakeCase, endless, pattern, render
from wire import pb


class Killed(FakeCase):
    def kill_worker(self, connection):
        pid = wire.wait_for(lambda: connection.stats().worker_pid, "a worker runs")
        os.kill(pid, signal.SIGKILL)
        wire.wait_for(lambda: connection.stats().worker_pid not in (0, pid), "another runs")

    def begin_endless(self, connection):
        job = connection.send(wire.RENDER, endless())
        connection.receive_for(job)
        wire.wait_for(lambda: connection.stats().slices > 0, "slices are done")
        return job

    def test_idle(self):
        connection = self.with_box()
        connection.follow(connection.send(wire.RENDER, render()))
        self.kill_worker(connection)
        replies = connection.follow(connection.send(wire.RENDER, render(seed=9)))
        self.assertEqual(bytes(wire.images(replies)[0][1]), pattern(64, 9))
        stats = connection.stats()
        self.assertEqual((stats.worker_starts, stats.loader_starts), (2, 1))

    def test_in_the_middle_then_again(self):
        connection, other = self.with_box(), self.connect()
        job = self.begin_endless(connection)
        self.kill_worker(other)
        slices = other.stats().slices
        wire.wait_for(lambda: other.stats().slices > slices + 5, "the job goes on")
        self.assertEqual(other.stats().jobs, 1)
        self.kill_worker(other)
        replies = connection.follow(job)
        self.assert_error(replies[-1], "worker-lost")
        self.assertEqual([reply.kind for reply in replies].count(wire.ACCEPTED), 0)  # it came before, once
        stats = other.stats()
        self.assertEqual((stats.loader_starts, stats.jobs, stats.jobs_failed), (1, 0, 1))

    def test_many_scenes_come_along(self):
        connection = self.with_box()
        for i in range(40):
            connection.load(f"s{i}", self.scenes, "box.gltf")
        self.kill_worker(connection)
        for i in range(40):
            self.assertEqual(connection.follow(connection.send(wire.RENDER, render(f"s{i}")))[-1].kind, wire.DONE)
        self.assertEqual(connection.stats().loader_starts, 41)

    def test_what_is_held_is_told(self):
        connection, other = self.with_box(), self.connect()
        self.assertEqual(connection.stats().device_bytes, 0)
        job = self.begin_endless(connection)
        self.assertEqual(other.stats().device_bytes, 1000)
        self.assertEqual(connection.ask(wire.CANCEL, pb.Cancel(request=job)).kind, wire.OK)
        wire.wait_for(lambda: other.stats().device_bytes == 0, "it holds nothing")
        connection.follow(connection.send(wire.RENDER, render()))
        self.assertEqual(other.stats().device_bytes, 0)
        self.begin_endless(connection)
        self.kill_worker(other)
        self.assertIn(other.stats().device_bytes, (0, 1000))  # the job is begun again

    def test_stopped_job_is_not_blamed(self):
        connection, other = self.with_box(), self.connect()
        job = self.begin_endless(connection)
        self.kill_worker(other)
        self.assertEqual(connection.ask(wire.CANCEL, pb.Cancel(request=job)).kind, wire.OK)
        self.assertEqual(connection.follow(connection.send(wire.RENDER, render()))[-1].kind, wire.DONE)

    def test_children_inherit_nothing(self):
        connection = self.with_box()
        connection.follow(connection.send(wire.RENDER, render()))
        self.assertEqual(connection.stats().device, "fake")
        self.kill_worker(connection)
        wire.wait_for(lambda: connection.stats().device, "it is ready")
        self.assertEqual(connection.stats().device, "fake")


class Environment(FakeCase):
    environment = {"AWS_SECRET_ACCESS_KEY": "hush", "VK_TOKEN": "hush", "PATH": "/usr/bin", "LP_NUM_THREADS": "1",
                   "HOME": "/nowhere"}

    def of(self, pid):
        with open(f"/proc/{pid}/environ", encoding="utf-8") as file:
            return dict(entry.split("=", 1) for entry in file.read().split("\0") if entry)

    def test_children_know_nothing_of_the_front_s_secrets(self):
        self.write("slow.gltf", "hang")
        connection = self.with_box()
        connection.send_load("slow", self.scenes, "slow.gltf")
        wire.wait_for(lambda: connection.stats().loader_pid, "the loader runs")
        stats = connection.stats()
        # The kernel shows it a moment after a program was started.
        front, worker, loader = (wire.wait_for(lambda pid=pid: self.of(pid), "it has an environment")
                                 for pid in (self.daemon.process.pid, stats.worker_pid, stats.loader_pid))
        self.assertEqual(front["AWS_SECRET_ACCESS_KEY"], "hush")
        for child in (worker, loader):
            self.assertNotIn("hush", child.values())
            self.assertNotIn("PATH", child)
            self.assertNotIn("FAKE_STATE", child)
            self.assertEqual(child["CANDIL_LOG"], "debug")
        self.assertEqual(worker["LP_NUM_THREADS"], "1")
        self.assertEqual(worker["HOME"], "/nowhere")
        self.assertNotIn("HOME", loader)


class Busy(FakeCase):
    def test_scenes_that_come_and_go_do_not_pile_up(self):
        connection = self.with_box()
        connection.follow(connection.send(wire.RENDER, render()))
        pid, before = connection.stats().worker_pid, self.daemon.descriptors()
        os.kill(pid, signal.SIGSTOP)
        for _ in range(500):
            connection.load("passing", self.scenes, "box.gltf")
        # Those that its socket has taken are the kernel's; a few of each moment's are ours.
        self.assertLess(self.daemon.descriptors(), before + 20)
        os.kill(pid, signal.SIGCONT)
        for name in ("box", "passing"):
            self.assertEqual(connection.follow(connection.send(wire.RENDER, render(name)))[-1].kind, wire.DONE)
        self.assertEqual(connection.stats().worker_starts, 1)


class Memory(FakeCase):
    environment = {"FAKE_MEMORY_PIXELS": "200"}

    def test_a_large_job_is_not_forgotten_when_the_worker_dies(self):
        connection, other = self.with_box(), self.connect()
        first = connection.send(wire.RENDER, endless())
        connection.receive_for(first)
        large = connection.send(wire.RENDER, render(width=16, height=12))  # refused while any other is there
        connection.receive_for(connection.send(wire.RENDER, endless()))
        self.assertEqual(connection.ask(wire.CANCEL, pb.Cancel(request=first)).kind, wire.OK)
        for _ in range(2):  # each end lets it try once more, until no younger one may begin before it
            self.assertEqual(connection.follow(connection.send(wire.RENDER, render()))[-1].kind, wire.DONE)
        slices = other.stats().slices
        wire.wait_for(lambda: other.stats().slices > slices + 5, "the refusal has come")
        os.kill(other.stats().worker_pid, signal.SIGKILL)
        self.assertEqual(connection.follow(large)[-1].kind, wire.DONE)


class Counts(FakeCase):
    environment = {"FAKE_COUNTS": "stages"}

    def test_out_of_bounds(self):
        connection = self.with_box()
        reply = connection.follow(connection.send(wire.RENDER, render()))[-1]
        self.assert_error(reply, "worker-lost")
        self.assertIn("nonsense", reply.body.message)
        self.assert_serves()


class MoreFigures(Counts):
    environment = {"FAKE_COUNTS": "figures"}


class NoNumber(Counts):
    environment = {"FAKE_COUNTS": "value"}


class IgnoredChildren(FakeCase):
    """Whoever starts the daemon may ignore the ends of its own children."""

    def prepare(self):
        before = signal.signal(signal.SIGCHLD, signal.SIG_IGN)
        self.addCleanup(signal.signal, signal.SIGCHLD, before)

    def test_they_are_still_collected(self):
        signal.signal(signal.SIGCHLD, signal.SIG_DFL)
        connection = self.with_box()
        connection.follow(connection.send(wire.RENDER, render()))
        os.kill(connection.stats().worker_pid, signal.SIGKILL)
        wire.wait_for(lambda: connection.stats().worker_starts == 2, "another is started")
        self.assertIn("killed by signal 9", self.daemon.log_text())


class DiesOnce(FakeCase):
    environment = {"FAKE_DIE_STEP": "3", "FAKE_DIE_TIMES": "1"}

    def test_one_retry(self):
        connection = self.with_box()
        replies = connection.follow(connection.send(wire.RENDER, render(samples=10, seed=4)))
        self.assertEqual(replies[-1].kind, wire.DONE)
        self.assertEqual(replies[-1].body.retries, 1)
        self.assertEqual(replies[-1].body.samples, 10)
        self.assertEqual([reply.kind for reply in replies].count(wire.ACCEPTED), 1)
        (frame, data), = wire.images(replies)
        self.assertEqual((frame.samples, bytes(data)), (10, pattern(64, 4)))
        self.assertEqual((connection.stats().worker_starts, connection.stats().loader_starts), (2, 1))


class DiesTwice(FakeCase):
    environment = {"FAKE_DIE_STEP": "3", "FAKE_DIE_TIMES": "2"}

    def test_the_second_loss_is_told(self):
        connection = self.with_box()
        replies = connection.follow(connection.send(wire.RENDER, render(samples=10)))
        self.assert_error(replies[-1], "worker-lost")
        self.assertEqual(connection.follow(connection.send(wire.RENDER, render()))[-1].kind, wire.DONE)
        self.assertEqual(connection.stats().loader_starts, 1)


class DiesForever(FakeCase):
    environment = {"FAKE_DIE_STEP": "1", "FAKE_DIE_TIMES": "1000"}

    def test_every_job_ends(self):
        connection = self.with_box()
        for job in [connection.send(wire.RENDER, render()) for _ in range(4)]:
            self.assert_error(connection.follow(job)[-1], "worker-lost")
        self.assert_serves()


class NeverStarts(FakeCase):
    environment = {"FAKE_EXIT": "1"}

    def test_jobs_are_told(self):
        connection = self.with_box()
        reply = connection.follow(connection.send(wire.RENDER, render()))[-1]
        self.assert_error(reply, "worker-lost")
        self.assertIn("exited with status 3", reply.body.message)
        self.assert_serves()


class OtherBuild(FakeCase):
    environment = {"FAKE_OTHER_BUILD": "1"}

    def test_jobs_are_told(self):
        connection = self.with_box()
        reply = connection.follow(connection.send(wire.RENDER, render()))[-1]
        self.assert_error(reply, "worker-lost")
        self.assertIn("another build", reply.body.message)


class NoDevice(FakeCase):
    environment = {"FAKE_NO_DEVICE": "1"}

    def test_jobs_are_told(self):
        connection = self.with_box()
        self.assert_error(connection.follow(connection.send(wire.RENDER, render()))[-1], "device")
        self.assertEqual(connection.stats().worker_starts, 1)

    def test_stats_tell_why(self):
        connection = self.connect()
        wire.wait_for(lambda: connection.stats().device_error, "the worker has said why")


class Missing(FakeCase):
    def prepare(self):
        empty = os.path.join(self.daemon.folder, "empty")
        os.mkdir(empty)
        self.daemon.arguments[self.daemon.arguments.index("--libexec") + 1] = empty

    def test_programs_that_are_not_there(self):
        connection = self.connect()
        reply = connection.receive_for(connection.send_load("box", self.scenes, "box.gltf"))
        self.assert_error(reply, "internal")
        self.assertIn("candil-loader", reply.body.message)
        self.assert_serves()


if __name__ == "__main__":
    unittest.main()
