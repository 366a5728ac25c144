"""Tables of verdicts held against truth: rows of `evaluate --csv` as Markdown and CSV."""

import csv
import io

from tools import run_tool


def score_files(name, pairs):
    """@param pairs of files: verdicts, and their truth"""
    words = [word for result, truth in pairs for word in ("--result", result, "--truth", truth)]
    return {"name": name, **next(csv.DictReader(io.StringIO(run_tool("evaluate", "--csv", *words))))}


def share(row, name, total):
    count, of = int(row[name]), int(row[total])
    if not of:
        return "–"
    bounds = ""
    if name + "_lower" in row:
        bounds = f", {100 * float(row[name + '_lower']):.2f} – {100 * float(row[name + '_upper']):.2f}"
    return f"{count} ({100 * count / of:.1f} %{bounds})"


def reaction(row, name):
    changes, missed = int(row[name + "_changes"]), int(row[name + "_missed"])
    if not changes:
        return "–"
    text = f"{missed} of {changes} missed"
    if missed < changes:
        median, longest = (float(row[f"{name}_{which}_s"]) for which in ("median", "longest"))
        frames = f"{median:.2f} / {longest:.2f}, {row[name + '_longest_frames']}"
        text = f"{frames}; {text}" if missed else frames
    return text


def distance(row):
    median, p95 = float(row["distance_error_median_m"]), float(row["distance_error_p95_m"])
    return "–" if median != median else f"{median:.3f} / {p95:.3f}"


COLUMNS = [  # heading, cell
    ("truly blocked", lambda row: row["blocked"]),
    ("false FREE", lambda row: share(row, "false_free", "blocked")),
    ("flights with false FREE", lambda row: share(row, "recordings_false_free", "recordings_blocked")),
    ("UNKNOWN", lambda row: share(row, "unknown_of_blocked", "blocked")),
    ("truly free", lambda row: row["free"]),
    ("false BLOCKED", lambda row: share(row, "false_block", "free")),
    ("UNKNOWN", lambda row: share(row, "unknown_of_free", "free")),
    ("distance error [m]", distance),
    ("appearance → BLOCKED [s]", lambda row: reaction(row, "appearance")),
    ("disappearance → FREE [s]", lambda row: reaction(row, "disappearance")),
    ("time [ms]", lambda row: f"{float(row['time_median_ms']):.0f}"),
]
LEGEND = ("False FREE and false BLOCKED: frames (share, 95 % Wilson interval as if frames were independent); those of one "
          "flight show the\nsame scene, so flights are counted, too: of those with truly blocked frames. Distance error: "
          "median / p95 where truth and\nverdict are BLOCKED. Reaction: median / longest, frames of the longest; changes that the verdict "
          "never followed are missed.\nTime: median per frame when the verdicts were made, with several flights at once "
          "unless --jobs 1. Frames whose obstacle stands only\nin the box's 0.10 m margin are not scored, nor those without "
          "a verdict, which `fails:` counts.")


def markdown(title, rows, columns=tuple(COLUMNS)):
    """A table whose first column, named by the title, is the rows' name."""
    cells = [[title] + [heading for heading, _ in columns]]
    cells += [[row["name"]] + [cell(row) for _, cell in columns] for row in rows]
    widths = [max(map(len, column)) for column in zip(*cells)]
    cells.insert(1, ["-" * width for width in widths])
    return "\n".join("| " + " | ".join(cell.ljust(width) for cell, width in zip(line, widths)) + " |" for line in cells)


def write_csv(path, rows):
    with open(path, "w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, rows[0].keys())
        writer.writeheader()
        writer.writerows(rows)
