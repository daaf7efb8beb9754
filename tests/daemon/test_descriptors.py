"""Few descriptors: what is accepted never lacks one, what is refused is told, and one that is missing all the same costs one request
and no worker."""
import contextlib
import os
import resource
import signal
import socket
import time
import unittest

import crowd
import wire
from fakes import FakeCase, endless, pattern, render
from wire import pb

SIDE = 700  # of an image that its socket does not take at once


class LateCase(FakeCase):
    def late(self, connection):
        """A load whose loader waits."""
        os.mkfifo(os.path.join(self.scenes, "late.gltf"))
        load = connection.send_load("late", self.scenes, "late.gltf")
        wire.wait_for(lambda: connection.stats().loader_pid, "the loader is there")
        return load

    def write_late(self):
        with open(os.path.join(self.scenes, "late.gltf"), "w", encoding="ascii") as file:
            file.write("ok")


class OnTheirWay(LateCase):
    """The kernel lets a user have no more descriptors on their way than the sender may have open."""
    most_descriptors = 256

    @contextlib.contextmanager
    def few(self, pid):
        """More are on their way than this process may have open."""
        before = resource.prlimit(pid, resource.RLIMIT_NOFILE)
        with contextlib.ExitStack() as stack:
            passed = [stack.enter_context(end) for end in socket.socketpair()]
            socket.send_fds(passed[0], [b"x"], [0] * 100)
            resource.prlimit(pid, resource.RLIMIT_NOFILE, (90, before[1]))
            yield
        with contextlib.suppress(ProcessLookupError):
            resource.prlimit(pid, resource.RLIMIT_NOFILE, before)

    def test_scenes_wait_until_there_are_fewer(self):
        connection = self.with_box()
        pid = wire.wait_for(lambda: connection.stats().device and connection.stats().worker_pid, "the worker is ready")
        passed = socket.socketpair()
        for end in passed:
            self.addCleanup(end.close)
        for _ in range(3):
            socket.send_fds(passed[0], [b"x"], [0] * 200)
        os.kill(pid, signal.SIGKILL)
        wire.wait_for(lambda: connection.stats().worker_pid not in (0, pid), "the next is to get the scene")
        job = connection.send(wire.RENDER, render())
        for _ in range(3):
            time.sleep(.05)  # for it to try again
            self.assertEqual((connection.stats().jobs, connection.stats().worker_starts), (1, 2))
        for end in passed:
            end.close()
        self.assertEqual(connection.follow(job)[-1].kind, wire.DONE)
        self.assertEqual(connection.stats().worker_starts, 2)


class Patient(OnTheirWay):
    """Who waits with a picture or a scene says so, and does not hang."""
    arguments = ("--hang", "1")

    def longer_than_that(self):
        wire.wait_for(lambda: "on their way" in self.daemon.log_text(), "it has tried")
        time.sleep(1.5)

    def test_scenes_wait_until_there_are_fewer(self):
        connection = self.with_box()
        load = self.late(connection)
        with self.few(connection.stats().loader_pid):
            self.write_late()
            self.longer_than_that()
        self.assertEqual(connection.receive_for(load).kind, wire.SCENE_INFO)

    def test_pictures_do(self):
        connection = self.with_box()
        with self.few(wire.wait_for(lambda: connection.stats().device and connection.stats().worker_pid, "the worker is ready")):
            job = connection.send(wire.RENDER, render())
            self.longer_than_that()
        done = connection.follow(job)[-1]
        self.assertEqual((done.kind, done.body.retries), (wire.DONE, 0))


class Spinning(OnTheirWay):
    """Who spins is no better for a scene that cannot be given to it yet."""
    arguments = ("--answer", "1")
    environment = {"FAKE_HANG": "burn", "FAKE_HANG_ON": "step"}

    def test_scenes_wait_until_there_are_fewer(self):
        connection = self.with_box()
        load = self.late(connection)
        job = connection.send(wire.RENDER, render())
        self.assertEqual(connection.receive_for(job).kind, wire.ACCEPTED)
        with self.few(self.daemon.process.pid):
            self.write_late()
            self.assertEqual(connection.receive_for(load).kind, wire.SCENE_INFO)
            wire.wait_for(lambda: connection.stats().worker_starts == 2, "the one that spins is ended")
        done = connection.follow(job)[-1]
        self.assertEqual((done.kind, done.body.retries), (wire.DONE, 1))


class Full(FakeCase):
    """All that clients may hold, at the same time: connections, a folder's descriptor with half a message, scenes, images."""
    most_descriptors = 1024
    environment = {"FAKE_STEP_US": "0"}
    jobs_each = 1

    def greeted(self):
        """A connection of a process of its own, or None for one that is turned away."""
        connection = self.connect(greet=False, elsewhere=True)
        try:
            connection.send(wire.HELLO, pb.Hello(version_min=1, version_max=1))
            reply = connection.receive()
        except (wire.Closed, BrokenPipeError):
            self.fail("a connection was closed without a word")
        if reply.kind == wire.HELLO_REPLY:
            return connection
        self.assert_error(reply, "too-many-connections")
        self.assertEqual(connection.drained(), [])
        connection.close()
        return None

    def fill_connections(self, already):
        """As many as there may be; the last half of a message's header is still to come, a descriptor came with the first."""
        connections = []
        while connection := self.greeted():
            connections.append(connection)
        self.assertEqual(len(connections) + already, self.stats.max_connections)
        return connections

    def fill_scenes(self, connection, already):
        loads = [connection.receive_for(connection.send_load(f"s{i}", self.scenes, "box.gltf"))
                 for i in range(self.stats.max_scenes - already + 1)]
        self.assertEqual({reply.kind for reply in loads[:-1]}, {wire.SCENE_INFO})
        self.assert_error(loads[-1], "too-many-scenes")
        return len(loads) - 1

    def keep_scenes_by_jobs(self, connections, count):
        """Each scene has a job without end and loses its name; as many come anew, and then not one more."""
        jobs = []
        for i in range(count):
            connection = connections[i % len(connections)]
            jobs.append((connection, connection.send(wire.RENDER, endless(f"s{i}"))))
        for connection, job in jobs:
            connection.receive_for(job)
        for i in range(count):
            self.assertEqual(connections[0].ask(wire.UNLOAD, pb.Unload(name=f"s{i}")).kind, wire.OK)
        for i in range(count):
            connections[0].load(f"s{i}", self.scenes, "box.gltf")
        return jobs

    def ask_for_images(self, connections):
        asked = []
        for number, connection in enumerate(connections):
            for k in range(self.jobs_each):
                job = connection.send(wire.RENDER, render(width=SIDE, height=SIDE, samples=8, progressive=True, seed=number + k))
                asked.append((connection, job, number + k))
            connection.send_with_fds(b"CN", [0])
        return asked

    def finish_half_messages(self, connections):
        """What was half a header becomes a PING: whoever has a descriptor in hand is still served."""
        for connection in connections:
            connection.sock.sendall(wire.packet(wire.PING, 5000, pb.Ping(payload=b"x"))[2:])

    def follow_all(self, asked):
        """Each has one end, which is its picture or a refusal in words; nothing comes behind it."""
        refused = 0
        for connection, job, seed in asked:
            replies = connection.follow(job)
            if replies[-1].kind == wire.ERROR:
                self.assert_error(replies[-1], "too-many-jobs")
                self.assertEqual(len(replies), 1)
                refused += 1
                continue
            frames = wire.images(replies)
            self.assertEqual([frame.final for frame, _ in frames].count(True), 1)
            self.assertEqual(bytes(frames[-1][1][:100]), pattern(100, seed))
            self.assertEqual(len(frames[-1][1]), SIDE * SIDE)
        return refused

    def round(self, observer):
        scenes = self.fill_scenes(observer, 1)
        connections = self.fill_connections(1)
        jobs = self.keep_scenes_by_jobs(connections, scenes)
        asked = self.ask_for_images(connections)
        # Nobody reads so far, so some images are as far as they can be.
        wire.wait_for(lambda: observer.stats().slices >= 8, "they are worked on")
        self.finish_half_messages(connections)
        refused = self.follow_all(asked)
        for connection, job in jobs:
            self.assertEqual(connection.ask(wire.CANCEL, pb.Cancel(request=job)).kind, wire.OK)
            self.assert_error(connection.follow(job)[-1], "cancelled")
        for connection in connections:
            self.assertEqual(connection.receive_for(5000).body.payload, b"x")
            self.assertEqual(connection.ask(wire.PING).kind, wire.PONG)
            self.assertEqual([reply for reply in connection.waiting if reply.kind != wire.PROGRESS], [])
            connection.close()
        for i in range(scenes):
            self.assertEqual(observer.ask(wire.UNLOAD, pb.Unload(name=f"s{i}")).kind, wire.OK)
        wire.wait_for(lambda: observer.stats().connections == 1, "all are gone")
        return len(asked) - refused

    def level(self, observer):
        observer.follow(observer.send(wire.RENDER, render()))
        stats = observer.stats()
        wire.wait_for(lambda: self.daemon.descriptors_at_rest() == self.idle, "descriptors are given back")
        self.assertEqual((stats.jobs, stats.image_bytes, stats.buffered_bytes, stats.scenes, stats.worker_starts), (0, 0, 0, 1, 1))
        return self.daemon.rss_kib()

    def test_everything_is_full_and_then_level(self):
        observer = self.with_box()
        observer.follow(observer.send(wire.RENDER, render()))
        self.stats, self.idle = observer.stats(), self.daemon.descriptors_at_rest()
        served = self.round(observer)
        memory = self.level(observer)
        self.assertGreaterEqual(served, min(60, (self.stats.max_connections - 1) * self.jobs_each))
        self.round(observer)
        self.assertLess(self.level(observer) - memory, crowd.growth_allowed_kib())
        self.assertLessEqual(self.daemon.descriptors(), self.most_descriptors)


class FullAt256(Full):
    most_descriptors = 256
    jobs_each = 4


class FullAt64(Full):
    most_descriptors = 64
    jobs_each = 12

    def test_the_log_and_stats_say_so(self):
        with self.daemon.connect() as connection:
            stats = connection.stats()
        self.assertLess((stats.max_connections, stats.max_scenes), (256, 64))
        self.assertIn(f"64 descriptors are enough for {stats.max_connections} connections and {stats.max_scenes} scenes",
                      self.daemon.log_text())


class TooFew(unittest.TestCase):
    def test_it_does_not_start(self):
        daemon = wire.Daemon(libexec=".", most_descriptors=40)
        self.addCleanup(daemon.stop)
        with self.assertRaisesRegex(RuntimeError, "ended with 1:\n.*40 descriptors are too few.*LimitNOFILE"):
            daemon.start()


class Missing(LateCase):
    """The limit falls while the daemon runs, as if the whole system had none left."""
    environment = {"FAKE_STEP_US": "1000"}

    def allow(self, soft):
        before = resource.prlimit(self.daemon.process.pid, resource.RLIMIT_NOFILE)
        resource.prlimit(self.daemon.process.pid, resource.RLIMIT_NOFILE, (soft, before[1]))
        return before[0]

    def assert_well(self, connection):
        self.assertEqual(connection.follow(connection.send(wire.RENDER, render()))[-1].kind, wire.DONE)
        self.assertEqual((connection.stats().worker_starts, connection.stats().jobs), (1, 0))

    def test_an_image_that_is_lost_costs_its_job(self):
        connection, other = self.with_box(), self.connect()
        going_on = other.send(wire.RENDER, endless())
        other.receive_for(going_on)
        job = connection.send(wire.RENDER, render(samples=50))
        self.assertEqual(connection.receive_for(job).kind, wire.ACCEPTED)
        soft = self.allow(3)
        self.assert_error(connection.follow(job)[-1], "memory")
        self.allow(soft)
        slices = other.stats().slices
        wire.wait_for(lambda: other.stats().slices > slices + 5, "the other job goes on")
        self.assertEqual(other.ask(wire.CANCEL, pb.Cancel(request=going_on)).kind, wire.OK)
        self.assert_well(connection)

    def test_an_intermediate_image_that_is_lost_costs_nothing(self):
        connection, other = self.with_box(), self.connect()
        soft = self.allow(3)
        job = connection.send(wire.RENDER, render(samples=400, progressive=True))
        wire.wait_for(lambda: other.stats().slices > 100, "some were asked for")
        self.allow(soft)
        replies = connection.follow(job)
        self.assertEqual(replies[-1].kind, wire.DONE)
        self.assertEqual([frame.final for frame, _ in wire.images(replies)].count(True), 1)
        self.assert_well(connection)

    def test_a_scene_that_is_lost_costs_its_load(self):
        connection = self.with_box()
        load = self.late(connection)
        soft = self.allow(3)
        self.write_late()
        self.assert_error(connection.receive_for(load), "memory")
        self.allow(soft)
        connection.load("again", self.scenes, "box.gltf")
        self.assert_well(connection)

    def test_whoever_connects_waits_and_is_not_forgotten(self):
        connection = self.with_box()
        soft = self.allow(3)
        late = self.connect(greet=False)
        late.send(wire.HELLO, pb.Hello(version_min=1, version_max=1))
        wire.wait_for(lambda: self.daemon.log_text().count("it waits") >= 2, "it is tried again")
        self.assertEqual(connection.ask(wire.PING).kind, wire.PONG)
        self.allow(soft)
        self.assertEqual(late.receive().kind, wire.HELLO_REPLY)
        self.assert_well(late)


if __name__ == "__main__":
    unittest.main()
