"""Scenes: how they come, what may be read, who keeps them, and loaders that are lost."""
import os
import signal
import subprocess
import unittest

import wire
from fakes import LIBEXEC, FakeCase, endless, render
from wire import pb


class Loads(FakeCase):
    def test_description(self):
        connection = self.connect()
        info = connection.load("box", self.scenes, "box.gltf")
        self.assertEqual((info.name, info.file, info.triangles, info.blob_bytes), ("box", "box.gltf", 12, 4096))
        self.assertGreater(info.load_us, 0)
        self.assertEqual(list(info.warnings), ["none inherited"])
        self.assertEqual(connection.ask(wire.DESCRIBE, pb.Describe(name="box")).body, info)

    def test_axis_and_unit_reach_the_loader(self):
        connection = self.connect()
        self.assertEqual(connection.load("a", self.scenes, "box.gltf").light_units, "up y unit 1")
        info = connection.load("b", self.scenes, "box.gltf", up=pb.UP_Z, metres_per_unit=0.01)
        self.assertEqual(info.light_units, "up z unit 0.01")

    def test_list(self):
        connection = self.with_box()
        job = connection.send(wire.RENDER, endless())
        connection.receive(wire.ACCEPTED, job)
        entry, = connection.ask(wire.LIST_SCENES).body.scenes
        self.assertEqual((entry.name, entry.triangles, entry.loading, entry.jobs), ("box", 12, False, 1))
        self.assertEqual((connection.stats().scenes, connection.stats().scene_bytes), (1, 4096))

    def test_replace_while_used(self):
        connection = self.with_box()
        job = connection.send(wire.RENDER, render(samples=300))
        connection.receive(wire.ACCEPTED, job)
        self.write("big.gltf", "ok 8192")
        self.assertEqual(connection.load("box", self.scenes, "big.gltf").blob_bytes, 8192)
        self.assertEqual(connection.follow(job)[-1].kind, wire.DONE)
        self.assertEqual(connection.stats().scene_bytes, 8192)
        self.assertEqual(connection.stats().worker_starts, 1)

    def test_failed_replacement_leaves_the_old(self):
        connection = self.with_box()
        self.write("bad.gltf", "refuse")
        self.assert_error(connection.receive_for(connection.send_load("box", self.scenes, "bad.gltf")), "scene-invalid")
        self.assertEqual(connection.follow(connection.send(wire.RENDER, render()))[-1].kind, wire.DONE)

    def test_the_same_name_twice_at_once(self):
        connection = self.connect()
        self.write("slow.gltf", "hang")
        connection.send_load("box", self.scenes, "slow.gltf")
        self.assert_error(connection.receive_for(connection.send_load("box", self.scenes, "box.gltf")), "bad-argument")

    def test_too_many(self):
        connection = self.connect()
        for i in range(64):
            connection.load(f"s{i}", self.scenes, "box.gltf")
        self.assert_error(connection.receive_for(connection.send_load("more", self.scenes, "box.gltf")),
                          "too-many-scenes")
        self.assertEqual(len(connection.ask(wire.LIST_SCENES).body.scenes), 64)
        self.assertEqual(connection.ask(wire.UNLOAD, pb.Unload(name="s5")).kind, wire.OK)
        connection.load("more", self.scenes, "box.gltf")

    def test_too_large_together(self):
        connection = self.connect()
        self.write("large.gltf", f"sparse {4 << 30}")
        for i in range(4):
            connection.load(f"s{i}", self.scenes, "large.gltf")
        reply = connection.receive_for(connection.send_load("box", self.scenes, "box.gltf"))
        self.assert_error(reply, "too-many-scenes")
        self.assertIn("unload some", reply.body.message)
        stats = connection.stats()
        self.assertEqual((stats.scenes, stats.scene_bytes, stats.loader_failures), (4, 16 << 30, 1))
        # In the place of another it fits, unless somebody still uses that.
        job = connection.send(wire.RENDER, endless("s1"))
        connection.receive(wire.ACCEPTED, job)
        self.assert_error(connection.receive_for(connection.send_load("s1", self.scenes, "large.gltf")), "too-many-scenes")
        self.assertEqual(connection.load("s0", self.scenes, "large.gltf").blob_bytes, 4 << 30)
        self.assertEqual(connection.ask(wire.UNLOAD, pb.Unload(name="s2")).kind, wire.OK)
        connection.load("box", self.scenes, "box.gltf")
        self.assertEqual(connection.stats().scene_bytes, (12 << 30) + 4096)

    def test_client_goes_while_loading(self):
        other = self.connect()
        self.write("slow.gltf", "hang")
        with self.daemon.connect() as leaving:
            leaving.send_load("slow", self.scenes, "slow.gltf")
            wire.wait_for(lambda: other.stats().loader_pid, "the loader runs")
        wire.wait_for(lambda: not other.stats().loader_pid, "the loader is stopped")
        self.assertEqual(len(other.ask(wire.LIST_SCENES).body.scenes), 0)
        other.load("slow", self.scenes, "box.gltf")

    def test_render_waits_for_its_scene(self):
        first, second = self.connect(), self.connect()
        os.mkfifo(os.path.join(self.scenes, "late.gltf"))
        load = first.send_load("box", self.scenes, "late.gltf")
        wire.wait_for(lambda: first.stats().loader_pid, "the loader runs")
        job = second.send(wire.RENDER, render())
        self.assertEqual(second.stats().jobs, 1)
        with open(os.path.join(self.scenes, "late.gltf"), "w") as file:
            file.write("ok")
        self.assertEqual(first.receive_for(load).kind, wire.SCENE_INFO)
        self.assertEqual(second.follow(job)[-1].kind, wire.DONE)

    def test_unload_while_loading(self):
        first, second = self.connect(), self.connect()
        self.write("slow.gltf", "hang")
        load = first.send_load("box", self.scenes, "slow.gltf")
        wire.wait_for(lambda: first.stats().loader_pid, "the loader runs")
        job = second.send(wire.RENDER, render())
        self.assertEqual(second.ask(wire.UNLOAD, pb.Unload(name="box")).kind, wire.OK)
        self.assert_error(first.receive_for(load), "cancelled")
        self.assert_error(second.receive_for(job), "cancelled")

    def test_unload_while_being_replaced(self):
        connection = self.with_box()
        self.write("slow.gltf", "hang")
        load = connection.send_load("box", self.scenes, "slow.gltf")
        wire.wait_for(lambda: connection.stats().loader_pid, "the loader runs")
        self.assertEqual(connection.ask(wire.UNLOAD, pb.Unload(name="box")).kind, wire.OK)
        self.assert_error(connection.receive_for(load), "cancelled")
        self.assertEqual(len(connection.ask(wire.LIST_SCENES).body.scenes), 0)
        self.assertEqual(connection.stats().loader_failures, 0)  # it was told to stop


class Turns(FakeCase):
    """Loads that never end, and others beside them."""
    arguments = ["--hang", "3600"]  # by then they would be found to hang

    def prepare(self):
        self.write("slow.gltf", "hang")

    def loaders(self):
        with open(f"/proc/{self.daemon.process.pid}/task/{self.daemon.process.pid}/children") as file:
            names = []
            for pid in file.read().split():
                try:
                    with open(f"/proc/{pid}/comm") as name:
                        names.append(name.read().strip())
                except OSError:
                    pass
        return names.count("candil-loader")

    def test_at_most_two_loaders_and_one(self):
        connection = self.connect()
        loads = [connection.send_load(f"s{i}", self.scenes, "slow.gltf") for i in range(5)]
        wire.wait_for(lambda: connection.stats().loader_starts == 5, "all were begun, in turn")
        wire.wait_for(lambda: self.loaders() == 3, "those that made room are stopped")
        self.assertEqual(len(connection.ask(wire.LIST_SCENES).body.scenes), 5)
        for i, load in enumerate(loads):
            self.assertEqual(connection.ask(wire.CANCEL, pb.Cancel(request=load)).kind, wire.OK)
            self.assert_error(connection.receive_for(load), "cancelled")
        wire.wait_for(lambda: self.loaders() == 0, "all are stopped")

    def test_hostile_loads_keep_no_other_out(self):
        hostile, other = [self.connect() for _ in range(3)], self.connect()
        for i in range(24):
            hostile[i % 3].send_load(f"s{i}", self.scenes, "slow.gltf")
        wire.wait_for(lambda: other.stats().loader_starts >= 2, "all places are taken")
        other.load("box", self.scenes, "box.gltf")
        scenes = other.ask(wire.LIST_SCENES).body.scenes
        self.assertEqual(sorted(s.name for s in scenes if s.loading), sorted(f"s{i}" for i in range(24)))

    def let_go(self, name, is_loading):
        """Put a good file in the place of a pipe. A loader may wait at the pipe, or may have been ended there and begun again."""
        pipe, file = os.path.join(self.scenes, "pipe"), os.path.join(self.scenes, name)
        os.link(file, pipe)
        self.write("good.gltf", "ok")
        os.rename(os.path.join(self.scenes, "good.gltf"), file)

        def is_over():
            try:
                writer = os.open(pipe, os.O_WRONLY | os.O_NONBLOCK)
                os.write(writer, b"ok")
                os.close(writer)
            except OSError:
                pass  # nobody waits there
            return not is_loading()
        wire.wait_for(is_over, "it is loaded")

    def test_a_load_that_made_room_is_begun_again(self):
        os.mkfifo(os.path.join(self.scenes, "late.gltf"))
        first, other = self.connect(), self.connect()
        first.send_load("endless", self.scenes, "slow.gltf")
        late = first.send_load("late", self.scenes, "late.gltf")
        first.send_load("more", self.scenes, "slow.gltf")
        other.load("a", self.scenes, "box.gltf")
        wire.wait_for(lambda: other.stats().loader_starts == 4, "the third of the first client's was begun")
        other.load("b", self.scenes, "box.gltf")
        self.assertIn('"late": begun again later', self.daemon.log_text())
        self.let_go("late.gltf", lambda: any(s.loading for s in other.ask(wire.LIST_SCENES).body.scenes if s.name == "late"))
        self.assertEqual(first.receive_for(late).kind, wire.SCENE_INFO)
        self.assertEqual((other.stats().loader_starts, other.stats().loader_failures), (5, 0))


class Distrust(FakeCase):
    """Whatever a loader does, the answer is an error and the daemon goes on."""

    def load_fails(self, orders, name):
        self.write("bad.gltf", orders)
        connection = self.connect()
        reply = connection.receive_for(connection.send_load("bad", self.scenes, "bad.gltf"))
        self.assert_error(reply, name)
        self.assertEqual(connection.stats().loader_failures, 1)
        self.assertEqual(connection.stats().loader_pid, 0)
        connection.load("box", self.scenes, "box.gltf")
        self.assertEqual(connection.follow(connection.send(wire.RENDER, render()))[-1].kind, wire.DONE)
        return reply

    def test_refuses(self):
        self.load_fails("refuse", "scene-invalid")

    def test_dies(self):
        self.assertIn("signal 9", self.load_fails("die", "loader-lost").body.message)

    def test_takes_too_long(self):
        self.assertIn("120 s of processor time", self.load_fails("overrun", "scene-limit").body.message)

    def test_too_large_alone(self):
        self.load_fails(f"sparse {(4 << 30) + 1}", "scene-limit")

    def test_unsealed_blob(self):
        self.load_fails("unsealed", "loader-lost")

    def test_other_build(self):
        self.load_fails("other-build", "loader-lost")

    def test_message_too_short(self):
        self.load_fails("nonsense", "loader-lost")

    def test_counts_out_of_bounds(self):
        self.load_fails("counts", "loader-lost")

    def test_dirty_text_is_cleaned(self):
        self.write("dirty.gltf", "dirty")
        info = self.connect().load("dirty", self.scenes, "dirty.gltf")
        self.assertEqual(info.warnings[0], "bad ??? ?[2J text")

    def test_killed_in_the_middle(self):
        self.write("slow.gltf", "hang")
        connection = self.connect()
        load = connection.send_load("slow", self.scenes, "slow.gltf")
        os.kill(wire.wait_for(lambda: connection.stats().loader_pid, "the loader runs"), signal.SIGKILL)
        self.assert_error(connection.receive_for(load), "loader-lost")
        self.assert_serves()

    def test_no_such_file(self):
        connection = self.connect()
        self.assert_error(connection.receive_for(connection.send_load("x", self.scenes, "none.gltf")), "scene-file")


class Paths(FakeCase):
    def prepare(self):
        self.daemon.arguments += ["--scene-root", self.scenes]
        self.write("deep/er/box.gltf", "ok")
        with open(os.path.join(self.daemon.folder, "outside.gltf"), "w") as file:
            file.write("ok")
        os.symlink(os.path.join(self.daemon.folder, "outside.gltf"), os.path.join(self.scenes, "absolute.gltf"))
        os.symlink("../outside.gltf", os.path.join(self.scenes, "relative.gltf"))
        os.symlink("..", os.path.join(self.scenes, "up"))
        os.symlink("deep/er", os.path.join(self.scenes, "within"))
        os.symlink("loop.gltf", os.path.join(self.scenes, "loop.gltf"))

    def load(self, path):
        return self.connect().ask(wire.LOAD, pb.Load(name="box", path=path))

    def test_beneath_the_root(self):
        for path in ("box.gltf", "deep/er/box.gltf", "within/box.gltf"):
            reply = self.load(path)
            self.assertEqual(reply.kind, wire.SCENE_INFO, reply)
            self.assertEqual(reply.body.file, "box.gltf")

    def test_outside(self):
        outside = os.path.join(self.daemon.folder, "outside.gltf")
        for path in ("../outside.gltf", "deep/../../outside.gltf", outside, "absolute.gltf", "relative.gltf",
                     "up/outside.gltf", "loop.gltf", "", ".", "..", "deep//er/box.gltf"):
            self.assert_error(self.load(path), "scene-path")
        self.assertEqual(self.connect().stats().loader_starts, 0)

    def test_missing_or_no_file(self):
        for path in ("none.gltf", "deep", "deep/er", "box.gltf/x"):
            self.assert_error(self.load(path), "scene-file")

    def test_a_descriptor_needs_no_root(self):
        connection = self.connect()
        self.write("deep/er/own.gltf", "ok")
        self.assertEqual(connection.load("own", os.path.join(self.scenes, "deep"), "er/own.gltf").file, "er/own.gltf")
        for path in ("../box.gltf", "/etc/hostname", "er/../../box.gltf"):
            reply = connection.receive_for(connection.send_load("x", os.path.join(self.scenes, "deep"), path))
            self.assert_error(reply, "scene-path")


class NoRoot(FakeCase):
    def test_paths_are_refused_with_advice(self):
        reply = self.connect().ask(wire.LOAD, pb.Load(name="box", path="box.gltf"))
        self.assert_error(reply, "scene-path")
        self.assertIn("--scene-root", reply.body.message)


class OwnScenes(FakeCase):
    def prepare(self):
        self.daemon.arguments += ["--scene", f"first={self.scenes}/box.gltf"]

    def test_loaded_at_start(self):
        connection = self.connect()
        self.assertEqual(connection.follow(connection.send(wire.RENDER, render("first")))[-1].kind, wire.DONE)
        self.assertEqual([entry.name for entry in connection.ask(wire.LIST_SCENES).body.scenes], ["first"])

    def test_a_client_may_fail_where_the_daemon_may_not(self):
        self.write("bad.gltf", "refuse")
        connection = self.connect()
        self.assert_error(connection.receive_for(connection.send_load("other", self.scenes, "bad.gltf")), "scene-invalid")
        self.assert_serves()

    def test_one_that_cannot_be_loaded_ends_the_daemon(self):
        self.write("bad.gltf", "refuse")
        for file in ("bad.gltf", "missing/bad.gltf"):
            second = subprocess.run([os.path.join(wire.BUILD, "bin", "candild"), "--libexec", LIBEXEC, "--socket",
                                     os.path.join(self.daemon.folder, "second.sock"), "--scene",
                                     f"good={self.scenes}/box.gltf", "--scene", f"bad={self.scenes}/{file}"],
                                    stderr=subprocess.PIPE, timeout=wire.PATIENCE, text=True, check=False)
            self.assertEqual(second.returncode, 1, second.stderr)
            self.assertIn("bad", second.stderr)


if __name__ == "__main__":
    unittest.main()
