"""Real recordings as bags, and the boxes that they are judged by.

A recording is a folder with left/, right/ and a metric calib.yaml, see `import_folder --help`. Its bag is made once, in
output/cache.
"""

import csv
import pathlib
import sys
import tempfile

from box_truth import Box
from flights import CACHE
from tools import ROOT, digest, run_tool, tool_digest

USUAL_DATA = (ROOT / ".." / "shared" / "data").resolve()
BOXES = [Box(width, height, length, left)
         for width, height, length in [(1.2, 0.4, 4.0), (1.2, 0.4, 2.0), (0.8, 0.4, 2.5), (0.6, 0.4, 1.5), (0.4, 0.2, 1.5),
                                       (0.4, 0.2, 3.0), (0.4, 0.2, 7.0)]
         for left in (0.0, 0.3, -0.3)]
NEAR_PX = 256  # disparities for the boxes: these rigs' baselines are long
USUAL_LENGTH_M, USUAL_BLIND_M, USUAL_PX = 4.0, 0.4, 128  # defaults of the corridor and of stereo
RANGES = "range.csv"


def is_metric(calibration):
    return any(line.startswith("baseline:") for line in calibration.read_text(encoding="utf-8").splitlines())


def find_recordings(root, name):
    """Folders with a metric calibration. @param name of who says that others are skipped"""
    folders = sorted(path.parent for path in root.rglob("calib.yaml"))
    for folder in folders:
        if not is_metric(folder / "calib.yaml"):
            print(f"{name}: {folder}: no metric calibration, skipped", file=sys.stderr)
    return [folder for folder in folders if is_metric(folder / "calib.yaml")]


def read_table(path):
    lines = [line for line in path.read_text(encoding="utf-8").splitlines() if not line.startswith("#")]
    return list(csv.DictReader(lines))


def replay(bag, csv_path, *arguments, overrides=()):
    """@return the result's rows."""
    words = [word for pair in overrides for word in ("--set", pair)]
    run_tool("replay", "--bag", bag, "--config", ROOT / "config" / "default.yaml", "--csv", csv_path, *arguments, *words)
    return read_table(csv_path)


class Recording:
    """A folder of images."""

    def __init__(self, folder):
        self.folder = folder

    def bag(self):
        """The folder as a bag, without its ranges: some are computed from the truth, they judge and do not help."""
        files = [(path, path.stat().st_size, path.stat().st_mtime_ns) for path in sorted(self.folder.rglob("*"))
                 if path.is_file()]
        program = tool_digest("import_folder", "flight_corridor_programs", "flight_corridor_tools",
                              "flight_corridor_ros")
        name = digest(program, *files)
        place = CACHE / "recordings" / digest(str(self.folder))
        bag = place / f"{name}.bag"
        if bag.exists():
            return bag
        place.mkdir(parents=True, exist_ok=True)
        for old in place.glob("*.bag"):
            old.unlink()
        with tempfile.TemporaryDirectory(dir=place) as scratch:  # what is moved out of it is whole
            links = pathlib.Path(scratch) / "folder"
            links.mkdir()
            for entry in self.folder.iterdir():
                if entry.name != RANGES:
                    (links / entry.name).symlink_to(entry)
            run_tool("import_folder", "--folder", links, "--out", links.parent / "recording.bag")
            return (links.parent / "recording.bag").rename(bag)

    def images(self):
        """Stems of the left images, in the order of import_folder: whole numbers by value, then other names."""
        stems = [path.stem for path in (self.folder / "left").iterdir()]
        return sorted(stems, key=lambda stem: (0, int(stem), stem) if stem.isdigit() else (1, 0, stem))

    def stamps(self):
        path = self.folder / "timestamps.csv"
        if path.exists():
            return [float(row["stamp_s"]) for row in read_table(path)]
        return [i / 10.0 for i in range(len(self.images()))]  # as import_folder has it

    def blind_m(self, disparities_px, length_m):
        """What is nearer than the rig sees with so many disparities is not asked."""
        calibration = self.calibration()
        nearest_m = calibration["fx"] * calibration["baseline"] / (disparities_px - 4)  # a few are below zero
        return min(max(USUAL_BLIND_M, nearest_m), 0.9 * length_m)

    def sight(self, disparities_px, length_m=USUAL_LENGTH_M):
        return [f"stereo/num_disparities_px={disparities_px}",
                f"corridor/blind_m={self.blind_m(disparities_px, length_m):.2f}"]

    def usual_sight(self):
        """With more disparities where the default sees nothing within the first quarter of the corridor."""
        sees_near = self.blind_m(USUAL_PX, USUAL_LENGTH_M) <= USUAL_LENGTH_M / 4
        return self.sight(USUAL_PX if sees_near else NEAR_PX)

    def box_settings(self, box):
        return [*self.sight(NEAR_PX, box.length), *box.overrides()]

    def depth_truths(self):
        return sorted((self.folder / "depth_gt").glob("*.png"))

    def calibration(self):
        lines = (self.folder / "calib.yaml").read_text(encoding="utf-8").splitlines()
        pairs = [line.split(":", 1) for line in lines if ":" in line and not line.startswith("#")]
        return {name: float(value) for name, value in pairs if name in ("fx", "fy", "cx", "cy", "baseline", "doffs")}
