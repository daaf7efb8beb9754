"""Sixty-four connections at once, the troublemakers among them: one that does not read, one that writes a byte at a time, one that
says nothing. `everyone` lets the others ask and tells whether the daemon stays level."""
import array
import fcntl
import os
import termios

import wire
from wire import pb

CONNECTIONS = 64
TROUBLEMAKERS = 3
CHUNK = 64 * 1024  # of an image; nothing else that waits here is as long


def unread(sock):
    """Bytes that a socket has for its reader."""
    count = array.array("i", [0])
    fcntl.ioctl(sock, termios.FIONREAD, count)
    return count[0]
ORDINARY = CONNECTIONS - TROUBLEMAKERS - 1  # one more looks on


class Crowd:
    """`render` makes the request of the stalled peer, which has to be one with a large image, and of the slow writer."""

    def __init__(self, daemon, connect, stalled_renders, slow_render):
        self.daemon = daemon
        self.observer = connect()
        self.ordinary = [connect() for _ in range(ORDINARY)]
        self.silent = connect()
        self.stalled = connect()
        for render in stalled_renders:
            self.stalled.send(wire.RENDER, render)
        self.slow = connect()
        self.slow_bytes = wire.packet(wire.RENDER, 1000, slow_render)
        self.slow_at = 0
        wire.wait_for(lambda: unread(self.stalled.sock) > CHUNK, "the stalled peer's image waits")

    def nudge(self):
        """One more byte of the slow writer's request, never the last."""
        if self.slow_at < len(self.slow_bytes) - 1:
            self.slow.sock.sendall(self.slow_bytes[self.slow_at:self.slow_at + 1])
            self.slow_at += 1

    def ask_all(self, render, asked=lambda: None):
        """Each ordinary connection sends `render(i)`, then `asked` is called; then their replies, in the order of sending."""
        requests = [connection.send(wire.RENDER, render(i)) for i, connection in enumerate(self.ordinary)]
        asked()
        for i, connection in enumerate(self.ordinary):
            if i % 8 == 0:
                self.nudge()
            yield i, connection.follow(requests[i])

    def finish_slow(self):
        """The rest of its bytes, one by one; all that comes back."""
        for i in range(self.slow_at, len(self.slow_bytes)):
            self.slow.sock.sendall(self.slow_bytes[i:i + 1])
        self.slow_at = len(self.slow_bytes)
        return self.slow.follow(1000)

    def held(self):
        """What must not grow: of the daemon, descriptors beyond its connections, jobs, bytes that wait."""
        stats = self.observer.stats()
        return {"descriptors": self.daemon.descriptors() - stats.connections, "jobs": stats.jobs, "connections": stats.connections,
                "buffered": stats.buffered_bytes, "images": stats.image_bytes}


def growth_allowed_kib():
    """AddressSanitizer keeps what was freed for a while. A job takes some 20 KiB, and one round may have had fewer of them at a
    time than a later one; what leaked a round would be several times as much."""
    return 64000 if os.environ.get("CANDIL_SANITIZE") == "1" else 2048


def slow_render(**fields):
    """Long enough to be still under way when the others have been served."""
    return pb.Render(options=[pb.Option(name="pt.depth", value="3")], **fields)
