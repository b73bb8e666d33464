"""A vehicle swims north, 1 m above the sea floor of scenario 2, and climbs over the rise that it hears.
Prints its track: python3 avoid.py [ASDIC [SCENE.yaml]]"""
import json, subprocess, sys

asdic, scene = (sys.argv[1:] + ["asdic", "data/scenes/scenario2.yaml"][len(sys.argv) - 1:])[:2]
sonar = subprocess.Popen([asdic, "serve", "--detect", "--rays", "4096", scene], text=True,
                         stdin=subprocess.PIPE, stdout=subprocess.PIPE)
x_m, z_m, wanted_z_m, speed_mps, climb_mps, step_s = 0.0, 11.0, 11.0, 2.0, 0.5, 0.2
print("x_m,z_m,nearest_m")
while x_m < 60.0:
    print(json.dumps({"x_m": x_m, "y_m": 0, "z_m": z_m}), file=sonar.stdin, flush=True)
    ping = json.loads(sonar.stdout.readline())
    ahead_m = [found["range_m"] for found in ping["detections"]
               if found["beam"] == "forward" and 2 < found["range_m"] < 30]
    if ahead_m and min(ahead_m) < 20:
        wanted_z_m = 8.0
    print(f"{x_m:.1f},{z_m:.2f},{min(ahead_m) if ahead_m else ''}")
    x_m += speed_mps * step_s
    z_m += max(-climb_mps, min(climb_mps, wanted_z_m - z_m)) * step_s
sonar.stdin.close()
sys.exit(sonar.wait())
