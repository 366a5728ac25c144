#!/usr/bin/python3
"""Makes flight.gif and index.html of what `scripts/demo` left in a folder."""

import csv
import html
import io
import math
import pathlib
import sys

from PIL import Image

import plot_ranges
import verdicts

GIF_WIDTH_PX, GIF_PERIOD_S, COLOURS = 560, 1 / 3, 64
VERDICT_COLOURS = ["#3cc850", "#e63232", "#ffb400"]  # as flight_corridor::colour() draws them

PAGE = """<!DOCTYPE html>
<html lang="en"><head><meta charset="utf-8"><title>flight_corridor: {name}</title>
<style>
body {{ font: 16px/1.5 sans-serif; max-width: 1000px; margin: 2em auto; padding: 0 1em; color: #222; }}
img {{ max-width: 100%; }}
table {{ border-collapse: collapse; }}
th, td {{ padding: 0.3em 0.9em; border-bottom: 1px solid #ddd; text-align: right; vertical-align: middle; }}
td img {{ width: 440px; display: block; }}
.FREE {{ color: #2a8f1d; }} .BLOCKED {{ color: #cf2020; }} .UNKNOWN {{ color: #b07800; }}
.FREE, .BLOCKED, .UNKNOWN {{ font-weight: bold; }}
</style></head><body>
<h1>Is the corridor ahead free?</h1>
<p>{name}: {frames} stereo pairs in {seconds:.1f} s.</p>
<img src="flight.gif" alt="the flight">
<p>Left: the left camera's image with the UAV's corridor, 4 m long, drawn into it.
Right: depth by stereo (near is red, far is blue), and the map from above (dark: occupied, white: seen free,
grey: not seen). Below: the verdicts over time,
<span class="FREE">FREE</span>, <span class="BLOCKED">BLOCKED</span> or <span class="UNKNOWN">UNKNOWN</span>.
All frames: <a href="flight.avi">flight.avi</a>.</p>
{node}{evaluation}
<h2>Changes of verdict</h2>
<table><tr><th>time [s]</th><th>verdict</th><th>clear [m]</th><th>d_K [m]</th><th style="text-align: left">why</th>
<th style="text-align: left">overlay, matched depth; filled depth, map</th></tr>
{changes}</table>
<h2>Ranges</h2>
<img src="ranges.png" alt="ranges of LiDAR, stereo and their fusion over time">
<p>Every frame: <a href="result.csv">result.csv</a>.</p>
{flown}
</body></html>
"""


def video_frames(path):
    """Pictures of a motion JPEG AVI."""
    data = path.read_bytes()
    at = data.index(b"movi") + 4
    while data[at:at + 4] == b"00dc":
        size = int.from_bytes(data[at + 4:at + 8], "little")
        yield Image.open(io.BytesIO(data[at + 8:at + 8 + size]))
        at += 8 + size + size % 2


def write_gif(frames, path):
    """One palette for all frames, and no dithering: both make the file small."""
    height_px = frames[0].height * GIF_WIDTH_PX // frames[0].width
    small = [frame.resize((GIF_WIDTH_PX, height_px), Image.LANCZOS) for frame in frames]
    sheet = Image.new("RGB", (GIF_WIDTH_PX, 5 * height_px))
    for i in range(4):
        sheet.paste(small[i * (len(small) - 1) // 3], (0, i * height_px))
    for i, colour in enumerate(VERDICT_COLOURS):
        sheet.paste(colour, (i * GIF_WIDTH_PX // 3, 4 * height_px, (i + 1) * GIF_WIDTH_PX // 3, 5 * height_px))
    palette = sheet.quantize(COLOURS)
    drawn = [frame.quantize(palette=palette, dither=Image.NONE) for frame in small]
    drawn[0].save(path, save_all=True, append_images=drawn[1:], duration=int(1000 * GIF_PERIOD_S), loop=0)


def node_section(path):
    rows = verdicts.read(path)
    states = [verdicts.STATES[int(row["field.state"])] for row in rows]
    latencies = sorted(float(row["field.latency"]) for row in rows)
    cells = "".join(f'<tr><td class="{state}">{state}</td><td>{states.count(state)}</td>'
                    f"<td>{100 * states.count(state) / len(states):.1f} %</td></tr>" for state in verdicts.STATES)
    return ("<h2>The node in real time</h2>"
            f"<table><tr><th>verdict</th><th>frames</th><th>share</th></tr>{cells}</table>"
            f"<p>From image to verdict: {1000 * latencies[len(latencies) // 2]:.0f} ms in the median. "
            'Every verdict: <a href="node.csv">node.csv</a>.</p>')


def evaluation_section(path):
    return (f"<h2>Against the truth</h2><pre>{html.escape(path.read_text(encoding='utf-8'))}</pre>"
            "<p>Straight towards a wood, more is UNKNOWN than in most scenes: trees fit on each other at another depth "
            "(AMBIGUOUS, see doc/limits.md).</p>")


def flown_section(path):
    with open(path, encoding="utf-8") as file:
        row = next(csv.DictReader(file))
    return ("<h2>A flight by what is seen</h2>"
            '<img src="fly.gif" alt="a quadrotor flies through a wood">'
            f"<p>A simulated quadrotor flies to the green ring: {row['outcome'].replace('_', ' ')} after "
            f"{float(row['time_s']):.0f} s and {float(row['distance_m']):.0f} m. Left: the directions that were judged, "
            "the one that is taken ringed. Right: from above. All frames: <a href=\"fly.avi\">fly.avi</a>.</p>")


def metres(text):
    value = float(text)
    return f"{value:.2f}" if math.isfinite(value) else "–"


def change_row(row, time_s, index):
    state = row["state"]
    picture = f"overlays/{index:06}_{state}.png"
    shown = f'<a href="{picture}"><img src="{picture}" alt=""></a>'
    return (f'<tr><td>{time_s:.2f}</td><td class="{state}">{state}</td><td>{metres(row["clear_distance_m"])}</td>'
            f'<td>{metres(row["range_fused_m"])}</td>'
            f'<td style="text-align: left">{row["reasons"].replace("|", "<br>")}</td>'
            f"<td>{shown}</td></tr>\n")


def main():
    if len(sys.argv) != 3:
        sys.exit("usage: demo_page.py FOLDER NAME")
    folder, name = pathlib.Path(sys.argv[1]), sys.argv[2]
    rows, times = plot_ranges.read(folder / "result.csv")
    every = max(1, round(GIF_PERIOD_S * (len(rows) - 1) / times[-1])) if times[-1] > 0 else 1
    write_gif(list(video_frames(folder / "flight.avi"))[::every], folder / "flight.gif")
    changes = [i for i in range(len(rows)) if i == 0 or rows[i]["state"] != rows[i - 1]["state"]]
    node, evaluation, flown = folder / "node.csv", folder / "evaluation.txt", folder / "fly.csv"
    if flown.exists():
        write_gif(list(video_frames(folder / "fly.avi"))[::3], folder / "fly.gif")
    (folder / "index.html").write_text(PAGE.format(
        name=html.escape(name), frames=len(rows), seconds=times[-1],
        node=node_section(node) if node.exists() else "",
        evaluation=evaluation_section(evaluation) if evaluation.exists() else "",
        flown=flown_section(flown) if flown.exists() else "",
        changes="".join(change_row(rows[i], times[i], i) for i in changes)), encoding="utf-8")


if __name__ == "__main__":
    main()
