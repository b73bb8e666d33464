#!/usr/bin/env python3
"""Random scenes that nobody tuned anything on: boxes, pipes, spheres, steps, rough meshes, mixtures.

    random_scenes.py DIR [COUNT] [--first N]    writes DIR/random_000.yaml, ...

A number always gives the same scene; those from 600 on are of targets in mid-water, far from the bottom. Pass the
files to `asdic bench honest`.
"""
import argparse
import math
import os
import random

FIRST_TARGETS = 600
KINDS = ("box", "pipe", "sphere", "step", "mesh", "mixture")
MATERIALS = ("{type: rock}", "{type: sand}",
             "{impedance_mrayl: 45, roughness_rms_mm: 1, slope_rms: 0.1}",
             "{impedance_mrayl: 8, roughness_rms_mm: 3, slope_rms: 0.2}")
BOTTOMS = ("mud", "sand", "gravel", "rock")


def write_terrain(path, rng, depth_m, rough_m, cells=59, size_m=90.0):
    """A floor of waves of halving height and length, from behind the sonar to beyond its range."""
    waves = []
    for octave in range(1, 7):
        for _ in range(8):
            waves.append((0.35 * rough_m * 0.5 ** octave,
                          rng.uniform(-1, 1) * 2 ** octave * 0.5, rng.uniform(-1, 1) * 2 ** octave * 0.5,
                          rng.uniform(0, 2 * math.pi)))
    with open(path, "w", encoding="ascii") as file:
        file.write(f"OFF\n{(cells + 1) ** 2} {2 * cells ** 2} 0\n")
        for i in range(cells + 1):
            for j in range(cells + 1):
                u, v = 2 * math.pi * i / cells, 2 * math.pi * j / cells
                z = depth_m + sum(a * math.sin(p * u + q * v + s) for a, p, q, s in waves)
                file.write(f"{size_m * i / cells - 15:.4f} {size_m * (j / cells - 0.5):.4f} {z:.4f}\n")
        for i in range(cells):
            for j in range(cells):
                a = i * (cells + 1) + j
                b, c, d = a + 1, a + cells + 1, a + cells + 2
                file.write(f"3 {a} {b} {c}\n3 {b} {d} {c}\n")


class Scene:
    def __init__(self, number, folder):
        self.rng = random.Random(1000 + number)
        self.name = f"random_{number:03d}"
        self.folder = folder
        self.kind = "target" if number >= FIRST_TARGETS else KINDS[number % len(KINDS)]
        self.objects = []

    def between(self, low, high):
        return round(self.rng.uniform(low, high), 4)

    def add(self, name, shape, position, rotation):
        material = self.rng.choice(MATERIALS)
        x, y, z = position
        self.objects.append(f"  - {{name: {name}{len(self.objects)}, {shape}, position_m: [{x:.3f}, {y:.3f}, "
                            f"{z:.3f}], rotation_deg: [0, {rotation[0]}, {rotation[1]}], material: {material}}}")

    def add_box(self, big):
        if big:
            size = [self.between(4, 20), self.between(4, 40), self.between(1, min(4, self.depth - 1))]
        else:
            size = [self.between(0.4, 4), self.between(0.4, 6), self.between(0.3, 2)]
        x = self.between(12, 30) + size[0] / 2
        self.add("box", f"box: {{size_m: {size}}}",
                 (x, self.between(-10, 10), self.depth - size[2] / 2), (0, self.between(-60, 60)))

    def add_pipe(self):
        radius, length = self.between(0.1, 0.6), self.between(5, 40)
        self.add("pipe", f"cylinder: {{radius_m: {radius}, length_m: {length}}}",
                 (self.between(8, 28), self.between(-6, 6), self.depth - 0.9 * radius),
                 (90, self.between(0, 90)))

    def add_sphere(self):
        radius = self.between(0.15, 1.2)
        self.add("sphere", f"sphere: {{radius_m: {radius}}}",
                 (self.between(6, 32), self.between(-8, 8), self.between(1.5, self.depth - radius)), (0, 0))

    def add_target(self):
        shape = self.rng.choice((f"sphere: {{radius_m: {self.between(0.15, 3)}}}",
                                 f"box: {{size_m: {[self.between(0.5, 6) for _ in range(3)]}}}",
                                 f"cylinder: {{radius_m: {self.between(0.1, 0.6)}, length_m: {self.between(2, 30)}}}"))
        self.add("target", shape, (self.between(12, 45), self.between(-4, 4), self.between(5, 15)),
                 (self.between(-30, 30), self.between(-60, 60)))

    def build(self):
        rng = self.rng
        khz = rng.choice((60, 100, 120, 200, 300, 450))
        wavelength = 1.49 / khz
        self.depth = self.between(6, 14)
        sonar_z = self.between(2, self.depth - 2)
        bottom = f"{{depth_m: {self.depth}, type: {rng.choice(BOTTOMS)}}}"
        if self.kind == "target":
            bottom = f"{{depth_m: {self.between(30, 90)}, type: {rng.choice(BOTTOMS)}}}"
            sonar_z = self.between(3, 8)
            for _ in range(rng.randint(1, 3)):
                self.add_target()
        elif self.kind == "box":
            for _ in range(rng.randint(1, 5)):
                self.add_box(False)
        elif self.kind == "pipe":
            for _ in range(rng.randint(1, 3)):
                self.add_pipe()
        elif self.kind == "sphere":
            for _ in range(rng.randint(1, 6)):
                self.add_sphere()
        elif self.kind == "step":
            self.add_box(True)
        elif self.kind == "mixture":
            self.add_box(False)
            self.add_pipe()
            self.add_sphere()
            if rng.random() < 0.5:
                self.add_box(True)
        else:
            write_terrain(os.path.join(self.folder, self.name + ".off"), rng, self.depth, self.between(0.3, 2.5))
            bottom = f"{{mesh: {{file: {self.name}.off, z_up: false}}, type: {rng.choice(BOTTOMS)}}}"
            sonar_z = max(min(sonar_z, self.depth - 3.5), 0.5)
            if rng.random() < 0.5:
                self.add_sphere()
        return self.text(bottom, sonar_z, khz, wavelength)

    def text(self, bottom, sonar_z, khz, wavelength):
        def aperture(low, high):
            return round(self.between(low, high) * wavelength, 5)

        sides = f"length_h_m: {aperture(2, 12)}, length_v_m: {aperture(2, 12)}"
        receivers = [f"    - {{name: r{b}, pitch_deg: {self.between(-10, 25)}, yaw_deg: {self.between(-30, 30)}, {sides}}}"
                     for b in range(self.rng.choice((1, 2, 3, 4, 6)))]
        lines = ["version: 1", f"bottom: {bottom}"]
        if self.objects:
            lines += ["objects:"] + self.objects
        lines += ["sonar:", f"  frequency_khz: {khz}", "  bandwidth_khz: 10",
                  f"  ping_rate_hz: {self.rng.choice((15, 20, 25))}",
                  f"  bin_length_m: {self.rng.choice((0.1, 0.25, 0.25, 0.5))}",
                  f"  transmitter: {{pitch_deg: {self.between(0, 10)}, length_h_m: {aperture(2, 8)}, "
                  f"length_v_m: {aperture(2, 8)}}}",
                  "  receivers:"] + receivers
        lines += ["  noise: {enabled: false}",
                  f"mission: {{pose: {{position_m: [0, 0, {sonar_z}], roll_deg: {self.between(-10, 10)}, "
                  f"pitch_deg: {self.between(-8, 8)}}}, pings: 8}}",
                  f"sampling: {{rays: 20000, multipath: {self.rng.choice(('off', 'first'))}}}",
                  "model: {terms: all}", "output: {csv: none, images: []}"]
        return "\n".join(lines) + "\n"


def write(folder, number):
    """Writes scene NUMBER; its path."""
    scene = Scene(number, folder)
    path = os.path.join(folder, scene.name + ".yaml")
    text = scene.build()
    with open(path, "w", encoding="ascii") as file:
        file.write(text)
    return path


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder")
    parser.add_argument("count", type=int, nargs="?", default=30)
    parser.add_argument("--first", type=int, default=0)
    args = parser.parse_args()
    os.makedirs(args.folder, exist_ok=True)
    for number in range(args.first, args.first + args.count):
        print(write(args.folder, number))


if __name__ == "__main__":
    main()
