"""asdic dataset: labelled frames, whole, repeatable, resumed and shared out; masks against rays that this file
casts itself; read back by numpy, PIL and json, and by the package that Roboflow imports annotations with."""
import fcntl
import json
import os
import re
import shutil

import node
import program
import tap
from foreign import numpy
from program import Folder, asdic

SCENE = """version: 1
bottom: {depth_m: 10, lambert_db: -30}
objects:
  - {name: ball, sphere: {radius_m: 1.2, segments: SEGMENTS}, position_m: [9, 0, 8.8], material: {lambert_db: -8}}
  - {name: post, sphere: {radius_m: 0.8, segments: SEGMENTS}, position_m: [6, 1, 9.2], material: {lambert_db: -8}}
sonar:
  frequency_khz: 300
  bandwidth_khz: 20
  ping_rate_hz: 40
  max_range_m: 14
  source_level_db: 220
  bin_length_m: 0.1
  blanking_m: 0.5
  transmitter: {length_h_m: 0.004, length_v_m: 0.01}
  receivers: {fan: {count: 48, sector_deg: 60, length_h_m: 0.1, length_v_m: 0.01}}
  noise: {enabled: false}
surface: {enabled: false}
mission: {pose: {position_m: [0, 0, 6], pitch_deg: -20}}
sampling: {rays: RAYS, seed: 3, multipath: false}
trial:
  draws:
    - {key: 'objects[0].position_m[1]', uniform: [-2, 2]}
    - {key: 'objects[1].position_m[1]', uniform: [-2, 2]}
    - {key: mission.pose.yaw_deg, uniform: [-5, 5]}
"""


def scene(folder, rays=4000, segments=32, **edits):
    text = SCENE.replace("RAYS", str(rays)).replace("SEGMENTS", str(segments))
    for old, new in edits.values():
        tap.contains(text, old)
        text = text.replace(old, new)
    return folder.write("set.yaml", text)


def files(folder):
    found = {}
    for root, _, names in os.walk(folder):
        for name in names:
            path = os.path.join(root, name)
            with open(path, "rb") as file:
                found[os.path.relpath(path, folder)] = file.read()
    return found


def says(done, code, part):
    """DONE failed with CODE and an error that has PART."""
    tap.equal(done.code, code, f"exit code ({done.err.strip()!r})")
    tap.contains(done.err, part)
    return done


def test_the_same_bytes_whole_resumed_and_in_parts():
    program.need_device()
    with Folder() as folder:
        path = scene(folder)
        asdic("dataset", path, "-n", "5", "-o", folder / "whole").check(code=0)
        whole = files(folder / "whole")
        tap.equal(len([n for n in whole if n.startswith("polar/masks/")]), 5, "masks")
        for k in (1, 2):
            asdic("dataset", path, "-n", "5", "--shard", f"{k}/2", "-o", folder / f"p{k}").check(code=0)
        asdic("merge", folder / "p2", folder / "p1", "-o", folder / "merged").check(code=0)
        tap.equal(files(folder / "merged") == whole, True, "parts joined are the whole")
        for name in ("frames/000003.txt", "manifest.jsonl", "polar/annotations.json"):
            os.remove(folder / ("whole/" + name))
        says(asdic("dataset", path, "-n", "5", "-o", folder / "whole"), 1, "--resume")
        asdic("dataset", path, "-n", "5", "-o", folder / "whole", "--resume").check(code=0)
        tap.equal(files(folder / "whole") == whole, True, "resumed is the whole")
        says(asdic("dataset", path, "-n", "5", "--seed", "2", "-o", folder / "whole",
              "--resume"), 1, "cannot be resumed")
        for count in (2, 3, 5):
            asdic("dataset", path, "-n", count, "-o", folder / "grown", "--resume").check(code=0)
            tap.equal(len(files(folder / "grown")["manifest.jsonl"].splitlines()), count, "frames that are told of")
        tap.equal(files(folder / "grown") == whole, True, "a set that has grown is the whole")
        says(asdic("dataset", path, "-n", 4, "-o", folder / "grown", "--resume"), 1, "holds 5 frames; --resume")
        for name, shard, frames in ("grown", "1/2", "frame 2, which is not of the part to be resumed, frames 0 to 1"), (
                "p1", "2/2", "frame 0, which is not of the part to be resumed, frames 2 to 4"):
            before = files(folder / name)
            says(asdic("dataset", path, "-n", 5, "--shard", shard, "-o", folder / name, "--resume"), 1,
                 f"{name}' holds {frames}; resume it with its own --shard, or give another folder")
            tap.equal(files(folder / name) == before, True, "what another part's resume leaves")
        asdic("dataset", path, "-n", 6, "--shard", "1/2", "-o", folder / "p1", "--resume").check(code=0)
        says(asdic("merge", folder / "p1", folder / "p2", "-o", folder / "m2"), 3, "different data sets")
        asdic("dataset", path, "-n", 5, "--shard", "1/2", "-o", folder / "p1", "--force").check(code=0)
        asdic("dataset", path, "-n", "4", "--seed", "2", "-o", folder / "whole", "--force").check(code=0)
        other = files(folder / "whole")
        tap.equal(len([n for n in other if n.startswith("levels/")]), 4, "frames that replaced five")
        tap.equal(other["levels/000000.npy"] == whole["levels/000000.npy"], False, "another seed")
        part = files(folder / "p1")
        says(asdic("merge", folder / "p1", folder / "p2", "-o", folder / "p1/.", "--force"), 2, "one of the parts")
        tap.equal(files(folder / "p1") == part, True, "a part that the result would replace stays")
        os.rename(folder / "p1/polar/masks/000001.png", folder / "mask.png")
        says(asdic("merge", folder / "p2", folder / "p1", "-o", folder / "merged", "--force"), 3,
             "p1/polar/masks/000001.png: cannot open")
        os.remove(folder / "p1/frames/000001.txt")
        says(asdic("merge", folder / "p2", folder / "p1", "-o", folder / "m2"), 3, "frame 1 is in none of the parts")
        says(asdic("merge", folder / "p2", folder / "p1", "-o", folder / "merged", "--force"), 3, "frame 1 is in none")
        tap.equal(sorted(files(folder / "merged")), sorted(whole), "a joined set stays where parts lack a frame")


def test_no_two_processes_make_one_set():
    program.need_device()
    with Folder() as folder:
        make = ("dataset", scene(folder, rays=500), "-n", "2", "--radius", "32")
        asdic(*make, "-o", folder / "d").check(code=0)
        whole = files(folder / "d")
        held = os.open(folder / "d", os.O_RDONLY)
        fcntl.flock(held, fcntl.LOCK_EX)  # as a process that writes there has it
        for command in ((*make, "-n", "3", "--resume"), (*make, "--seed", "2", "--force"),
                        ("merge", folder / "d", "--force")):
            into = folder / ("d" if command[0] == "dataset" else "m")
            if command[0] == "merge":
                os.mkdir(into)
                os.close(held)
                held = os.open(into, os.O_RDONLY)
                fcntl.flock(held, fcntl.LOCK_EX)
            says(asdic(*command, "-o", into), 1, f"another process is writing to '{into}' just now; wait for it, or")
        os.close(held)
        tap.equal((files(folder / "d") == whole, os.listdir(folder / "m")), (True, []), "nothing is changed")
        asdic("merge", folder / "d", "--force", "-o", folder / "m").check(code=0)
        tap.equal(files(folder / "m") == whole, True, "once it is free")


def test_frames_that_are_not_whole_are_made_again():
    """Each frame lacks another of its files, or has it shorter."""
    program.need_device()
    kinds = ["frames", "levels"] + [f"{form}/{kind}" for form in ("bearing", "polar")
                                    for kind in ("images", "images16", "labels", "masks")]
    with Folder() as folder:
        make = ("dataset", scene(folder, rays=500), "-n", 3 * len(kinds), "--radius", "32", "-o", folder / "d")
        asdic(*make).check(code=0)
        whole = files(folder / "d")
        for k, name in enumerate(3 * kinds):
            path = next(folder / ("d/" + n) for n in whole if n.startswith(f"{name}/{k:06d}."))
            size = (None, 1, 100)[k // len(kinds)]
            if size is None:
                os.remove(path)
            else:
                os.truncate(path, min(size, os.path.getsize(path) - 1))
        says(asdic("merge", folder / "d", "-o", folder / "m"), 3, "frame 0 is in none of the parts")
        asdic(*make, "--resume").check(code=0)
        tap.equal(files(folder / "d") == whole, True, "the whole")
        for damage, why in ((os.remove, "levels/000001.npy: cannot open"),
                            (lambda path: os.truncate(path, 100), f"frame 1 in '{folder / 'd'}' is damaged: its files "
                             "have not the sizes that its record says; --resume makes it again")):
            damage(folder / "d/levels/000001.npy")
            says(asdic("merge", folder / "d", "-o", folder / "m"), 3, why)
            asdic(*make, "--resume").check(code=0)
        # Records of older sets do not say how large the files are.
        first, rest = whole["frames/000001.txt"].split(b"\n", 1)
        tap.equal((first[:1], rest[:1]), (b"S", b"M"), "lines of a record")
        folder.write("d/frames/000001.txt", rest.decode())
        asdic("merge", folder / "d", "-o", folder / "m").check(code=0)
        tap.equal(files(folder / "m") == {**whole, "frames/000001.txt": rest}, True, "an older part is joined")
        asdic(*make, "--resume").check(code=0)
        tap.equal(files(folder / "d") == files(folder / "m"), True, "an older set goes on")
        os.remove(folder / "d/levels/000001.npy")
        asdic(*make, "--resume").check(code=0)
        tap.equal(files(folder / "d") == whole, True, "and has what it lacked")


def test_frames_of_no_set_are_made_again():
    """What joining parts left on a full disk, and frames whose dataset.json is gone."""
    program.need_device()
    with Folder() as folder:
        path = scene(folder, rays=500)
        make = ("dataset", path, "-n", "3", "--radius", "32")
        asdic(*make, "-o", folder / "d").check(code=0)
        asdic(*make, "--seed", "2", "-o", folder / "other").check(code=0)
        whole, other = files(folder / "d"), files(folder / "other")
        if os.path.exists("/dev/full"):
            os.makedirs(folder / "m/levels")
            os.symlink("/dev/full", folder / "m/levels/000001.npy")  # after frame 0
            says(asdic("merge", folder / "d", "-o", folder / "m"), 1, "No space left")
            os.remove(folder / "m/levels/000001.npy")
            says(asdic(*make, "--seed", "2", "-o", folder / "m", "--resume"), 1, "cannot be resumed")
            asdic(*make, "-o", folder / "m", "--resume").check(code=0)
            tap.equal(files(folder / "m") == whole, True, "the whole")
        for resume in ([], ["--resume"]):
            shutil.copytree(folder / "d", folder / "e")
            os.remove(folder / "e/dataset.json")
            asdic(*make, "--seed", "2", "-o", folder / "e", *resume).check(code=0)
            tap.equal(files(folder / "e") == other, True, "another seed's frames")
            shutil.rmtree(folder / "e")
        shutil.copytree(folder / "d", folder / "e")
        folder.write("e/dataset.json", whole["dataset.json"].decode().replace('"frames":3', '"frames":3' + 15 * "0"))
        says(asdic("merge", folder / "e", "-o", folder / "n"), 3, "does not say how many frames")
        asdic(*make, "--seed", "2", "-o", folder / "e", "--force").check(code=0)
        tap.equal(files(folder / "e") == other, True, "frames in place of those of a number that nobody made")


def test_no_frame_is_made_of_a_set_that_cannot_be_drawn():
    """A misspelt key, a file that is not there, or the tail of a later frame, is told before the first."""
    program.need_device()
    with Folder() as folder:
        for draw, words in (("{key: misson.pose.yaw_deg, uniform: [-5, 5]}", "unknown key 'misson'; did you mean 'mission'?"),
                            ("{key: bottom, choice: [" + 9 * "{depth_m: 10}, " + "{mesh: no.ply}]}",
                             "no.ply: cannot open: No such file or directory  [bottom.mesh.file]\nerror: "),
                            ("{key: environment.ph, normal: [7.8, 0.2]}", " with seed 1; keep what is drawn to what a")):
            path = scene(folder, a=("{key: mission.pose.yaw_deg, uniform: [-5, 5]}", draw))
            done = asdic("dataset", path, "-n", 3000, "-o", folder / "d").check(code=3)
            tap.contains(done.err, words)
            tap.equal(os.path.exists(folder / "d"), False, "made before the error")


def test_frames_of_other_depths_are_the_same_in_parts():
    """Sound is faster at depth: bins, automatic rays, speckle and one layer's fit hang on the sonar's depth, and frames
    of other depths share a scene."""
    program.need_device()
    with Folder() as folder:
        for water in ("", "environment: {sound_speed_gradient_per_s: 0.02}\nmodel: {refraction: layer}\n"):
            path = scene(folder, a=("source_level_db", "speckle: rayleigh\n  source_level_db"),
                         b=("  max_range_m: 14\n", ""), c=("rays: 4000", "rays: auto"), d=("count: 48", "count: 4"),
                         e=("depth_m: 10,", "depth_m: 910, type: sand}\n#"), f=("surface:", water + "surface:"),
                         g=("{key: mission.pose.yaw_deg, uniform: [-5, 5]}",
                            "{key: 'mission.pose.position_m[2]', uniform: [6, 900]}\n"
                            "    - {key: bottom.type, choice: [mud, sand, gravel]}"))
            make = ("dataset", path, "-n", "6", "--radius", "32", "-o", folder / "d")
            asdic(*make, "--force").check(code=0)
            whole = files(folder / "d")
            for k in (3, 4, 5):  # the last one's scene is then built by another frame
                os.remove(folder / f"d/frames/{k:06d}.txt")
            asdic(*make, "--resume").check(code=0)
            tap.equal(files(folder / "d") == whole, True, "resumed is the whole")
            shapes = {len(whole[f"levels/{k:06d}.npy"]) for k in range(6)}
            tap.equal(len(shapes), 1, "shapes")


def test_frames_may_have_other_numbers_of_bins():
    """More frames than are under way at once, each as long as its own range."""
    program.need_device()
    with Folder() as folder:
        path = scene(folder, rays=500, segments=16, a=("count: 48", "count: 4"),
                     b=("{key: mission.pose.yaw_deg, uniform: [-5, 5]}", "{key: sonar.max_range_m, uniform: [10, 14]}"))
        asdic("dataset", path, "-n", "8", "--radius", "32", "-o", folder / "d").check(code=0)
        frames = [json.loads(line) for line in folder.read("d/manifest.jsonl").splitlines()]
        numpy(f"""import numpy as np
for k, range_m in enumerate({[float(f["drawn"]["sonar.max_range_m"]) for f in frames]}):
    bins = np.load(f"d/levels/{{k:06d}}.npy").shape[-1]
    assert abs(bins - range_m / 0.1) <= 1, (k, bins, range_m)
""", folder / ".")


def test_an_array_is_of_one_size_in_all_depths():
    """Frames of one wind share a scene, at depths that sound speeds differ between by 5 m/s, or by 155 m/s in a
    gradient."""
    program.need_device()
    with Folder() as folder:
        for water in ("", "sound_speed_gradient_per_s: -0.5, "):
            path = scene(folder, a=("surface: {enabled: false}\n", f"environment: {{{water}wind_speed_kn: 5}}\n"),
                         b=("receivers: {fan: {count: 48, sector_deg: 60, length_h_m: 0.1, length_v_m: 0.01}}",
                            "array: {elements: 32, element: {length_v_m: 0.01}, beams: {count: 8, sector_deg: 90}}"),
                         c=("depth_m: 10,", "depth_m: 320,"), d=("[9, 0, 8.8]", "[9, 0, 318.8]"),
                         e=("{key: mission.pose.yaw_deg, uniform: [-5, 5]}",
                            "{key: 'mission.pose.position_m[2]', uniform: [5, 315]}\n"
                            "    - {key: environment.wind_speed_kn, choice: [5, 10]}"))
            make = ("dataset", path, "-n", 6, "--radius", 32)
            asdic(*make, "-o", folder / "d", "--force").check(code=0)
            whole = files(folder / "d")
            for k in (1, 2):
                asdic(*make, "--shard", f"{k}/2", "-o", folder / f"p{k}", "--force").check(code=0)
            asdic("merge", folder / "p1", folder / "p2", "-o", folder / "m", "--force").check(code=0)
            tap.equal(files(folder / "m") == whole, True, "parts joined are the whole")
            os.remove(folder / "d/frames/000004.txt")
            os.remove(folder / "d/frames/000005.txt")
            asdic(*make, "-o", folder / "d", "--resume").check(code=0)
            tap.equal(files(folder / "d") == whole, True, "resumed is the whole")


def test_frames_in_layers_of_water():
    """There nothing moves, so that each frame is of a scene of its own. Layers that hardly differ show the objects
    where one layer does."""
    program.need_device()
    with Folder() as folder:
        for name, water in ("one", "sound_speed_mps: 1500"), ("layers", "sound_speed_profile: [[0, 1500], [5, 1500.01]]"):
            path = scene(folder, rays=2000, a=("surface:", f"environment: {{{water}}}\nsurface:"))
            asdic("dataset", path, "-n", "2", "--radius", "64", "-o", folder / name).check(code=0)
        numpy("""
import numpy as np
from PIL import Image
for k in range(2):
    one, layers = (np.array(Image.open(f"{name}/polar/masks/{k:06d}.png")) for name in ("one", "layers"))
    shown = (one > 0) | (layers > 0)
    assert set(one[shown]) >= {1, 2} and (one != layers).sum() < 0.2 * shown.sum(), (k, (one != layers).sum(), shown.sum())
""", folder / ".", "PIL")


def test_labels_say_what_masks_show():
    program.need_device()
    with Folder() as folder:
        asdic("dataset", scene(folder), "-n", "3", "-o", folder / "d").check(code=0)
        set_ = json.loads(folder.read("d/dataset.json"))
        tap.equal(set_["classes"], ["ball", "post"], "classes")
        tap.equal(folder.read("d/classes.txt"), "ball\npost\n", "classes.txt")
        lines = [json.loads(line) for line in folder.read("d/manifest.jsonl").splitlines()]
        tap.equal([line["frame"] for line in lines], [0, 1, 2], "frames")
        tap.equal(len({line["scene_sha256"] for line in lines}), 3, "scenes")
        tap.equal(sorted(lines[0]["drawn"]), sorted(
            ["objects[0].position_m[1]", "objects[1].position_m[1]", "mission.pose.yaw_deg"]), "drawn")
        numpy("""
import json, numpy as np
from PIL import Image, ImageDraw
for form in ("polar", "bearing"):
    coco = json.load(open(f"d/{form}/annotations.json"))
    assert [c["name"] for c in coco["categories"]] == ["ball", "post"]
    assert len({a["id"] for a in coco["annotations"]}) == len(coco["annotations"]) >= 4
    for image in coco["images"]:
        picture = Image.open(f"d/{form}/" + image["file_name"])
        assert picture.mode == "L" and picture.size == (image["width"], image["height"])
        deep = np.array(Image.open(f"d/{form}/" + image["file_name"].replace("images", "images16"))).astype(int)
        flat = np.array(picture).astype(int)
        assert ((deep == 0) == (flat == 0)).all() and deep.max() > 30000
        shown = deep > 0  # as far up the window, within half a step of 254
        assert abs((deep[shown] - 1) / 65534 - (flat[shown] - 1) / 254).max() <= 0.50001 / 254
        name = image["file_name"].replace("images/", "")[:-4]
        mask = np.array(Image.open(f"d/{form}/masks/{name}.png"))
        drawn = np.zeros_like(mask)
        yolo = open(f"d/{form}/labels/{name}.txt").read().split("\\n")[:-1]
        own = [a for a in coco["annotations"] if a["image_id"] == image["id"]]
        assert len(yolo) == len(own)
        for line, a in zip(yolo, own):
            k = a["category_id"]
            y, x = np.nonzero(mask == k)
            box = [x.min(), y.min(), x.max() + 1 - x.min(), y.max() + 1 - y.min()]
            assert a["area"] == len(x) and a["bbox"] == box, (a["bbox"], box)
            c, cx, cy, w, h = map(float, line.split())
            assert c == k - 1
            got = [(cx - w / 2) * image["width"], (cy - h / 2) * image["height"],
                   w * image["width"], h * image["height"]]
            assert max(abs(p - q) for p, q in zip(got, box)) < 0.01
            # Even-odd, at the pixels' centres.
            inside = np.zeros(mask.shape, int)
            v, u = np.mgrid[0:mask.shape[0], 0:mask.shape[1]] + 0.5
            hit = np.zeros(mask.shape, bool)
            for polygon in a["segmentation"]:
                p = np.array(polygon, float).reshape(-1, 2)
                odd = np.zeros(mask.shape, bool)
                for (x0, y0), (x1, y1) in zip(p, np.roll(p, -1, 0)):
                    if y0 != y1:
                        odd ^= (np.minimum(y0, y1) <= v) & (v < np.maximum(y0, y1)) & (u < x0)
                hit |= odd
            assert (hit >= (mask == k)).all()
            assert hit.sum() - (mask == k).sum() <= 0.02 * hit.sum() + 2  # holes alone
    if form == "bearing":
        levels = np.load("d/levels/000001.npy")
        picture = np.array(Image.open("d/bearing/images16/000001.png"))
        assert levels.shape == (48, 140) and picture.shape == (140, 48)
        assert ((picture.T[:, ::-1] == 0) == np.isnan(levels)).all()
""", folder / ".", "PIL")


def test_a_fan_may_be_listed_from_starboard():
    """Its pictures and masks have port on the left all the same, and its levels keep the order of the scene."""
    program.need_device()
    with Folder() as folder:
        beams = ", ".join(f"{{yaw_deg: {29.375 - 1.25 * k}, length_h_m: 0.1, length_v_m: 0.01}}" for k in range(48))
        path = scene(folder, a=("{fan: {count: 48, sector_deg: 60, length_h_m: 0.1, length_v_m: 0.01}}", f"[{beams}]"),
                     b=("objects[0].position_m[1]', uniform: [-2, 2]", "objects[0].position_m[1]', uniform: [1, 2]"),
                     c=("objects[1].position_m[1]', uniform: [-2, 2]", "objects[1].position_m[1]', uniform: [-2, -1]"))
        asdic("dataset", path, "-n", "2", "-o", folder / "d").check(code=0)
        numpy("""
import numpy as np
from PIL import Image
for frame in ("000000", "000001"):
    for form in ("polar", "bearing"):
        mask, grey = (np.array(Image.open(f"d/{form}/{sub}/{frame}.png")).astype(int) for sub in ("masks", "images16"))
        ball, post = (np.argmax((grey * (mask == k)).max(axis=0)) for k in (1, 2))  # the column of its loudest bin
        assert post < 0.48 * mask.shape[1] and ball > 0.52 * mask.shape[1], (form, post, ball, mask.shape)
    from_port = np.load(f"d/levels/{frame}.npy")[::-1]
    grey = np.array(Image.open(f"d/bearing/images16/{frame}.png")).T[:, ::-1].astype(int)
    assert from_port.shape == grey.shape == (48, 140) and ((grey == 0) == np.isnan(from_port)).all()
    for column in range(140):  # the gain hangs on the range alone: a louder beam is brighter
        heard = grey[:, column] > 0
        assert (np.diff(grey[heard, column][np.argsort(from_port[heard, column])]) >= 0).all(), column
    assert len(np.unique(grey)) > 1000
""", folder / ".", "PIL")


def test_pictures_are_levels_in_their_window():
    """Greys from the levels by what docs/dataset.md says of gain, window and places; the window from frame 0."""
    program.need_device()
    with Folder() as folder:
        asdic("dataset", scene(folder), "-n", "2", "--radius", "200", "-o", folder / "d").check(code=0)
        said = asdic("model", "absorption", "t_degc=10", "s_ppt=35", "z_m=6", "ph=8", "f_khz=300").check(code=0).out
        alpha = float(re.search(r"[-+.0-9e]+(?= dB/km)", said)[0])
        numpy(f"""
import json, numpy as np
from PIL import Image
set_ = json.load(open("d/dataset.json"))
low, high = set_["low_db"], set_["high_db"]
range_m = (np.arange(140) + 0.5) * 0.1
shown = [np.load(f"d/levels/00000{{k}}.npy").astype(float) + 30 * np.log10(range_m) + 2 * {alpha} * range_m / 1000
         for k in (0, 1)]
ordered = np.sort(shown[0][np.isfinite(shown[0])])
n = len(ordered)
assert low == 10 * np.floor(ordered[n // 20] / 10), (low, ordered[n // 20])
assert high == max(10 * np.ceil(ordered[n * 995 // 1000] / 10), low + 30), (high, ordered[n * 995 // 1000])
grey = np.where(np.isnan(shown[1]), 0, 1 + 65534 * np.clip((shown[1] - low) / (high - low), 0, 1))
picture = np.array(Image.open("d/bearing/images16/000001.png")).astype(int)
assert abs(picture - grey.T[::-1]).max() < 1.5, abs(picture - grey.T[::-1]).max()
polar = np.array(Image.open("d/polar/images16/000001.png")).astype(int)
assert polar.shape == (200, 200), polar.shape  # sin 30 degrees to either side
v, u = np.mgrid[0:200, 0:200] + 0.5
r, bearing = np.hypot(200 - v, u - 100) / 200 * 140, np.degrees(np.arctan2(u - 100, 200 - v))
inside = (r < 140) & (abs(bearing) < 30)
clear = (abs(r % 1 - 0.5) < 0.45) & (abs((bearing + 30) / 1.25 % 1 - 0.5) < 0.45)  # of rounding
wanted = np.where(inside, grey[np.clip((bearing + 30) / 1.25, 0, 47).astype(int), np.clip(r, 0, 139).astype(int)], 0)
assert clear.sum() > 20000 and abs(polar - wanted)[clear].max() < 1.5, abs(polar - wanted)[clear].max()
""", folder / ".", "PIL")


def test_a_name_keeps_its_class():
    """Where the ball is left out, or another object takes its place, the post stays "post" in labels and masks."""
    program.need_device()
    ball = "sphere: {radius_m: 1.2}, position_m: [9, 0, 8.8], material: {lambert_db: -8}}"
    with Folder() as folder:
        path = scene(folder, a=("{key: 'objects[0].position_m[1]', uniform: [-2, 2]}",
                                "{key: 'objects[0]', choice: [none, {name: buoy, " + ball +
                                ", {name: {choice: [ball, buoy]}, " + ball + "]}"))
        asdic("dataset", path, "-n", "6", "-o", folder / "d").check(code=0)
        classes = folder.read("d/classes.txt").split()
        tap.equal(classes, ["buoy", "ball", "post"], "the names of any frame, in the file's order")
        coco = json.loads(folder.read("d/polar/annotations.json"))
        tap.equal([c["name"] for c in coco["categories"]], classes, "categories")
        seen = set()
        for k, line in enumerate(folder.read("d/manifest.jsonl").splitlines()):
            objects = json.loads(line)["objects"]
            names = [o["name"] for o in objects]
            tap.equal([classes[o["number"] - 1] for o in objects], names, "numbers")
            labels = folder.read(f"d/polar/labels/{k:06d}.txt").splitlines()
            tap.equal([classes[int(label.split()[0])] for label in labels], names, "YOLO's classes")
            own = [a["category_id"] for a in coco["annotations"] if a["image_id"] == k]
            tap.equal([classes[c - 1] for c in own], names, "COCO's categories")
            mask = numpy(f"""import numpy as np
from PIL import Image
print(*np.unique(np.array(Image.open('d/polar/masks/{k:06d}.png'))))""", folder / ".", "PIL")
            tap.equal([classes[int(c) - 1] for c in mask.split()[1:]], names, "the mask's numbers")
            seen.add(names[0])
        tap.equal(seen, {"ball", "buoy", "post"}, "frames of all kinds")
        unnamed = scene(folder, a=("{name: ball,", "{name: 7,"),
                        b=("objects[0].position_m[1]', uniform: [-2, 2]", "objects[0].name', uniform: [1, 2]"))
        says(asdic("dataset", unnamed, "-n", "2", "-o", folder / "e"), 3, "draw it by 'choice'")


def test_others_read_the_same():
    """Names, boxes and polygons as Roboflow's reader has them, against the pixels of the masks. It makes one hull
    of an object's parts: polygons are compared where there is one part."""
    program.need_device()
    node.packages()
    with Folder() as folder:
        asdic("dataset", scene(folder, rays=100000), "-n", "3", "-o", folder / "d").check(code=0)
        for form in ("polar", "bearing"):
            folder.write(form + ".json", node.read("labels.mjs", folder / "d/" + form))
        print("# one part each:", numpy("""
import json, numpy as np
from PIL import Image
worst = 1
polygons = 0
for form in ("polar", "bearing"):
    for kind, frames in json.load(open(form + ".json")).items():
        assert sorted(frames) == ["000000.png", "000001.png", "000002.png"], (kind, sorted(frames))
        for name, boxes in frames.items():
            mask = np.array(Image.open(f"d/{form}/masks/{name}"))
            labels = [b["label"] for b in boxes]
            assert labels == ["ball", "post"], (kind, form, name, labels)
            for number, box in enumerate(boxes, 1):
                own = mask == number
                y, x = np.nonzero(own)
                size = (1, 1) if kind == "COCO" else mask.shape[::-1]
                got = [(box["x"] - box["width"] / 2) * size[0], (box["y"] - box["height"] / 2) * size[1],
                       (box["x"] + box["width"] / 2) * size[0], (box["y"] + box["height"] / 2) * size[1]]
                want = [x.min(), y.min(), x.max() + 1, y.max() + 1]
                assert np.allclose(got, want, rtol=0, atol=0.01), (kind, form, name, got, want)
                if kind != "COCO":
                    continue
                points = np.array(box["points"])
                if not (points == points.round()).all():
                    continue  # of a hull
                v, u = np.mgrid[0:mask.shape[0], 0:mask.shape[1]] + 0.5
                inside = np.zeros(mask.shape, bool)
                for (x0, y0), (x1, y1) in zip(points, np.roll(points, -1, 0)):
                    inside ^= (np.minimum(y0, y1) <= v) & (v < np.maximum(y0, y1)) & (u < x0)
                worst = min(worst, (inside & own).sum() / (inside | own).sum())
                polygons += 1
print(polygons, "polygons, overlap with the masks", worst)
assert polygons >= 8 and worst >= 0.99, (polygons, worst)
""", folder / ".", "PIL").strip())


def test_masks_are_those_of_rays():
    program.need_device()
    with Folder() as folder:
        asdic("dataset", scene(folder, rays=6000000, segments=256), "-n", "1", "--range-db", "0:100",
              "-o", folder / "d").check(code=0)
        tap.equal(json.loads(folder.read("d/dataset.json"))["classes"], ["ball", "post"], "classes")
        tap.equal(folder.read("d/classes.txt"), "ball\npost\n", "classes.txt")
        none = asdic("dataset", folder / "none.yaml", "--range-db", "0:100", "-o", folder / "e")
        tap.contains(none.check(code=3).err, "none.yaml: cannot open")
        tap.equal(os.path.exists(folder / "e"), False, "a folder")
        out = numpy("""
import json, numpy as np
from PIL import Image
lines = [json.loads(l) for l in open("d/manifest.jsonl")]
c = 1449.0 + 4.6 * 10  # the wavelength alone depends on it
rad = np.pi / 180
both = either = 0
for line in lines:
    yaw, pitch = line["attitude_deg"][2] * rad, line["attitude_deg"][1] * rad
    n = 2200
    el, az = np.meshgrid(np.linspace(0.0, 65.0, n) * rad, np.linspace(-50.0, 50.0, n) * rad + yaw)
    d_omega = np.cos(el)
    u = np.stack([np.cos(el) * np.cos(az), np.cos(el) * np.sin(az), np.sin(el)], -1).reshape(-1, 3)
    w = d_omega.reshape(-1)
    with np.errstate(divide="ignore"):
        t = np.where(u[:, 2] > 0, 4.0 / u[:, 2], np.inf)
    kind = np.zeros(len(t), int)
    sine = u[:, 2].copy()
    mu = np.full(len(t), 10 ** -3.0)
    for o, r in zip(line["objects"], (1.2, 0.8)):
        to = np.array(o["position_m"]) - np.array([0, 0, 6.0])
        along = u @ to
        under = r * r - (to @ to - along ** 2)
        d = along - np.sqrt(np.maximum(under, 0))
        hit = (under > 0) & (d > 0) & (d < t)
        t[hit] = d[hit]
        kind[hit] = o["number"]
        sine[hit] = -np.sum(u[hit] * (u[hit] * d[hit, None] - to) / r, -1)
        mu[hit] = 10 ** -0.8
    near = t[kind > 0]
    ok = (t < near.max() + 0.1) & (t > near.min() - 0.1)
    u, w, t, kind, sine, mu = u[ok], w[ok], t[ok], kind[ok], sine[ok], mu[ok]
    lam = 1489.0 / 300e3
    ahead = np.array([np.cos(pitch) * np.cos(yaw), np.cos(pitch) * np.sin(yaw), -np.sin(pitch)])
    down = np.array([np.sin(pitch) * np.cos(yaw), np.sin(pitch) * np.sin(yaw), np.cos(pitch)])
    right = np.array([-np.sin(yaw), np.cos(yaw), 0.0])
    x, y, z = u @ ahead, u @ right, u @ down
    sent = (np.sinc(0.004 / lam * y) * np.sinc(0.01 / lam * z)) ** 2
    e = sent * np.sinc(0.01 / lam * z) ** 2 * mu * sine * w / t ** 2
    cell = (t / 0.1).astype(int)
    # Beams that hear an object at half power somewhere: its outline's bearings and steepest elevation from the sonar.
    near_axis = np.zeros((3, 48), bool)
    for o, r in zip(line["objects"], (1.2, 0.8)):
        to = np.array(o["position_m"]) - np.array([0, 0, 6.0])
        q = np.array([to @ ahead, to @ right, to @ down])
        flat = np.hypot(q[0], q[1])
        steep = abs(np.arctan2(q[2], flat)) + np.arcsin(r / np.linalg.norm(q))
        reach = np.arcsin(r / flat) + np.arcsin(0.443 * lam / 0.1 / np.cos(steep))
        near_axis[o["number"]] = abs((np.arange(48) - 23.5) * 1.25 * rad - np.arctan2(q[1], q[0])) <= reach
    mask = np.array(Image.open(f"d/bearing/masks/{line['frame']:06d}.png")).T[:, ::-1]
    for b in range(48):
        a = (b - 23.5) * 1.25 * rad
        g = e * np.sinc(0.1 / lam * (np.cos(a) * y - np.sin(a) * x)) ** 2
        parts = np.stack([np.bincount(cell[kind == k], g[kind == k], 140) for k in range(3)])
        best = parts[1:].argmax(0) + 1
        own = np.where((parts[1:].max(0) >= 0.5 * parts.sum(0) + 1e-30) & near_axis[best, b], best, 0)
        both += ((own == mask[b]) & (own > 0)).sum()
        either += ((own > 0) | (mask[b] > 0)).sum()
print(both, either, both / either)
assert either > 250 and both >= 0.99 * either, (both, either)
""", folder / ".", "PIL")
        print("# masks over rays:", out.strip())


def test_labels_hug_objects():
    """Over nothing else to be heard, an object's columns are the beams that hear some of it at half power, found here
    from its corners; with --side-lobes they are all that hear it at all."""
    program.need_device()
    box = "{name: ball, sphere: {radius_m: 1.2, segments: 32}, position_m: [9, 0, 8.8]"
    point = "{name: post, sphere: {radius_m: 0.8, segments: 32}, position_m: [6, 1, 9.2], material: {lambert_db: -8}}"
    with Folder() as folder:
        path = scene(folder, rays=40000, a=("bottom: {depth_m: 10, lambert_db: -30}", "bottom: {none: true}"),
                     b=(box, "{name: ball, box: {size_m: [0.5, 2, 1]}, position_m: [5, 0, 8.8], rotation_deg: [10, 20, 40]"),
                     c=(point, "{name: post, point: {target_strength_db: 0}, position_m: [12, 1, 9.2]}"),
                     d=("pitch_deg: -20}", "pitch_deg: -20, roll_deg: 12}"),
                     e=("    - {key: mission.pose.yaw", "    - {key: 'objects[0].rotation_deg[2]', uniform: [0, 180]}\n"
                        "    - {key: mission.pose.yaw"))
        make = ("dataset", path, "-n", 6, "--radius", 64)
        asdic(*make, "-o", folder / "d").check(code=0)
        asdic(*make, "-o", folder / "lobes", "--side-lobes").check(code=0)
        numpy("""
import json, numpy as np
from PIL import Image
rad = np.pi / 180
def turn(roll, pitch, yaw):
    c, s = np.cos, np.sin
    return (np.array([[c(yaw), -s(yaw), 0], [s(yaw), c(yaw), 0], [0, 0, 1]]) @
            np.array([[c(pitch), 0, s(pitch)], [0, 1, 0], [-s(pitch), 0, c(pitch)]]) @
            np.array([[1, 0, 0], [0, c(roll), -s(roll)], [0, s(roll), c(roll)]]))
corners = np.array([[x, y, z] for x in (-0.25, 0.25) for y in (-1, 1) for z in (-0.5, 0.5)])
yaws = (np.arange(48) - 23.5) * 1.25 * rad
lam = 1490.09 / 300e3
for line in map(json.loads, open("d/manifest.jsonl")):
    head = turn(*(np.array(line["attitude_deg"]) * rad))
    own, all_of = (np.array(Image.open(f"{name}/bearing/masks/{line['frame']:06d}.png")) for name in ("d", "lobes"))
    for o, body in zip(line["objects"], (corners, np.zeros((1, 3)))):
        at = body @ turn(*(np.array(o["attitude_deg"]) * rad)).T + o["position_m"] - np.array(line["position_m"])
        x, y, z = (at @ head).T
        bearing, steep = np.arctan2(y, x), np.arctan2(abs(z), np.hypot(x, y)).max()
        reach = np.arcsin(0.4429 * lam / 0.1 / np.cos(steep))
        off = np.maximum(bearing.min() - yaws, yaws - bearing.max())
        columns = (own == o["number"]).any(axis=0)
        wanted = off < reach
        assert (columns == wanted).all(), (line["frame"], o["name"], columns.nonzero(), wanted.nonzero())
        assert (all_of == o["number"]).any(axis=0).sum() > columns.sum() + 8, o["name"]
        assert (all_of[own > 0] == own[own > 0]).all()
""", folder / ".", "PIL")
        for name, side, more in ("d", False, ["--side-lobes"]), ("lobes", True, []):
            tap.equal(json.loads(folder.read(f"{name}/dataset.json"))["side_lobes"], side, "dataset.json")
            tap.equal(json.loads(folder.read(f"{name}/polar/annotations.json"))["info"]["side_lobes"], side, "COCO's info")
            says(asdic(*make, "-o", folder / name, "--resume", *more), 1, "cannot be resumed")
        says(asdic("merge", folder / "d", folder / "lobes", "-o", folder / "m"), 3, "different data sets")
        # Sets of before there was a choice have all lobes, and do not say so.
        folder.write("lobes/dataset.json", folder.read("lobes/dataset.json").replace('"side_lobes":true,', ""))
        asdic("merge", folder / "lobes", "-o", folder / "m").check(code=0)
        tap.equal(json.loads(folder.read("m/polar/annotations.json"))["info"]["side_lobes"], True, "of an older set")


def test_a_void_frame_is_passed_over():
    """A draw puts the sonar below the bottom: the frame is told of, has no pictures, and the set goes on."""
    program.need_device()
    with Folder() as folder:
        path = scene(folder, rays=500, a=("{key: mission.pose.yaw_deg, uniform: [-5, 5]}",
                                          "{key: 'mission.pose.position_m[2]', uniform: [5, 12]}"))
        make = ("dataset", path, "-n", 12, "--radius", 32)
        done = asdic(*make, "-o", folder / "d").check(code=0)
        whole = files(folder / "d")
        lines = [json.loads(line) for line in whole["manifest.jsonl"].splitlines()]
        tap.equal([line["frame"] for line in lines], list(range(12)), "frames")
        void = [line["frame"] for line in lines if line["position_m"][2] > 10]
        tap.equal([line["frame"] for line in lines if "void" in line], void, "void frames")
        tap.equal(0 < len(void) < 12, True, "some are")
        first = lines[void[0]]
        tap.contains(first["void"], f"the sonar is at z = {first['position_m'][2]:.6g} m, below the bottom at 10 m")
        tap.equal(done.err.count("void"), 1, "said once")
        are = "is" if len(void) == 1 else "are"
        tap.contains(done.err, f"remark: {len(void)} of 12 frames {are} void, without pictures and labels: frame {void[0]}, ")
        made = sorted(int(name[7:13]) for name in whole if name.startswith("levels/"))
        tap.equal(made, [k for k in range(12) if k not in void], "frames with levels")
        coco = json.loads(whole["polar/annotations.json"])
        tap.equal([image["id"] for image in coco["images"]], made, "COCO's images")
        for k in (1, 2):
            asdic(*make, "--shard", f"{k}/2", "-o", folder / f"p{k}").check(code=0)
        asdic("merge", folder / "p1", folder / "p2", "-o", folder / "m").check(code=0)
        tap.equal(files(folder / "m") == whole, True, "parts joined are the whole")
        folder.write(f"d/frames/{void[0]:06d}.txt", whole[f"frames/{void[0]:06d}.txt"].decode()[:-20])
        folder.write(f"d/levels/{void[0]:06d}.npy", "of another")
        os.remove(folder / f"d/frames/{made[0]:06d}.txt")
        says(asdic("merge", folder / "d", "-o", folder / "n"), 3, "frame")
        asdic(*make, "-o", folder / "d", "--resume").check(code=0)
        tap.equal(files(folder / "d") == whole, True, "resumed is the whole")
        # The first frame is void: the next one's levels make the window.
        early = scene(folder, rays=500, a=("{key: mission.pose.yaw_deg, uniform: [-5, 5]}",
                                           "{key: 'mission.pose.position_m[2]', choice: [11, 6]}"))
        for seed in range(1, 20):
            done = asdic("dataset", early, "-n", 8, "--radius", 32, "--seed", seed, "-o", folder / "e", "--force").check(code=0)
            lines = [json.loads(line) for line in folder.read("e/manifest.jsonl").splitlines()]
            if "void" in lines[0]:
                break
        tap.equal("void" in lines[0], True, "a seed whose first frame is void")
        tap.contains(done.err, "void, without pictures and labels: frame 0, ")
        tap.equal([name for name in os.listdir(folder / "e/levels") if name.startswith("000000")], [], "its levels")
        lost = scene(folder, a=("[0, 0, 6]", "[0, 0, 11]"))
        says(asdic("dataset", lost, "-n", 2, "-o", folder / "g"), 3, "all 2 frames are void: frame 0, ")
        tap.equal(os.path.exists(folder / "g"), False, "a folder")


def test_the_first_scene_is_remarked_on():
    """What `asdic check` says of a scene, once, and what is odd about a set."""
    program.need_device()
    with Folder() as folder:
        path = scene(folder, rays=500, a=("[9, 0, 8.8]", "[0, 0, 6.2]"), b=("objects[0].position_m[1]", "objects[1].position_m[0]"),
                     c=("uniform: [-2, 2]}\n    - {key: 'objects[1].position_m[1]'", "uniform: [5, 7]}\n    - {key: 'objects[1].position_m[1]'"))
        remarks = asdic("check", path).err.count(": remark: ")
        make = ("dataset", path, "-n", 3, "--radius", 32)
        for into, more in ("d", []), ("d", ["--resume"]):
            done = asdic(*make, "-o", folder / into, *more).check(code=0)
            tap.equal(done.err.count("object 'ball' has the sonar inside it at ping 0"), 1, "said of the ball")
            tap.equal(done.err.count(": remark: "), remarks, "remarks")
        tap.contains(done.err, "3 frames in")
        bare = folder.write("bare.yaml", re.sub(r"objects:\n.*?sonar:", "sonar:", folder.read("set.yaml").split("trial:")[0],
                                                flags=re.DOTALL))
        done = asdic("dataset", bare, "-n", 1, "--radius", 32, "-o", folder / "e").check(code=0)
        tap.equal(done.err.count(": remark: nothing is drawn"), 1, "said of no draws")
        tap.equal(done.err.count(": remark: no objects, and so no classes"), 1, "said of no objects")
        tap.contains(done.err, "1 frame in")
        tap.equal(asdic("dataset", bare, "-n", 1, "--radius", 32, "-o", folder / "f", "-q").check(code=0).err, "", "quiet")


def test_labels_beyond_the_foot():
    """Steep beams hear what lies behind the sonar in the planes that they span with the upright: in those it has labels."""
    program.need_device()
    beams = [f"{{yaw_deg: {(k - 23.5) * 1.25}, pitch_deg: 75, length_h_m: 0.1, length_v_m: 0.004}}" for k in range(48)]
    with Folder() as folder:
        path = scene(folder, rays=40000, a=("bottom: {depth_m: 10, lambert_db: -30}", "bottom: {none: true}"),
                     b=("{radius_m: 1.2, segments: 32}, position_m: [9, 0, 8.8]", "{radius_m: 0.5, segments: 32}, position_m: [-3, 0, 9]"),
                     c=("{length_h_m: 0.004, length_v_m: 0.01}", "{length_h_m: 0.002, length_v_m: 0.002, pitch_deg: 75}"),
                     d=("{fan: {count: 48, sector_deg: 60, length_h_m: 0.1, length_v_m: 0.01}}", f"[{', '.join(beams)}]"),
                     e=("[0, 0, 6], pitch_deg: -20", "[0, 0, 3]"))
        asdic("dataset", path, "-n", 4, "--radius", 64, "-o", folder / "d").check(code=0)
        numpy("""
import json, numpy as np
from PIL import Image
yaws = (np.arange(48) - 23.5) * 1.25 * np.pi / 180
inside = outside = 0
for line in map(json.loads, open("d/manifest.jsonl")):
    x, y, _ = np.array(line["objects"][0]["position_m"]) - line["position_m"]
    bearing = np.arctan2(y, x) - line["attitude_deg"][2] * np.pi / 180
    off_m = abs(np.hypot(x, y) * np.sin(bearing - yaws))
    columns = (np.array(Image.open(f"d/bearing/masks/{line['frame']:06d}.png")) == 1).any(axis=0)
    assert columns[off_m < 0.45].all() and not columns[off_m > 0.9].any(), (line["frame"], columns.nonzero(), off_m)
    inside, outside = inside + (off_m < 0.45).sum(), outside + (off_m > 0.9).sum()
assert inside > 10 and outside > 10, (inside, outside)
""", folder / ".", "PIL")


def test_a_fan_may_be_tilted():
    """By its mount or with the vehicle: the same beams hear the object, and have its labels."""
    program.need_device()
    ball, fan, sent = "position_m: [9, 0, 8.8]", "length_v_m: 0.01}}", "{length_h_m: 0.004, length_v_m: 0.01}"
    yaws = "    - {key: mission.pose.yaw_deg, uniform: [-5, 5]}\n"
    with Folder() as folder:
        for name, vehicle, mount in (("v", ", pitch_deg: -40", ""), ("m", "", ", pitch_deg: 40")):
            path = scene(folder, rays=40000, a=("sector_deg: 60", "sector_deg: 120"), b=(ball, "position_m: [4, 0, 9]"),
                         c=(sent, f"{{length_h_m: 0.002, length_v_m: 0.005{mount}}}"), d=(fan, f"length_v_m: 0.005{mount}}}}}"),
                         e=(", pitch_deg: -20", vehicle), f=("[-2, 2]", "[-6, 6]"), g=(yaws, ""))
            asdic("dataset", path, "-n", 6, "--radius", 64, "-o", folder / name).check(code=0)
        numpy("""
import numpy as np
from PIL import Image
for k in range(6):
    v, m = (np.array(Image.open(f"{name}/bearing/masks/{k:06d}.png")) for name in "vm")
    for number in (1, 2):
        a, b = ((mask == number).any(axis=0) for mask in (v, m))
        assert a.sum() > 3 and (a != b).sum() <= 1, (k, number, a.nonzero(), b.nonzero())
""", folder / ".", "PIL")


def test_what_cannot_be_is_said_once():
    program.need_device()
    with Folder() as folder:
        path = scene(folder)
        says(asdic("dataset", path, "-n", "0", "-o", folder / "d"), 2, "--number")
        says(asdic("dataset", path, "-n", "2", "--shard", "3/3", "-o", folder / "e", "--threshold",
              "2"), 2, "--threshold")
        says(asdic("dataset", path, "-n", "2", "--shard", "1/3", "-o", folder / "h"), 0,
             "--shard 1/3: nothing to do; frames to share: 2")
        says(asdic("dataset", path, "-n", "2", "-o", folder / "d", "--force", "--resume"), 2,
             "--force starts afresh and --resume goes on; give one of them")
        says(asdic("dataset", folder / "none.yaml", "-o", folder / "d"), 3, "none.yaml")
        says(asdic("dataset", "-", "-n", "2", "-o", folder / "d", stdin=folder.read("set.yaml")), 2,
             "the scene is read for every frame; it must be a file")
        coherent = scene(folder, a=("seed: 3, multipath: false", "seed: 3, coherent: true"),
                         b=("receivers: {fan: {count: 48, sector_deg: 60, length_h_m: 0.1, length_v_m: 0.01}}",
                            "array: {elements: 16, beams: {count: 8, sector_deg: 60}}"))
        says(asdic("dataset", coherent, "-n", "2", "-o", folder / "d"), 3, "leave 'coherent' out of 'sampling'")
        bad = scene(folder, a=("uniform: [-5, 5]", "uniform: [-500, 500]"))
        done = asdic("dataset", bad, "-n", "3", "-o", folder / "d")
        says(done, 3, "'yaw_deg' = -500 is out of range [-360, 360] deg  [trial.draws[2]]")
        nameless = scene(folder, a=("name: ball, ", ""))
        says(asdic("dataset", nameless, "-n", "2", "-o", folder / "f"), 3, "name")
        fan = "receivers: {fan: {count: 48, sector_deg: 60, length_h_m: 0.1, length_v_m: 0.01}}"
        beam = "{length_h_m: 0.1, length_v_m: 0.01, yaw_deg: %d, pitch_deg: %d}"
        for aims, wrong in ((((-10, 0), (10, 0), (5, 0)), 2), (((10, 0), (-10, 0), (-5, 0)), 2),
                            (((-10, 90), (0, 90), (10, 90)), 0)):
            beams = scene(folder, a=(fan, "receivers: [" + ", ".join(beam % aim for aim in aims) + "]"))
            says(asdic("dataset", beams, "-n", "2", "-o", folder / "f"), 3,
                 f"receiver {wrong} is not in the order of bearings")


def test_frames_need_the_first_ping_alone():
    """Where a draw shortens the way of a scene with more pings than that."""
    program.need_device()
    with Folder() as folder:
        path = scene(folder, a=("mission: {pose: {position_m: [0, 0, 6], pitch_deg: -20}}",
                                "mission: {waypoints: {points_m: [[0, 0, 6], [9, 0, 6]]}, pings: 200}"),
                     b=("mission.pose.yaw_deg, uniform: [-5, 5]", "'mission.waypoints.points_m[1][0]', uniform: [2, 9]"))
        asdic("dataset", path, "-n", "2", "-o", folder / "d").check(code=0)


def test_poses_are_exact_in_utm():
    """The manifest's positions are those that were drawn, to 0.01 mm, seven digits before the point."""
    program.need_device()
    with Folder() as folder:
        path = scene(folder, a=("position_m: [9, 0, 8.8]", "position_m: [5984309, 431200, 8.8]"),
                     b=("position_m: [6, 1, 9.2]", "position_m: [5984306, 431201, 9.2]"),
                     c=("position_m: [0, 0, 6]", "position_m: [5984300.0625, 431200, 6]"),
                     d=("objects[0].position_m[1]', uniform: [-2, 2]",
                        "objects[0].position_m[0]', uniform: [5984308, 5984310]"),
                     e=("[-2, 2]", "[431199, 431202]"))
        asdic("dataset", path, "-n", "2", "-o", folder / "d").check(code=0)
        for line in folder.read("d/manifest.jsonl").splitlines():
            told = json.loads(line)
            tap.equal(told["position_m"], [5984300.0625, 431200, 6])
            for i, axis in enumerate((0, 1)):
                drawn = float(told["drawn"][f"objects[{i}].position_m[{axis}]"])
                tap.equal(round(told["objects"][i]["position_m"][axis] - drawn, 4), 0.0, f"metres off, object {i}")


def test_a_set_is_of_all_files_that_its_scene_names():
    """A set whose sonar's file, or a mesh that is drawn, changed is another one; other files may come and go."""
    program.need_device()
    with Folder() as folder:
        text = folder.read(os.path.basename(scene(folder)))
        begin, end = text.index("sonar:\n") + 7, text.index("surface:")
        sonar = "\n".join(line.strip() for line in text[begin:end].splitlines())
        mesh = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"
        text = text[:begin - 1] + " {file: sonar.yaml}\n" + text[end:] + (
            "    - {key: 'objects[0]', choice: [{name: ball, mesh: {file: a.obj}, position_m: [9, 0, 8]},\n"
            "       {name: ball, mesh: {file: b.obj}, position_m: [9, 0, 8]}]}\n")
        path = folder.write("set.yaml", text.replace(
            "    - {key: 'objects[0].position_m[1]', uniform: [-2, 2]}\n", ""))
        own = {"sonar.yaml": sonar, "a.obj": mesh, "b.obj": mesh}
        for name, content in own.items():
            folder.write(name, content)
        asdic("dataset", path, "-n", "2", "-o", folder / "d").check(code=0)
        whole = files(folder / "d")
        for name, old, new in (("sonar.yaml", "level_db: 220", "level_db: 160"), ("a.obj", "v 1 0", "v 2 0"),
                               ("b.obj", "v 1 0", "v 2 0")):
            folder.write(name, own[name].replace(old, new))
            says(asdic("dataset", path, "-n", "2", "-o", folder / "d", "--resume"), 1, "cannot be resumed")
            folder.write(name, own[name])
        folder.write("c.obj", mesh)
        os.remove(folder / "d/frames/000001.txt")
        asdic("dataset", path, "-n", "2", "-o", folder / "d", "--resume").check(code=0)
        tap.equal(files(folder / "d") == whole, True, "resumed is the whole")


def test_a_full_disk_loses_nothing():
    program.need_device()
    if not os.path.exists("/dev/full"):
        raise tap.Skip("no /dev/full")
    with Folder() as folder:
        path = scene(folder)
        asdic("dataset", path, "-n", "3", "-o", folder / "d").check(code=0)
        whole = files(folder / "d")
        os.remove(folder / "d/frames/000002.txt")
        os.remove(folder / "d/levels/000002.npy")
        os.symlink("/dev/full", folder / "d/levels/000002.npy")  # devices alone are written through a link
        done = asdic("dataset", path, "-n", "3", "-o", folder / "d", "--resume")
        says(done, 1, "levels/000002.npy")
        tap.contains(done.err, "No space left")
        os.remove(folder / "d/levels/000002.npy")
        asdic("dataset", path, "-n", "3", "-o", folder / "d", "--resume").check(code=0)
        tap.equal(files(folder / "d") == whole, True, "goes on after a full disk")


tap.main(globals())
