"""A vehicle swims north, 1 m above the sea floor of scenario 2, and climbs over the rise that it hears.
Prints its track: python3 avoid.py [ASDIC [SCENE.yaml]]"""
import json, subprocess, sys

asdic, scene = (sys.argv[1:] + ["asdic", "data/scenes/scenario2.yaml"][len(sys.argv) - 1:])[:2]
sonar = subprocess.Popen([asdic, "serve", "--expected", "--rays", "4096", scene], text=True,
                         stdin=subprocess.PIPE, stdout=subprocess.PIPE)
x_m, z_m, wanted_z_m, speed_mps, climb_mps, step_s = 0.0, 11.0, 11.0, 2.0, 0.5, 0.2
print("x_m,z_m,nearest_m")
while x_m < 60.0:
    print(json.dumps({"x_m": x_m, "y_m": 0, "z_m": z_m}), file=sonar.stdin, flush=True)
    ping = json.loads(sonar.stdout.readline())
    level_db, expected_db = ping["level_db"]["forward"], ping["expected_db"]["forward"]
    detected_m = [(n + 0.5) * ping["bin_length_m"] for n in range(4, 60)
                  if level_db[n] > expected_db[n] + 6]  # 6 dB above what the floor alone returns
    if detected_m and detected_m[0] < 20:
        wanted_z_m = 8.0
    print(f"{x_m:.1f},{z_m:.2f},{detected_m[0] if detected_m else ''}")
    x_m += speed_mps * step_s
    z_m += max(-climb_mps, min(climb_mps, wanted_z_m - z_m)) * step_s
sonar.stdin.close()
sys.exit(sonar.wait())
