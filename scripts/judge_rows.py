"""What `judge` holds verdicts against: rows of its table, each with recordings and their truth."""

import csv
import functools
import re

import numpy as np

from box_truth import TrueDepth, write_truth
from flights import Flight
from recordings import BOXES, NEAR_PX, USUAL_DATA, Recording, find_recordings, read_table
from tools import run_tool

BARS = re.compile("railing|lattice")  # UNKNOWN may be right before them: counted apart
IN_VIEW = 0.9  # share of a box; of the default rig's corridor 0.97 is
SUITE_OPTIONS = ["--rate=2"]


class Case:
    """A recording, with what settings it is replayed, and what is true of it."""

    def __init__(self, name, bag, truth, settings=()):
        """@param bag makes it where it is not there
        @param truth a file, or what writes one from the result's rows"""
        self.name, self.bag, self.truth, self.settings = name, bag, truth, list(settings)


class Row:
    """Cases that are scored together; group: rows of which a total is printed."""

    def __init__(self, group, name, cases, knows_distance=True):
        self.group, self.name, self.cases, self.knows_distance = group, name, cases, knows_distance


def bag_with_truth(bag):
    return Case(bag.stem, lambda: bag, bag.parent / (bag.name + ".truth.csv"))


def bags_with_truth(folder):
    return [bag for bag in sorted(folder.glob("*.bag")) if (folder / (bag.name + ".truth.csv")).exists()]


def traced_rows(folders):
    """Path-traced flights; of two of one name that of the last folder."""
    bags = {bag.stem: bag for folder in folders for bag in bags_with_truth(folder)}
    return [Row("traced, bars" if BARS.search(name) else "traced", name, [bag_with_truth(bag)])
            for name, bag in bags.items()]


def phantom_rows():
    return [Row("phantom", bag.stem, [bag_with_truth(bag)]) for bag in bags_with_truth(USUAL_DATA / "forest_phantom")]


def write_label(is_blocked, path, rows):
    """The same for every frame; at what distance is not known."""
    with open(path, "w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        writer.writerow(["stamp", "clear_exact", "clear_shrunk", "clear_inflated"])
        writer.writerows([row["stamp"], *3 * ["0" if is_blocked else "inf"]] for row in rows)


def labelled_row(group, folder, is_blocked):
    recording = Recording(folder)
    case = Case(folder.name, recording.bag, functools.partial(write_label, is_blocked), recording.usual_sight())
    return Row(group, folder.name, [case], knows_distance=False)


def kitti_rows():
    """The car drove on."""
    folder = USUAL_DATA / "kitti_odo06"
    return [labelled_row("kitti", folder, is_blocked=False)] if folder.is_dir() else []


class TrueBoxes:
    """What the true depth of a recording's frames says about boxes."""

    def __init__(self, recording):
        self.recording, self.calibration = recording, recording.calibration()

    @functools.cached_property
    def frames(self):
        return {path.stem: TrueDepth(path, self.calibration) for path in self.recording.depth_truths()}

    def is_in_view(self, box):
        """Whether both cameras see nearly all of what is asked: points all over the box, from where stereo sees."""
        of, first_m = self.calibration, self.recording.blind_m(NEAR_PX, box.length)
        z, x, y = np.meshgrid(np.linspace(first_m, box.length, 40), box.width * np.linspace(-0.5, 0.5, 40) - box.left,
                              box.height * np.linspace(-0.5, 0.5, 20))
        height_px, width_px = next(iter(self.frames.values())).depth.shape
        left_px, v_px = of["cx"] + of["fx"] * x / z, of["cy"] + of["fy"] * y / z
        right_px = left_px + of["doffs"] - of["fx"] * of["baseline"] / z
        seen = (0 <= np.minimum(left_px, right_px)) & (np.maximum(left_px, right_px) < width_px)
        return np.mean(seen & (0 <= v_px) & (v_px < height_px)) >= IN_VIEW

    def is_scored(self, box):
        """Whether box_truth knows of any frame that it is blocked or free."""
        return any(not np.isinf(exact) or np.isinf(inflated)
                   for exact, _, inflated in (frame.row(box) for frame in self.frames.values()))

    def write(self, box, path, rows):
        frames = [(row["stamp"], self.frames.get(image)) for row, image in zip(rows, self.recording.images())]
        write_truth(path, frames, box)


def box_rows(recording):
    """Boxes of several sizes and places against the true depth: those in view, and the others."""
    boxes, name = TrueBoxes(recording), recording.folder.name
    seen, unseen = [], []
    for index, box in enumerate(BOXES):
        if not boxes.is_scored(box):
            continue
        case = Case(f"{name}_box_{index}", recording.bag, functools.partial(boxes.write, box), recording.box_settings(box))
        (seen if boxes.is_in_view(box) else unseen).append(case)
    return [Row("boxes in view", name, seen), Row("boxes partly out of view", f"{name}, out of view", unseen)]


def still_rows():
    """Recordings with true depth, and frames that were judged by eye."""
    if not USUAL_DATA.is_dir():
        return []
    rows = [row for folder in find_recordings(USUAL_DATA, "judge") if any((folder / "depth_gt").glob("*.png"))
            for row in box_rows(Recording(folder))]
    eth3d = USUAL_DATA / "eth3d_two_view"
    labels = read_table(eth3d / "labels.csv") if eth3d.is_dir() else []
    rows += [labelled_row("by eye", eth3d / label["scene"], label["label_4m"] == "blocked") for label in labels]
    return rows + [labelled_row("by eye", folder, is_blocked=True) for folder in sorted(USUAL_DATA.glob("euroc_*"))]


def suite_rows(seeds, wanted):
    """Families of `simulate`; their kind is the group."""
    rows = []
    for family, kind in (line.split(",") for line in run_tool("simulate", "--families").split() if seeds):
        if not wanted or family in wanted:
            flights = [Flight(family, seed, SUITE_OPTIONS) for seed in seeds]
            cases = [Case(f"{family}_{flight.seed}", flight.simulated, flight.truth) for flight in flights]
            rows.append(Row(f"suite, {kind}", family, cases))
    return rows
