"""libcandil as a user has it: installed, found by pkg-config and by CMake, usable from C and C++, and hiding its insides."""
import os
import re
import subprocess
import sys
import tempfile

from common import BUILD, SOURCE, run

SANITIZE = os.environ.get("CANDIL_SANITIZE") == "1"
FLAGS = ["-fsanitize=address,undefined"] if SANITIZE else []

PROJECT = """cmake_minimum_required(VERSION 3.22)
project(user C)
find_package(candil REQUIRED)
add_executable(shared minimal.c)
target_link_libraries(shared candil::candil)
add_executable(static minimal.c)
target_link_libraries(static candil::candil_static)
"""


def must(*command, **more):
    result = run(*command, **more)
    assert result.returncode == 0, result
    return result.stdout


def symbols(*command):
    return {line.split()[-1] for line in must(*command).splitlines() if len(line.split()) == 3}


def check_symbols(libraries):
    for listed in (symbols("nm", "-D", "--defined-only", os.path.join(libraries, "libcandil.so")),
                   symbols("nm", "-g", "--defined-only", os.path.join(libraries, "libcandil.a"))):
        foreign = {s for s in listed if not s.startswith("candil_") or s != s.lower()}
        foreign = {s for s in foreign if not (SANITIZE and "asan" in s)}
        assert "candil_render" in listed and not foreign, foreign
    needed = must("readelf", "-d", os.path.join(libraries, "libcandil.so"))
    for library in ("vulkan", "GL", "OpenImageIO", "protobuf", "jansson"):
        assert library not in needed, needed


def project_version():
    with open(os.path.join(SOURCE, "CMakeLists.txt"), encoding="utf-8") as file:
        return re.search(r"project\(candil VERSION (\d+)\.(\d+)\.(\d+)", file.read()).groups()


VERSION_PROGRAM = """#include <candil.h>
#include <stdio.h>
int main(void)
{
	if (candil_version() != CANDIL_VERSION_NUMBER)
		return 1;
	printf("%u.%u.%u %d.%d.%d\\n", candil_version() >> 16, candil_version() >> 8 & 255, candil_version() & 255,
	       CANDIL_VERSION_MAJOR, CANDIL_VERSION_MINOR, CANDIL_VERSION_PATCH);
	return 0;
}
"""


def check_version(folder, libraries, flags, env):
    """The name of the shared library, its function, the headers and both packages tell the project's version."""
    major, minor, patch = project_version()
    whole = f"{major}.{minor}.{patch}"
    name = f"libcandil.so.{major}.{minor}" if major == "0" else f"libcandil.so.{major}"
    assert f"Library soname: [{name}]" in must("readelf", "-d", os.path.join(libraries, "libcandil.so"))
    assert os.readlink(os.path.join(libraries, "libcandil.so")) == name
    assert os.readlink(os.path.join(libraries, name)) == f"libcandil.so.{whole}"
    source, program = os.path.join(folder, "version.c"), os.path.join(folder, "version")
    with open(source, "w") as file:
        file.write(VERSION_PROGRAM)
    must("cc", "-Wall", "-Wextra", "-Werror", *FLAGS, source, *flags, "-o", program)
    assert must(program, env=dict(env, LD_LIBRARY_PATH=libraries)) == f"{whole} {whole}\n"
    assert must("pkg-config", "--modversion", "candil", env=env) == whole + "\n"
    with open(os.path.join(libraries, "cmake", "candil", "candilConfigVersion.cmake")) as file:
        assert f'set(PACKAGE_VERSION "{whole}")' in file.read()


def main():
    example = os.path.join(SOURCE, "clients", "examples", "minimal.c")
    with tempfile.TemporaryDirectory() as folder:
        prefix = os.path.join(folder, "prefix")
        must("cmake", "--install", BUILD, "--component", "libcandil", "--prefix", prefix)
        found = [path for path, _, files in os.walk(prefix) if "candil.pc" in files]
        libraries = os.path.dirname(found[0])
        check_symbols(libraries)

        env = dict(os.environ, PKG_CONFIG_PATH=found[0])
        flags = must("pkg-config", "--cflags", "--libs", "candil", env=env).split()
        check_version(folder, libraries, flags, env)
        program = os.path.join(folder, "minimal")
        must("cc", "-Wall", "-Wextra", "-Werror", *FLAGS, example, *flags, "-o", program)
        result = run(program, os.path.join(folder, "nobody"), "x", "y", env=dict(env, LD_LIBRARY_PATH=libraries))
        assert result.returncode == 1 and "no daemon answers" in result.stderr, result

        header = os.path.join(folder, "user.cpp")
        with open(header, "w") as file:
            file.write("#include <candil.h>\nint main() { candil_render_request r; candil_render_request_init(&r); }\n")
        must("c++", "-std=c++11", "-Wall", "-Wextra", "-Wpedantic", "-Werror", *FLAGS, header, *flags, "-o",
             os.path.join(folder, "user"))

        with open(os.path.join(folder, "CMakeLists.txt"), "w") as file:
            file.write(PROJECT)
        with open(example) as source, open(os.path.join(folder, "minimal.c"), "w") as copy:
            copy.write(source.read())
        build = os.path.join(folder, "build")
        must("cmake", "-S", folder, "-B", build, f"-DCMAKE_PREFIX_PATH={prefix}", f"-DCMAKE_C_FLAGS={' '.join(FLAGS)}")
        must("cmake", "--build", build)
        for name in ("shared", "static"):
            result = run(os.path.join(build, name), os.path.join(folder, "nobody"), "x", "y")
            assert result.returncode == 1 and "no daemon answers" in result.stderr, result


try:
    main()
except subprocess.TimeoutExpired as late:
    sys.exit(str(late))
