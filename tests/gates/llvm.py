"""Tools of LLVM's, and the files that they judge. Versions differ in what they say of the same code: only ours judges."""
import os
import re
import shutil
import subprocess
import sys

SOURCE = os.environ["CANDIL_SOURCE"]
FOLDERS = ("clients", "protocol", "server", "shaders", "tests")
MAJOR = "14"
SKIPPED = 77


def tool(name):
    """The path of a tool of our version; ends the test where there is none."""
    path = shutil.which(f"{name}-{MAJOR}") or shutil.which(name)
    if not path:
        print(f"skipped: no {name}; deploy/packages names its package", flush=True)
        sys.exit(SKIPPED)
    told = subprocess.run([path, "--version"], capture_output=True, text=True, check=True).stdout
    major = re.search(r"version (\d+)", told)
    if not major or major[1] != MAJOR:
        print(f"skipped: {path} is no {name} {MAJOR}, and nothing was judged:\n{told}", flush=True)
        sys.exit(SKIPPED)
    return path


def sources(*endings):
    """Our files of these endings, by their paths from the checkout's root."""
    found = [os.path.relpath(os.path.join(at, name), SOURCE) for folder in FOLDERS
             for at, _, names in os.walk(os.path.join(SOURCE, folder)) for name in names if name.endswith(endings)]
    assert len(found) > 100, found
    return sorted(found)
