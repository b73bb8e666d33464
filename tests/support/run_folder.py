"""What tests of run folders share: a scene, and looking into what asdic wrote."""
import ast
import json
import os
import struct
import zlib

import tap

SCENE = """
version: 1
bottom: {{depth_m: 12, type: sand}}
objects:
  - name: ball
    sphere: {{radius_m: 1}}
    position_m: [20, 0, 6]
    material: {{impedance_mrayl: 45, roughness_rms_mm: 1, slope_rms: 0.1}}
sonar:
  frequency_khz: 100
  ping_rate_hz: 20
  source_level_db: 200
  bin_length_m: 1
  receivers:
{receivers}
mission: {{pose: {{position_m: [0, 0, 5]}}, pings: {pings}}}
sampling: {{rays: {rays}, seed: 7}}
output: {{npy: {npy}, images: [waterfall, ascope, fan]}}
"""
PAIR = "    - {name: forward}\n    - {name: down, pitch_deg: 45}"
HEADER = ("ping,time_s,beam,bin,range_m,level_db,bottom_db,surface_db,volume_db,object_db,"
          "multipath_db,noise_db,stderr_db")


def flip(path, at):
    """Damages the byte AT a place in a file; once more mends it."""
    with open(path, "r+b") as file:
        file.seek(at)
        byte = file.read(1)[0]
        file.seek(at)
        file.write(bytes([byte ^ 16]))


def scene(folder, pings=6, rays=2000, receivers=PAIR, npy="true"):
    return folder.write("pool.yaml", SCENE.format(pings=pings, rays=rays, receivers=receivers,
                                                  npy=npy))


def data(folder, run, name):
    with open(os.path.join(folder.path, run, name), "rb") as file:
        return file.read()


def facts(folder, run):
    return json.loads(data(folder, run, "run.json"))


def edit_facts(folder, run, old, new):
    """Changes run.json, and states the sum of its bytes anew."""
    text = data(folder, run, "run.json").decode()
    tap.contains(text, old)
    text = text.replace(old, new)
    body = text[:text.rindex('  "crc32"')]
    folder.write(os.path.join(run, "run.json"),
                 f'{body}  "crc32": "{zlib.crc32(body.encode()):08x}"\n}}\n')


def pictures(folder, run):
    return sorted(n for n in os.listdir(folder / run) if n.endswith(".png"))


def same(folder, a, b):
    """All files but run.json have the same bytes."""
    names = [n for n in sorted(os.listdir(folder / a)) if n != "run.json"]
    tap.equal([n for n in sorted(os.listdir(folder / b)) if n != "run.json"], names, f"files of {b}")
    for name in names:
        if data(folder, a, name) != data(folder, b, name):
            raise AssertionError(f"{a}/{name} and {b}/{name} differ")


def npy(content):
    """The header of an NPY file and what follows."""
    tap.equal(content[:8], b"\x93NUMPY\x01\x00", "magic")
    length = struct.unpack("<H", content[8:10])[0]
    tap.equal((10 + length) % 64, 0, "length of the header modulo 64")
    return ast.literal_eval(content[10:10 + length].decode()), content[10 + length:]


def png_texts(content):
    """Text chunks by keyword; checks every chunk's sum."""
    tap.equal(content[:8], b"\x89PNG\r\n\x1a\n", "signature")
    texts, at = {}, 8
    while at < len(content):
        length, kind = struct.unpack(">I4s", content[at:at + 8])
        body = content[at + 8:at + 8 + length]
        tap.equal(struct.unpack(">I", content[at + 8 + length:at + 12 + length])[0],
                  zlib.crc32(kind + body), "sum of a chunk")
        if kind == b"tEXt":
            key, value = body.split(b"\0", 1)
            texts[key.decode()] = value.decode("latin-1")
        elif kind == b"iTXt":
            key, rest = body.split(b"\0", 1)
            texts[key.decode()] = rest[2:].split(b"\0", 2)[2].decode()
        at += 12 + length
    return texts


def png_rows(data):
    """Rows of (r, g, b), of the kind of PNG that asdic and ffmpeg write."""
    at, packed, size = 8, b"", None
    while at < len(data):
        length, kind = struct.unpack_from(">I4s", data, at)
        if kind == b"IHDR":
            size = struct.unpack_from(">IIBB", data, at + 8)
        if kind == b"IDAT":
            packed += data[at + 8:at + 8 + length]
        at += 12 + length
    width, height, depth, colour = size
    tap.equal((depth, colour), (8, 2), "8-bit RGB")
    raw, rows, before, at = zlib.decompress(packed), [], bytes(3 * width), 0
    for _ in range(height):
        kind, line = raw[at], bytearray(raw[at + 1:at + 1 + 3 * width])
        at += 1 + 3 * width
        for i in range(3 * width if kind else 0):
            left = line[i - 3] if i >= 3 else 0
            up, corner = before[i], before[i - 3] if i >= 3 else 0
            if kind == 1:
                line[i] = (line[i] + left) & 255
            elif kind == 2:
                line[i] = (line[i] + up) & 255
            elif kind == 3:
                line[i] = (line[i] + (left + up) // 2) & 255
            elif kind == 4:
                p = left + up - corner
                best = min((abs(p - left), 0, left), (abs(p - up), 1, up), (abs(p - corner), 2, corner))
                line[i] = (line[i] + best[2]) & 255
        rows.append(bytes(line))
        before = bytes(line)
    return rows
