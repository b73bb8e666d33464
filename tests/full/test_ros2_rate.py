"""512 beams in ROS 2: pings a second, and how long from a pose to its picture, between two vendors' DDS."""
import tap
from program import Folder
from ros2 import Server, need, peer

SCENE = """version: 1
bottom: {depth_m: 12, type: sand}
objects:
  - {name: ball, sphere: {radius_m: 0.5}, position_m: [15, 1, 9], material: {impedance_mrayl: 45}}
sonar:
  frequency_khz: 750
  bandwidth_khz: 50
  ping_rate_hz: 10
  source_level_db: 200
  bin_length_m: 0.1
  max_range_m: 30
  speckle: rayleigh
  receivers:
    fan: {count: 512, sector_deg: 120, length_h_m: 0.1, length_v_m: 0.005}
  transmitter: {length_h_m: 0.002, length_v_m: 0.005}
mission: {pose: {position_m: [0, 0, 7]}}
sampling: {rays: 32768}
"""
POSES = [f"0 {0.05 * i:.2f} -7 0 0 0.7071067811865476 0.7071067811865476" for i in range(200)]


def test_ten_pings_a_second():
    need()
    with Folder() as folder:
        with Server(folder, SCENE) as server:
            peer(server, folder, POSES[:2])  # kernels are compiled
            found = {m["summary"]: m for m in peer(server, folder, POSES, hz=10)}
        for topic in ("sonar", "image"):
            print(f"# {topic}: {found[topic]['per_s']:.2f} pings a second, median "
                  f"{found[topic]['median_ms']:.1f} ms, p99 {found[topic]['p99_ms']:.1f} ms")
        tap.equal(found["image"]["pings"] >= 198, True, f"{found['image']}")


tap.main(globals())
