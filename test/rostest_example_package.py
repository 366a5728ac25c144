#!/usr/bin/python3
"""A package of one's own finds the library with find_package, compiles and runs; the documentation shows its code."""

import os
import subprocess
import tempfile
import unittest

import rospkg
import rosunit

ROOT = os.path.realpath(os.path.join(rospkg.RosPack().get_path("flight_corridor"), "doc", ".."))
EXAMPLE = os.path.join(ROOT, "test", "example_package")


def run(*command):
    done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=False)
    return done.returncode, done.stdout


def text_of(*path):
    with open(os.path.join(ROOT, *path), encoding="utf-8") as file:
        return file.read()


class ExamplePackage(unittest.TestCase):
    def test_it_builds_and_runs(self):
        with tempfile.TemporaryDirectory() as build:
            for command in (["cmake", "-S", EXAMPLE, "-B", build, "-DCMAKE_BUILD_TYPE=Release"],
                            ["cmake", "--build", build]):
                code, output = run(*command)
                self.assertEqual(code, 0, output)
            code, output = run(os.path.join(build, "devel", "lib", "corridor_example", "ask_corridor"))
        self.assertEqual(code, 0, output)
        self.assertIn("corridor: BLOCKED, clear for 2.0", output)
        self.assertIn("box: FREE", output)

    def test_the_documentation_shows_its_code(self):
        documentation = text_of("doc", "integration.md")
        for name, language in (("CMakeLists.txt", "cmake"), ("ask_corridor.cpp", "cpp")):
            block = "```%s\n%s```\n" % (language, text_of("test", "example_package", name))
            self.assertIn(block, documentation, name)


if __name__ == "__main__":
    rosunit.unitrun("flight_corridor", "example_package", ExamplePackage)
