#!/usr/bin/python3
"""What the documentation names is installed, and starts without the workspace."""

import glob
import os
import re
import subprocess
import sys
import tempfile
import unittest

import rospkg
import rosunit

SOURCE = os.path.realpath(os.path.join(rospkg.RosPack().get_path("flight_corridor"), "doc", ".."))


class Install(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        subprocess.run(["cmake", "--install", sys.argv[1], "--prefix", cls.folder.name], stdout=subprocess.DEVNULL,
                       check=True)
        cls.programs = os.path.join(cls.folder.name, "lib", "flight_corridor")
        cls.share = os.path.join(cls.folder.name, "share", "flight_corridor")
        cls.documents = ""
        for document in ("README.md", os.path.join("doc", "integration.md")):
            with open(os.path.join(SOURCE, document), encoding="utf-8") as file:
                cls.documents += file.read()

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    def run_installed(self, *command):
        libraries = os.path.join(self.folder.name, "lib")
        modules, = glob.glob(os.path.join(libraries, "python3*", "*-packages"))
        environment = dict(os.environ)
        for variable, folder in (("LD_LIBRARY_PATH", libraries), ("PYTHONPATH", modules)):
            environment[variable] = folder + os.pathsep + environment.get(variable, "")
        done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=False,
                              env=environment)
        self.assertEqual(done.returncode, 0, done.stdout)
        return done.stdout

    def test_programs_of_the_documentation_are_installed(self):
        names = set(re.findall(r"rosrun flight_corridor (\w+)", self.documents))
        self.assertIn("replay", names)
        for name in names:
            self.assertTrue(os.access(os.path.join(self.programs, name), os.X_OK), name)

    def test_files_of_the_documentation_are_installed(self):
        files = {"launch/" + name for name in re.findall(r"\b(\w+\.launch)\b", self.documents)}
        files.update(re.findall(r"\b(?:arduino|config)/[\w/]+\.\w+", self.documents))
        self.assertTrue({"launch/demo.launch", "config/default.yaml"} <= files, files)
        for file in files:
            self.assertTrue(os.path.isfile(os.path.join(self.share, file)), file)

    def test_programs_find_their_libraries_in_the_install_space(self):
        nodelet = os.path.join(self.folder.name, "lib", "libflight_corridor_nodelet.so")
        tools = [os.path.join(self.programs, name) for name in ("corridor_node", "range_serial", "replay", "simulate")]
        for file in [nodelet, *tools]:
            for line in self.run_installed("ldd", file).splitlines():
                self.assertNotIn("not found", line, file)
                if "libflight_corridor" in line:
                    self.assertIn(self.folder.name, line, file)

    def test_the_doctor_starts_with_what_is_installed(self):
        self.assertIn("--seconds", self.run_installed("/usr/bin/python3", "-B", os.path.join(self.programs, "doctor"),
                                                      "--help"))


if __name__ == "__main__":
    rosunit.unitrun("flight_corridor", "install", Install)
