"""Clients that do not read: they hold up nobody, and what waits for them has a bound."""
import os
import socket
import unittest

import wire
from fakes import FakeCase, endless, pattern, render
from wire import pb

# The limit, a reply begun below it, and the last words of sixteen requests.
CAP = 256 * 1024 + 64 * 1024 + 16 * 20 * 1024


class Stalled(FakeCase):
    def assert_bounded(self, before_kib):
        with self.daemon.connect() as other:
            stats = other.stats()
        self.assertLessEqual(stats.buffered_bytes, CAP)
        # AddressSanitizer keeps what was freed for a while.
        self.assertLess(self.daemon.rss_kib(), before_kib + (64000 if os.environ.get("CANDIL_SANITIZE") == "1" else 8000))

    def test_large_image_waits_outside(self):
        before = self.daemon.rss_kib()
        stalled, other = self.with_box(), self.connect()
        job = stalled.send(wire.RENDER, render(width=8000, height=8000, samples=1, seed=5))
        wire.wait_for(lambda: other.stats().buffered_bytes > 0, "the image waits")
        for _ in range(5):
            self.assertEqual(other.follow(other.send(wire.RENDER, render()))[-1].kind, wire.DONE)
        self.assert_bounded(before)
        replies = stalled.follow(job)
        (frame, data), = wire.images(replies)
        self.assertEqual(frame.bytes, 64000000)
        self.assertEqual(bytes(data[:1000]), pattern(1000, 5))
        self.assertEqual(len(data), 64000000)
        self.assertEqual(replies[-1].kind, wire.DONE)

    def test_sixteen_images(self):
        before = self.daemon.rss_kib()
        stalled, other = self.with_box(), self.connect()
        jobs = [stalled.send(wire.RENDER, render(width=1000, height=1000, samples=1)) for _ in range(16)]
        wire.wait_for(lambda: other.stats().buffered_bytes > 0, "images wait")
        self.assertEqual(other.follow(other.send(wire.RENDER, render()))[-1].kind, wire.DONE)
        self.assert_bounded(before)
        for job in jobs:
            self.assertEqual(stalled.follow(job)[-1].kind, wire.DONE)

    def test_progressive(self):
        before = self.daemon.rss_kib()
        stalled, other = self.with_box(), self.connect()
        stalled.send(wire.RENDER, endless(width=1000, height=1000, progressive=True))
        wire.wait_for(lambda: other.stats().buffered_bytes > 0, "previews wait")
        slices = other.stats().slices
        wire.wait_for(lambda: other.stats().slices > slices + 50, "the job goes on")
        self.assert_bounded(before)

    def test_progress_is_dropped(self):
        before = self.daemon.rss_kib()
        stalled, other = self.with_box(), self.connect()
        for _ in range(16):
            stalled.send(wire.RENDER, endless())
        wire.wait_for(lambda: other.stats().slices > 3000, "much progress")
        self.assert_bounded(before)

    def test_ping_flood(self):
        before = self.daemon.rss_kib()
        flooding, other = self.connect(), self.connect()
        flooding.sock.setblocking(False)
        ping = wire.packet(wire.PING, 1, pb.Ping(payload=bytes(256)))
        sent = 0
        full = 0
        # Until the daemon has stopped reading for good: its buffer, then both sockets', are full.
        while full < 200:
            try:
                sent += flooding.sock.send(ping * 100)
                full = 0
            except BlockingIOError:
                full += 1
                other.ask(wire.PING)
        self.assertGreater(sent, 256 * 1024)
        self.assert_bounded(before)
        self.assertGreater(other.stats().buffered_bytes, 128 * 1024)
        flooding.close()
        wire.wait_for(lambda: other.stats().buffered_bytes == 0, "its bytes are freed")

    def test_reading_again(self):
        connection = self.connect()
        connection.sock.settimeout(wire.PATIENCE)
        count = 5000
        ping = pb.Ping(payload=bytes(200))
        data = b"".join(wire.packet(wire.PING, i, ping) for i in range(1, count + 1))
        connection.sock.setblocking(False)
        received = bytearray()
        at = 0
        while len(received) < len(data):
            try:
                at += connection.sock.send(data[at:at + 65536]) if at < len(data) else 0
            except BlockingIOError:
                pass
            try:
                received += connection.sock.recv(65536)
            except BlockingIOError:
                pass
        self.assertEqual([wire.HEADER.unpack_from(received, i * 219)[5] for i in range(count)],
                         list(range(1, count + 1)))


class CommonRoom(FakeCase):
    """What does not fit a connection's own room: five pictures fill the common one, nearly."""
    environment = {"FAKE_SPARSE": "12"}  # as many bytes a pixel as an EXR is estimated at
    LARGE = 12 * 4096 * 4096

    def ask_for(self, connection, **fields):
        return connection.send(wire.RENDER, render(samples=1, **fields))

    def large(self, connection):
        return self.ask_for(connection, width=4096, height=4096)

    def fill(self):
        # Of one process they would leave a quarter of the room.
        connections = [self.with_box()] + [self.connect(elsewhere=True) for _ in range(4)]
        jobs = [(connection, self.large(connection)) for connection in connections]
        other = self.connect()
        wire.wait_for(lambda: other.stats().image_bytes == 5 * self.LARGE, "five images wait")
        self.assertLessEqual(5 * self.LARGE, 1 << 30)
        return jobs, other

    def assert_small_ones_pass(self, other):
        for side in (8, 500):  # 500 pixels a side take most of what a connection has for itself
            replies = other.follow(self.ask_for(other, width=side, height=side, seed=3))
            self.assertEqual(bytes(wire.images(replies)[0][1]), pattern(side * side, 3))

    def wait_until_traced(self, other, slices):
        wire.wait_for(lambda: other.stats().slices == slices, "the job is traced")

    def finish(self, connection, job, size):
        replies = connection.follow(job)
        self.assertEqual(replies[-1].kind, wire.DONE)
        (frame, data), = wire.images(replies)
        self.assertEqual((frame.bytes, len(data)), (size, size))

    def test_a_full_room_holds_up_only_what_needs_it(self):
        jobs, other = self.fill()
        waiting, younger = self.connect(elsewhere=True), self.connect(elsewhere=True)
        job = self.large(waiting)
        self.wait_until_traced(other, 6)
        # It would fit, but the one before it has waited longer.
        middle = self.ask_for(younger, width=1024, height=1024)
        self.wait_until_traced(other, 7)
        self.assert_small_ones_pass(other)
        stats = other.stats()
        self.assertEqual((stats.image_bytes, stats.jobs), (5 * self.LARGE, 7))
        # A client that reads makes room.
        self.finish(*jobs[0], self.LARGE)
        self.finish(waiting, job, self.LARGE)
        self.finish(younger, middle, 12 << 20)
        for connection, left in jobs[1:]:
            self.finish(connection, left, self.LARGE)
        self.assertEqual(other.stats().image_bytes, 0)

    def test_a_client_that_goes_makes_room(self):
        jobs, other = self.fill()
        waiting = self.connect(elsewhere=True)
        job = self.large(waiting)
        self.wait_until_traced(other, 6)
        self.assert_small_ones_pass(other)
        jobs[2][0].close()
        self.finish(waiting, job, self.LARGE)
        self.assertEqual(jobs[3][0].ask(wire.CANCEL, pb.Cancel(request=jobs[3][1])).kind, wire.OK)
        wire.wait_for(lambda: other.stats().image_bytes == 3 * self.LARGE, "its room is given back")

    def test_one_larger_than_the_room_has_it_alone(self):
        jobs, other = self.fill()
        waiting = self.connect(elsewhere=True)
        aovs = 1 | 2 | 4 | 8
        huge = self.ask_for(waiting, width=8192, height=8192, aovs=aovs)  # 2.75 GiB by estimate
        self.wait_until_traced(other, 6)
        for connection, job in jobs[:4]:
            self.assertEqual(connection.ask(wire.CANCEL, pb.Cancel(request=job)).kind, wire.OK)
        self.assert_small_ones_pass(other)
        self.assertEqual(other.stats().image_bytes, self.LARGE)
        jobs[4][0].close()
        frames = iter(lambda: waiting.receive_for(huge).kind, wire.IMAGE)
        self.assertEqual(list(frames), [wire.ACCEPTED])
        self.assertEqual(other.stats().image_bytes, 12 << 26)

    def test_sweeps_and_previews_come_to_their_end(self):
        jobs, other = self.fill()
        late = self.connect(elsewhere=True)
        sweep = pb.Sweep(render=render(width=1024, height=1024, samples=8, progressive=True, progress_ms=1),
                         cameras=[pb.Camera(eye=pb.Vec3(x=i), target=pb.Vec3(z=1), vfov_degrees=40) for i in range(4)])
        swept = late.send(wire.SWEEP, sweep)
        single = late.send(wire.RENDER, render(width=2048, height=2048, samples=64, progressive=True))
        self.assert_small_ones_pass(other)
        for connection, _ in jobs:
            connection.close()
        for request, finals in ((swept, 4), (single, 1)):
            replies = late.follow(request)
            self.assertEqual(replies[-1].kind, wire.DONE)
            self.assertEqual(sum(frame.final for frame, _ in wire.images(replies)), finals)


class Crowd(FakeCase):
    def test_who_is_turned_away_keeps_nobody_waiting(self):
        """Hundreds without a place, who do not take the answer that they get: each gets one, and another process gets in.
        One at a time would take minutes."""
        crowd = [self.connect() for _ in range(192)]
        flood = [self.connect(greet=False) for _ in range(600)]
        self.assertEqual(self.connect(elsewhere=True).ask(wire.PING).kind, wire.PONG)
        for connection in flood:
            self.assert_error(connection.receive(), "too-many-connections")
        for number in (-1, 100):
            self.assertEqual(crowd[number].ask(wire.PING).kind, wire.PONG)
        self.assertLess(self.daemon.log_text().count("connection refused"), len(flood))

    def test_too_many_connections(self):
        crowd = [self.connect() for _ in range(192)]
        reply, = self.connect(greet=False).drained()
        self.assert_error(reply, "too-many-connections")
        self.assertIn("this process has 192", reply.body.message)
        crowd += [self.connect(elsewhere=True) for _ in range(64)]
        reply, = self.connect(elsewhere=True, greet=False).drained()
        self.assert_error(reply, "too-many-connections")
        self.assertIn("there are 256", reply.body.message)
        for connection in crowd[:10]:
            connection.close()
        wire.wait_for(lambda: crowd[20].stats().connections <= 246, "places are free")
        self.assertEqual(self.connect(elsewhere=True).ask(wire.PING).kind, wire.PONG)

    def test_connections_that_say_nothing(self):
        silent = [socket.socket(socket.AF_UNIX) for _ in range(100)]
        for sock in silent:
            self.addCleanup(sock.close)
            sock.connect(self.daemon.socket)
        self.assert_serves()


if __name__ == "__main__":
    unittest.main()
