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
