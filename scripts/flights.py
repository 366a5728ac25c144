"""Simulated flights and the verdicts on them: nothing is done again unless what it depends on changed."""

import argparse

from jobs import CACHE, Job
from tools import digest, run_tool, tool_digest


def seed_range(text):
    """A-B, or one number."""
    first, _, last = text.partition("-")
    if not first.isdigit() or not (last or first).isdigit() or int(last or first) < int(first):
        raise argparse.ArgumentTypeError(f"A-B, A no larger than B, or one number ({text})")
    return range(int(first), int(last or first) + 1)


class Replay:
    """Our pipeline with a configuration: writes result.csv."""

    def __init__(self, config, overrides, options=()):
        self.config, self.overrides, self.options = config, overrides, options
        self.key = self.address()

    def address(self):
        program = tool_digest("replay", "flight_corridor_programs", "flight_corridor_tools", "flight_corridor_ros",
                              "flight_corridor")
        return "replay_" + digest(program, self.config, *self.overrides, *self.options)

    def judge(self, bag, folder):
        overrides = [word for pair in self.overrides for word in ("--set", pair)]
        run_tool("replay", "--bag", bag, "--csv", folder / "result.csv", "--config", self.config, *overrides,
                 *self.options)


class Yardsticks:
    """Stock methods: writes a table for each threshold of each, e.g. paper_4.00.csv."""

    def __init__(self):
        self.key = self.address()

    def address(self):
        return "yardsticks_" + tool_digest("yardsticks", "flight_corridor_tools", "flight_corridor_ros",
                                           "flight_corridor")

    def judge(self, bag, folder):
        run_tool("yardsticks", "--bag", bag, "--out", folder)


class Flight(Job):
    """One flight: a family of scenes, a seed, further options of simulate; and the verdicts of `judges` on it. Bags are
    big: they go unless they are to be kept."""

    def __init__(self, family, seed, options, keep_bag=False):
        self.family, self.seed, self.options, self.keep_bag, self.judges = family, seed, options, keep_bag, []
        super().__init__(f"{family} seed {seed}")
        self.truth, self.bag = self.folder / "truth.csv", self.folder / "flight.bag"

    def address(self):
        program = tool_digest("simulate", "flight_corridor_programs", "flight_corridor_tools", "flight_corridor_ros",
                              "flight_corridor_sim")
        return CACHE / f"{self.family}_{self.seed}_{digest(program, *self.options)}"

    def is_current(self):
        return super().is_current() and all(judge.address() == judge.key for judge in self.judges)

    def result(self, judge, file):
        return self.folder / judge.key / file

    def results(self):
        return [self.truth, *([self.bag] if self.keep_bag else []), *[self.folder / judge.key for judge in self.judges]]

    def make(self, scratch):
        bag = self.bag
        if not (bag.exists() and self.truth.exists()):
            bag = scratch / bag.name
            run_tool("simulate", "--scene", self.family, "--seed", self.seed, *self.options, "--out", bag, "--truth",
                     scratch / self.truth.name)
        for judge in self.judges:
            if not (self.folder / judge.key).exists():
                verdicts = scratch / judge.key
                verdicts.mkdir()
                judge.judge(bag, verdicts)

    def simulated(self):
        """@return its bag, which stays."""
        self.keep_bag = True
        self.ensure()
        return self.bag
