#!/usr/bin/python3
"""Plots the LiDAR's range d_L, the stereo range D_c and the fused range d_K of a replay over time."""

import argparse
import csv
import sys

import matplotlib

matplotlib.use("Agg")  # no display needed
import matplotlib.pyplot as plt  # noqa: E402

STATE_COLOURS = {"FREE": "#2ca02c", "BLOCKED": "#d62728", "UNKNOWN": "#ffbf00"}
RANGES = [  # column, label, style
    ("range_stereo_m", "$D_c$ stereo", dict(color="#1f77b4", marker=".", linestyle="none", markersize=4)),
    ("range_lidar_m", "$d_L$ LiDAR", dict(color="#7f7f7f", marker="x", linestyle="none", markersize=3)),
    ("range_fused_m", "$d_K$ fused", dict(color="black", linewidth=1.5)),
]


def read(path):
    """Rows of R.csv. Times are relative to the first row: a float cannot hold nine decimals of an epoch."""
    with open(path, newline="", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    if not rows:
        sys.exit(f"plot_ranges: {path}: no rows")
    nanoseconds = [int(sec) * 10**9 + int(nsec) for sec, nsec in (row["stamp"].split(".") for row in rows)]
    return rows, [(stamp - nanoseconds[0]) * 1e-9 for stamp in nanoseconds]


def shade_states(axes, rows, times):
    """Colours the background by verdict, one span per run of equal states."""
    ends = times[1:] + [times[-1] + (times[-1] - times[0]) / max(1, len(times) - 1)]
    first = 0
    for i, row in enumerate(rows):
        if i + 1 == len(rows) or rows[i + 1]["state"] != row["state"]:
            axes.axvspan(times[first], ends[i], color=STATE_COLOURS[row["state"]], alpha=0.15, linewidth=0)
            first = i + 1


def plot(rows, times, length_m, title):
    figure, axes = plt.subplots(figsize=(9, 4.5))
    shade_states(axes, rows, times)
    for column, label, style in RANGES:
        axes.plot(times, [float(row[column]) for row in rows], label=label, **style)
    fused = [float(row["range_fused_m"]) for row in rows]
    sigma = [float(row["range_fused_sigma_m"]) for row in rows]
    axes.fill_between(times, [r - 3 * s for r, s in zip(fused, sigma)], [r + 3 * s for r, s in zip(fused, sigma)],
                      color="black", alpha=0.15, linewidth=0, label="$d_K \\pm 3\\sigma$")
    axes.axhline(length_m, color="#d62728", linestyle="--", linewidth=1, label="$D_{min}$")
    for state in STATE_COLOURS:
        if any(row["state"] == state for row in rows):
            axes.fill_between([], [], color=STATE_COLOURS[state], alpha=0.3, label=state)
    axes.set(xlabel="time [s]", ylabel="range [m]")
    figure.suptitle(title)
    axes.set_ylim(bottom=0)
    axes.grid(alpha=0.3)
    axes.legend(loc="lower center", bbox_to_anchor=(0.5, 1.0), fontsize="small", ncol=4, frameon=False)
    figure.tight_layout()
    return figure


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("result", help="R.csv of replay")
    parser.add_argument("picture", help="picture to write, e.g. ranges.png")
    parser.add_argument("--length", type=float, default=4.0, metavar="M", help="D_min, corridor/length_m [m] (4.0)")
    parser.add_argument("--title", default="", help="title of the plot")
    arguments = parser.parse_args()
    try:
        rows, times = read(arguments.result)
        plot(rows, times, arguments.length, arguments.title).savefig(arguments.picture, dpi=120)
    except (OSError, KeyError, ValueError) as error:
        sys.exit(f"plot_ranges: {arguments.result}: {error}")


if __name__ == "__main__":
    main()
