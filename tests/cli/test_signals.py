"""What is left of a command that ends by a signal: no daemon, no worker, no loader, no file. Stand-ins do the work, so that
each end comes at a known moment."""
import os
import pty
import shutil
import signal
import stat
import subprocess
import tempfile
import unittest

from common import BUILD, environment
from fakes import LIBEXEC
from wire import PATIENCE, wait_for

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
        self.environment.update(XDG_STATE_HOME=state, FAKE_TRACE=self.path("trace"), FAKE_STATE=self.folder)
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


class Descriptors(Case):
    def test_nothing_that_the_caller_has_open_reaches_a_child(self):
        secret = self.path("ok.gltf")
        fd = os.open(secret, os.O_RDONLY)
        os.dup2(fd, 9)
        self.addCleanup(os.close, 9)
        os.close(fd)
        process = self.start(*COMMANDS["render"], pass_fds=[9], stdin=subprocess.PIPE)
        members = self.all_of(process.pid, "candil-loader")
        ours = descriptors(process.pid)
        self.assertEqual(ours[9], secret)
        self.assertEqual(sorted(members.values()), ["candil-loader", "candil-worker", "candild"])
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
        picture = subprocess.run([self.candil, "render", "ok.gltf", "-o", "whole.png"], cwd=self.folder, capture_output=True,
                                 env=self.environment, timeout=PATIENCE)
        self.assertEqual(picture.returncode, 0, picture)
        # The shell's own closing: subprocess has none for a single descriptor.
        closed = subprocess.run(["sh", "-c", 'exec "$0" "$@" <&- >&-', self.candil, "render", "ok.gltf", "-o", "out.png"],
                                cwd=self.folder, stderr=subprocess.PIPE, env=self.environment, timeout=PATIENCE)
        self.assertEqual(closed.returncode, 1, closed)
        self.assertIn(b"cannot write the answer", closed.stderr)
        with open(self.path("whole.png"), "rb") as whole, open(self.path("out.png"), "rb") as other:
            self.assertEqual(whole.read(), other.read())
        os.unlink(self.path("whole.png"))


if __name__ == "__main__":
    unittest.main()
