"""Every C and C++ file is laid out as .clang-format says. On failure: what clang-format would change, as a patch that
`patch -p1` applies in the checkout's root."""
import difflib
import os
import re
import subprocess
import sys

import llvm


def main():
    clang_format = llvm.tool("clang-format")
    files = llvm.sources(".c", ".h", ".cpp")
    told = subprocess.run([clang_format, "--dry-run", "-Werror", "--style=file", *files], cwd=llvm.SOURCE,
                          stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
    if told.returncode == 0:
        print(len(files), "files")
        return 0
    wrong = sorted(set(re.findall(r"^(.+?):\d+:\d+: error:", told.stderr, re.MULTILINE)))
    for file in wrong:
        with open(os.path.join(llvm.SOURCE, file), encoding="utf-8") as source:
            before = source.read()
        after = subprocess.run([clang_format, "--style=file", file], cwd=llvm.SOURCE, capture_output=True, text=True, check=True)
        sys.stdout.writelines(difflib.unified_diff(before.splitlines(True), after.stdout.splitlines(True),
                                                   f"a/{file}", f"b/{file}"))
    print(f"\n{len(wrong)} of {len(files)} files are laid out otherwise" if wrong else told.stderr)
    return 1


if __name__ == "__main__":
    sys.exit(main())
