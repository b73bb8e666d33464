"""`asdic serve --ros2` and the other vendor's DDS that it is tested with, on the loopback."""
import itertools
import json
import os
import signal
import subprocess
import threading
import time

import program
import tap
from program import asdic

PEER = os.environ["ROS2_PEER"]
HERE = """<General><Interfaces><NetworkInterface address="127.0.0.1"/></Interfaces>
<AllowMulticast>false</AllowMulticast></General><Discovery><ParticipantIndex>auto</ParticipantIndex>
<Peers><Peer address="127.0.0.1"/></Peers></Discovery>"""


def need():
    if "built without Cyclone DDS" in asdic("serve", "--ros2", "/dev/null").err:
        raise tap.Skip("built without Cyclone DDS")
    if not PEER:
        raise tap.Skip("no other DDS: libfastrtps-dev, fastddsgen")
    program.need_device()


class Server:
    """asdic serve --ros2 in a domain of its own, its stderr read as it comes."""
    domains = itertools.count(21 + os.getpid() % 180)

    def __init__(self, folder, scene, *options, uri=HERE, **env):
        self.domain = next(Server.domains)
        self.lines = []
        self.child = subprocess.Popen(
            [program.PATH, "serve", folder.write("scene.yaml", scene), "--ros2", *options],
            stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True,
            env=program.environment({"ROS_DOMAIN_ID": str(self.domain), "CYCLONEDDS_URI": uri,
                                     "ROS_LOCALHOST_ONLY": None, **env}))
        self.thread = threading.Thread(target=self.listen)
        self.thread.start()

    def listen(self):
        for line in self.child.stderr:
            self.lines.append(line)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        if self.child.poll() is None:
            self.child.send_signal(signal.SIGINT)
        try:
            self.code = self.child.wait(timeout=40)
        finally:
            self.child.kill()
            self.thread.join()

    @property
    def said(self):
        return "".join(self.lines)

    def wait_for(self, text, seconds=30):
        end = time.monotonic() + seconds
        while text not in self.said:
            if time.monotonic() > end or self.child.poll() is not None:
                tap.contains(self.said, text)
                return
            time.sleep(0.05)


def peer(server, folder, poses, kind="odometry", quality="best_effort", hz=0, frame="map", wait=60,
         stamp=None, cold=False, topics=None, clockless=False, untimed=False):
    """What the other DDS got: JSON objects. The first pose goes out beforehand until there is a ping, which
    is not among them; not when COLD. It subscribes to TOPICS, else to all. Stamps of poses begin at STAMP and are
    0.1 s apart, are all 0 when UNTIMED, else the time."""
    server.wait_for("poses from")  # who comes first is found seconds later
    out = folder.path
    done = subprocess.run([PEER, str(server.domain), kind, quality, str(hz), frame, out,
                           *([] if stamp is None else [str(stamp)])], input="\n".join(poses), text=True,
                          capture_output=True, check=True, timeout=110,
                          env=program.environment({"PEER_WAIT_S": str(wait), "PEER_COLD": "1" if cold else None,
                                                   "PEER_TOPICS": topics, "PEER_UNTIMED": "1" if untimed else None,
                                                   "PEER_CLOCKLESS": "1" if clockless else None}))
    return [json.loads(line) for line in done.stdout.splitlines()]
