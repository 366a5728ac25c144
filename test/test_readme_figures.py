#!/usr/bin/python3
"""Every figure in README's tables of how good it is is that of doc/evaluation.md, column by column."""

import math
import pathlib
import re
import unittest

import rosunit

ROOT = pathlib.Path(__file__).resolve().parent.parent
SOURCES = {  # how a row of README begins: how its source does
    "| obstacles that a camera can see |": "| **all visible** |",
    "| what no camera sees": "| **all unseeable** |",
    "| flight_corridor |": "ours ",
    "| the paper's chain |": "paper ",
    "| SGBM and OctoMap's": "stock ",
}


def numbers(text):
    return re.findall(r"\d+(?:\.\d+)?", text)


def wilson_percent(count, total, z=1.959964):
    middle = count + z * z / 2.0
    half = z * math.sqrt(count * (total - count) / total + z * z / 4.0)
    return [100.0 * (middle + sign * half) / (total + z * z) for sign in (-1, 1)]


def figures_of(source):
    """What a row of README says, in its order, from the row of doc/evaluation.md that it is taken from."""
    if not source.startswith("|"):  # chain, median, p99, processor time, memory, ratio
        median, p99, _, _, ratio = numbers(source)[:5]
        return [median, p99, ratio]
    blocked, false_free, _, free, false_blocked, unknown = (numbers(cell) for cell in source.split("|")[2:8])
    return [false_free[0], *blocked, *false_free[1:], false_blocked[0], *free, *false_blocked[1:], *unknown,
            *wilson_percent(int(unknown[0]), int(free[0]))]


def is_rounded(said, figure):
    """Whether a number is another, rounded to as many places as it has."""
    places = len(said.partition(".")[2])
    return abs(float(said) - float(figure)) <= 0.5 * 10.0 ** -places + 1e-9


def row(lines, beginning):
    found = [line for line in lines if line.startswith(beginning)]
    assert len(found) == 1, f"{len(found)} rows begin with {beginning!r}"
    return found[0]


class ReadmeFigures(unittest.TestCase):
    def setUp(self):
        text = (ROOT / "README.md").read_text()
        self.readme = text.split("\n## How good it is\n")[1].split("\n## ")[0].splitlines()
        self.evaluation = (ROOT / "doc" / "evaluation.md").read_text().splitlines()

    def test_every_figure_is_that_of_its_source(self):
        for beginning, source in SOURCES.items():
            figures = figures_of(row(self.evaluation, source))
            said = numbers(row(self.readme, beginning).partition(beginning)[2])
            self.assertGreaterEqual(len(said), 2, beginning)
            self.assertLessEqual(len(said), len(figures), beginning)
            for one, figure in zip(said, figures):
                self.assertTrue(is_rounded(one, figure), f"{one} of {beginning!r} is not {figure}: {figures}")

    def test_every_row_has_a_source(self):
        rows = [line for line in self.readme if line.startswith("|") and not line.startswith("|---")]
        heads = sum(line.startswith("|---") for line in self.readme)
        self.assertEqual(len(rows) - heads, len(SOURCES))


if __name__ == "__main__":
    rosunit.unitrun("flight_corridor", "readme_figures", ReadmeFigures)
