"""Tables and pictures of closed-loop flights: rows of `fly --csv`."""

import statistics

import matplotlib

matplotlib.use("Agg")  # no display needed
import matplotlib.pyplot as plt  # noqa: E402

FAULTS = ["own", "at_rest", "outside"]
OUTCOMES = {"goal": "#1f4e79", "given_up": "#e6a700", "collision": "#d62728"}
COLUMNS = ["world", "rule", "flights", "collisions", "own fault / hit at rest / from outside the view",
           "goals where a way exists", "mean speed [m/s]", "top speed [m/s]", "stops", "waited [s]",
           "nearest: median / least [m]"]


def wilson(count, total):
    """95 % interval of a share [%]."""
    z, share = 1.96, count / total
    middle = (share + z * z / (2 * total)) / (1 + z * z / total)
    half = z * (share * (1 - share) / total + z * z / (4 * total * total)) ** 0.5 / (1 + z * z / total)
    return 100 * max(0.0, middle - half), 100 * min(1.0, middle + half)


def numbers(rows, column):
    return [float(row[column]) for row in rows]


def summary(world, rule, rows):
    """Speeds, stops and waiting are means over the flights that reached the goal."""
    goals = [row for row in rows if row["outcome"] == "goal"]
    with_way = [row for row in rows if row["way_exists"] == "1"]
    reached = [row for row in with_way if row["outcome"] == "goal"]
    collisions = sum(row["outcome"] == "collision" for row in rows)
    low, high = wilson(collisions, len(rows))
    nearest = numbers(rows, "nearest_m")

    def mean(column):
        return f"{statistics.mean(numbers(goals, column)):.2f}" if goals else "–"

    share = f" ({100 * len(reached) / len(with_way):.0f} %)" if with_way else ""
    return [world, rule, str(len(rows)), f"{collisions} ({low:.1f}–{high:.1f} %)",
            " / ".join(str(sum(row["fault"] == fault for row in rows)) for fault in FAULTS),
            f"{len(reached)} of {len(with_way)}{share}", mean("mean_speed_mps"),
            f"{max(numbers(rows, 'top_speed_mps')):.2f}", mean("stops"), mean("waited_s"),
            f"{statistics.median(nearest):.2f} / {min(nearest):.2f}"]


def groups(rows):
    """Rows by world and rule, those of all worlds last."""
    rules = list(dict.fromkeys(row["rule"] for row in rows))
    worlds = sorted({row["world"] for row in rows})
    for world in [*worlds, "all"]:
        for rule in rules:
            chosen = [row for row in rows if row["rule"] == rule and world in (row["world"], "all")]
            if chosen:
                yield world, rule, chosen


def markdown(rows):
    cells = [COLUMNS, ["---"] * len(COLUMNS), *[summary(*group) for group in groups(rows)]]
    return "\n".join("| " + " | ".join(line) + " |" for line in cells)


def draw_flights(rows):
    """What became of the flights, and how fast they were."""
    lines = list(groups(rows))
    figure, (outcomes, speeds) = plt.subplots(1, 2, figsize=(11, 1.6 + 0.3 * len(lines)), sharey=True)
    for i, (_, _, chosen) in enumerate(lines):
        left = 0.0
        for outcome, colour in OUTCOMES.items():
            share = 100 * sum(row["outcome"] == outcome for row in chosen) / len(chosen)
            outcomes.barh(i, share, left=left, color=colour, label=outcome.replace("_", " ") if i == 0 else None)
            left += share
        means = numbers([row for row in chosen if row["outcome"] == "goal"], "mean_speed_mps")
        speeds.plot(means, [i] * len(means), "|", color=OUTCOMES["goal"], markersize=9)
    outcomes.set_yticks(range(len(lines)), [f"{world}, {rule}" for world, rule, _ in lines])
    outcomes.set_ylim(len(lines) - 0.5, -0.5)
    outcomes.set_xlabel("share of the flights [%]")
    outcomes.legend(loc="lower center", bbox_to_anchor=(0.5, 1.0), ncol=3, frameon=False, fontsize="small")
    speeds.set(xlabel="mean speed of each flight that reached its goal [m/s]", xlim=(0, None))
    speeds.grid(axis="x", alpha=0.3)
    figure.tight_layout()
    return figure
