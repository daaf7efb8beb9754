"""PROTOCOL.md names every message, field, number, code and limit, every stage and figure of an account; candil.proto what grows with
the renderer; the README every effect and option, and no other; the example is what goes over the wire."""
import glob
import os
import re
import subprocess
import unittest

import wire
from fakes import FakeCase
from wire import pb

SOURCE = os.environ["CANDIL_SOURCE"]


def read(*path):
    with open(os.path.join(SOURCE, *path), encoding="utf-8") as file:
        return file.read()


MANUAL = read("protocol", "PROTOCOL.md")
README = read("README.md")

# Enumerations that grow with what is rendered: PROTOCOL.md refers to candil.proto for their values.
GROWING = ("Technique", "Effect", "LightKind")


def rows():
    """The cells of every table's rows."""
    return [[cell.strip().strip("`") for cell in line.strip("|").split("|")]
            for line in MANUAL.splitlines() if line.startswith("|")]


def message_rows():
    return [row for row in rows() if re.fullmatch(r"0x\w\w", row[1])]


def types():
    """(name, number, last reply or "") of every message."""
    return re.findall(r"\bX\((\w+), (0x\w\w)(?:, (\w+))?\)", read("protocol", "header.h"))


class Manual(unittest.TestCase):
    def test_every_message_type_and_its_number(self):
        self.assertGreater(len(types()), 20)
        self.assertEqual({row[0]: row[1] for row in message_rows()}, {name: number for name, number, _ in types()})

    def test_the_reply_that_ends_a_request(self):
        told = {row[0]: re.findall(r"\b[A-Z_]+\b", row[3].partition(";")[0])[-1] for row in message_rows() if row[3]}
        self.assertEqual(told, {name: reply for name, _, reply in types() if reply})

    def test_wire_py_agrees(self):
        for name, number, _ in types():
            self.assertEqual(getattr(wire, name), int(number, 16), name)

    def test_every_status(self):
        statuses = re.findall(r'X\((\w+), (\d+), "([\w-]+)"\)', read("protocol", "status.h"))
        self.assertGreater(len(statuses), 30)
        self.assertEqual([tuple(row[:3]) for row in rows() if len(row) == 4 and row[1].isdigit()], statuses)

    def test_every_limit_and_its_value(self):
        limits = re.findall(r"^#define (LIMIT_\w+)\s+(\(.*?\)|\S+)", read("protocol", "limits.h"), re.MULTILINE)
        self.assertGreater(len(limits), 40)
        table = {row[0]: row[1].replace(",", "") for row in rows() if row[0].startswith("LIMIT_")}
        for name, value in limits:
            self.assertIn(name, table)
            self.assertEqual(float(table[name]), float(eval(re.sub(r"(?<=\d)(ull|u)\b", "", value))), name)
        self.assertEqual(set(table), {name for name, _ in limits})

    def test_every_message_and_field(self):
        words = set(re.findall(r"\w+", MANUAL))

        def check(message):
            self.assertIn(message.name, words)
            for field in message.fields:
                self.assertIn(f"`{field.name}`", MANUAL, f"{message.name}.{field.name}")
            for nested in message.nested_types:
                check(nested)

        for message in pb.DESCRIPTOR.message_types_by_name.values():
            check(message)
        for enum in pb.DESCRIPTOR.enum_types_by_name.values():
            for value in enum.values if enum.name not in GROWING else ():
                self.assertIn(value.name, words)

    def test_values_that_the_proto_explains(self):
        proto = read("protocol", "candil.proto")
        for name in GROWING:
            self.assertRegex(MANUAL, rf"\b{name}\b")
            for value in pb.DESCRIPTOR.enum_types_by_name[name].values:
                self.assertRegex(proto, rf"\b{value.name} = {value.number}; +// \w")

    def test_every_stage_and_figure(self):
        server = "".join(read(path) for path in glob.glob(os.path.join(SOURCE, "server", "*", "**", "*.c"), recursive=True))
        stages = set(re.findall(r'(?:add_stage|timer_begin|timer_add|run_items)\((?:[^",;]+, )+"([a-z-]+)"', server))
        stages |= set(re.findall(r'\.stage = "([a-z-]+)"', server))
        figures = set(re.findall(r'add_figure\(\w+, "([a-z.]+)"', server))
        self.assertLessEqual({"trace", "voxelise", "visibility", "encode"}, stages)
        self.assertLessEqual({"clamp.share", "entries"}, figures)
        for name in stages | figures:
            self.assertIn(f"`{name}`", MANUAL)


class Readme(unittest.TestCase):
    def test_every_option_with_its_words_and_no_other(self):
        names = set()
        for path in glob.glob(os.path.join(SOURCE, "server", "worker", "technique", "*", "*_options.c")):
            source = read(path)
            options = re.findall(r'OPTION_\w+\("(\w+\.\w+)", (\w+)', source)
            self.assertTrue(options, path)
            names |= {name for name, _ in options}
            for name, words in options:
                listed = re.search(rf"\*const {words}\[\] = {{(.*?), NULL}};", source, re.DOTALL)
                for word in re.findall(r'"([^"]+)"', listed.group(1)) if listed else ():
                    self.assertRegex(README, rf"\b{word}\b", name)
        self.assertGreater(len(names), 30)
        # It is a word of the command line alone: the file goes another way.
        names.add(re.search(r'TECHNIQUE_OPTION_IMPORT "([\w.]+)"', read("protocol", "names.h")).group(1))
        techniques = [value.name.removeprefix("TECHNIQUE_").lower()
                      for value in pb.DESCRIPTOR.enum_types_by_name["Technique"].values]
        self.assertEqual(set(re.findall(rf"(?<![\w-])(?:{'|'.join(techniques)})\.[a-z_]+", README)), names)

    def test_every_effect(self):
        names = [value.name for value in pb.DESCRIPTOR.enum_types_by_name["Effect"].values]
        manual = subprocess.run([os.path.join(wire.BUILD, "bin", "candil"), "render", "--help"], stdout=subprocess.PIPE,
                                check=True).stdout.decode()
        for text in (README, manual):
            for name in names:
                self.assertIn(name.removeprefix("EFFECT_").lower().replace("_", "-"), text)


class Example(FakeCase):
    arguments = ()

    def prepare(self):
        self.daemon.arguments += ["--scene-root", self.scenes]

    def test_the_bytes_of_the_exchange(self):
        blocks = re.findall(r"^C  ((?:[0-9A-F]{2} )+).*\n   ((?:[0-9A-F]{2} )+)", MANUAL, re.MULTILINE)
        self.assertEqual(len(blocks), 3)
        connection = self.connect(greet=False)
        kinds = []
        for header, body in blocks:
            data = bytes.fromhex(header + body)
            self.assertEqual(len(data), 16 + int.from_bytes(data[8:12], "little"))
            connection.sock.sendall(data)
            kinds.append(connection.receive().kind)
        self.assertEqual(kinds, [wire.HELLO_REPLY, wire.SCENE_INFO, wire.ACCEPTED])
        (frame, data), = wire.images(connection.follow(3))
        self.assertEqual((frame.width, frame.height, frame.format, len(data)), (4, 4, pb.FORMAT_PNG, 16))


if __name__ == "__main__":
    unittest.main()
