"""asdic serve --ros2 against another vendor's DDS (ros2/peer.cc, Fast DDS): poses in, pings out, field by
field; and one message for each thing that keeps them from one another. All on the loopback."""
import json
import math
import re
import struct
import subprocess

import program
import tap
from program import Folder, asdic
from ros2 import PEER, Server, need, peer
from scenes import SONAR, ball_over_sand

SCENE = ball_over_sand(f"""{SONAR},
  receivers: {{fan: {{count: 12, sector_deg: 90, length_h_m: 0.1, length_v_m: 0.05}}}},
  transmitter: {{length_h_m: 0.01, length_v_m: 0.04}}""", 512, more="model: {terms: all}\n")
START = 5000 * 10**9  # of stamps, ns
S15, C15, HALF = math.sin(math.radians(15)), math.cos(math.radians(15)), math.sqrt(0.5)
# East, north, up and a quaternion; the same as asdic's north, east, down, roll, pitch, yaw.
POSES = [("2 1 -7 0 0 0 1", "0,1,2,7,0,0,90"),
         (f"0 1 -7 0 0 {HALF!r} {HALF!r}", "0,1,0,7,0,0,0"),
         (f"0 1 -6 {S15!r} 0 0 {C15!r}", "0,1,0,6,30,0,90"),
         (f"0 1 -6 0 {S15!r} 0 {C15!r}", "0,1,0,6,0,-30,90")]


def test_pings_are_those_of_lines_field_by_field():
    need()
    with Folder() as folder:
        with Server(folder, SCENE, "--detect") as server:
            got = peer(server, folder, [pose for pose, _ in POSES], stamp=START + 7)
        tap.equal(server.code, 130, server.said)
        tap.lacks(server.said, "warning")
        # What the other end sent to be found were pings, too, at the first pose.
        before = int(re.search(r"^(\d+) pings;", server.said, re.M).group(1)) - len(POSES)
        lines = "\n".join([POSES[0][1]] * before + [line for _, line in POSES])
        answers = [json.loads(line) for line in asdic("serve", folder / "scene.yaml", "--detect", stdin=lines)
                   .check(code=0).out.splitlines()][before:]
        sonar, image, found = ([m for m in got if m.get("topic") == t] for t in
                               ("sonar", "image", "detections"))
        tap.equal((len(sonar), len(image), len(found)), (4, 4, 4), "messages")
        beams = list(answers[0]["level_db"])
        for i, (answer, s, m, d) in enumerate(zip(answers, sonar, image, found)):
            bins = len(answer["level_db"][beams[0]])
            for message in (s, m, d):
                tap.equal((message["stamp"], message["frame"]), (START + 7 + i * 10**8, "sonar"))
            tap.equal((s["frequency"], s["dtype"], s["beams"], s["bytes"], s["tx"], s["rx"][0]),
                      (1e5, 8, 12, 4 * 12 * bins, 12, 12))
            tap.equal(s["ranges"], [bins, 0.25, (bins - 0.5) * 0.5], "ranges")
            tap.equal([round(math.degrees(math.atan2(-y, z)), 6) for _, y, z in s["directions"]],
                      [-41.25 + 7.5 * b for b in range(12)], "port first")
            with open(folder / f"sonar_{i}", "rb") as file:
                levels = struct.unpack(f"<{12 * bins}f", file.read())
            for b, beam in enumerate(beams):
                for n, level in enumerate(answer["level_db"][beam]):
                    ours = levels[n * 12 + b]
                    tap.equal(None if ours != ours else f"{ours:.9g}",
                              None if level is None else f"{level:.9g}", f"ping {i} {beam} {n}")
            tap.equal((m["encoding"], m["height"], m["width"], m["step"], m["bytes"]),
                      ("rgb8", 400, 566, 1698, 400 * 1698))
            speed = s["sound_speed"]
            theirs = [(round(t * speed / 2, 3), round(math.degrees(a), 3)) for t, a, _ in d["found"]]
            ours = [(round(x["range_m"], 3), -41.25 + 7.5 * beams.index(x["beam"]))
                    for x in answer["detections"]]
            tap.equal(theirs, ours, "detections")
        tap.equal(sum(len(d["found"]) for d in found) > 0, True, "something is detected")


SCAN = ball_over_sand(f"""{SONAR}, max_range_m: 20,
  receivers: [{{name: head, yaw_deg: 10, length_h_m: 0.1, length_v_m: 0.05}}], scan: {{sector_deg: 90, step_deg: 30}},
  transmitter: {{length_h_m: 0.1, length_v_m: 0.04}}""", 512, more="model: {terms: all}\n")


def turned(q, v):
    """V turned by the quaternion x, y, z, w: v + 2 w (u x v) + 2 u x (u x v)."""
    def cross(a, b):
        return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])
    once = cross(q[:3], v)
    return [a + 2 * q[3] * b + 2 * c for a, b, c in zip(v, once, cross(q[:3], once))]


def test_a_scanned_head_is_where_tf_says():
    """Back and forth, by as much from ping to ping as the scene says, from the end to port; to who asks for reliable
    delivery, as tf2's listeners do."""
    need()
    with Folder() as folder:
        for options, vehicle, sonar in (((), "base_link", "sonar"),
                                        (("--vehicle-frame", "auv/hull", "--sonar-frame", "head"), "auv/hull", "head")):
            with Server(folder, SCAN, *options) as server:
                got = peer(server, folder, [POSES[0][0]] * 8, stamp=START)
            before = int(re.search(r"^(\d+) pings;", server.said, re.M).group(1)) - 8
            heads, pings = ([m for m in got if m.get("topic") == t] for t in ("tf", "sonar"))
            tap.equal([m["stamp"] for m in heads], [START + i * 10**8 for i in range(8)], server.said)
            tap.equal([m["stamp"] for m in heads], [m["stamp"] for m in pings], "stamps of both")
            tap.equal({(m["count"], m["frame"], m["child"], *m["at"]) for m in heads}, {(1, vehicle, sonar, 0, 0, 0)},
                      "what /tf leads from and to")
            tap.equal({m["frame"] for m in pings}, {sonar}, "pings' frame")
            for i, (m, ping) in enumerate(zip(heads, pings)):
                # z, x of the sonar ahead of its head and down; x, y of the vehicle forward and to port
                at = math.radians((-45, -15, 15, 45, 15, -15)[(before + i) % 6])
                beam = at + math.radians(10)
                for v, wanted in (((0, 0, 1), (math.cos(at), -math.sin(at), 0)), ((1, 0, 0), (0, 0, -1)),
                                  (ping["directions"][0], (math.cos(beam), -math.sin(beam), 0))):
                    off = max(abs(a - b) for a, b in zip(turned(m["q"], v), wanted))
                    tap.equal(off < 1e-12, True, f"ping {before + i}: {v} is {off:g} off")
            tap.lacks(server.said, "warning")


def test_poses_stamped_clock_and_reliable_subscribers():
    need()
    with Folder() as folder:
        with Server(folder, SCENE, "--pose-type", "pose", "--sim-time", "--reliable") as server:
            got = peer(server, folder, [p for p, _ in POSES[:3]], kind="pose", quality="reliable")
        sonar = [m for m in got if m.get("topic") == "sonar"]
        # The peer's clock says 1000 s and 1 s more with every pose.
        tap.equal([m["stamp"] for m in sonar], [10**9 * (1000 + i) for i in range(3)], server.said)
        tap.equal({m.get("topic", "summary") for m in got}, {"sonar", "image", "summary"}, "topics")
        tap.lacks(server.said, "warning")


def test_poses_without_a_clock_are_told_once():
    need()
    with Folder() as folder:
        with Server(folder, SCENE, "--sim-time") as server:
            got = peer(server, folder, ["0 0 -7 0 0 0 1"], wait=6, cold=True, clockless=True)
        tap.equal([m for m in got if "topic" in m], [], "pings")
        tap.equal(server.said.count("warning"), 1, server.said)
        tap.contains(server.said, "there are poses but no /clock yet")


def brightest(folder, number):
    """The largest sum of red, green, blue in a picture."""
    with open(folder / f"image_{number}", "rb") as file:
        data = file.read()
    return max(map(sum, zip(data[::3], data[1::3], data[2::3])))


def test_a_message_is_made_for_who_subscribes_alone():
    """Pings that nobody hears are made all the same. A picture that nobody subscribes to is not drawn: one near
    the bottom, which is loud, then does not choose the window of those in mid-water."""
    need()
    near, far = f"0 0 -11 0 {HALF!r} 0 {HALF!r}", "0 0 -4 0 0 0 1"  # straight down from 1 m above it, and ahead
    with Folder() as folder:
        with Server(folder, SCENE) as server:
            got = peer(server, folder, [near], wait=2, cold=True, topics="none")
            tap.equal([m for m in got if "topic" in m], [], "messages that nobody asked for")
            got = peer(server, folder, [near], topics="sonar")
            tap.equal([m["topic"] for m in got if "topic" in m], ["sonar"], server.said)
            got = peer(server, folder, [far], topics="sonar,image")
            tap.equal({m["topic"] for m in got if "topic" in m}, {"sonar", "image"}, server.said)
            own = brightest(folder, 0)
        tap.equal(int(re.search(r"^(\d+) pings;", server.said, re.M).group(1)) >= 3, True, server.said)
        tap.lacks(server.said, "warning")
        with Server(folder, SCENE) as server:
            peer(server, folder, [near, far], stamp=START)
            loud, others = brightest(folder, 0), brightest(folder, 1)
        print(f"# brightest: {own} in its own window, {loud} near the bottom and {others} in its window")
        tap.equal(own > others + 100, True, "the window is of the first picture that somebody has")
        # That bins are held against their neighbours is told when the first ping's are.
        folder.write("flat.asc", "ncols 2\nnrows 2\nxllcorner -200\nyllcorner -200\ncellsize 200\n12 12\n12 12\n")
        with Server(folder, SCENE.replace("depth_m: 12", "grid: flat.asc"), "--detect") as server:
            for topics, is_heard in (("sonar", False), ("sonar,image,detections", True)):
                got = peer(server, folder, [far], topics=topics)
                tap.equal(("detections" in {m.get("topic") for m in got}, "their neighbours" in server.said),
                          (is_heard, is_heard), server.said)


def test_a_scans_picture_has_what_nobody_heard():
    """Of every direction, also for who listens from the sixth ping on."""
    need()
    with Folder() as folder:
        with Server(folder, SCAN) as server:
            peer(server, folder, [POSES[0][0]] * 5, topics="sonar", stamp=START)
            image = [m for m in peer(server, folder, POSES[0][:1], topics="image", stamp=START + 10**9)
                     if m.get("topic") == "image"][-1]
            with open(folder / "image_0", "rb") as file:
                data = file.read()
        apex = math.ceil(400 * math.sin(math.radians(50)))  # half a step outside the first direction
        seen = [any(any(data[3 * (y * image["width"] + x):][:3]) for y, x in (
            (int(400 - r * math.cos(at)), int(apex + r * math.sin(at))) for r in range(40, 390)))
            for at in map(math.radians, (-35, -5, 25, 55))]
        tap.equal(seen, [True] * 4, "directions")


def test_poses_of_another_frame_are_told_once():
    need()
    with Folder() as folder:
        with Server(folder, SCENE) as server:
            got = peer(server, folder, ["0 0 -7 0 0 0 1"] * 2, frame="odom", wait=2, cold=True)
            tap.equal([m for m in got if "topic" in m], [], "pings")
            got = peer(server, folder, ["0 0 -7 0 0 0 1"])
            tap.equal(len([m for m in got if m.get("topic") == "sonar"]), 1, "a pose of the right frame")
        tap.equal(server.said.count("warning"), 1, server.said)
        tap.contains(server.said, "poses in the frame 'odom', not 'map'")


def told_of(pose, why):
    """Why there is no ping of POSE; the next one has its ping, and what comes after that is told anew."""
    need()
    with Folder() as folder:
        with Server(folder, SCENE, "--frame", "odom") as server:
            got = peer(server, folder, [pose, pose, "0 0 -7 0 0 0 1", pose, pose], frame="odom", wait=3, stamp=START,
                       cold=True)  # fmt: skip
        tap.equal(len([m for m in got if m.get("topic") == "sonar"]), 1, server.said)
        tap.equal(server.said.count("warning"), 2, server.said)
        tap.contains(server.said, why)


def test_a_pose_above_the_surface_is_told_once():
    told_of("0 0 1 0 0 0 1", "above the sea surface")


def test_a_pose_below_the_bottom_is_told_once():
    told_of("0 0 -20 0 0 0 1", "below the bottom at 12 m")


def test_a_quaternion_of_no_length_is_told_once():
    need()
    with Folder() as folder:
        with Server(folder, SCENE) as server:
            peer(server, folder, ["0 0 -7 0 0 0 0"] * 3, wait=3, cold=True)
        tap.equal(server.said.count("a quaternion of length 1"), 1, server.said)


def test_the_sonar_keeps_its_own_rate():
    """Poses every 100 ms are pings every 325 ms, at most a tenth too early: by their stamps, not by when they come.
    One that comes early, at 300 ms, does not bring the next forward from 650 ms to 600 ms."""
    tap.equal(stamps_of_pings(START), [5000.0, 5000.3, 5000.7])


def test_a_simulation_that_begins_at_0_keeps_its_rate():
    """Its first ping is stamped 0 as its pose is, and its second pose is no leap of time. A pose of 0 that was sent
    again is one that has no time."""
    tap.equal(sorted(set(stamps_of_pings(0))), [0.0, 0.3, 0.7])


def stamps_of_pings(start):
    """In s, of poses every 100 ms from START on at 3.0769 pings a second."""
    need()
    with Folder() as folder:
        with Server(folder, SCENE.replace("ping_rate_hz: 10", "ping_rate_hz: 3.0769")) as server:
            got = peer(server, folder, [POSES[0][0]] * 9, wait=0.75, stamp=start)
    return [m["stamp"] / 1e9 for m in got if m.get("topic") == "sonar"]


def test_poses_without_a_time_are_served_as_they_come():
    """Their pings have none either, and keep the sonar's rate."""
    need()
    with Folder() as folder:
        with Server(folder, SCENE.replace("ping_rate_hz: 10", "ping_rate_hz: 2")) as server:
            got = peer(server, folder, [POSES[0][0]] * 3, wait=10, cold=True, untimed=True)
            tap.equal({m["stamp"] for m in got if m.get("topic") == "sonar"}, {0}, server.said)
            tap.equal(len([m for m in got if m.get("topic") == "sonar"]) >= 3, True, server.said)
            got = peer(server, folder, [POSES[0][0]] * 80, hz=20, cold=True, untimed=True)
            pings = [m["pings"] for m in got if m.get("summary") == "sonar"]
        print(f"# {pings} pings of 80 poses in 4 s")
        tap.equal(len(pings) == 1 and 2 <= pings[0] <= 1 + 5.5 / 0.45, True, f"{pings} pings, one in half a second")


def test_time_that_leaps_back_begins_anew():
    """As of a simulation that is begun again while the sonar is there."""
    need()
    with Folder() as folder:
        with Server(folder, SCENE) as server:
            tap.equal(len([m for m in peer(server, folder, [POSES[0][0]]) if m.get("topic") == "sonar"]), 1, "before")
            got = peer(server, folder, [POSES[0][0]] * 2, wait=6, stamp=START, cold=True)
        tap.equal([m["stamp"] for m in got if m.get("topic") == "sonar"], [START, START + 10**8], server.said)


def test_who_does_not_find_one_another_is_told():
    need()
    with Folder() as folder:
        with Server(folder, SCENE) as server:
            server.wait_for("nobody publishes '/asdic/pose' (nav_msgs/msg/Odometry)")
            tap.contains(server.said, f"in domain {server.domain} yet")
        tap.equal(server.code, 130, "code")
        for options, kind, quality, text in (
                ((), "pose", "best_effort", "'/asdic/pose' is published as geometry_msgs/msg/PoseStamped, "
                 "and read as nav_msgs/msg/Odometry; --pose-type chooses"),
                ((), "odometry", "reliable", "a subscriber of '/asdic/sonar' asks for reliable delivery")):
            with Server(folder, SCENE, *options) as server:
                with subprocess.Popen([PEER, str(server.domain), kind, quality, "0", "map", folder.path],
                                      stdin=subprocess.PIPE, stdout=subprocess.DEVNULL) as other:
                    server.wait_for(text)
                    other.kill()
            tap.equal(server.said.count(text), 1, server.said)


def test_no_network_and_no_such_domain():
    need()
    with Folder() as folder:
        for domain in ("300", "-1", "seven", "7x", "99999999999999999999"):
            with Server(folder, SCENE, ROS_DOMAIN_ID=domain) as server:
                server.child.wait(timeout=60)
            tap.equal((server.code, server.said.count("error")), (1, 1), server.said)
            tap.contains(server.said, f"ROS_DOMAIN_ID is '{domain}'; a DDS domain is a number from 0 to 232")
        for uri, why in (("<General><Interfaces><NetworkInterface name=\"none0\"/></Interfaces></General>",
                          "none0: does not match an available interface; see the network"),
                         ("<General><Nonsense>1</Nonsense></General>", "Nonsense: unknown element")):
            with Server(folder, SCENE, uri=uri) as server:
                server.child.wait(timeout=60)
            tap.equal((server.code, server.said.count("error:")), (1, 1), server.said)
            tap.contains(server.said, f"cannot join the DDS domain {server.domain}")
            tap.contains(server.said, why)
        with Server(folder, SCENE, uri="", ROS_LOCALHOST_ONLY="1") as server:
            server.wait_for("poses from")
        tap.equal(server.code, 130, server.said)


def test_no_interface_at_all():
    """In a network namespace of its own, where not even the loopback is up."""
    need()
    alone = ["unshare", "--map-root-user", "--net"]
    if subprocess.run(["sh", "-c", " ".join([*alone, "true"])], capture_output=True, check=False).returncode:
        raise tap.Skip("no network namespace can be made here")
    with Folder() as folder:
        done = subprocess.run([*alone, program.PATH, "serve", folder.write("scene.yaml", SCENE), "--ros2"],
                              capture_output=True, text=True, check=False, timeout=60,
                              env=program.environment({"CYCLONEDDS_URI": None, "ROS_DOMAIN_ID": None}))
        tap.equal((done.returncode, done.stdout), (1, ""), done.stderr)
        tap.equal(done.stderr, "error: cannot join the DDS domain 0 (ROS_DOMAIN_ID): Error: failed to find interfaces "
                  "for \"udp\"; see the network, and CYCLONEDDS_URI where that is set\n")


def test_options_that_do_not_go_together():
    with Folder() as folder:
        scene = folder.write("scene.yaml", SCENE)
        for options, text in ((("--pose-topic", "/x"), "goes with --ros2"),
                              (("--ros2", "--format", "csv"), "go with lines"),
                              (("--ros2", "--pose-topic", "auv pose"), "is no topic"),
                              (("--ros2", "--topics", "/a//b"), "is no topic"),
                              (("--ros2", "--topics", "/"), "is no topic"),
                              (("--ros2", "--topics", "/a/"), "is no topic"),
                              (("--ros2", "--pose-topic", "/1abc"), "is no topic"),
                              (("--ros2", "--topics", "/auv/2nd"), "is no topic"),
                              (("--ros2", "--pose-type", "twist"), "pose")):
            done = asdic("serve", scene, *options).check(code=2, out="")
            tap.contains(done.err, text)


tap.main(globals(), at_once=14)  # they wait for discovery and for what must not come
