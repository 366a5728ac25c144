"""Lists of independent jobs, for one machine or many. A result's name is made of all that decides on it; where it is
there, nothing is done. Processes that share the folder claim each job, by a folder beside its result."""

import argparse
import contextlib
import math
import multiprocessing
import os
import pathlib
import shlex
import shutil
import signal
import socket
import subprocess
import sys
import tempfile
import threading
import time

import tools
from tools import ROOT, ToolError

CACHE = ROOT / "output" / "cache"
# Where process ids mean the same: on one machine, until it starts anew.
HOST = "-".join([socket.gethostname(), pathlib.Path("/proc/sys/kernel/random/boot_id").read_text(encoding="ascii")[:8],
                 os.readlink("/proc/self/ns/pid").strip("pid:[]")])
RENEWED_S, STALE_S = 20.0, 120.0  # age of a claim; machines' clocks must agree to a minute
POLL_S = 1.0
ARRAY_TASKS = 1000  # of Slurm's usual MaxArraySize


class Job:
    """Derived classes have address(), a folder named by all that decides on the result, and make(scratch), which writes
    results() there."""

    def __init__(self, name):
        self.name, self.folder = name, self.address()
        self.claim, self.failure = (self.folder.with_name(self.folder.name + end) for end in (".claim", ".failed"))

    def results(self):
        """What is made, in the order in which it appears."""
        return [self.folder]

    def is_current(self):
        """Whether programs and configuration are still those that the result is named by."""
        return self.address() == self.folder

    def outcome(self):
        return "done"

    def is_there(self):
        return all(path.exists() for path in self.results())

    def is_settled(self):
        return self.is_there() or self.failure.exists()

    def why_failed(self):
        return self.failure.read_text(encoding="utf-8").strip()

    def ensure(self):
        """It is there afterwards, made by this process or another."""
        self.failure.unlink(missing_ok=True)
        while self.run() is None:
            time.sleep(POLL_S)
        if not self.is_there():
            raise ToolError(self.why_failed())

    def run(self):
        """@return what became of it, "" if that was settled before; None while another process has it."""
        if self.is_settled():
            return ""
        owner = take(self.claim)
        if owner is None:
            return None
        try:
            return "" if self.is_settled() else self._run(owner)  # asked again: settled before it was claimed
        finally:
            if owner.exists():
                shutil.rmtree(self.claim, ignore_errors=True)

    def _run(self, owner):
        try:
            scratch = pathlib.Path(tempfile.mkdtemp(dir=self.claim))
            self._check()
            with renewed(owner):
                self.make(scratch)
            self._check()
            for path in self.results():
                if not path.exists():
                    path.parent.mkdir(exist_ok=True)
                    (scratch / path.name).rename(path)  # what is moved is whole
            return self.outcome()
        except (ToolError, OSError) as error:
            if not self.is_there():
                self.failure.write_text(f"{error}\n", encoding="utf-8")
            return f"FAILED: {error}"

    def _check(self):
        tools.tool_digest.cache_clear()
        if not self.is_current():
            raise ToolError("a program or the configuration was changed since the start")


def take(claim):
    """Claims for this process, by an atomic mkdir; what is nobody's any more by an atomic rename.
    @return the file that says whose it is, None where it is another's."""
    mine = claim / f"{os.getpid()}@{HOST}@{time.strftime('%Y-%m-%dT%H:%M:%S')}"
    claim.parent.mkdir(parents=True, exist_ok=True)
    with contextlib.suppress(FileExistsError):
        claim.mkdir()
        mine.touch()
        return mine
    with contextlib.suppress(FileNotFoundError):  # given back or taken over meanwhile
        owner = next(claim.glob("*@*@*"), None)
        if owner and is_stale(owner):
            os.utime(owner)
            owner.rename(mine)
            return mine
        if not owner and age_s(claim) > STALE_S:  # its process ended before it wrote its name, or after it removed it
            shutil.rmtree(claim, ignore_errors=True)
    return None


def age_s(path):
    return time.time() - path.stat().st_mtime


def is_stale(owner):
    pid, host, _ = owner.name.split("@")
    return age_s(owner) > STALE_S or (host == HOST and not pathlib.Path("/proc", pid).exists())


@contextlib.contextmanager
def renewed(owner):
    """The claim is kept young."""
    done = threading.Event()

    def renew():
        while not done.wait(RENEWED_S):
            with contextlib.suppress(OSError):
                os.utime(owner)

    thread = threading.Thread(target=renew, daemon=True)
    thread.start()
    try:
        yield
    finally:
        done.set()
        thread.join()


def work(jobs):
    """Makes what nobody else makes, until all is settled, and prints how it goes."""
    start, before = time.monotonic(), sum(job.is_settled() for job in jobs)
    while pending := [job for job in jobs if not job.is_settled()]:
        claimed_by_others = 0
        for job in pending:
            outcome = job.run()
            claimed_by_others += outcome is None
            if outcome:
                settled = sum(job.is_settled() for job in jobs)
                left_s = (time.monotonic() - start) * (len(jobs) - settled) / max(1, settled - before)
                sys.stderr.write(f"[{settled}/{len(jobs)}] {job.name}: {outcome}, {left_s:.0f} s left\n")
        if claimed_by_others == len(pending):
            time.sleep(POLL_S)


def work_in_parallel(jobs, processes):
    """What failed before is tried again."""
    for job in jobs:
        job.failure.unlink(missing_ok=True)
    for reason in (signal.SIGINT, signal.SIGTERM):  # leaves in order: no claim stays, no program goes on
        signal.signal(reason, lambda reason, _: sys.exit(128 + reason))
    workers = [multiprocessing.Process(target=work, args=(jobs,), daemon=True)
               for _ in range(min(processes, len(jobs)))]
    for worker in workers:
        worker.start()
    while any([worker.is_alive() for worker in workers]):  # asked of each: who was killed leaves the list of processes
        time.sleep(0.1)


def shard(text):
    index, _, count = text.partition("/")
    if not (index.isdigit() and count.isdigit() and 1 <= int(index) <= int(count)):
        raise argparse.ArgumentTypeError(f"I/N, I from 1 to N ({text})")
    return int(index), int(count)


def number(text):
    if not text.isdigit():
        raise argparse.ArgumentTypeError(f"0 or more ({text})")
    return int(text)


def add_options(parser):
    parser.add_argument("--jobs", type=number, default=len(os.sched_getaffinity(0)), metavar="N",
                        help="at once (all cores); 0: none, the table of what is there")
    where = parser.add_mutually_exclusive_group()
    where.add_argument("--list", action="store_true", help="print a shell command for each job, e.g. for GNU parallel")
    where.add_argument("--shard", type=shard, metavar="I/N", help="only every N-th job from the I-th on, and no table")
    where.add_argument("--slurm", action="store_true", help="let Slurm do them; SBATCH_ variables are sbatch's options")


def shard_command():
    """This command for one shard, whose I/N is to follow: it takes the programs as they are built now."""
    script, *words = [word for word in sys.argv if word not in ("--list", "--slurm")]
    words = [str(pathlib.Path(script).resolve()), *words, "--jobs", "1", "--shard"]
    return f"cd {shlex.quote(os.getcwd())} && {tools.AS_BUILT}=1 {shlex.join(words)} "


def submit(jobs):
    tasks, name = min(len(jobs), ARRAY_TASKS), pathlib.Path(sys.argv[0]).name
    log = CACHE.parent / f"{name}-%A.slurm.log"
    log.parent.mkdir(exist_ok=True)
    try:
        done = subprocess.run(["sbatch", "--parsable", "--requeue", "--open-mode=append", f"--array=1-{tasks}",
                               f"--job-name={name}", f"--output={log}",
                               "--wrap", f"{shard_command()}$SLURM_ARRAY_TASK_ID/{tasks}"],
                              capture_output=True, text=True, check=True)
    except (OSError, subprocess.CalledProcessError) as error:
        raise ToolError(f"sbatch: {getattr(error, 'stderr', '') or error}") from error
    array = done.stdout.strip().split(";")[0]
    print(f"{len(jobs)} jobs in {tasks} tasks: squeue --job {array}; {str(log).replace('%A', array)}\n"
          f"When they are done, {name} with the same options prints the table; with --jobs 0, what is there by then.")


def run(jobs, arguments):
    """Does what the options say.  @return whether a table is wanted."""
    if arguments.list:
        print("\n".join(f"{shard_command()}{i}/{len(jobs)}" for i in range(1, len(jobs) + 1)))
    elif arguments.slurm:
        submit(jobs)
    else:
        first, step = arguments.shard or (1, 1)
        mine = jobs[first - 1::step]
        if arguments.jobs:
            work_in_parallel(mine, arguments.jobs)
        if arguments.shard:
            print("shard {}/{}: {} there, {} failed, {} missing; ".format(first, step, *tally(mine))
                  + "of all {}: {} there, {} failed, {} missing".format(len(jobs), *tally(jobs)))
            sys.exit(0 if all(job.is_there() for job in mine) else 1)
    return not (arguments.list or arguments.slurm)


def tally(jobs):
    """How many are there, failed, and are missing."""
    there = sum(job.is_there() for job in jobs)
    settled = sum(job.is_settled() for job in jobs)
    return there, settled - there, len(jobs) - settled


def upper_bound(events, of, risk=0.05):
    """The largest rate at which so few events are no less likely than the risk (Clopper and Pearson 1934)."""
    if events >= of:
        return 1.0
    low, high = events / of, 1.0
    for _ in range(60):
        rate = (low + high) / 2
        likelihood = sum(math.exp(math.lgamma(of + 1) - math.lgamma(k + 1) - math.lgamma(of - k + 1)
                                  + k * math.log(rate) + (of - k) * math.log1p(-rate)) for k in range(events + 1))
        low, high = (rate, high) if likelihood > risk else (low, rate)
    return high


def tally_table(event, groups):
    """How many flights are there, why others are not, and what so many tell.
    @param event what is bounded
    @param groups of name, jobs, events, and of how many flights"""
    lines = [f"| | flights | flown | failed | missing | {event} | at most (one-sided 95 %) |", "|" + " --- |" * 7]
    lines += [f"| {name} | {len(jobs)} | " + " | ".join(map(str, tally(jobs)))
              + f" | {events} of {of} | {100 * upper_bound(events, of):.2f} % |" for name, jobs, events, of in groups]
    return "\n".join([*lines, *failures({job: None for _, jobs, _, _ in groups for job in jobs})])


def failures(jobs):
    return [f"failed: {job.name}: {job.why_failed()}" for job in jobs if job.is_settled() and not job.is_there()]
