"""Every field of the header wrong, every cut of the stream: an answer that names it, and a daemon that goes on."""
import os
import socket
import unittest

import wire
from fakes import FakeCase
from wire import pb


class Header(FakeCase):
    def refused(self, data, name, request):
        """These bytes after a good hello: one error, then the end of the stream."""
        connection = self.connect()
        connection.sock.sendall(data)
        replies = connection.drained()
        self.assertEqual(len(replies), 1, replies)
        self.assert_error(replies[0], name)
        self.assertEqual(replies[0].request, request)
        self.assert_serves()

    def test_magic(self):
        for i in range(4):
            data = bytearray(wire.packet(wire.PING, 9))
            data[i] ^= 0x20
            self.refused(data, "bad-magic", 0)

    def test_version(self):
        for version in (0, 2, 255):
            self.refused(wire.header(wire.PING, 0, 9, version=version), "bad-version", 9)

    def test_flags(self):
        for bit in range(1, 16):
            self.refused(wire.header(wire.PING, 0, 9, flags=1 << bit), "bad-flags", 9)

    def test_length(self):
        for length in (64 * 1024 + 1, 1 << 31, (1 << 32) - 1):
            self.refused(wire.header(wire.PING, length, 9), "message-too-long", 9)

    def test_longest_length_is_read(self):
        connection = self.connect()
        # An unknown field of 65,530 bytes: its tag takes 2 bytes, its length 3.
        body = b"\xfa\x01" + b"\xfb\xff\x03" + bytes(65531)
        self.assertEqual(len(body), 64 * 1024)
        self.assertEqual(connection.ask(wire.PING, body).kind, wire.PONG)

    def test_unknown_type(self):
        connection = self.connect()
        for kind in (0x00, 0x7A, 0x7F, wire.PONG, wire.DONE, wire.ERROR):
            request = connection.send(kind, b"never looked at")
            self.assert_error(connection.receive(request=request), "unknown-type")
        self.assertEqual(connection.ask(wire.PING).kind, wire.PONG)

    def test_request_id_comes_back(self):
        connection = self.connect()
        for request in (0, 1, 0x80000000, 0xFFFFFFFF):
            connection.send(wire.PING, request=request)
            connection.receive(wire.PONG, request)

    def test_truncated_header(self):
        for count in range(16):
            with self.daemon.connect() as connection:
                connection.sock.sendall(wire.packet(wire.PING, 9)[:count])
                connection.sock.shutdown(socket.SHUT_WR)
                self.assertEqual(connection.drained(), [])
        self.assert_serves()

    def test_truncated_body(self):
        data = wire.packet(wire.PING, 9, pb.Ping(payload=b"0123456789"))
        for count in range(16, len(data)):
            with self.daemon.connect() as connection:
                connection.sock.sendall(data[:count])
                connection.sock.shutdown(socket.SHUT_WR)
                self.assertEqual(connection.drained(), [])
        self.assert_serves()

    def test_one_byte_at_a_time(self):
        connection = self.connect(greet=False)
        hello = wire.packet(wire.HELLO, 1, pb.Hello(version_min=1, version_max=1, client="slow"))
        for byte in hello + wire.packet(wire.PING, 2, pb.Ping(payload=b"slow")):
            connection.sock.sendall(bytes([byte]))
        connection.receive(wire.HELLO_REPLY, 1)
        self.assertEqual(connection.receive(wire.PONG, 2).body.payload, b"slow")

    def test_many_messages_in_one_piece(self):
        connection = self.connect()
        connection.sock.sendall(b"".join(wire.packet(wire.PING, i) for i in range(1, 501)))
        for i in range(1, 501):
            connection.receive(wire.PONG, i)

    def test_last_words_before_the_end_are_answered(self):
        connection = self.connect()
        connection.sock.sendall(wire.packet(wire.PING, 9))
        connection.sock.shutdown(socket.SHUT_WR)
        self.assertEqual([reply.kind for reply in connection.drained()], [wire.PONG])


class Descriptors(FakeCase):
    def settled(self):
        """The daemon's number of descriptors once nobody else is connected."""
        with self.daemon.connect() as probe:
            wire.wait_for(lambda: probe.stats().connections == 1, "others are gone")
            return self.daemon.descriptors()

    def test_without_the_flag_it_is_closed(self):
        before = self.settled()
        with self.daemon.connect() as connection, open(os.devnull) as file:
            for i in range(1, 101):
                connection.send_with_fds(wire.packet(wire.PING, i), [file.fileno()] * 3)
                connection.receive(wire.PONG, i)
            self.assertLessEqual(self.daemon.descriptors(), before + 2)
        self.assertEqual(self.settled(), before)

    def test_with_the_body_it_is_closed(self):
        before = self.settled()
        connection = self.connect()
        data = wire.packet(wire.LOAD, 5, pb.Load(name="box", path="box.gltf"), wire.FLAG_FD)
        folder = os.open(self.scenes, os.O_RDONLY)
        self.addCleanup(os.close, folder)
        connection.sock.sendall(data[:20])
        connection.send_with_fds(data[20:], [folder])
        self.assert_error(connection.receive(request=5), "bad-message")
        connection.close()
        self.assertEqual(self.settled(), before)

    def test_unfinished_message_gives_it_back(self):
        before = self.settled()
        with self.daemon.connect() as connection, open(os.devnull) as file:
            connection.send_with_fds(b"C", [file.fileno()])
        self.assertEqual(self.settled(), before)

    def test_flag_without_descriptor(self):
        connection = self.connect()
        request = connection.send(wire.LOAD, pb.Load(name="box", path="box.gltf"), flags=wire.FLAG_FD)
        self.assert_error(connection.receive(request=request), "bad-message")
        self.assertEqual(connection.ask(wire.PING).kind, wire.PONG)

    def test_flag_on_another_message(self):
        connection = self.connect()
        request = connection.send(wire.PING, flags=wire.FLAG_FD)
        self.assert_error(connection.receive(request=request), "bad-message")

    def test_a_file_for_a_folder(self):
        connection = self.connect()
        with open(os.devnull) as file:
            data = wire.packet(wire.LOAD, 5, pb.Load(name="box", path="box.gltf"), wire.FLAG_FD)
            connection.send_with_fds(data, [file.fileno()])
            self.assert_error(connection.receive(request=5), "scene-file")


if __name__ == "__main__":
    unittest.main()
