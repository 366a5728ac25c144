#!/usr/bin/python3
"""Prints the verdicts of a running node, as `rostopic echo -p /flight_corridor/corridor` recorded them."""

import csv
import sys

WATCHDOG = "8"  # the reason NO_DATA alone: what the node says while there are no pairs
STATES = ["UNKNOWN", "FREE", "BLOCKED"]  # by number, as in CorridorState.msg


def read(path):
    with open(path, newline="", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    pairs = [i for i, row in enumerate(rows) if row["field.reasons"] != WATCHDOG]
    return rows[pairs[0]:pairs[-1] + 1] if pairs else []  # from the first pair to the last one


def print_table(rows):
    states = [STATES[int(row["field.state"])] for row in rows]
    start = int(rows[0]["field.header.stamp"])
    for state in STATES:
        print(f"  {state:8} {states.count(state):5}  {100 * states.count(state) / len(states):5.1f} %")
    latencies = sorted(float(row["field.latency"]) for row in rows)
    print(f"  median latency {1000 * latencies[len(latencies) // 2]:.0f} ms")
    print(f"changes of verdict:\n  {'time [s]':>9}  {'verdict':8}  {'clear [m]':>9}  {'d_K [m]':>9}")
    for i, row in enumerate(rows):
        if i == 0 or states[i] != states[i - 1]:
            seconds = (int(row["field.header.stamp"]) - start) * 1e-9
            print(f"  {seconds:9.3f}  {states[i]:8}  {float(row['field.clear_distance']):9.3f}  "
                  f"{float(row['field.range_fused']):9.3f}")


def main():
    if len(sys.argv) != 2:
        sys.exit("usage: verdicts.py FILE")
    try:
        rows = read(sys.argv[1])
        if not rows:
            sys.exit(f"verdicts: {sys.argv[1]}: the node gave no verdict")
        print_table(rows)
    except (OSError, KeyError, ValueError) as error:
        sys.exit(f"verdicts: {sys.argv[1]}: {error}")


if __name__ == "__main__":
    main()
