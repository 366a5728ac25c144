"""What the ground truth of a recording says about boxes along the optical axis: which are blocked, which are free."""

import csv

import numpy as np
from PIL import Image, ImageFilter

BORDER_M = 0.10  # nearer to the box's sides than this, a frame is not scored: as the simulator has it
LEAST_POINTS = 10  # fewer points in a box may be the truth's own outliers
REACH_PX = 5  # of a true depth: what is so far around it is no nearer, since truth is sparse
MOST_UNKNOWN = 0.05  # share of the box's rays without truth in reach: with more nobody knows that the box is free


def read_millimetres(path):
    return np.asarray(Image.open(path), dtype=float)


class Box:
    """Starts at the camera and points along its axis. Lengths in metres; left: how far it is shifted to the left."""

    def __init__(self, width, height, length, left=0.0):
        self.width, self.height, self.length, self.left = width, height, length, left

    def __str__(self):
        shift = f", {abs(self.left):.1f} m to the {'left' if self.left > 0 else 'right'}" if self.left else ""
        return f"{self.width:.1f} × {self.height:.1f} × {self.length:.1f} m{shift}"

    def overrides(self):
        return [f"corridor/width_m={self.width}", f"corridor/height_m={self.height}",
                f"corridor/length_m={self.length}", f"corridor/offset_m=[0.0, {self.left}, 0.0]"]

    def grown(self, border):
        return Box(self.width + 2 * border, self.height + 2 * border, self.length + border, self.left)


class TrueDepth:
    """A frame's true depth [m], and where each pixel looks. NaN where it is unknown, and where the right camera does not
    look: that is kept apart."""

    def __init__(self, path, calibration):
        depth = read_millimetres(path) / 1000.0
        self.depth = np.where(depth > 0, depth, np.nan)
        known = Image.fromarray(np.uint8(depth > 0)).filter(ImageFilter.MaxFilter(2 * REACH_PX + 1))
        self.is_unknown = np.asarray(known) == 0
        v, u = np.indices(depth.shape)
        self.x = (u - calibration["cx"]) / calibration["fx"]
        self.y = (v - calibration["cy"]) / calibration["fy"]
        right_u = u + calibration["doffs"] - calibration["fx"] * calibration["baseline"] / self.depth
        self.only_left = np.where(right_u < 0, self.depth, np.nan)
        self.depth[right_u < 0] = np.nan

    def passage(self, box):
        """Between which depths each pixel's ray is in a box; where it leaves before it enters, it never is."""
        with np.errstate(divide="ignore", invalid="ignore"):
            sides = np.sort([(-box.left - box.width / 2) / self.x, (-box.left + box.width / 2) / self.x], axis=0)
            heights = np.sort([-box.height / 2 / self.y, box.height / 2 / self.y], axis=0)
        enter = np.maximum(0.0, np.maximum(sides[0], heights[0]))
        return enter, np.minimum(box.length, np.minimum(sides[1], heights[1]))

    def clear_distance(self, box, depth=None):
        """Depth of the nearest surface in a box; inf: none."""
        depth = self.depth if depth is None else depth
        enter, leave = self.passage(box)
        inside = np.sort(depth[(enter <= depth) & (depth <= leave)])
        return inside[LEAST_POINTS - 1] if len(inside) >= LEAST_POINTS else np.inf

    def is_known(self, box):
        enter, leave = self.passage(box)
        crossing = enter < leave
        return np.count_nonzero(self.is_unknown & crossing) <= MOST_UNKNOWN * np.count_nonzero(crossing)

    def row(self, box):
        """clear_exact, clear_shrunk and clear_inflated, as simulate writes them; a free box of which too little is known,
        or in which something stands that the right camera does not see, counts as neither."""
        exact, shrunk, inflated = (self.clear_distance(box.grown(border)) for border in (0.0, -BORDER_M, BORDER_M))
        hidden = np.isfinite(self.clear_distance(box.grown(BORDER_M), self.only_left))
        if not np.isfinite(inflated) and (hidden or not self.is_known(box)):
            inflated = box.length
        return [exact, shrunk, inflated]


def write_truth(path, frames, box):
    """@param frames pairs of a stamp and a TrueDepth, or None where it is not known"""
    unknown = [np.inf, np.inf, box.length]
    with open(path, "w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        writer.writerow(["stamp", "clear_exact", "clear_shrunk", "clear_inflated"])
        writer.writerows([stamp, *(f"{value:.6f}" for value in (frame.row(box) if frame else unknown))]
                         for stamp, frame in frames)
