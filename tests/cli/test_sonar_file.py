"""A sonar from a file of its own: found beside the scene, overridden, blamed by its own lines, kept whole."""
import json
import os

import program
import tap
from program import Folder, asdic
from run_folder import data, facts

SONAR = """frequency_khz: 200
bandwidth_khz: 20
ping_rate_hz: 20
source_level_db: 200
bin_length_m: 1
receivers:
  - {name: left, yaw_deg: -20}
  - {name: right, yaw_deg: 20}
"""
SCENE = """version: 1
bottom: {{depth_m: 12, type: sand}}
sonar: {sonar}
mission: {{pose: {{position_m: [0, 0, 5]}}, pings: 2}}
sampling: {{rays: 500}}
"""


def write(folder, sonar="{file: sonars/pair.yaml}", text=SONAR):
    os.makedirs(folder / "sonars", exist_ok=True)
    folder.write("sonars/pair.yaml", text)
    return folder.write("own.yaml", SCENE.format(sonar=sonar))


def checked(path):
    return json.loads(asdic("check", path, "--json").check(code=0).out)[0]


def test_file_is_the_sonar():
    with Folder() as folder:
        apart = checked(write(folder))
        indented = "".join("\n  " + line for line in SONAR.splitlines())
        one = checked(write(folder, indented))
        for key in ("beams", "bins", "bin_length_m", "max_range_m", "absorption_db_per_km", "rays"):
            tap.equal(apart[key], one[key], key)
        tap.equal(apart["beams"], ["left", "right"])


def test_keys_beside_it_come_first():
    with Folder() as folder:
        scene = checked(write(folder, "{file: sonars/pair.yaml, bin_length_m: 0.5, receivers: [{name: bow}]}"))
        tap.equal((scene["beams"], scene["bin_length_m"]), (["bow"], 0.5))


def test_maps_beside_it_are_joined():
    """Key by key; and what the scene says instead of a part of the file takes that with it."""
    own = SONAR + "speckle: k\nspeckle_shape: 2\ntransmitter: {length_h_m: 0.2, length_v_m: 0.1}\n"
    array = "array: {elements: 8, shading: taylor, side_lobe_db: -35, beams: {count: 4, sector_deg: 40}}\n"
    with Folder() as folder:
        def levels(sonar, text=own):
            return asdic("expect", write(folder, sonar, text), "-o", "-").check(code=0).out
        file = "{file: sonars/pair.yaml"
        lines = (own.replace("transmitter: {", "transmitter: {pitch_deg: 9, ") + "noise: {enabled: false}\n").splitlines()
        written = levels("".join("\n  " + line for line in lines), "")
        tap.equal(levels(file + ", transmitter: {pitch_deg: 9}, noise: {enabled: false}}"), written)
        for more in ("speckle: none", "speckle: rayleigh", "speckle: k", "speckle: k, speckle_shape: 9"):
            checked(write(folder, f"{file}, {more}}}", own))
        tap.equal(checked(write(folder, f"{file}, {array.strip()}}}", own))["beams"], ["000", "001", "002", "003"])
        ahead = own[:own.index("receivers")] + array
        tap.equal(checked(write(folder, file + ", receivers: [{name: bow}]}", ahead))["beams"], ["bow"])
        for shading in ("none", "hann", "chebyshev"):
            checked(write(folder, f"{file}, array: {{shading: {shading}}}}}", ahead))


def test_errors_name_its_lines():
    with Folder() as folder:
        path = write(folder, "{file: sonars/pair.yaml, blanking_m: -1}",
                     SONAR.replace("20\nping", "2000\npimg"))
        err = asdic("check", path).check(code=3).err
        sonar = str(path).replace("own.yaml", "sonars/pair.yaml")
        tap.contains(err, f"{sonar}:2:16: error: 'bandwidth_khz' = 2000 is out of range [0.001, 1000] kHz")
        tap.contains(err, f"{sonar}:3:1: error: unknown key 'pimg_rate_hz'; did you mean 'ping_rate_hz'?  [sonar]")
        tap.contains(err, f"{path}:3:45: error: 'blanking_m' = -1")
        err = asdic("check", write(folder, text="frequency_khz: [1,\n")).check(code=3).err
        tap.contains(err, f"{sonar}:2:")
        err = asdic("check", write(folder, text="- 1\n")).check(code=3).err
        tap.contains(err, f"{sonar}:1:1: error: a sonar's file must hold keys of a scene's 'sonar'")
        err = asdic("check", write(folder, text="file: pair.yaml\n")).check(code=3).err
        tap.contains(err, "cannot name another 'file'")
        err = asdic("check", write(folder, text="frequency_khz: 100\n")).check(code=3).err
        tap.contains(err, f"{path}:3:8: error: missing key 'receivers'")
        err = asdic("check", write(folder, "{file: sonars/none.yaml}")).check(code=3).err
        tap.contains(err, f"{path}:3:15: error: ")
        tap.contains(err, "sonars/none.yaml")


def test_run_keeps_the_whole():
    """The folder can be drawn and scanned without the sonar's file; another sonar is another run."""
    program.need_device()
    with Folder() as folder:
        path = write(folder)
        asdic("run", path, "-o", folder / "r").check(code=0)
        whole = facts(folder, "r")["scene"]["text"]
        tap.contains(whole, "frequency_khz: 200")
        tap.equal("pair.yaml" in whole, False, whole)
        again = folder.write("again.yaml", whole)
        asdic("run", again, "-o", folder / "again").check(code=0)
        tap.equal(data(folder, "again", "bins.csv") == data(folder, "r", "bins.csv"), True, "bins")
        write(folder, text=SONAR.replace("source_level_db: 200", "source_level_db: 190"))
        done = asdic("run", path, "-o", folder / "r", "--resume").check(code=1)
        tap.contains(done.err, "another")
        asdic("render", folder / "r").check(code=0)


def test_detect_knows_the_scene_again():
    program.need_device()
    with Folder() as folder:
        scene = write(folder)
        with open(scene, "a", encoding="utf-8") as file:
            file.write("objects:\n  - {name: ball, sphere: {radius_m: 1}, position_m: [15, 0, 8],\n"
                       "     material: {impedance_mrayl: 45}}\n")
        asdic("run", scene, "-o", folder / "r").check(code=0)
        done = asdic("detect", folder / "r").check(code=0)
        tap.contains(done.out, "ball")
        tap.equal("have no names" in done.err, False, done.err)
        folder.write("sonars/pair.yaml", SONAR.replace("200\n", "210\n", 1))
        done = asdic("detect", folder / "r", "--force").check(code=0)
        tap.contains(done.err, "its objects have no names")


tap.main(globals())
