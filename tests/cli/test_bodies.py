"""Echoes of bodies at any attitude, half buried or free, beside a sum over their visible faces that nothing of asdic is
in but the absorption: laws, attitudes of body, vehicle and beams, faces, what the bottom covers."""
import csv
import json
import math

import tap
from program import Folder, asdic, need_device

C, DEPTH = 1500.0, 12.0


def attitude(roll, pitch, yaw):
    """Rows: body to world; yaw first, then pitch, then roll."""
    (r, p, y) = (math.radians(a) for a in (roll, pitch, yaw))
    cr, sr, cp, sp, cy, sy = math.cos(r), math.sin(r), math.cos(p), math.sin(p), math.cos(y), math.sin(y)
    return ((cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr),
            (sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr), (-sp, cp * sr, cp * cr))


def turned(m, v):
    return [sum(m[i][k] * v[k] for k in range(3)) for i in range(3)]


def turned_back(m, v):
    return [sum(m[k][i] * v[k] for k in range(3)) for i in range(3)]


def faces(shape, size, count=70):
    """(point, normal, area) over the surface, in the body's frame."""
    steps = [(i + 0.5) / count for i in range(count)]
    rounds = [2 * math.pi * (i + 0.5) / (2 * count) for i in range(2 * count)]
    if shape == "sphere":
        for u in steps:
            for a in rounds:
                s = math.sqrt(1 - (2 * u - 1) ** 2)
                n = (s * math.cos(a), s * math.sin(a), 2 * u - 1)
                yield [size * x for x in n], n, 2 * math.pi * size * size / count ** 2
    elif shape == "cylinder":
        radius, length = size
        for u in steps:
            for a in rounds:
                n = (math.cos(a), 0, math.sin(a))
                yield [radius * n[0], (u - 0.5) * length, radius * n[2]], n, math.pi * radius * length / count ** 2
                r = radius * math.sqrt(u)
                for side in (-1, 1):
                    yield ([r * math.cos(a), side * length / 2, r * math.sin(a)], (0, side, 0),
                           math.pi * radius * radius / (2 * count ** 2))
    else:
        for axis in range(3) if shape == "box" else [0]:
            b, c = (axis + 1) % 3, (axis + 2) % 3
            for side in (-1, 1):
                n = [0, 0, 0]
                n[axis] = side
                for u in steps:
                    for v in steps:
                        at = [side * s / 2 for s in size]
                        at[b], at[c] = (u - 0.5) * size[b], (v - 0.5) * size[c]
                        yield at, n, size[b] * size[c] / count ** 2


def strength(material, sine, wavelength, range_m):
    """Of a square metre; docs/model.md has the rough facet's."""
    if "lambert_db" in material:
        return 10 ** (0.1 * material["lambert_db"]) * sine ** 2
    water, solid = 1.025 * C / 1e3, material["impedance_mrayl"]
    k = 2 * math.pi / wavelength
    coherent = math.exp(-(2 * k * 1e-3 * material["roughness_rms_mm"] * sine) ** 2)
    area = material["coherent_area_m2"]
    zones = area / (wavelength * range_m)  # what the Fresnel integrals leave of the lobe of a flat area
    slope2 = material["slope_rms"] ** 2 + wavelength ** 2 * (1 - 2 * zones ** 2) / (4 * math.pi * area)
    lobe = math.exp(-(1 / sine ** 2 - 1) / slope2) / (4 * math.pi * slope2 * sine ** 4)
    return ((solid - water) / (solid + water)) ** 2 * (coherent * lobe + (1 - coherent) * sine ** 2 / math.pi)


def gain(v, beam, wavelength):
    if v[0] <= 0:
        return 0.0
    out = 1.0
    for side, along in ((beam["length_h_m"], v[1]), (beam["length_v_m"], v[2])):
        x = math.pi * side * along / wavelength
        out *= (math.sin(x) / x) ** 2 if x else 1.0
    return out


def echo_by_bin(scene, shape, size, alpha):
    """Sum over what is seen, by bins."""
    body, sonar, pose = scene["objects"][0], scene["sonar"], scene["mission"]["pose"]
    wavelength = C / (1e3 * sonar["frequency_khz"])
    own, vehicle = attitude(*body["rotation_deg"]), attitude(*(pose[k + "_deg"] for k in ("roll", "pitch", "yaw")))
    transmitter, receiver = sonar["transmitter"], sonar["receivers"][0]
    aim = attitude(receiver["roll_deg"], -receiver["pitch_deg"], receiver["yaw_deg"])  # a beam's pitch looks down
    bins = {}
    for point, normal, area in faces(shape, size):
        at = [a + b for a, b in zip(turned(own, point), body["position_m"])]
        away = [a - b for a, b in zip(at, pose["position_m"])]
        range_m = math.sqrt(sum(x * x for x in away))
        u = [x / range_m for x in away]
        sine = -sum(a * b for a, b in zip(turned(own, normal), u))
        if sine <= 0 or at[2] > DEPTH:
            continue
        v = turned_back(vehicle, u)
        both = gain(v, transmitter, wavelength) * gain(turned_back(aim, v), receiver, wavelength)
        loss = 10 ** (-0.2 * alpha * (range_m - 1) / 1000) / range_m ** 4
        n = int(range_m / sonar["bin_length_m"])
        bins[n] = bins.get(n, 0.0) + loss * both * strength(body["material"], sine, wavelength, range_m) * area
    return bins


ROUGH = {"impedance_mrayl": 8, "roughness_rms_mm": 1.2, "slope_rms": 0.5, "coherent_area_m2": 0.05}
DULL = {"lambert_db": -8}
FLAT = {"impedance_mrayl": 8, "roughness_rms_mm": 0.6, "slope_rms": 0.005, "coherent_area_m2": 0.05}
CASES = (("sphere", 1.1, ROUGH, [14, -2, 12.3], [10, 20, 30]),
         ("sphere", 0.7, DULL, [9, 1, 9], [0, 0, 0]),
         ("cylinder", (0.4, 4.5), DULL, [15, 3, 12], [25, 40, 70]),
         ("cylinder", (0.5, 1.2), ROUGH, [11, -1, 10], [-50, 65, 10]),
         ("box", (2.0, 1.0, 1.5), DULL, [13, -3, 12], [35, -20, 50]),
         ("plate", (0.0, 2.0, 1.5), ROUGH, [16, 1, 11.5], [30, 40, -25]),
         ("plate", (0.0, 1.0, 0.8), FLAT, [16.25, 0, 6], [10, 0.3, 0.2]))
KEYS = {"sphere": lambda size: {"radius_m": size},
        "cylinder": lambda size: {"radius_m": size[0], "length_m": size[1]},
        "box": lambda size: {"size_m": size}, "plate": lambda size: {"size_m": size[1:]}}


def scene_of(shape, size, material, position, rotation):
    return {
        "version": 1, "bottom": {"depth_m": DEPTH}, "surface": {"enabled": False},
        "environment": {"sound_speed_mps": C, "temperature_degc": 10, "salinity_ppt": 0, "max_depth_m": 10},
        "objects": [{"name": "body", shape: KEYS[shape](size), "position_m": position, "rotation_deg": rotation,
                     "material": material}],
        "sonar": {"frequency_khz": 100, "bandwidth_khz": 20, "max_range_m": 25, "bin_length_m": 0.5,
                  "ping_rate_hz": 20, "noise": {"enabled": False},
                  "transmitter": {"length_h_m": 0.02, "length_v_m": 0.02},
                  "receivers": [{"name": "a", "length_h_m": 0.03, "length_v_m": 0.02, "yaw_deg": 15, "pitch_deg": 12,
                                 "roll_deg": 35}]},
        "mission": {"pose": {"position_m": [0, 0, 6], "yaw_deg": -12, "pitch_deg": 9, "roll_deg": -20}},
        "sampling": {"rays": 40000, "multipath": "off"}, "model": {"terms": "all"}, "output": {"images": []}}


def test_a_body_is_as_loud_as_its_visible_faces():
    need_device()
    water = ("f_khz=100", "t_degc=10", "s_ppt=0", "z_m=10", "ph=8")
    alpha = float(asdic("model", "absorption", *water).check(0).out.split()[0])
    for shape, size, *rest in CASES:
        scene = scene_of(shape, size, *rest)
        with Folder() as folder:
            asdic("run", folder.write("body.yaml", json.dumps(scene)), "-o", folder / "out", "-q").check(0)
            with open(folder / "out/bins.csv", encoding="ascii") as file:
                found = {int(row["bin"]): 10 ** (0.1 * float(row["object_db"])) for row in csv.DictReader(file)
                         if row["object_db"]}
        right = echo_by_bin(scene, shape, size, alpha)
        off = [10 * math.log10(sum(found.values()) / sum(right.values()))]
        off += [10 * math.log10(found[n] / right[n]) for n in right if right[n] > 0.2 * max(right.values())]
        print(f"# {shape}: {off[0]:.3f} dB, bins", *(f"{x:.2f}" for x in off[1:]))
        tap.equal(abs(off[0]) < 0.05 and max(map(abs, off)) < 0.2, True, f"{shape} {rest[1:]}: {off}")


def test_a_crease_angle_tells_strips_from_a_curve():
    """A tube of twelve strips, one of them square on: its A / lambda against the tube's sqrt(R / 2 lambda) L (R. J. Urick,
    Principles of Underwater Sound, 1983, table 9.1), five times L^2 / lambda away."""
    need_device()
    radius, length, wavelength, heard = 0.2, 0.4, C / 100e3, []
    scene = scene_of("cylinder", (radius, length), {"impedance_mrayl": 45, "roughness_rms_mm": 0, "slope_rms": 0},
                     [50, 0, 6], [0, 15, 0])
    scene["objects"][0]["cylinder"]["segments"] = 12
    scene["sonar"] |= {"max_range_m": 52, "ping_rate_hz": 10, "receivers": [
        {"name": "a", "length_h_m": 0.03, "length_v_m": 0.02}]}
    scene["mission"]["pose"] = {"position_m": [0, 0, 6]}
    for crease in (0, 29, 31, 90):
        scene["objects"][0]["crease_deg"] = crease
        with Folder() as folder:
            asdic("run", folder.write("body.yaml", json.dumps(scene)), "-o", folder / "out", "-q").check(0)
            with open(folder / "out/bins.csv", encoding="ascii") as file:
                heard.append(10 * math.log10(sum(10 ** (0.1 * float(row["object_db"])) for row in csv.DictReader(file)
                                                 if row["object_db"])))
    strip = 20 * math.log10(2 * radius * math.sin(math.pi / 12) * length / wavelength)
    tube = 10 * math.log10(radius * length ** 2 / (2 * wavelength))
    off = [heard[0] - heard[3] - (strip - tube), heard[1] - heard[0], heard[2] - heard[3]]
    print("# off by", *(f"{x:.2f}" for x in off), "dB of", f"{strip - tube:.2f}")
    tap.equal(max(map(abs, off)) < 0.5, True, f"{heard}")
    scene["objects"][0] = {"name": "body", "point": 0, "position_m": [50, 0, 6], "crease_deg": 20}
    with Folder() as folder:
        said = asdic("check", folder.write("body.yaml", json.dumps(scene)))
        tap.equal("'crease_deg' has no effect on a point" in said.err + said.out, True, said.err)


tap.main(globals())
