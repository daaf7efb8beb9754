"""Start, socket, users, signals, private connections; and what the front must not be linked with."""
import fcntl
import os
import re
import signal
import socket
import stat
import subprocess
import sys
import tempfile
import unittest

import wire
from fakes import LIBEXEC, FakeCase, endless, render
from wire import pb

CANDILD = os.path.join(wire.BUILD, "bin", "candild")
NOBODY = 65534

TECHNIQUES = len(pb.Technique.keys()) - 1   # all but "auto"


class Socket(FakeCase):
    def test_mode(self):
        self.assertEqual(stat.S_IMODE(os.stat(self.daemon.socket).st_mode), 0o600)

    def second_daemon(self, path):
        return subprocess.run([CANDILD, "--socket", path, "--libexec", LIBEXEC], stderr=subprocess.PIPE,
                              timeout=wire.PATIENCE, text=True, check=False)

    def test_a_living_socket_is_left_alone(self):
        second = self.second_daemon(self.daemon.socket)
        self.assertEqual(second.returncode, 1)
        self.assertIn("answers", second.stderr)
        self.assert_serves()

    def test_a_file_is_left_alone(self):
        path = os.path.join(self.daemon.folder, "precious")
        with open(path, "w") as file:
            file.write("data")
        self.assertEqual(self.second_daemon(path).returncode, 1)
        with open(path) as file:
            self.assertEqual(file.read(), "data")

    def test_a_dead_socket_is_replaced(self):
        path = os.path.join(self.daemon.folder, "dead.sock")
        with socket.socket(socket.AF_UNIX) as dead:
            dead.bind(path)
        other = wire.Daemon(libexec=LIBEXEC)
        other.socket = path
        with other, other.connect() as connection:
            self.assertEqual(connection.ask(wire.PING).kind, wire.PONG)

    def test_a_socket_of_another_kind_is_left_alone(self):
        path = os.path.join(self.daemon.folder, "datagrams.sock")
        with socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM) as other:
            other.bind(path)
            inode = os.stat(path).st_ino
            self.assertEqual(self.second_daemon(path).returncode, 1)
            self.assertEqual(os.stat(path).st_ino, inode)

    @staticmethod
    def has_open(pid, path):
        links = os.path.join("/proc", str(pid), "fd")
        try:
            return path in [os.readlink(os.path.join(links, number)) for number in os.listdir(links)]
        except OSError:  # closed or ended while we looked
            return False

    def test_one_that_starts_beside_it_is_waited_for(self):
        path = os.path.join(self.daemon.folder, "late.sock")
        folder = os.open(self.daemon.folder, os.O_RDONLY)
        fcntl.flock(folder, fcntl.LOCK_EX)  # as a daemon does while it looks for a socket in its way
        process = subprocess.Popen([CANDILD, "--socket", path, "--libexec", LIBEXEC], stderr=subprocess.DEVNULL)
        self.addCleanup(process.wait)
        self.addCleanup(process.terminate)
        wire.wait_for(lambda: process.poll() is not None or self.has_open(process.pid, self.daemon.folder), "it waits")
        os.close(folder)
        wire.wait_for(lambda: process.poll() is not None or os.path.exists(path), "it listens")
        self.assertIsNone(process.poll())

    def test_a_path_too_long(self):
        self.assertEqual(self.second_daemon("/" + "x" * 200).returncode, 1)

    @unittest.skipIf(os.geteuid() != 0, "only root can become another user")
    def test_another_user_is_refused(self):
        os.chmod(self.daemon.folder, 0o755)
        os.chmod(self.daemon.socket, 0o666)
        sock = socket.socket(socket.AF_UNIX)
        child = os.fork()
        if child == 0:
            # The credentials that count are those at the time of connecting.
            os.setresuid(NOBODY, NOBODY, NOBODY)
            sock.connect(self.daemon.socket)
            connection = wire.Connection(sock=sock, greet=False)
            try:
                connection.send(wire.HELLO, pb.Hello(version_min=1, version_max=1))
            except OSError:
                pass
            replies = connection.drained()
            os._exit(0 if [reply.body.name for reply in replies] == ["not-allowed"] else 1)
        sock.close()
        self.assertEqual(os.waitpid(child, 0)[1], 0)
        self.assert_serves()


class Signals(FakeCase):
    def leave(self, how):
        connection, loading, idle, silent = self.with_box(), self.connect(), self.connect(), self.connect(greet=False)
        self.write("slow.gltf", "hang")
        job = connection.send(wire.RENDER, endless())
        connection.receive(wire.ACCEPTED, job)
        load = loading.send_load("slow", self.scenes, "slow.gltf")
        wire.wait_for(lambda: loading.stats().loader_pid, "the loader runs")
        children = [loading.stats().worker_pid, loading.stats().loader_pid]
        self.daemon.process.send_signal(how)
        self.assert_error(connection.follow(job)[-1], "shutting-down")
        self.assert_error(loading.receive_for(load), "shutting-down")
        # Under id 0 everybody is told, also those who wait for nothing.
        for other in (connection, loading, idle, silent):
            told = other.drained()
            self.assertEqual([reply.request for reply in told], [0])
            self.assert_error(told[0], "shutting-down")
        self.assertEqual(self.daemon.process.wait(wire.PATIENCE), 0)
        self.assertFalse(os.path.exists(self.daemon.socket))
        for pid in children:
            self.assertFalse(os.path.exists(f"/proc/{pid}"), "the child was not collected")

    def test_term(self):
        self.leave(signal.SIGTERM)

    def test_int(self):
        self.leave(signal.SIGINT)

    def test_a_hangup_ends_nothing(self):
        connection = self.with_box()
        job = connection.send(wire.RENDER, endless())
        connection.receive(wire.ACCEPTED, job)
        self.daemon.process.send_signal(signal.SIGHUP)
        wire.wait_for(lambda: "SIGHUP" in self.daemon.log_text(), "it has taken the signal")
        connection.send(wire.CANCEL, pb.Cancel(request=job))
        self.assert_error(connection.follow(job)[-1], "cancelled")
        self.assert_serves()

    def test_the_second_ends_it_at_once(self):
        connection = self.with_box()
        connection.send(wire.RENDER, render(width=4000, height=4000))
        other = self.connect()
        wire.wait_for(lambda: other.stats().buffered_bytes > 0, "the image waits")
        os.kill(self.daemon.process.pid, signal.SIGSTOP)  # both signals come before it looks
        for how in (signal.SIGTERM, signal.SIGINT, signal.SIGCONT):
            os.kill(self.daemon.process.pid, how)
        self.assertEqual(self.daemon.process.wait(wire.PATIENCE), 0)
        self.assertIn("at once", self.daemon.log_text())
        self.assertFalse(os.path.exists(self.daemon.socket))

    def test_a_client_that_does_not_read_delays_it_little(self):
        connection = self.with_box()
        connection.send(wire.RENDER, render(width=4000, height=4000))
        other = self.connect()
        wire.wait_for(lambda: other.stats().buffered_bytes > 0, "the image waits")
        self.daemon.process.send_signal(signal.SIGTERM)
        self.assertEqual(self.daemon.process.wait(wire.PATIENCE), 0)

    def test_killed_front_takes_its_worker_along(self):
        connection = self.with_box()
        connection.follow(connection.send(wire.RENDER, render()))
        worker = connection.stats().worker_pid
        self.daemon.process.kill()
        self.daemon.process.wait()
        wire.wait_for(lambda: not running(worker), "the worker has ended")
        self.daemon.start()  # on the socket that the dead one left


class Warm(unittest.TestCase):
    """--warm: who can connect finds a picture of each technique rendered."""

    def start(self, orders, **environment):
        folder = self.enterContext(tempfile.TemporaryDirectory())
        with open(os.path.join(folder, "box.gltf"), "w") as file:
            file.write(orders)
        path = os.path.join(folder, "box.gltf")
        daemon = wire.Daemon("--warm", f"box={path}", "--scene", f"other={path}", libexec=LIBEXEC, environment=environment)
        self.trace = daemon.environment["FAKE_TRACE"] = os.path.join(daemon.folder, "trace")
        self.addCleanup(daemon.stop)
        return daemon

    def test_one_picture_of_each_technique(self):
        daemon = self.start("ok").start()
        with daemon.connect() as connection:
            stats = connection.stats()
            self.assertEqual((stats.jobs, stats.jobs_failed, stats.worker_starts, stats.scenes), (0, 0, 1, 2))
            self.assertEqual(stats.jobs_done, TECHNIQUES)
            with open(self.trace) as file:
                self.assertEqual(len(set(file.read().split())), TECHNIQUES)
            self.assertEqual(connection.follow(connection.send(wire.RENDER, render()))[-1].kind, wire.DONE)
        self.assertEqual(daemon.end(), 0)

    def test_what_fails_keeps_nobody_out(self):
        daemon = self.start("ok", FAKE_NO_DEVICE="1").start()
        with daemon.connect() as connection:
            self.assertEqual((connection.stats().jobs_failed, connection.stats().jobs), (TECHNIQUES, 0))
        self.assertEqual(daemon.end(), 0)

    def test_a_bad_scene_ends_it(self):
        with self.assertRaisesRegex(RuntimeError, "scene (box|other): "):
            self.start("refuse").start()

    def test_it_can_be_ended_meanwhile(self):
        daemon = self.start("ok", FAKE_STEP_US="1000000000")
        with open(daemon.log, "ab") as log:
            process = subprocess.Popen([daemon.program, "--socket", daemon.socket] + daemon.arguments, stderr=log, env=daemon.environment)
        wire.wait_for(lambda: os.path.exists(self.trace) and os.path.getsize(self.trace), "it renders")
        self.assertFalse(os.path.exists(daemon.socket))
        process.terminate()
        self.assertEqual(process.wait(wire.PATIENCE), 0)


class Cache(FakeCase):
    def prepare(self):
        self.cache = os.path.join(self.daemon.folder, "cache")
        self.daemon.environment["MESA_SHADER_CACHE_DIR"] = self.cache
        self.told = re.escape(self.cache)

    def test_who_removes_it_is_told_that_nothing_is_kept(self):
        connection = self.connect()
        self.assertEqual(connection.stats().device_note, "")
        os.rmdir(self.cache)
        for _ in range(2):
            self.assertRegex(connection.stats().device_note, f"^{self.told} was removed or replaced: .* until candild is started again$")
            os.makedirs(self.cache, exist_ok=True)  # another of its name is not the daemon's to write to


class OddCache(Cache):
    """Its path is no text, and too long to be told whole."""

    def prepare(self):
        super().prepare()
        whole = os.path.join(self.daemon.folder, "")
        whole += "?" + "c" * (118 - len(whole))
        self.cache = whole.replace("?", "\udcff") + "\u00fc"  # the first of its two bytes is the 120th
        self.daemon.environment["MESA_SHADER_CACHE_DIR"] = self.cache
        self.told = re.escape(whole)


class LeaveDuringAPilot(FakeCase):
    """A quote holds its scene for as long as its pilot is out."""
    environment = {"FAKE_PILOT_US": "600000000"}

    def leave(self, connection):
        self.daemon.process.send_signal(signal.SIGTERM)
        self.assertEqual(self.daemon.process.wait(wire.PATIENCE), 0)
        return connection.drained()

    def test_before_the_answer(self):
        connection = self.with_box()
        connection.send(wire.QUOTE, pb.Quote(render=render()))
        connection.ask(wire.PING)
        told = self.leave(connection)
        self.assertEqual([reply.request for reply in told], [connection.last - 1, 0])
        self.assert_error(told[0], "shutting-down")

    def test_behind_the_answer(self):
        connection = self.with_box()
        self.assertEqual(connection.ask(wire.QUOTE, pb.Quote(render=render())).kind, wire.QUOTE_REPLY)
        self.leave(connection)


def running(pid):
    try:
        with open(f"/proc/{pid}/stat") as file:
            return file.read().rpartition(")")[2].split()[0] != "Z"
    except (FileNotFoundError, ProcessLookupError):
        return False


class Private(unittest.TestCase):
    def setUp(self):
        self.ours, theirs = socket.socketpair(socket.AF_UNIX, socket.SOCK_STREAM)
        environment = {key: value for key, value in os.environ.items() if key != "XDG_RUNTIME_DIR"}
        self.process = subprocess.Popen([CANDILD, "--private-fd", str(theirs.fileno()), "--libexec", LIBEXEC],
                                        pass_fds=[theirs.fileno()], env=environment, stderr=subprocess.DEVNULL)
        theirs.close()
        self.addCleanup(self.finish)

    def finish(self):
        self.ours.close()
        self.assertEqual(self.process.wait(wire.PATIENCE), 0)

    def test_serves_until_it_closes(self):
        connection = wire.Connection(sock=self.ours)
        with open(os.path.join(os.environ["CANDIL_BUILD"], "tests", "private.gltf"), "w") as file:
            file.write("ok")
        connection.load("box", os.path.dirname(file.name), "private.gltf")
        self.assertEqual(connection.follow(connection.send(wire.RENDER, render()))[-1].kind, wire.DONE)
        self.assertIsNone(self.process.poll())

    def test_it_may_be_warmed(self):
        folder = self.enterContext(tempfile.TemporaryDirectory())
        with open(os.path.join(folder, "box.gltf"), "w") as file:
            file.write("ok")
        ours, theirs = socket.socketpair(socket.AF_UNIX, socket.SOCK_STREAM)
        process = subprocess.Popen([CANDILD, "--private-fd", str(theirs.fileno()), "--libexec", LIBEXEC, "--no-state", "--warm",
                                    f"box={file.name}"], pass_fds=[theirs.fileno()], stderr=subprocess.DEVNULL)
        theirs.close()
        with wire.Connection(sock=ours) as connection:
            self.assertEqual(connection.follow(connection.send(wire.RENDER, render()))[-1].kind, wire.DONE)
        self.assertEqual(process.wait(wire.PATIENCE), 0)

    def test_ends_after_a_broken_stream(self):
        connection = wire.Connection(sock=self.ours)
        connection.sock.sendall(b"x" * 16)
        self.assertEqual([reply.body.name for reply in connection.drained()], ["bad-magic"])
        self.assertEqual(self.process.wait(wire.PATIENCE), 0)

    def test_ends_in_the_middle_of_a_job(self):
        connection = wire.Connection(sock=self.ours)
        connection.send(wire.RENDER, endless())


class Program(unittest.TestCase):
    def run_it(self, *arguments, **keywords):
        return subprocess.run([CANDILD, *arguments], capture_output=True, text=True, timeout=wire.PATIENCE,
                              check=False, **keywords)

    def test_help_and_version(self):
        shown = self.run_it("--help")
        self.assertEqual(shown.returncode, 0)
        for option in ("--socket", "--scene", "--scene-root", "--device", "--require-gpu", "--memory-budget", "--slice",
                       "--libexec", "--private-fd"):
            self.assertIn(option, shown.stdout)
        self.assertTrue(self.run_it("--version").stdout.startswith("candild "))

    def test_wrong_arguments(self):
        for arguments in (["--frobnicate"], ["--socket", "x", "--slice", "0"], ["scene.gltf"]):
            refused = self.run_it(*arguments)
            self.assertEqual(refused.returncode, 2)
            self.assertTrue(refused.stderr.startswith("candild: "))
        self.assertIn("takes a value", self.run_it("--socket").stderr)
        self.assertIn("no such option", self.run_it("--sockets").stderr)
        self.assertIn("takes no value", self.run_it("--require-gpu=1").stderr)

    def test_a_descriptor_that_is_no_connection(self):
        listener = socket.socket(socket.AF_UNIX)
        listener.bind("")  # the kernel chooses a name
        listener.listen(1)
        datagrams, other = socket.socketpair(socket.AF_UNIX, socket.SOCK_DGRAM)
        with listener, datagrams, other, open("/dev/null") as file:
            for one in (listener, datagrams, file):
                refused = self.run_it("--no-state", "--private-fd", str(one.fileno()), "--libexec", LIBEXEC,
                                      pass_fds=[one.fileno()])
                self.assertEqual(refused.returncode, 1)
                self.assertIn("no connected stream socket", refused.stderr)

    def test_closed_standard_descriptors_are_filled(self):
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "candil.sock")
            # The shell's own closing: subprocess has none for a single descriptor.
            process = subprocess.Popen(["sh", "-c", 'exec "$0" "$@" <&- >&- 2>&-', CANDILD, "--socket", path,
                                        "--libexec", LIBEXEC])
            self.addCleanup(process.wait)
            self.addCleanup(process.terminate)
            wire.wait_for(lambda: os.path.exists(path), "it listens")
            for number in range(3):
                self.assertEqual(os.readlink(f"/proc/{process.pid}/fd/{number}"), "/dev/null")

    def test_nowhere_to_listen(self):
        environment = {key: value for key, value in os.environ.items() if key != "XDG_RUNTIME_DIR"}
        refused = self.run_it(env=environment)
        self.assertEqual(refused.returncode, 2)
        self.assertIn("--socket", refused.stderr)

    def test_links_no_device_and_no_parser(self):
        needed = subprocess.run(["readelf", "-d", CANDILD], capture_output=True, text=True, check=True).stdout
        libraries = [line.split("[")[1].split("]")[0] for line in needed.splitlines() if "(NEEDED)" in line]
        self.assertTrue(libraries)
        allowed = ("libc.so", "libm.so", "libprotobuf-nanopb.so", "libseccomp.so", "libasan.so", "libubsan.so")
        for library in libraries:
            self.assertTrue(library.startswith(allowed), f"{library} is linked into the front")


if __name__ == "__main__":
    sys.exit(unittest.main())
