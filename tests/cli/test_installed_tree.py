"""The whole of candil installed under a prefix, moved elsewhere, and used from there: everything that a render needs is in it."""
import os
import shutil
import subprocess
import sys
import tempfile

BUILD = os.environ["CANDIL_BUILD"]
SOURCE = os.environ["CANDIL_SOURCE"]

with tempfile.TemporaryDirectory(prefix="candil-") as folder:
    first, moved = os.path.join(folder, "first place"), os.path.join(folder, "another place")
    subprocess.run(["cmake", "--install", BUILD, "--prefix", first], check=True, stdout=subprocess.DEVNULL)
    shutil.move(first, moved)
    candil = os.path.join(moved, "bin", "candil")
    out = os.path.join(folder, "picture.png")
    # Another working directory, and no socket to find by chance.
    environment = {k: v for k, v in os.environ.items() if k != "XDG_RUNTIME_DIR"}
    done = subprocess.run([candil, "render", os.path.join(SOURCE, "deploy", "first.gltf"), "-o", out, "--size", "16x16", "--spp", "1"],
                          cwd=folder, env=environment, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
    text = done.stdout.decode()
    if done.returncode == 5 and "no Vulkan" in text:
        print("skipped:", text)
        sys.exit(77)
    print(text)
    assert done.returncode == 0, text
    with open(out, "rb") as f:
        assert f.read(8) == b"\x89PNG\r\n\x1a\n"
    subprocess.run([candil, "compare", out, out], check=True, env=environment)
    subprocess.run([candil, "doctor"], check=True, env=environment, stdout=subprocess.DEVNULL)
