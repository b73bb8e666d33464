"""Tracks of false alarms alone: as many as 'asdic detect' says are to be expected."""
import json
import math

import tap
from detections import COARSE, EMPTY, rows
from program import Folder, asdic, need_device


def test_an_empty_sea_has_the_false_tracks_that_are_said():
    need_device()
    with Folder() as folder:
        folder.write("empty.yaml", EMPTY)
        done = asdic("detect", "empty.yaml", "-o", "out", "--json", *COARSE, cwd=folder.path).check(0)
        report = json.loads(done.out)
        tracks, pfa = report["tracks"], report["pfa_measured"]
        tap.equal(pfa["low"] <= 0.003 <= pfa["high"], True, f"{pfa}")
        # Of 6 false alarms a ping, which are 2.8 plots: 1 in 170 is confirmed. Independent beams
        # would make 4.9 plots a ping, and 50 tracks.
        said, found = tracks["by_chance"], tracks["confirmed"]
        tap.equal(2 < said < 30, True, f"{said} are said")
        tap.equal(abs(found - said) < 3.3 * said ** 0.5 + 0.3 * said + 1, True,
                  f"{found} false tracks of {said}")
        tap.equal(found > 0, True, "false tracks")
        tap.equal(tracks["on_objects"], 0, "false tracks of an object")
        tap.equal({row["truth"] for row in rows(folder / "out/tracks.csv")}, {"none"}, "names of tracks")
        text = asdic("detect", "out", "--force", *COARSE, cwd=folder.path).check(0).out
        tap.contains(text, "of false alarms alone")


def test_no_false_track_is_confirmed_sooner_than_it_can_be():
    need_device()
    with Folder() as folder:
        said = []
        for pings in 3, 4:  # a track is confirmed by three plots
            folder.write("short.yaml", EMPTY.replace("pings: 600", f"pings: {pings}"))
            done = asdic("detect", "short.yaml", "-o", f"out{pings}", "--json", cwd=folder.path).check(0)
            said.append(json.loads(done.out)["tracks"]["by_chance"])
        tap.equal(said[0], 0)
        # One in 170 of 2.8 plots, as in the long run; so few pings have their plots by chance.
        tap.equal(0.005 < said[1] < 0.05, True, f"{said}")


def said_of(folder, *changes):
    """How many false tracks are to be expected of the empty sea with these CHANGES, (old, new) each."""
    text = EMPTY
    for old, new in (("pings: 600", "pings: 30"), ("rays: 20000", "rays: 500"), *changes):
        tap.contains(text, old)
        text = text.replace(old, new)
    folder.write("sea.yaml", text)
    done = asdic("detect", "sea.yaml", "-o", "out", "-f", "--json", "-q", *COARSE, cwd=folder.path).check(0)
    return json.loads(done.out)["tracks"]["by_chance"]


def test_false_tracks_are_where_beams_look():
    """Plots lie on the axes of beams: those that no gate joins have the tracks of as many single ones, however far apart
    they look. Twice as many were said."""
    need_device()
    with Folder() as folder:
        said = {}
        width = math.degrees(2 * math.asin(0.5 * 0.886 * 1500 / (100e3 * math.hypot(0.001, 0.1))))
        for name, places in ("one", (0,)), ("near", (0, 1)), ("apart", (0, 4)), ("far", (0, 8)), ("three", (-8, 0, 8)):
            beams = ", ".join(f"{{yaw_deg: {place * width}, length_h_m: 0.1}}" for place in places)
            said[name] = said_of(folder,
                                 ("{fan: {count: 8, sector_deg: 1.75, length_h_m: 0.75, length_v_m: 0.05}}", f"[{beams}]"),
                                 ("receivers", "transmitter: {length_h_m: 0.001}\n  receivers"), ("3.0e-3", "1.0e-6"),
                                 ("bottom:", "environment: {sound_speed_mps: 1500}\nbottom:"))
        for name, beams in ("apart", 2), ("far", 2), ("three", 3):
            tap.equal(abs(said[name] / said["one"] / beams - 1) < 0.05, True, f"{name}: {said}")
        tap.equal(said["near"] > 1.1 * said["far"], True, f"near each other {said}")


def test_false_tracks_do_not_depend_on_the_compass():
    """A fan that looks across south, where bearings begin anew, hears as wide a sea as one to the north."""
    need_device()
    with Folder() as folder:
        quiet = ("3.0e-3", "1.0e-6")  # hardly a false alarm: none are counted
        said = [said_of(folder, quiet, ("[0, 0, 7]", f"[0, 0, 7], yaw_deg: {yaw}")) for yaw in (0, 90, 180)]
        tap.equal(all(abs(s / said[0] - 1) < 1e-6 for s in said), True, f"{said}")


def test_beams_that_turn_away_confirm_fewer():
    """Where the vehicle turns by a beam in two pings, a third plot is seldom where the first was; a run of which half goes
    straight has half of what one at rest has. As many were said of either."""
    need_device()
    with Folder() as folder:
        said = []
        for turn_deg in 0, 2, 0.5:  # the fan is 1.75 degrees wide
            for half in (False, True) if turn_deg else (False,):
                yaws = [turn_deg * max(i - (15 if half else 0), 0) for i in range(31)]
                folder.write("turn.csv", "time_s,x_m,y_m,z_m,roll_deg,pitch_deg,yaw_deg\n" + "".join(
                    f"{i / 40},0,0,7,0,0,{yaw}\n" for i, yaw in enumerate(yaws)))
                said.append(said_of(folder, ("3.0e-3", "1.0e-6"), ("pose: {position_m: [0, 0, 7]}", "track: turn.csv")))
        rest, quick, half_quick, slow, _ = said
        tap.equal(quick < 0.1 * rest and quick < slow < rest, True, f"{said}")
        tap.equal(abs(half_quick - 0.5 * (rest + quick)) < 0.05 * rest, True, f"{said}")


def test_false_tracks_do_not_depend_on_the_order_of_beams():
    """Nor on one that looks straight down, whose plots fall on one spot."""
    need_device()
    with Folder() as folder:
        fan = "{fan: {count: 8, sector_deg: 1.75, length_h_m: 0.75, length_v_m: 0.05}}"
        ahead, aside, low, down = ("{}", "{yaw_deg: 30}", "{yaw_deg: 3, pitch_deg: 60}", "{pitch_deg: 90}")
        said = {beams: said_of(folder, ("3.0e-3", "1.0e-6"), (fan, f"[{', '.join(beams)}]"))
                for beams in ((ahead, aside), (ahead, down, aside), (down, ahead, aside),
                              (ahead, low, aside), (low, ahead, aside), (ahead, aside, low), (down, down))}
        # With the low one last beams have other rays, whose levels differ as samples do: by 0.5 dB here and there.
        two, middle, first, *three, other, none = said.values()
        tap.equal(all(abs(s / two - 1) < 1e-6 for s in (middle, first)), True, f"{said}")
        tap.equal(abs(three[1] / three[0] - 1) < 1e-6 and abs(other / three[0] - 1) < 0.05, True, f"{said}")
        tap.equal(three[0] > two, True, f"{said}")
        tap.equal(none, 0, "down alone")


def test_tracks_are_of_as_many_false_alarms_as_there_are():
    """Over steep ground neighbours and planes are passed tens of times as often as designed; hardly a track was said."""
    need_device()
    with Folder() as folder:
        depths = [[18 + 3 * math.sin(i / 5) + 2 * math.cos(j / 7) for j in range(81)] for i in range(81)]
        folder.write("hills.asc", "ncols 81\nnrows 81\nxllcorner -80\nyllcorner -80\ncellsize 2\nNODATA_value -9999\n" +
                     "\n".join(" ".join(f"{depth:.2f}" for depth in row) for row in depths) + "\n")
        folder.write("hills.yaml", """version: 1
bottom: {grid: hills.asc, type: gravel}
sonar: {frequency_khz: 100, bandwidth_khz: 5, ping_rate_hz: 5, max_range_m: 60, source_level_db: 205, bin_length_m: 0.6,
        receivers: {fan: {count: 3, sector_deg: 50, length_h_m: 0.05, length_v_m: 0.05}}, speckle: rayleigh}
mission: {pose: {position_m: [0, 0, 8], pitch_deg: -4}, pings: 100}
sampling: {rays: 20000}
detector: {pfa: 1.0e-2}
output: {images: [], csv: none}
""")
        asdic("run", "hills.yaml", "-o", "out", "-q", cwd=folder.path).check(0)
        for background in "flat", "cfar":
            done = asdic("detect", "out", "--background", background, "-f", "--json", *COARSE, cwd=folder.path)
            tap.equal("levels step from bin to bin" in done.err, background == "cfar", done.err)
            tracks = json.loads(done.check(0).out)["tracks"]
            said, found = tracks["by_chance"], tracks["confirmed"]
            tap.equal(found > 20 and found / 3 < said < 1.5 * found, True, f"{background}: {tracks}")


def test_false_tracks_of_a_scanned_sonar_are_not_said():
    """Beams of one degree: five pings at a fifth of it stay within a beam, and confirm a little less than at rest; at half
    of it they do not."""
    need_device()
    with Folder() as folder:
        fan = "{fan: {count: 8, sector_deg: 1.75, length_h_m: 0.75, length_v_m: 0.05}}"
        said = []
        for step_deg in 0, 0.2, 0.5:
            scan = f"scan: {{sector_deg: 12, step_deg: {step_deg}}}\n  " if step_deg else ""
            said.append(said_of(folder, (fan, "[{length_h_m: 0.75}]"), ("speckle:", f"{scan}speckle:")))
        tap.equal((said[0] > 0, 0.8 < said[1] / said[0] < 1, said[2]), (True, True, None), f"{said}")
        done = asdic("detect", "out", "-f", cwd=folder.path).check(0)
        tap.lacks(done.out, "to be expected")
        tap.contains(done.err, "tracks are not for this sonar")


tap.main(globals())
