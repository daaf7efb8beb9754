"""The documents in the checkout's root name files that are there."""
import glob
import os
import re
import unittest

SOURCE = os.environ["CANDIL_SOURCE"]
FOLDERS = ("clients", "deploy", "protocol", "server", "shaders", "tests")


def read(name):
    with open(os.path.join(SOURCE, name), encoding="utf-8") as file:
        return file.read()


class Documents(unittest.TestCase):
    def test_paths_are_there(self):
        seen = 0
        for name in ("ARCHITECTURE.md", "CONTRIBUTING.md", "README.md", "SECURITY.md", "tests/README.md"):
            for path in re.findall(rf"(?<![\w/.-])((?:{'|'.join(FOLDERS)})(?:/[\w.*-]+)+)", read(name)):
                path = path.rstrip(".")
                seen += 1
                with self.subTest(document=name, path=path):
                    self.assertTrue(glob.glob(os.path.join(SOURCE, path)), f"{name} names {path}")
        self.assertGreater(seen, 50)

    def test_files_beside_a_path_are_there(self):
        """A bare file name of the page on the architecture is one of the tree's."""
        names = {file for folder in FOLDERS for _, _, files in os.walk(os.path.join(SOURCE, folder)) for file in files}
        for name in re.findall(r"(?<![\w/.*-])([a-z_]+\.(?:c|h|cpp|glsl|py|proto))\b", read("ARCHITECTURE.md")):
            with self.subTest(file=name):
                self.assertTrue(name in names or name == "effects.glsl", name)


if __name__ == "__main__":
    unittest.main()
