"""Faults of a running system: each finding is a function from an Observation to sentences."""

import math
from collections import Counter
from dataclasses import dataclass, field
from statistics import median

PAIRS_PER_WATCHDOG = 2  # pairs within ros/watchdog_s below which one that is late already means UNKNOWN
MOST_LOST = 0.5         # share of pairs without a verdict that is still called well
SAME_S = 1e-6           # stamps that differ by less are equal

# Bits of CorridorState.reasons that make UNKNOWN, and what to look at.
REMEDIES = {
    "UNOBSERVED": "a hole in the box, which no clear ray crosses: textureless surfaces, plain sky, glare, dusk; "
                  "or a box out of view (corridor/frame_id, offset_m)",
    "NO_DATA": "no pair, or too old: see the images and the clocks",
    "NO_POSE": "tf lacks a frame that the configuration names (map/frame_id, corridor/frame_id), or the camera is "
               "beyond the map: the node's log says which",
    "BAD_IMAGE": "wrong size or encoding, or one camera on both topics: the node's log says which",
    "BAD_CALIBRATION": "CameraInfo is impossible: the node's log says which number",
    "NO_DISPARITY": "hardly any match: texture, exposure, rectification, a covered lens, left and right exchanged",
    "MOVING": "something that moves can come into the corridor before the UAV stands (speed/mover_mps)",
    "RECENTLY_BLOCKED": "something blocked there within corridor/hold_s",
    "FROZEN_IMAGE": "images are bit-identical to earlier ones: the camera's driver",
    "AMBIGUOUS": "a patch is matched behind the box but fits in it as well: a repeated pattern, wires, railings",
    "WEAK_EVIDENCE": "a small patch of matches in the box: the edge of a textureless obstacle, or a mismatch",
    "LIDAR_NEARER": "the LiDAR measures less than stereo: glass, its mounting in tf, its unit",
}


@dataclass
class Topic:
    """One topic while it was listened to. Stamps, and the clock when each message came [s]."""
    name: str
    publishers: list = field(default_factory=list)
    listeners: list = field(default_factory=list)
    stamps: list = field(default_factory=list)
    arrivals: list = field(default_factory=list)
    last: object = None

    def ages(self):
        return [arrival - stamp for arrival, stamp in zip(self.arrivals, self.stamps)]


@dataclass
class Observation:
    """A node and its surroundings, looked at for `seconds`."""
    seconds: float
    node: str = ""                                    # "": there is none
    left: Topic = None
    right: Topic = None
    left_info: Topic = None
    right_info: Topic = None
    lidar: Topic = None                               # None: the node does not subscribe to one
    goal: Topic = None                                # goal_direction; None: the node does not subscribe to one
    verdict: Topic = None
    others: list = field(default_factory=list)        # what else may stop somebody: free, free_areas, scans
    commands_in: list = field(default_factory=list)   # of corridor_guard, or who else commands by free_areas
    commands_out: list = field(default_factory=list)
    reasons: list = field(default_factory=list)       # of each verdict: (state's name, set of reasons' names)
    ranges: list = field(default_factory=list)        # of the LiDAR: (range, min_range, max_range)
    frames: list = field(default_factory=list)        # tf's edges: (parent, child)
    parameters: dict = field(default_factory=dict)    # the node's, by key
    use_sim_time: bool = False
    clock_ticks: bool = True

    def stereo(self):
        return [topic for topic in (self.left, self.right, self.left_info, self.right_info) if topic]


def no_node(seen):
    if seen.node:
        return []
    return ["No node publishes a verdict (flight_corridor/CorridorState): roslaunch flight_corridor corridor.launch."]


def missing_images(seen):
    found = []
    for topic in seen.stereo():
        if not topic.publishers:
            found.append(f"Nobody publishes {topic.name}, which the node waits for: see corridor.launch's arguments "
                         "stereo, left, right and image.")
        elif not topic.stamps:
            found.append(f"{topic.name} is announced by {', '.join(topic.publishers)}, but nothing came in "
                         f"{seen.seconds:.0f} s.")
    return found


def nearest_difference(one, others):
    """Median of how far the nearest of the other stamps is [s]."""
    return median(min(abs(stamp - other) for other in others) for stamp in one)


def tolerance(seen):
    """How far the stamps of a pair may be apart [s]."""
    return seen.parameters.get("ros/sync_slop_s", 0.01) if seen.parameters.get("ros/approximate_sync") else SAME_S


def stamps_apart(seen):
    if not (seen.left and seen.right and seen.left.stamps and seen.right.stamps):
        return []
    apart_s = nearest_difference(seen.left.stamps, seen.right.stamps)
    slop_s = tolerance(seen)
    if apart_s <= slop_s:
        return []
    return [f"Left and right images are stamped {1000 * apart_s:.1f} ms apart, the node pairs up to "
            f"{1000 * slop_s:.1f} ms: trigger the cameras together, or set ros/approximate_sync and ros/sync_slop_s."]


def infos_apart(seen):
    slop_s = tolerance(seen)
    found = []
    for image, info in ((seen.left, seen.left_info), (seen.right, seen.right_info)):
        if not (image and info and image.stamps and info.stamps):
            continue
        if not any(info.stamps):
            found.append(f"{info.name} has no stamp (0), {image.name} has one: each CameraInfo must carry its image's "
                         "stamp. Let the driver stamp both alike, or give the calibration file to raw_stereo.launch "
                         "(left_calibration, right_calibration), which does.")
            continue
        apart_s = nearest_difference(image.stamps, info.stamps)
        if apart_s > slop_s:
            found.append(f"{info.name} is stamped {1000 * apart_s:.1f} ms from {image.name}, the node pairs up to "
                         f"{1000 * slop_s:.1f} ms: let the driver stamp both alike, or set ros/approximate_sync and "
                         "ros/sync_slop_s.")
    return found


def bad_calibration(seen):
    found = []
    for topic in (seen.left_info, seen.right_info):
        if topic and topic.last is not None and not topic.last.P[0] > 0.0:
            found.append(f"{topic.name} has no projection matrix P: the camera is not calibrated.")
    infos = [topic.last for topic in (seen.left_info, seen.right_info) if topic and topic.last is not None]
    if not found and len(infos) == 2 and not infos[0].P[3] > infos[1].P[3]:
        found.append(f"The baseline is not positive: P[3] is {infos[0].P[3]:g} left and {infos[1].P[3]:g} right. "
                     "It needs the CameraInfo of a stereo calibration, left and right not exchanged.")
    for image, info in ((seen.left, seen.left_info), (seen.right, seen.right_info)):
        if not (image and info and hasattr(image.last, "width") and info.last is not None):
            continue
        size, said = (image.last.width, image.last.height), (info.last.width, info.last.height)
        if size != said:
            found.append(f"{image.name} is {size[0]}x{size[1]} px, {info.name} says {said[0]}x{said[1]}.")
    return found


def connected(frames, one, other):
    """Whether tf's edges lead from one frame to another."""
    reached, edges = {one}, [set(edge) for edge in frames]
    while True:
        more = set().union(*(edge for edge in edges if edge & reached), set()) - reached
        if not more:
            return other in reached
        reached |= more


def missing_transforms(seen):
    camera = frame_of(seen.left)
    if not camera:
        return []
    wanted = {"the LiDAR's frame": frame_of(seen.lidar),
              "goal_direction's frame": frame_of(seen.goal),
              "map/frame_id": seen.parameters.get("map/frame_id", ""),
              "corridor/frame_id": seen.parameters.get("corridor/frame_id", "")}
    return [f"tf does not connect the camera's frame \"{camera}\" with \"{frame}\" ({name}): publish it, e.g. with "
            "tf2_ros static_transform_publisher."
            for name, frame in wanted.items() if frame and not connected(seen.frames, camera, frame)]


def frame_of(topic):
    return topic.last.header.frame_id.lstrip("/") if topic and topic.last is not None else ""


def describe_age(age_s):
    """As the node says it: "2.000 s old", "stamped 3600.000 s (1.0 h) ahead of the clock"."""
    seconds = f"{abs(age_s):.3f} s" + (f" ({abs(age_s) / 3600:.1f} h)" if abs(age_s) >= 900.0 else "")
    return f"stamped {seconds} ahead of the clock" if age_s < 0.0 else f"{seconds} old"


def clocks_apart(seen):
    if seen.use_sim_time and not seen.clock_ticks:
        return ["use_sim_time is set, but /clock does not tick: play the bag with --clock, or unset it."]
    limit_s = seen.parameters.get("corridor/max_age_s", 0.5)
    found = []
    for topic in (seen.left, seen.right):
        if not (topic and topic.stamps):
            continue
        age_s = median(topic.ages())
        if not abs(age_s) <= limit_s:
            found.append(f"{topic.name} is {describe_age(age_s)} when it comes, outside +-{limit_s:g} s "
                         "(corridor/max_age_s): synchronise the clocks" + ("." if seen.use_sim_time or age_s < 0.0 else
                         "; for a bag set use_sim_time and play it with --clock."))
    return found


def low_rate(seen):
    if not (seen.left and seen.left.stamps):
        return []
    found = []
    rate_hz = len(seen.left.stamps) / seen.seconds
    least_hz = PAIRS_PER_WATCHDOG / seen.parameters.get("ros/watchdog_s", 0.5)
    if rate_hz < least_hz:
        found.append(f"Images come at {rate_hz:.1f} Hz, less than {least_hz:.1f} Hz: with ros/watchdog_s as it is, "
                     "one that is late already means UNKNOWN.")
    answered = sum("NO_DATA" not in reasons for _, reasons in seen.reasons)
    if answered and answered < (1.0 - MOST_LOST) * len(seen.left.stamps):
        found.append(f"The node answers {answered} of {len(seen.left.stamps)} images: the machine is too slow, "
                     "or pairs lack a partner.")
    return found


def silent_lidar(seen):
    """A topic that nobody publishes does not count."""
    if not (seen.lidar and seen.lidar.publishers):
        return []
    if not seen.ranges:
        return [f"{seen.lidar.name} is announced by {', '.join(seen.lidar.publishers)}, but nothing came in "
                f"{seen.seconds:.0f} s: stereo answers alone."]
    if any(low <= value <= high or value == math.inf for value, low, high in seen.ranges):
        return []
    value, low, high = seen.ranges[-1]
    return [f"Every LiDAR reading is refused: the last one is {value:g} m, its message allows {low:g} to {high:g} m. "
            "Check that its driver sends metres, and min_range below max_range."]


def nobody_listens(seen):
    if not seen.verdict or any(topic.listeners for topic in (seen.verdict, *seen.others)):
        return []
    return [f"Nobody listens to {', '.join(topic.name for topic in (seen.verdict, *seen.others))}: "
            "the verdict stops nobody."]


def idle_guard(seen):
    return [f"Nobody publishes {topic.name}, which {', '.join(topic.listeners)} waits for: see corridor_guard.launch's "
            "argument cmd_vel_in." for topic in seen.commands_in if not topic.publishers] + \
           [f"Nobody listens to {topic.name} from {', '.join(topic.publishers)}: it stops nobody. See "
            "corridor_guard.launch's argument cmd_vel." for topic in seen.commands_out if not topic.listeners]


def other_senders(seen):
    return [f"{topic.name} has {len(topic.publishers)} senders, {', '.join(topic.publishers)}: what passes by "
            "corridor_guard is not limited. Leave one, and remap the others to its cmd_vel_in."
            for topic in seen.commands_out if len(topic.publishers) > 1]


def unknown_verdicts(seen):
    unknown = [reasons for state, reasons in seen.reasons if state == "UNKNOWN"]
    if not seen.reasons or 2 * len(unknown) <= len(seen.reasons):
        return []
    counts = Counter(reason for reasons in unknown for reason in reasons if reason in REMEDIES)
    share = f"{len(unknown)} of {len(seen.reasons)} verdicts are UNKNOWN"
    return [f"{share}, {count} with {reason}: {REMEDIES[reason]}." for reason, count in counts.most_common()] or \
        [f"{share}."]


FINDINGS = [no_node, missing_images, stamps_apart, infos_apart, bad_calibration, missing_transforms, clocks_apart, low_rate,
            silent_lidar, nobody_listens, idle_guard, other_senders, unknown_verdicts]


def examine(seen):
    """All findings, as sentences."""
    return [sentence for finding in FINDINGS for sentence in finding(seen)]
