#!/usr/bin/python3
"""Jobs are made once, however many processes share a list; what a process leaves behind is taken over."""

import argparse
import itertools
import os
import pathlib
import subprocess
import sys
import tempfile
import threading
import time
import unittest

import rosunit

sys.path.insert(0, os.path.join(os.path.dirname(os.path.realpath(__file__)), "..", "scripts"))
import jobs  # noqa: E402
from tools import ToolError  # noqa: E402


class Note(jobs.Job):
    """A job that writes down, in a log for all, that it was made."""

    def __init__(self, folder, name, fails=False):
        self.place, self.fails = folder / name, fails
        super().__init__(name)

    def address(self):
        return self.place

    def make(self, scratch):
        if self.fails:
            raise ToolError("no such world")
        with open(self.place.parent / "log", "a", encoding="utf-8") as log:
            log.write(f"{self.name}\n")
        (scratch / self.folder.name).mkdir()


def gone_pid():
    """Of a process that has ended."""
    with subprocess.Popen(["true"]) as process:
        process.wait()
    return process.pid


class Jobs(unittest.TestCase):
    def setUp(self):
        scratch = tempfile.TemporaryDirectory()
        self.addCleanup(scratch.cleanup)
        self.folder = pathlib.Path(scratch.name)
        self.job = Note(self.folder, "a")

    def made(self):
        log = self.folder / "log"
        return sorted(log.read_text(encoding="utf-8").split()) if log.exists() else []

    def claim(self, pid, host=jobs.HOST, age_s=0.0):
        self.job.claim.mkdir()
        owner = self.job.claim / f"{pid}@{host}@2000-01-01T00:00:00"
        owner.touch()
        os.utime(owner, 2 * (time.time() - age_s,))

    def test_a_job_is_made_once_and_its_claim_given_back(self):
        self.assertEqual([self.job.run(), self.job.run()], ["done", ""])
        self.assertEqual(self.made(), ["a"])
        self.assertEqual({path.name for path in self.folder.iterdir()}, {"a", "log"})

    def test_the_claim_names_process_host_and_time(self):
        pid, host, when = jobs.take(self.job.claim).name.split("@")
        self.assertEqual((int(pid), host), (os.getpid(), jobs.HOST))
        self.assertLess(abs(time.mktime(time.strptime(when, "%Y-%m-%dT%H:%M:%S")) - time.time()), 60.0)

    def test_what_a_living_process_has_is_left_to_it(self):
        self.claim(os.getppid())
        self.assertIsNone(self.job.run())
        self.assertEqual(self.made(), [])

    def test_what_a_process_has_that_is_gone_is_taken_over(self):
        self.claim(gone_pid())
        self.assertEqual(self.job.run(), "done")
        self.assertFalse(self.job.claim.exists())

    def test_whether_another_machines_process_lives_is_told_by_the_claims_age(self):
        self.claim(gone_pid(), "elsewhere", age_s=0.5 * jobs.STALE_S)
        self.assertIsNone(self.job.run())
        os.utime(next(self.job.claim.iterdir()), 2 * (time.time() - 2.0 * jobs.STALE_S,))
        self.assertEqual(self.job.run(), "done")

    def test_a_claim_without_a_name_is_taken_over_when_it_is_old(self):
        self.job.claim.mkdir()
        self.assertIsNone(self.job.run())
        os.utime(self.job.claim, 2 * (time.time() - 2.0 * jobs.STALE_S,))
        self.assertEqual([self.job.run(), self.job.run()], [None, "done"])

    def test_one_of_many_gets_a_job_whether_new_or_stale(self):
        for is_stale in 10 * [False, True]:
            if is_stale:
                self.claim(gone_pid())
            start, got = threading.Barrier(8), []

            def contend():
                start.wait()
                got.append(jobs.take(self.job.claim))

            threads = [threading.Thread(target=contend) for _ in range(8)]
            for thread in threads:
                thread.start()
            for thread in threads:
                thread.join()
            owners = [owner for owner in got if owner]
            self.assertEqual(len(owners), 1)
            owners[0].unlink()
            self.job.claim.rmdir()

    def test_processes_share_a_list_and_finish_what_one_left_behind(self):
        self.claim(gone_pid())
        names = [f"b{i}" for i in range(30)]
        jobs.work_in_parallel([self.job, *(Note(self.folder, name) for name in names)], 3)
        self.assertEqual(self.made(), sorted(["a", *names]))

    def test_a_failure_is_kept_with_its_reason_until_the_next_run(self):
        failing = Note(self.folder, "b", fails=True)
        jobs.work_in_parallel([self.job, failing], 2)
        self.assertEqual(jobs.tally([self.job, failing, Note(self.folder, "c")]), (1, 1, 1))
        self.assertEqual(jobs.failures([self.job, failing]), ["failed: b: no such world"])
        failing.fails = False
        jobs.work_in_parallel([self.job, failing], 2)
        self.assertEqual(jobs.tally([self.job, failing]), (2, 0, 0))

    def test_a_result_of_other_programs_than_it_is_named_by_is_not_kept(self):
        self.job.place = self.folder / "of_the_new_program"
        self.assertIn("changed", self.job.run())
        self.assertEqual(jobs.tally([self.job]), (0, 1, 0))

    def test_shards_share_a_list_without_rest(self):
        for length, count in itertools.product([0, 1, 7, 100], [1, 3, 8]):
            listed, shards = list(range(length)), [jobs.shard(f"{i}/{count}") for i in range(1, count + 1)]
            self.assertEqual(sorted(sum((listed[first - 1::step] for first, step in shards), [])), listed)

    def test_there_is_no_shard_beyond_the_last_or_before_the_first(self):
        for text in ["0/3", "4/3", "1", "1/", "/3", "-1/3", "a/b", "1/0"]:
            with self.assertRaises(argparse.ArgumentTypeError):
                jobs.shard(text)

    def test_the_bound_of_no_event_has_a_closed_form(self):
        for of in (1, 10, 299, 2995):
            self.assertAlmostEqual(jobs.upper_bound(0, of), 1.0 - 0.05 ** (1.0 / of), places=12)
        self.assertEqual([round(100.0 * jobs.upper_bound(0, of), 2) for of in (299, 2995)], [1.0, 0.1])

    def test_the_bound_of_some_events_is_that_of_clopper_and_pearson(self):
        # scipy.stats.beta.ppf(0.95, events + 1, of - events)
        for events, of, expected in [(1, 20, 0.2161061642), (3, 48, 0.1536889989), (40, 2995, 0.0173503379),
                                     (19, 20, 0.9974386212)]:
            self.assertAlmostEqual(jobs.upper_bound(events, of), expected, places=9)
        self.assertEqual([jobs.upper_bound(5, 5), jobs.upper_bound(0, 0)], [1.0, 1.0])


if __name__ == "__main__":
    rosunit.unitrun("flight_corridor", "jobs", Jobs)
