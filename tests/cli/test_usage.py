"""The command line where no daemon, no device and no scene is needed: help, usage, outputs, exit codes."""
import json
import os
import tempfile
import unittest

from common import CANDIL, Daemon, environment, run, write_scene

COMMANDS = ["ping", "doctor", "load", "unload", "scenes", "describe", "render", "sweep", "study", "compare", "inspect", "stats"]


class Usage(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)
        self.env = environment(self.folder.name)

    def candil(self, *arguments):
        return run(CANDIL, *arguments, env=self.env, cwd=self.folder.name)

    def refused(self, code, *arguments):
        result = self.candil(*arguments)
        self.assertEqual(result.returncode, code, (arguments, result))
        self.assertIn("candil", result.stderr)
        return result

    def test_every_command_explains_itself(self):
        top = self.candil("--help")
        self.assertEqual(top.returncode, 0)
        for command in COMMANDS:
            self.assertIn(command, top.stdout)
            result = self.candil(command, "--help")
            self.assertEqual(result.returncode, 0)
            self.assertTrue(result.stdout.startswith(f"Usage: candil {command}"), result.stdout)
            self.assertIn("--json", result.stdout)
            self.assertEqual(result.stderr, "")
        for code in range(10):
            self.assertIn(f"\n  {code}  ", top.stdout)
        self.assertRegex(self.candil("--version").stdout, r"^candil \d+\.\d+\.\d+\n$")

    def test_wrong_command_lines(self):
        self.refused(2)
        self.refused(2, "no-such-command")
        self.refused(2, "--no-such-option", "ping")
        self.refused(2, "ping", "one-too-many")
        self.refused(2, "unload")
        self.refused(2, "load", "a.gltf", "--up", "x")
        self.refused(2, "load", "a.gltf", "--unit", "0")
        self.refused(2, "render")
        self.refused(2, "render", "a.gltf")
        self.refused(2, "render", "-o", "a.png")
        self.refused(2, "render", "a.gltf", "-o", "a.jpg")
        for wrong in (["--size", "0x5"], ["--size", "5"], ["--size", "5x5x5"], ["--size", "-5x5"], ["--spp", "0"],
                      ["--spp", "1e3"], ["--spp", "4294967296"], ["--seed", "x"], ["--camera", "1,2,3"], ["--camera", ""],
                      ["--camera", "0,0,nan,0,0,0,0,1,0,40"], ["--background", "1,1"], ["--background", "1,1,inf"],
                      ["--effects", "shiny"], ["--effects", "+shiny"], ["--technique", "magic"], ["--view", "pretty"],
                      ["--exposure", "bright"], ["--set", "pt.depth"], ["--set", "=1"], ["--set", "pt.depth="],
                      ["--aov", "id"], ["--half"], ["--format", "jpg"], ["--error", "0"], ["--error", "nan"], ["--time", "0"],
                      ["--time", "1.5"], ["--time", "86400001"], ["--filter", "sinc"], ["--lens", "1"], ["--lens", "0,1"],
                      ["--lens", "1,-1"], ["--orthographic", "0"], ["--orthographic", "wide"],
                      ["--panorama", "--orthographic", "1"], ["--at", "1"], ["--background-turn", "90"],
                      ["--background", "1,1,1", "--background-scale", "2"]):
            self.refused(2, "render", "a.gltf", "-o", "a.png", *wrong)
        for wrong in (["--aov", "colour"], ["--exposure", "1"], ["--view", "filmic"], ["--half", "--float"]):
            self.refused(2, "render", "a.gltf", "-o", "a.exr", *wrong)
        self.assertEqual(os.listdir(self.folder.name), [])

    def test_refusals_name_the_form(self):
        for option, value, words in (("--size", "5", ["it takes WxH", '"5"']), ("--spp", "1e3", ["16777216"]),
                                     ("--spp", "16777217", ["16777216"]), ("--background", "1", ["r,g,b"]),
                                     ("--camera", "1,2,3", ["ten numbers"]), ("--unit", "0", ["metres"]),
                                     ("--effects", "auto,-shiny,lights", ['"-shiny"', "emitters", "or caustics"]),
                                     ("--aov", "id,colour,depth", ['"colour"', "albedo"])):
            result = self.refused(2, "render", "a.gltf", "-o", "a.exr", option, value)
            for word in words:
                self.assertIn(word, result.stderr)
        for arguments in (["--no-such"], ["ping", "--no-such"], ["render", "--no-such"]):
            for line in self.refused(2, *arguments).stderr.splitlines():
                self.assertTrue(line.startswith("candil: "), line)
        for arguments in (["load", "a.glb"], ["load", "a.gltf", "--under-root"]):
            self.assertIn("OBJ", self.refused(2, *arguments, "--up", "z").stderr)

    def test_more_edits_than_a_request_holds(self):
        lights = ["--light", "point:at=0,1,0,intensity=1"] * 33
        said = self.refused(2, "render", "a.gltf", "-o", "a.png", *lights).stderr
        self.assertIn("--light is taken 32 times at most", said)

    def test_help_in_every_way(self):
        self.assertEqual(self.candil("help").stdout, self.candil("--help").stdout)
        for command in COMMANDS:
            wanted = self.candil(command, "--help").stdout
            self.assertEqual(self.candil(command, "-h").stdout, wanted)
            self.assertEqual(self.candil("help", command).stdout, wanted)
        self.refused(2, "help", "no-such-command")

    def test_nobody_to_connect_to(self):
        for command in (["ping"], ["stats"], ["scenes"], ["unload", "x"], ["describe", "x"],
                        ["render", "x", "-o", "x.png"]):
            said = self.refused(3, "--connect", "nobody.sock", *command).stderr
            self.assertIn("candild --socket starts one there", said)
            self.refused(3, *command)
            answer = json.loads(self.candil(*command, "--json").stdout)
            self.assertEqual(answer["error"]["name"], "connect")
            self.assertEqual(answer["exit"], 3)
        self.assertEqual(os.listdir(self.folder.name), [])

    def test_a_missing_list_of_cameras_is_said_to_be_missing(self):
        scene = write_scene(self.folder.name)
        for option in (["--cameras", "nope.json"], ["--keys", "nope.json", "--frames", "3"]):
            said = self.refused(2, "sweep", scene, "-o", "x{index}.png", *option).stderr
            self.assertIn("No such file", said)

    def test_messages_name_what_was_typed(self):
        scene = write_scene(self.folder.name)
        with open(os.path.join(self.folder.name, "odd.json"), "w", encoding="ascii") as file:
            file.write("[1, 2]")
        for option in (["--cameras", "odd.json"], ["--keys", "odd.json", "--frames", "3"]):
            said = self.refused(2, "sweep", scene, "-o", "x{index}.png", *option).stderr
            self.assertIn(f"camera 0 of {option[0]}: ", said)
        for arguments in (["only.exr"], ["a.exr", "b.exr", "--no-such"], ["a.exr", "b.exr", "--mask-above", "x"]):
            said = self.refused(2, "compare", *arguments).stderr
            self.assertTrue(said.startswith("candil compare: "), said)
            self.assertNotIn("candil-compare", said)
        said = self.candil("compare", "a.exr", "b.exr")
        self.assertEqual(said.returncode, 1)
        self.assertTrue(said.stderr.startswith("candil compare: "), said.stderr)

    def test_missing_file_is_a_scene_error(self):
        self.refused(4, "render", "missing.gltf", "-o", "x.png")
        self.refused(4, "render", "./missing", "-o", "x.png")
        self.refused(4, "describe", "missing.gltf")
        self.assertIn("folder", self.refused(4, "describe", ".").stderr)
        del self.env["XDG_RUNTIME_DIR"]
        said = self.refused(3, "render", "nothere", "-o", "x.png").stderr
        self.assertIn("no file nothere", said)
        self.assertIn("--connect", said)

    def test_a_scene_that_is_being_loaded_is_waited_for(self):
        # Large enough to take a moment.
        with open(os.path.join(self.folder.name, "large.obj"), "w") as file:
            for i in range(100000):
                file.write(f"v {i} 0 0\nv {i} 1 0\nv {i} 0 1\nf -3 -2 -1\n")
        with Daemon(self.folder.name, "--scene", "large=" + os.path.join(self.folder.name, "large.obj")) as daemon:
            found = self.candil("--connect", daemon.socket, "describe", "large", "--json")
            self.assertEqual(found.returncode, 0, found)
            self.assertEqual(json.loads(found.stdout)["triangles"], 100000)
            self.assertEqual(self.candil("--connect", daemon.socket, "describe", "other").returncode, 4)

    def test_output_is_tried_before_anything_else(self):
        scene = write_scene(self.folder.name)
        before = sorted(os.listdir(self.folder.name))
        # With --connect to nobody, 3 would come next.
        self.refused(1, "--connect", "nobody.sock", "render", scene, "-o", "no/such/folder/x.png")
        self.refused(1, "--connect", "nobody.sock", "render", scene, "-o", self.folder.name, "--format", "png")
        answer = json.loads(self.candil("render", scene, "-o", "no/such/folder/x.png", "--json").stdout)
        self.assertEqual(answer["exit"], 1)
        self.assertEqual(sorted(os.listdir(self.folder.name)), before)

    def test_doctor_says_what_it_found(self):
        result = self.candil("doctor", "--json")
        found = json.loads(result.stdout)
        self.assertEqual(result.returncode, 0 if found["ok"] else 5)
        self.assertFalse(found["daemon"]["reachable"])
        programs = {p["name"]: p for p in found["programs"]}
        for name in ("candild", "candil-loader", "candil-worker", "candil-compare", "candil-report"):
            self.assertTrue(programs[name]["works"], programs[name])
        self.assertTrue(found["kernel"]["memfd_sealing"])
        self.assertIn("worker", found)
        text = self.candil("doctor")
        self.assertEqual(text.returncode, result.returncode)
        self.assertIn("A render can", text.stdout)

    def test_doctor_asks_the_daemon_for_its_device(self):
        with Daemon(self.folder.name, "--device", "977") as daemon:
            result = self.candil("--connect", daemon.socket, "doctor", "--json")
            found = json.loads(result.stdout)
            self.assertEqual((result.returncode, found["daemon"]["reachable"], found["daemon"]["ready"]), (5, True, False))
            text = self.candil("--connect", daemon.socket, "doctor")
        self.assertEqual(text.returncode, 5)
        self.assertIn("A render cannot work.", text.stdout)

    def test_doctor_names_what_is_missing(self):
        # A candil alone, without its family.
        lonely = os.path.join(self.folder.name, "bin")
        os.mkdir(lonely)
        with open(CANDIL, "rb") as source, open(os.path.join(lonely, "candil"), "wb") as copy:
            copy.write(source.read())
        os.chmod(os.path.join(lonely, "candil"), 0o755)
        result = run(os.path.join(lonely, "candil"), "doctor", "--json", env=dict(self.env, PATH=lonely))
        self.assertEqual(result.returncode, 5, result)
        found = json.loads(result.stdout)
        self.assertFalse(found["ok"])
        self.assertEqual([p["works"] for p in found["programs"]], [False] * 5)


if __name__ == "__main__":
    unittest.main()
