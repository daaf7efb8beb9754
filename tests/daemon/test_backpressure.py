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


class Crowd(FakeCase):
    def test_too_many_connections(self):
        crowd = [self.connect() for _ in range(256)]
        late = self.connect(greet=False)
        self.assert_error(late.drained()[0], "too-many-connections")
        for connection in crowd[:10]:
            connection.close()
        wire.wait_for(lambda: crowd[20].stats().connections <= 246, "places are free")
        self.assert_serves()

    def test_connections_that_say_nothing(self):
        silent = [socket.socket(socket.AF_UNIX) for _ in range(100)]
        for sock in silent:
            self.addCleanup(sock.close)
            sock.connect(self.daemon.socket)
        self.assert_serves()


if __name__ == "__main__":
    unittest.main()
