"""Pictures of tables of verdicts: rows of `evaluate --csv` with a name."""

import matplotlib

matplotlib.use("Agg")  # no display needed
import matplotlib.pyplot as plt  # noqa: E402

DANGEROUS, HARMLESS, UNKNOWN = "#d62728", "#1f4e79", "#e6a700"
SYSTEM_COLOURS = ["#1f4e79", "#d62728", "#e6a700", "#7f7f7f"]
SHARES = [0, 0.1, 1, 10, 100]  # [%] ticks: linear up to 0.1 %, logarithmic beyond
SHORTEST_AXIS_S = 0.5


def percent(row, name, total):
    return 100.0 * int(row[name]) / int(row[total]) if int(row[total]) else float("nan")


def rows_figure(rows, panels, title):
    """One line for each row, shared by panels; the totals' lines are shaded."""
    figure, all_axes = plt.subplots(1, panels, figsize=(11, 1.4 + 0.26 * len(rows)), sharey=True, squeeze=False)
    for axes in all_axes[0]:
        axes.set_ylim(len(rows) - 0.5, -0.5)
        axes.set_yticks(range(len(rows)), [row["name"] for row in rows])
        axes.tick_params(axis="y", length=0)
        axes.grid(axis="x", alpha=0.3)
        for spine in ("top", "right", "left"):
            axes.spines[spine].set_visible(False)
        for i, row in enumerate(rows):
            if row["name"].startswith("all "):
                axes.axhspan(i - 0.5, i + 0.5, color="#000000", alpha=0.07, linewidth=0)
    figure.suptitle(title, fontsize="medium")
    return figure, all_axes[0]


def draw_share(axes, rows, name, total, colour, label):
    """Shares with their Wilson intervals."""
    for i, row in enumerate(rows):
        if int(row[total]):
            axes.plot([100 * float(row[f"{name}_lower"]), 100 * float(row[f"{name}_upper"])], [i, i], color=colour,
                      alpha=0.5, linewidth=2, solid_capstyle="butt")
    shares = [percent(row, name, total) for row in rows]
    axes.plot(shares, range(len(rows)), "o", color=colour, markersize=5, label=label)


def draw_verdicts(rows):
    """Shares of wrong and of unknown answers of the truly blocked and of the truly free frames."""
    figure, (blocked, free) = rows_figure(rows, 2, "Wrong and unknown verdicts; bars: 95 % Wilson intervals")
    draws = [(blocked, "blocked", "false_free", "unknown_of_blocked", DANGEROUS, "false FREE"),
             (free, "free", "false_block", "unknown_of_free", HARMLESS, "false BLOCKED")]
    for axes, total, wrong, unknown, colour, label in draws:
        axes.plot([percent(row, unknown, total) for row in rows], range(len(rows)), "D", color=UNKNOWN, markersize=6,
                  fillstyle="none", label="UNKNOWN")
        draw_share(axes, rows, wrong, total, colour, label)
        axes.set_xscale("symlog", linthresh=SHARES[1])
        axes.set_xticks(SHARES, SHARES)
        axes.set(xlim=(-0.01, 120), xlabel=f"share of the truly {total} frames [%]")
        axes.legend(loc="lower center", bbox_to_anchor=(0.5, 1.0), ncol=2, frameon=False, fontsize="small")
    figure.tight_layout()
    return figure


def draw_span(axes, rows, from_column, to_column, labels):
    """A line from one number to a larger one."""
    spans = [(float(row[from_column]), float(row[to_column])) for row in rows]
    for i, span in enumerate(spans):
        axes.plot(span, [i, i], color=HARMLESS, linewidth=1.5, alpha=0.6)
    axes.plot([low for low, _ in spans], range(len(rows)), "o", color=HARMLESS, markersize=5, label=labels[0])
    axes.plot([high for _, high in spans], range(len(rows)), "|", color=HARMLESS, markersize=9, label=labels[1])
    axes.set_xlim(left=-0.02 * axes.get_xlim()[1])
    axes.legend(loc="lower center", bbox_to_anchor=(0.5, 1.0), ncol=2, frameon=False, fontsize="small")


def draw_accuracy(rows):
    """Distance errors and reaction times."""
    figure, (distance, appearance, disappearance) = rows_figure(rows, 3, "Distance error and reaction to changes")
    draw_span(distance, rows, "distance_error_median_m", "distance_error_p95_m", ("median", "95th percentile"))
    distance.set_xlabel("distance error [m]")
    for axes, name, verdict in [(appearance, "appearance", "BLOCKED"), (disappearance, "disappearance", "FREE")]:
        draw_span(axes, rows, f"{name}_median_s", f"{name}_longest_s", ("median", "longest"))
        axes.set(xlabel=f"{name} → {verdict} [s]", xlim=(None, max(SHORTEST_AXIS_S, axes.get_xlim()[1])))
        for i, row in enumerate(rows):
            if int(row[f"{name}_missed"]):
                axes.annotate(f"{row[f'{name}_missed']} missed ", (1.0, i), xycoords=("axes fraction", "data"),
                              ha="right", va="center", fontsize="x-small", color=DANGEROUS)
    figure.tight_layout()
    return figure


def draw_curve(axes, rows, colour):
    rows = sorted(rows, key=lambda row: (percent(row, "false_block", "free"), -percent(row, "false_free", "blocked")))
    x, y = ([percent(row, *share) for row in rows] for share in (("false_block", "free"), ("false_free", "blocked")))
    axes.plot(x, y, "o-", color=colour, markersize=4, linewidth=1.2, label=rows[0]["system"])
    for row, block, free in zip(rows, x, y):
        if row["in_use"]:
            axes.plot(block, free, "*", color=colour, markersize=16, markeredgecolor="black", zorder=3)


def draw_roc(rows):
    """False FREE against false BLOCKED: each curve whole, and near no error at all."""
    figure, (whole, near) = plt.subplots(1, 2, figsize=(11, 5.2))
    systems = list(dict.fromkeys(row["system"] for row in rows))
    for axes in (whole, near):
        for system, colour in zip(systems, SYSTEM_COLOURS):
            draw_curve(axes, [row for row in rows if row["system"] == system], colour)
        axes.set(xlabel="false BLOCKED [% of truly free frames]", ylabel="false FREE [% of truly blocked frames]")
        axes.grid(alpha=0.3)
    whole.set(xlim=(-2, 102), ylim=(-2, 102), title="whole")
    near.set(xlim=(-0.2, 10), ylim=(-0.2, 10), title="near no error")
    whole.plot([], [], "*", color="white", markersize=14, markeredgecolor="black", label="threshold in use")
    whole.legend(frameon=False, fontsize="small")
    counts = f"{rows[0]['blocked']} truly blocked and {rows[0]['free']} truly free frames"
    figure.suptitle(f"{counts}; UNKNOWN is neither error", fontsize="medium")
    figure.tight_layout()
    return figure
