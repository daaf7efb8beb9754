"""What is left of a command that ends by a signal: no daemon, no worker, no loader, no file. Stand-ins do the work, so that
each end comes at a known moment."""
import fcntl
import os
import pty
import shutil
import signal
import stat
import subprocess
import sys
import tempfile
import termios
import time
import unittest

from common import BUILD, environment
from fakes import LIBEXEC
from wire import PATIENCE, wait_for

NOBODY = 65534
KEPT = {"ok.gltf", "hang.gltf", "bin", "libexec", "trace"}


def parents():
    """{pid: parent's pid} of all processes that live."""
    found = {}
    for name in filter(str.isdigit, os.listdir("/proc")):
        try:
            with open(f"/proc/{name}/stat", encoding="ascii", errors="replace") as file:
                state, parent = file.read().rpartition(")")[2].split()[:2]
        except OSError:
            continue
        if state != "Z":
            found[int(name)] = int(parent)
    return found


def family(pid):
    """{pid: program} of all that a process has started, and what these have."""
    found, before = {}, parents()
    left = [pid]
    while left:
        parent = left.pop()
        for child in (c for c, p in before.items() if p == parent):
            try:
                found[child] = os.path.basename(os.readlink(f"/proc/{child}/exe"))
                left.append(child)
            except OSError:
                pass  # it has ended
    return found


def descriptors(pid):
    """{number: what it is} of a process."""
    folder = f"/proc/{pid}/fd"
    return {int(number): os.readlink(os.path.join(folder, number)) for number in os.listdir(folder)}


class Case(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.mkdtemp(prefix="candil-test-")
        self.addCleanup(shutil.rmtree, self.folder)
        os.makedirs(self.path("bin"))
        os.makedirs(self.path("libexec"))
        for name in ("candil", "candild"):
            shutil.copy(os.path.join(BUILD, "bin", name), self.path("bin"))
        os.symlink(LIBEXEC, self.path("libexec/candil"))
        for word in ("ok", "hang"):
            with open(self.path(word + ".gltf"), "w") as file:
                file.write(word)
        self.environment = environment(self.folder)
        # What the daemon has learned is kept elsewhere.
        state = tempfile.mkdtemp(prefix="candil-test-")
        self.addCleanup(shutil.rmtree, state)
        self.environment.update(XDG_STATE_HOME=state, FAKE_TRACE=self.path("trace"), FAKE_STATE=self.folder,
                                MESA_SHADER_CACHE_DIR=self.folder)  # beneath which stand-ins may write
        self.candil = self.path("bin/candil")
        # One that nohup or a shell's background ignores is inherited, and left alone.
        for number in (signal.SIGHUP, signal.SIGINT):
            before = signal.signal(number, signal.SIG_DFL if number == signal.SIGHUP else signal.default_int_handler)
            self.addCleanup(signal.signal, number, before)

    def path(self, name):
        return os.path.join(self.folder, name)

    def start(self, *arguments, **more):
        more = {"stdin": subprocess.DEVNULL, "stdout": subprocess.PIPE, "stderr": subprocess.PIPE, **more}
        process = subprocess.Popen([self.candil, *arguments], cwd=self.folder, env=self.environment, **more)
        self.addCleanup(self.finish, process)
        return process

    @staticmethod
    def finish(process):
        process.kill()
        process.communicate(timeout=PATIENCE)

    def all_of(self, pid, program):
        """The family once this program is of it."""
        def found():
            self.assertIn(pid, parents(), "it ended before")
            members = family(pid)
            return members if program in members.values() else None
        return wait_for(found, f"{program} runs")

    def assert_gone(self, members):
        self.assertIn("candild", members.values())
        wait_for(lambda: not set(members) & set(parents()), f"{members} have ended")

    def picture(self, *arguments):
        """The bytes of a picture that nothing disturbed."""
        done = subprocess.run([self.candil, "render", "ok.gltf", "-o", "whole.png", "--technique", "pt", *arguments],
                              cwd=self.folder, env=self.environment, capture_output=True, timeout=PATIENCE)
        self.assertEqual(done.returncode, 0, done)
        with open(self.path("whole.png"), "rb") as file:
            data = file.read()
        os.unlink(self.path("whole.png"))
        return data

    def leftovers(self):
        return sorted(set(os.listdir(self.folder)) - KEPT)


COMMANDS = {
    "render": ["render", "hang.gltf", "-o", "out.png"],
    "sweep": ["sweep", "hang.gltf", "-o", "out-{index}.png", "--orbit", "2"],
    "quote": ["quote", "hang.gltf"],
    "study": ["study", "hang.gltf", "-o", "out"],
    "inspect": ["inspect", "hang.gltf", "-o", "out", "--technique", "vct"],
    "describe": ["describe", "hang.gltf"],
}
ENDLESS = ["render", "ok.gltf", "-o", "out.png", "--technique", "pt", "--spp", "10000000"]


class Private(Case):
    """The daemon that a command has started for itself ends with it."""

    def test_every_command_killed_in_a_load(self):
        for name, arguments in COMMANDS.items():
            with self.subTest(command=name):
                process = self.start(*arguments)
                members = self.all_of(process.pid, "candil-loader")
                process.kill()
                self.assert_gone(members)

    def test_killed_in_a_frame(self):
        process = self.start(*ENDLESS)
        wait_for(lambda: os.path.exists(self.path("trace")) and os.path.getsize(self.path("trace")) > 0, "it renders")
        members = family(process.pid)
        process.kill()
        self.assert_gone(members)

    def test_killed_at_its_start(self):
        process = self.start(*ENDLESS)
        members = wait_for(lambda: family(process.pid), "it has started something")
        process.kill()
        wait_for(lambda: not set(members) & set(parents()), "they have ended")

    def test_signals(self):
        for number in (signal.SIGHUP, signal.SIGINT, signal.SIGTERM):
            with self.subTest(signal=number):
                process = self.start(*COMMANDS["render"])
                members = self.all_of(process.pid, "candil-loader")
                process.send_signal(number)
                _, error = process.communicate(timeout=PATIENCE)
                self.assertEqual(process.returncode, 8, error)
                self.assert_gone(members)
                self.assertEqual(self.leftovers(), [])

    def test_a_terminal_that_closes(self):
        pid, terminal = pty.fork()
        if pid == 0:
            try:
                os.chdir(self.folder)
                os.execve(self.candil, [self.candil, *COMMANDS["render"]], self.environment)
            finally:
                os._exit(127)
        try:
            members = self.all_of(pid, "candil-loader")
            os.close(terminal)
            self.assertEqual(os.waitstatus_to_exitcode(os.waitpid(pid, 0)[1]), 8)
        except BaseException:
            os.kill(pid, signal.SIGKILL)
            raise
        self.assert_gone(members)
        self.assertEqual(self.leftovers(), [])

    def test_killed_whenever_it_leaves_no_file_without_its_name(self):
        try:
            os.close(os.open(self.folder, os.O_TMPFILE | os.O_WRONLY))
        except OSError:
            self.skipTest("this file system has no files without names")
        whole = self.picture("--size", "64x64", "--spp", "1")
        for i in range(24):
            process = self.start("render", "ok.gltf", "-o", "out.png", "--size", "64x64", "--technique", "pt", "--spp", "1")
            time.sleep(i * 0.004)  # somewhere in its life, wherever that is on this machine
            process.kill()
            process.communicate(timeout=PATIENCE)
            self.assertLessEqual(set(self.leftovers()), {"out.png"})
            if os.path.exists(self.path("out.png")):
                self.assertEqual(os.path.getsize(self.path("out.png")), len(whole))
                os.unlink(self.path("out.png"))


class Pipes(Case):
    """An output whose reader is not there, or has stopped, ends by a signal like any other."""
    LARGE = ["--size", "512x512", "--technique", "pt", "--spp", "1"]

    def setUp(self):
        super().setUp()
        os.mkfifo(self.path("pipe.png"))
        self.addCleanup(KEPT.discard, "pipe.png")
        KEPT.add("pipe.png")

    def interrupt(self, process, number):
        process.send_signal(number)
        process.wait(timeout=PATIENCE)  # and only then be the reader that it may have waited for
        _, error = process.communicate(timeout=PATIENCE)
        self.assertEqual(process.returncode, 8, error)
        self.assertIn(b"cancelled", error)
        self.assertEqual(self.leftovers(), [])

    @staticmethod
    def is_full(fd):
        """Whether a pipe takes no more."""
        waiting = bytearray(4)
        fcntl.ioctl(fd, termios.FIONREAD, waiting)
        return int.from_bytes(waiting, sys.byteorder) == fcntl.fcntl(fd, fcntl.F_GETPIPE_SZ)

    def test_no_reader(self):
        for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
            with self.subTest(signal=number):
                process = self.start("render", "ok.gltf", "-o", "pipe.png")
                # It holds signals back from here on, and has not begun with the scene before it has a reader.
                wait_for(lambda: self.holds_back(process.pid), "it waits")
                self.interrupt(process, number)

    @staticmethod
    def holds_back(pid):
        with open(f"/proc/{pid}/status", encoding="ascii") as file:
            lines = dict(line.split(":", 1) for line in file if line.startswith("SigCgt"))
        return int(lines["SigCgt"], 16) >> signal.SIGTERM - 1 & 1

    def test_a_reader_that_has_stopped(self):
        for number in (signal.SIGINT, signal.SIGTERM):
            for command in (["render", "ok.gltf", "-o", "pipe.png"],
                            ["sweep", "ok.gltf", "-o", "pipe.png{index}", "--format", "png", "--orbit", "1"]):
                with self.subTest(signal=number, command=command[0]):
                    reader = os.open(self.path("pipe.png"), os.O_RDONLY | os.O_NONBLOCK)
                    if command[0] == "sweep" and not os.path.exists(self.path("pipe.png0")):
                        os.symlink("pipe.png", self.path("pipe.png0"))
                        self.addCleanup(KEPT.discard, "pipe.png0")
                        KEPT.add("pipe.png0")
                    process = self.start(*command, *self.LARGE)
                    wait_for(lambda: self.is_full(reader), "the pipe is full")
                    self.interrupt(process, number)
                    os.close(reader)

    def test_standard_output_that_nobody_reads(self):
        for name in ("-", "/dev/stdout"):
            for number in (signal.SIGINT, signal.SIGTERM):
                with self.subTest(output=name, signal=number):
                    process = self.start("render", "ok.gltf", "-o", name, "--format", "png", *self.LARGE)
                    wait_for(lambda: self.is_full(process.stdout.fileno()), "the pipe is full")
                    self.interrupt(process, number)

    def test_an_answer_that_nobody_reads(self):
        reader, writer = os.pipe()
        fcntl.fcntl(reader, fcntl.F_SETPIPE_SZ, 4096)
        self.addCleanup(os.close, reader)
        process = self.start("sweep", "ok.gltf", "-o", "pipe.png-{index}", "--format", "png", "--orbit", "40", "--size", "8x8",
                             "--spp", "1", "--json", stdout=writer)
        os.close(writer)
        wait_for(lambda: self.is_full(reader), "the pipe is full")
        # Nothing waits with it, and it ends as any program does.
        wait_for(lambda: not family(process.pid), "its daemon has ended")
        process.terminate()
        process.communicate(timeout=PATIENCE)
        self.assertEqual(process.returncode, -signal.SIGTERM)

    def test_a_reader_gets_the_picture(self):
        whole = self.picture(*self.LARGE)
        self.assertGreater(len(whole), 65536, "more than a pipe holds")
        process = self.start("render", "ok.gltf", "-o", "pipe.png", *self.LARGE)
        with open(self.path("pipe.png"), "rb") as pipe:
            self.assertEqual(pipe.read(), whole)
        self.assertEqual(process.wait(PATIENCE), 0)
        self.assertTrue(stat.S_ISFIFO(os.stat(self.path("pipe.png")).st_mode))
        process = self.start("render", "ok.gltf", "-o", "/dev/stdout", "--format", "png", "--quiet", *self.LARGE)
        self.assertEqual(process.communicate(timeout=PATIENCE)[0], whole)

    def test_a_reader_that_goes(self):
        process = self.start("render", "ok.gltf", "-o", "-", *self.LARGE)
        process.stdout.read(1)
        process.stdout.close()
        self.assertEqual(process.wait(PATIENCE), 1)
        self.assertIn(b"Broken pipe", process.stderr.read())


class Files(Case):
    """A file that a picture replaces keeps what is its owner's."""

    def render(self, **more):
        done = subprocess.run([self.candil, "render", "ok.gltf", "-o", "out.png", "--size", "8x8", "--quiet"], cwd=self.folder,
                              env=self.environment, stderr=subprocess.PIPE, timeout=PATIENCE, **more)
        self.assertEqual(done.returncode, 0, done)
        os.chmod(self.folder, 0o755)
        self.assertEqual(self.leftovers(), ["out.png"])
        return os.stat(self.path("out.png"))

    def write(self, mode):
        with open(self.path("out.png"), "w") as file:
            file.write("what was there before, and is longer than a small picture" * 1000)
        os.chmod(self.path("out.png"), mode)
        return os.stat(self.path("out.png"))

    def test_mode(self):
        before = os.umask(0o027)
        self.addCleanup(os.umask, before)
        self.assertEqual(stat.S_IMODE(self.render().st_mode), 0o640)
        for mode in (0o600, 0o664, 0o755):
            old = self.write(mode)
            new = self.render()
            self.assertEqual(stat.S_IMODE(new.st_mode), mode)
            self.assertNotEqual(new.st_ino, old.st_ino, "it was replaced, not written over")

    def test_another_hard_link_keeps_the_old(self):
        old = self.write(0o644)
        other = tempfile.mkdtemp(prefix="candil-test-", dir=os.path.dirname(self.folder))
        self.addCleanup(shutil.rmtree, other)
        os.link(self.path("out.png"), os.path.join(other, "out.png"))
        self.render()
        self.assertEqual(os.stat(os.path.join(other, "out.png")).st_size, old.st_size)

    def test_a_folder_that_takes_no_file(self):
        # Root may write anywhere: it becomes somebody else.
        somebody = {"user": NOBODY, "group": NOBODY, "extra_groups": []} if os.geteuid() == 0 else {}
        if somebody:
            self.environment["XDG_STATE_HOME"] = "/nonexistent"
        del self.environment["FAKE_TRACE"]
        old = self.write(0o666)
        self.addCleanup(os.chmod, self.folder, 0o700)
        os.chmod(self.folder, 0o555)
        new = self.render(**somebody)
        self.assertEqual(new.st_ino, old.st_ino)
        self.assertNotEqual(new.st_size, old.st_size)

    @unittest.skipIf(os.geteuid() != 0, "only root has files of others")
    def test_owner(self):
        self.write(0o666)
        os.chown(self.path("out.png"), NOBODY, NOBODY)
        new = self.render()
        self.assertEqual((new.st_uid, new.st_gid, stat.S_IMODE(new.st_mode)), (NOBODY, NOBODY, 0o666))
        # Who cannot give files away writes over what is there.
        os.chown(self.path("out.png"), 1, 1)
        old = self.write(0o666)
        self.environment["XDG_STATE_HOME"] = "/nonexistent"
        del self.environment["FAKE_TRACE"]
        os.chmod(self.folder, 0o777)
        new = self.render(user=NOBODY, group=NOBODY, extra_groups=[])
        self.assertEqual((new.st_ino, new.st_uid), (old.st_ino, 1))


class Descriptors(Case):
    def test_nothing_that_the_caller_has_open_reaches_a_child(self):
        secret = self.path("ok.gltf")
        fd = os.open(secret, os.O_RDONLY)
        os.dup2(fd, 9)
        self.addCleanup(os.close, 9)
        os.close(fd)
        process = self.start(*COMMANDS["render"], pass_fds=[9], stdin=subprocess.PIPE)
        self.all_of(process.pid, "candil-loader")

        def started():
            """All of them; one that has not begun its own program yet has the name of who started it."""
            found = family(process.pid)
            return found if sorted(found.values()) == ["candil-loader", "candil-worker", "candild"] else None
        members = wait_for(started, "all have begun")
        ours = descriptors(process.pid)
        self.assertEqual(ours[9], secret)
        for pid, program in members.items():
            with self.subTest(program=program):
                theirs = descriptors(pid)
                self.assertNotIn(secret, theirs.values())
                self.assertEqual(theirs[0], "/dev/null")
                # Who reads the command's output waits for the command alone.
                self.assertNotIn(ours[1], theirs.values())
                if program != "candild":
                    self.assertLessEqual(set(theirs), {0, 1, 2, 3, 4})

    def test_a_closed_stream_is_no_place_for_a_picture(self):
        whole = self.picture()
        # The shell's own closing: subprocess has none for a single descriptor.
        closed = subprocess.run(["sh", "-c", 'exec "$0" "$@" <&- >&-', self.candil, "render", "ok.gltf", "-o", "out.png",
                                 "--technique", "pt"],
                                cwd=self.folder, stderr=subprocess.PIPE, env=self.environment, timeout=PATIENCE)
        self.assertEqual(closed.returncode, 1, closed)
        self.assertIn(b"cannot write the answer", closed.stderr)
        with open(self.path("out.png"), "rb") as file:
            self.assertEqual(file.read(), whole)


if __name__ == "__main__":
    unittest.main()
