"""Simulated flights and the verdicts on them, in a cache: nothing is done again unless what it depends on changed."""

import argparse
import concurrent.futures
import pathlib
import sys
import tempfile
import time

from tools import ROOT, ToolError, digest, run_tool, tool_digest

CACHE = ROOT / "output" / "cache"


def seed_range(text):
    """A-B, or one number."""
    first, _, last = text.partition("-")
    if not first.isdigit() or not (last or first).isdigit() or int(last or first) < int(first):
        raise argparse.ArgumentTypeError(f"A-B, A no larger than B, or one number ({text})")
    return range(int(first), int(last or first) + 1)


def positive(text):
    if not text.isdigit() or int(text) < 1:
        raise argparse.ArgumentTypeError(f"1 or more ({text})")
    return int(text)


class Replay:
    """Our pipeline with a configuration: writes result.csv."""

    def __init__(self, config, overrides):
        self.arguments = ["--config", config, *[word for pair in overrides for word in ("--set", pair)]]
        program = tool_digest("replay", "flight_corridor_tools", "flight_corridor_ros", "flight_corridor")
        self.key = "replay_" + digest(program, config, *overrides)

    def judge(self, bag, folder):
        run_tool("replay", "--bag", bag, "--csv", folder / "result.csv", *self.arguments)


class Yardsticks:
    """Stock methods: writes a table for each threshold of each, e.g. paper_4.00.csv."""

    def __init__(self):
        self.key = "yardsticks_" + tool_digest("yardsticks", "flight_corridor_tools", "flight_corridor_ros",
                                                "flight_corridor")

    def judge(self, bag, folder):
        run_tool("yardsticks", "--bag", bag, "--out", folder)


class Flight:
    """One flight: a family of scenes, a seed, and further options of simulate."""

    def __init__(self, family, seed, options):
        self.family, self.seed = family, seed
        self.arguments = ["--scene", family, "--seed", seed, *options]
        program = tool_digest("simulate", "flight_corridor_tools", "flight_corridor_ros", "flight_corridor_sim")
        self.folder = CACHE / f"{family}_{seed}_{digest(program, *options)}"
        self.truth, self.bag = self.folder / "truth.csv", self.folder / "flight.bag"

    def result(self, judge, file):
        return self.folder / judge.key / file

    def fly(self, judges, keep_bag):
        """Makes the verdicts that are missing. Bags are big: they go unless they are to be kept."""
        missing = [judge for judge in judges if not (self.folder / judge.key).exists()]
        if not missing:
            return
        self.folder.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryDirectory(dir=self.folder) as name:  # what is moved out of it is whole
            scratch = pathlib.Path(name)
            bag = self.bag if self.bag.exists() else self._simulate(scratch, keep_bag)
            for judge in missing:
                verdicts = scratch / judge.key
                verdicts.mkdir()
                judge.judge(bag, verdicts)
                verdicts.rename(self.folder / judge.key)

    def _simulate(self, scratch, keep_bag):
        bag, truth = scratch / "flight.bag", scratch / "truth.csv"
        run_tool("simulate", *self.arguments, "--out", bag, "--truth", truth)
        truth.rename(self.truth)
        return bag.rename(self.bag) if keep_bag else bag

    def simulated(self):
        """@return its bag, which stays."""
        if not self.bag.exists():
            self.folder.mkdir(parents=True, exist_ok=True)
            with tempfile.TemporaryDirectory(dir=self.folder) as scratch:
                self._simulate(pathlib.Path(scratch), True)
        return self.bag


def fly_all(flights, judges_of, jobs, keep_bags):
    """Flies in parallel, each for the judges of that flight, and prints how it goes.  @return the flights that failed."""
    failed, start = [], time.monotonic()
    with concurrent.futures.ThreadPoolExecutor(jobs) as pool:
        futures = {pool.submit(flight.fly, judges_of(flight), keep_bags): flight for flight in flights}
        try:
            for done, future in enumerate(concurrent.futures.as_completed(futures), 1):
                flight, outcome = futures[future], ""
                try:
                    future.result()
                except (ToolError, OSError) as error:
                    failed.append(flight)
                    outcome = f" FAILED: {error}"
                left_s = (time.monotonic() - start) * (len(flights) - done) / done
                print(f"[{done}/{len(flights)}] {flight.family} seed {flight.seed}, {left_s:.0f} s left{outcome}",
                      file=sys.stderr, flush=True)
        except BaseException:  # Ctrl-C: what has not begun shall not
            pool.shutdown(cancel_futures=True)
            raise
    return failed
