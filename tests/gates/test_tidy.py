"""No file that the build compiles has a fault by .clang-tidy, which says what is looked for. All processors work on it."""
import concurrent.futures
import json
import os
import subprocess
import sys

import llvm

BUILD = os.environ["CANDIL_BUILD"]


def compiled():
    """Our compiled files, C++ first: it takes longest."""
    with open(os.path.join(BUILD, "compile_commands.json"), encoding="utf-8") as file:
        files = {os.path.relpath(command["file"], llvm.SOURCE) for command in json.load(file)}
    ours = files & set(llvm.sources(".c", ".cpp"))
    assert len(ours) > 100, ours
    return sorted(ours, key=lambda file: (not file.endswith(".cpp"), file))


def main():
    clang_tidy = llvm.tool("clang-tidy")

    def judge(file):
        return subprocess.run([clang_tidy, "--quiet", "-p", BUILD, file], cwd=llvm.SOURCE, stdout=subprocess.PIPE,
                              stderr=subprocess.STDOUT, text=True)

    files = compiled()
    faulty = 0
    with concurrent.futures.ThreadPoolExecutor(len(os.sched_getaffinity(0))) as pool:
        for told in pool.map(judge, files):
            if told.returncode:
                faulty += 1
                print(told.stdout, flush=True)
    print(f"{faulty} of {len(files)} files have faults")
    return 1 if faulty else 0


if __name__ == "__main__":
    sys.exit(main())
