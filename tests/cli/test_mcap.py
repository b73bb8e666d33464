"""run.mcap and detections.mcap: read by a reader of our own, from the specification, and by the packages
of Foxglove's viewer; their fields against bins.csv, detections.csv and frames worked out by hand."""
import csv
import json
import math
import os
import subprocess

import mcap
import node
import program
import tap
from program import Folder, asdic
from run_folder import data

FAN = "{fan: {count: 12, sector_deg: 90, length_h_m: 0.1, length_v_m: 0.05}}"
SCENE = """version: 1
bottom: {depth_m: 12, type: sand}
objects:
  - {name: ball, sphere: {radius_m: 1}, position_m: [20, 3, 6], material: {impedance_mrayl: 45}}
sonar:
  frequency_khz: 100
  ping_rate_hz: 10
  source_level_db: 200
  receivers: RECEIVERS
  transmitter: {length_h_m: 0.01, length_v_m: 0.04}SCAN
mission: MISSION
sampling: {rays: 500, seed: 7}
output: {mcap: true, csv: long, images: []}
"""
TRACK = """time_s,x_m,y_m,z_m,roll_deg,pitch_deg,yaw_deg
0,1,2,5,0,0,0
0.1,1,2,5,0,0,90
0.2,3,-4,6,30,0,90
0.3,3,-4,6,0,20,90
0.4,3,-4,6,30,20,180
0.5,3,-4,6,30,20,180
"""


def scene(folder, mission="{track: track.csv}", receivers=FAN, scan="", name="scene.yaml"):
    folder.write("track.csv", TRACK)
    return folder.write(name, SCENE.replace("RECEIVERS", receivers).replace("MISSION", mission)
                        .replace("SCAN", scan))


def run_of(folder, *options, out="r", **changes):
    program.need_device()
    asdic("run", scene(folder, **changes), "-o", folder / out, *options).check(code=0)
    return mcap.File(folder / out + "/run.mcap")


def rotate(q, v):
    """v turned by the quaternion: q v q*, written out."""
    x, y, z, w = q["x"], q["y"], q["z"], q["w"]
    rows = ((1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)),
            (2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)),
            (2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)))
    return [sum(a * b for a, b in zip(row, v)) for row in rows]


def close(actual, expected, what="value", within=1e-9):
    if len(actual) != len(expected) or any(abs(a - b) > within for a, b in zip(actual, expected)):
        raise AssertionError(f"{what} is {actual}, expected {expected}")


def quaternion(q):
    return [q[k] for k in "xyzw"]


def test_the_file_is_as_the_specification_asks():
    with Folder() as folder:
        file = run_of(folder)
        tap.equal({topic: (name, len(file.of(topic))) for topic, name in
                   ((t, file.schemas[s][0]) for t, s in file.channels.values())},
                  {"/tf": ("tf2_msgs/msg/TFMessage", 6),
                   "/asdic/pose": ("geometry_msgs/msg/PoseStamped", 6),
                   "/asdic/sonar": ("marine_acoustic_msgs/msg/ProjectedSonarImage", 6),
                   "/asdic/image": ("sensor_msgs/msg/Image", 6)}, "channels")
        tap.equal(file.library, "asdic " + asdic("--version").out.split()[1])
        tap.equal(file.metadata["asdic"][2]["seed"], "7")
        tap.equal([m.time for m in file.of("/asdic/sonar")], [10**8 * i for i in range(6)], "times")
        stamps = [m.value["header"]["stamp"] for m in file.of("/asdic/sonar")]
        tap.equal([(s["sec"], s["nanosec"]) for s in stamps], [(0, 10**8 * i) for i in range(6)])


def test_chunks_are_many_in_a_long_run():
    """Ten pictures of 0.7 MB and more are several chunks of 4 MiB; File checks each."""
    with Folder() as folder:
        file = run_of(folder, mission="{pose: {position_m: [0, 0, 5]}, pings: 16}")
        tap.equal((len(file.chunks) > 1, len(file.of("/asdic/image"))), (True, 16), "chunks")
        parts = [run_of(folder, "--shard", f"{k}/2", out=f"part{k}", mission="{pose: {position_m: "
                        "[0, 0, 5]}, pings: 16}") for k in (1, 2)]
        tap.equal([len(p.of("/asdic/sonar")) for p in parts], [8, 8], "parts")
        asdic("merge", folder / "part2", folder / "part1", "-o", folder / "whole").check(code=0)
        tap.equal(data(folder, "whole", "run.mcap") == data(folder, "r", "run.mcap"), True, "merged")
        os.remove(folder / "r/run.mcap")
        asdic("run", folder / "scene.yaml", "-o", folder / "r", "--resume").check(code=0)
        tap.equal(data(folder, "whole", "run.mcap") == data(folder, "r", "run.mcap"), True, "resumed")


def test_times_that_messages_cannot_have_are_refused():
    """A stamp has 31 bits of seconds, and the file's own times begin at 0; other formats take any time."""
    head, *rows = TRACK.splitlines()
    with Folder() as folder:
        for start_s, good in ((0, True), (2147483646.5, True), (-0.1, False), (2147483647.5, False), (1e11, False)):
            path = scene(folder)
            moved = (f"{float(row.split(',')[0]) + start_s!r},{row.partition(',')[2]}" for row in rows)
            folder.write("track.csv", "\n".join([head, *moved]) + "\n")
            done = asdic("check", path).check(code=0 if good else 3)
            tap.equal("[output.mcap]" in done.err, not good, done.err)
            folder.write("scene.yaml", folder.read("scene.yaml").replace("mcap: true, ", ""))
            asdic("check", path).check(code=0)


def test_levels_are_those_of_bins_csv():
    with Folder() as folder:
        file = run_of(folder)
        rows = csv.DictReader(data(folder, "r", "bins.csv").decode().splitlines())
        sonar = [m.value for m in file.of("/asdic/sonar")]
        floats = [memoryview(v["image"]["data"]).cast("f") for v in sonar]
        image = sonar[0]["image"]
        tap.equal((image["dtype"], image["beam_count"], image["is_bigendian"]), (8, 12, False))
        count = 0
        for row in rows:
            ping, bin_, beam = int(row["ping"]), int(row["bin"]), int(row["beam"])
            level = floats[ping][bin_ * 12 + beam]
            tap.equal("" if math.isnan(level) else f"{level:.9g}", row["level_db"], str(row))
            tap.equal(sonar[ping]["ranges"][bin_], float(row["range_m"]), "range")
            count += 1
        tap.equal(count, sum(len(f) for f in floats), "levels")
        info = sonar[0]["ping_info"]
        tap.equal((info["frequency"], len(info["rx_beamwidths"]), len(info["tx_beamwidths"])),
                  (1e5, 12, 12))
        for width, length_m in ((info["rx_beamwidths"][0], 0.1), (info["tx_beamwidths"][0], 0.04)):
            x = math.pi * length_m * math.sin(width / 2) * 1e5 / info["sound_speed"]
            tap.equal(round((math.sin(x) / x) ** 2, 4), 0.5, "power at the beam's edge")


def test_frames_are_those_of_ros():
    """Quaternions by hand: north is yaw 90 of ENU; a roll keeps its sign, bow up is a negative pitch."""
    with Folder() as folder:
        poses = [m.value["pose"] for m in run_of(folder).of("/asdic/pose")]
        close([poses[0]["position"][k] for k in "xyz"], [2, 1, -5], "east, north, up")
        half = math.sqrt(0.5)
        close(quaternion(poses[0]["orientation"]), [0, 0, half, half], "bow north")
        close(quaternion(poses[1]["orientation"]), [0, 0, 0, 1], "bow east")
        s15, c15 = math.sin(math.radians(15)), math.cos(math.radians(15))
        close(quaternion(poses[2]["orientation"]), [s15, 0, 0, c15], "starboard down by 30")
        s10, c10 = math.sin(math.radians(10)), math.cos(math.radians(10))
        close(quaternion(poses[3]["orientation"]), [0, -s10, 0, c10], "bow up by 20")
        # Bow south, up by 20, then starboard down by 30: axes in east, north, up.
        q = poses[4]["orientation"]
        cos20, sin20 = math.cos(math.radians(20)), math.sin(math.radians(20))
        close(rotate(q, (1, 0, 0)), [0, -cos20, sin20], "forward")
        close(rotate(q, (0, 1, 0)), [math.cos(math.pi / 6), sin20 / 2, cos20 / 2], "port")


def test_transforms_lead_from_a_beam_to_the_world():
    with Folder() as folder:
        file = run_of(folder)
        directions = file.of("/asdic/sonar")[0].value["beam_directions"]
        bearings = [math.degrees(math.atan2(-d["y"], d["z"])) for d in directions]
        close([bearings[0], bearings[-1]], [-41.25, 41.25], "as viewers read them: starboard positive")
        for index, north_of_east_deg in ((0, 90), (1, 0)):  # bow north, bow east
            world, sonar = file.of("/tf")[index].value["transforms"]
            tap.equal([(t["header"]["frame_id"], t["child_frame_id"]) for t in (world, sonar)],
                      [("map", "base_link"), ("base_link", "sonar")])
            for d, bearing in zip(directions, bearings):
                v = rotate(world["transform"]["rotation"], rotate(
                    sonar["transform"]["rotation"], [d[k] for k in "xyz"]))
                angle = math.radians(north_of_east_deg - bearing)
                close(v, [math.cos(angle), math.sin(angle), 0], "a beam in the world", 1e-7)


def test_a_beam_that_looks_down_does_so_in_the_world():
    with Folder() as folder:
        file = run_of(folder, receivers="[{name: a}, {name: down, pitch_deg: 30}]")
        tap.equal([t for t, _ in file.channels.values()], ["/tf", "/asdic/pose", "/asdic/sonar"],
                  "two beams make no fan")
        down = file.of("/asdic/sonar")[1].value["beam_directions"][1]
        world, sonar = file.of("/tf")[1].value["transforms"]
        v = rotate(world["transform"]["rotation"], rotate(sonar["transform"]["rotation"],
                                                          [down[k] for k in "xyz"]))
        close(v, [math.cos(math.pi / 6), 0, -0.5], "east and down", 1e-7)


def test_the_picture_is_the_fan():
    with Folder() as folder:
        for m in run_of(folder).of("/asdic/image"):
            v = m.value
            # A sector of 90 degrees, 400 pixels long: sin 45 to either side.
            tap.equal((v["encoding"], v["height"], v["width"], v["step"], len(v["data"])),
                      ("rgb8", 400, 566, 3 * 566, 400 * 566 * 3))
            rows = [v["data"][i * v["step"]:(i + 1) * v["step"]] for i in range(400)]
            tap.equal((rows[399][:3], rows[0][:3], rows[200][3 * 283:3 * 284] != b"\0\0\0"),
                      (b"\0\0\0", b"\0\0\0", True), "corners are empty, the middle is not")


def test_a_scanned_head_turns_its_frame():
    with Folder() as folder:
        file = run_of(folder, receivers="[{name: head, length_h_m: 0.1}]",
                      mission="{pose: {position_m: [0, 0, 5]}, pings: 5}",
                      scan="\n  scan: {sector_deg: 40, step_deg: 10}")
        # Directions -20 to 20 degrees from the bow, which looks north; ahead in the sonar's frame is z.
        for m, bearing in zip(file.of("/tf"), (-20, -10, 0, 10, 20)):
            world, sonar = m.value["transforms"]
            v = rotate(world["transform"]["rotation"],
                       rotate(sonar["transform"]["rotation"], (0, 0, 1)))
            close(v, [math.sin(math.radians(bearing)), math.cos(math.radians(bearing)), 0], str(bearing))
            close(quaternion(world["transform"]["rotation"]), [0, 0, math.sqrt(0.5), math.sqrt(0.5)])
        sums = [sum(m.value["data"]) for m in file.of("/asdic/image")]
        tap.equal(sums == sorted(sums) and sums[0] < sums[-1], True, "the picture grows")


def test_detections_are_those_of_detections_csv():
    with Folder() as folder:
        run_of(folder)
        asdic("detect", folder / "r", "--background", "flat").check(code=0)
        rows = list(csv.DictReader(data(folder, "r", "detections.csv").decode().splitlines()))
        found = mcap.File(folder / "r/detections.mcap").of("/asdic/detections")
        tap.equal((len(found), len(rows) > 6), (6, True), f"{len(rows)} rows")
        for i, m in enumerate(found):
            v, of_ping = m.value, [r for r in rows if int(r["ping"]) == i]
            tap.equal((m.type, v["header"]["frame_id"]), ("marine_acoustic_msgs/msg/SonarDetections",
                                                          "sonar"))
            tap.equal({len(v[k]) for k in ("flags", "two_way_travel_times", "tx_delays", "intensities",
                                           "tx_angles", "rx_angles")}, {len(of_ping)}, "lists")
            speed = v["ping_info"]["sound_speed"]
            for k, row in enumerate(of_ping):
                tap.equal((v["flags"][k]["flag"], v["tx_delays"][k], v["tx_angles"][k]), (0, 0, 0))
                close([v["two_way_travel_times"][k] * speed / 2, v["intensities"][k],
                       math.degrees(v["rx_angles"][k])],
                      [float(row["range_m"]), float(row["level_db"]), -41.25 + 7.5 * int(row["beam"])],
                      str(row), 1e-4)
        again = asdic("detect", folder / "r", "--background", "flat").check(code=1)
        tap.contains(again.err, "--force")
        asdic("detect", folder / "r", "--background", "flat", "--force").check(code=0)


def test_a_full_disk_leaves_no_half_file():
    with Folder() as folder:
        before = run_of(folder).data
        os.remove(folder / "r/run.mcap")
        done = subprocess.run(["sh", "-c", f"ulimit -f 2000; trap '' XFSZ; exec {program.PATH} run "
                               f"{folder / 'scene.yaml'} -o {folder / 'r'} --resume"],
                              capture_output=True, text=True, check=False, timeout=100)
        tap.equal(done.returncode, 1, done.stderr)
        tap.contains(done.stderr, "run.mcap': File too large")
        tap.equal([n for n in os.listdir(folder / "r") if "run.mcap" in n], [], "a half file")
        asdic("run", folder / "scene.yaml", "-o", folder / "r", "--resume").check(code=0)
        tap.equal(data(folder, "r", "run.mcap") == before, True, "made again")


# --- by others --------------------------------------------------------------------------------------


def short(value):
    """As readers/mcap.mjs prints it."""
    if isinstance(value, dict):
        return {k: short(v) for k, v in value.items()}
    if isinstance(value, (list, tuple, bytes)):
        if len(value) > 64 and not isinstance(value[0], dict):
            return {"length": len(value), "sum": sum(x for x in value if x == x)}
        return [short(v) for v in value]
    return value


def same(theirs, ours, where):
    if isinstance(ours, dict):
        tap.equal(set(theirs), set(ours), where)
        for key in ours:
            same(theirs[key], ours[key], f"{where}.{key}")
    elif isinstance(ours, list):
        tap.equal(len(theirs), len(ours), where)
        for i, (a, b) in enumerate(zip(theirs, ours)):
            same(a, b, f"{where}[{i}]")
    elif isinstance(ours, float):
        close([theirs], [ours], where, 1e-9 * max(1, abs(ours)))
    else:
        tap.equal(theirs, ours, where)


def test_others_read_the_same():
    node.packages()
    with Folder() as folder:
        files = [run_of(folder)]
        asdic("detect", folder / "r", "--background", "flat").check(code=0)
        files.append(mcap.File(folder / "r/detections.mcap"))
        for file, name in zip(files, ("run.mcap", "detections.mcap")):
            theirs = [json.loads(line) for line in node.read("mcap.mjs", folder / "r/" + name).splitlines()]
            tap.equal(len(theirs), len(file.messages), name)
            for topic, _ in file.channels.values():
                of_topic = [m for m in theirs if m["topic"] == topic]
                for a, b in zip(of_topic, file.of(topic)):
                    tap.equal((a["type"], a["time"]), (b.type, b.time))
                    same(a["value"], short(b.value), f"{topic} {b.time}")


tap.main(globals())
