"""Memory does not grow with the number of pings: peak resident size of asdic run and render."""
import os
import subprocess

import program
import tap
from program import Folder

SCENE = """
version: 1
bottom: {{depth_m: 12, type: sand}}
sonar:
  frequency_khz: 100
  ping_rate_hz: 50
  source_level_db: 200
  bin_length_m: 1
  receivers: [{{name: forward}}]
mission: {{pose: {{position_m: [0, 0, 7]}}, pings: {pings}}}
sampling: {{rays: 64, multipath: "off"}}
output: {{npy: true, netcdf: true, mcap: true}}
"""


def peak_mib(*arguments):
    """Of one call of asdic, as the system counted it."""
    child = subprocess.Popen([program.PATH, *arguments, "-q"], env=program.environment({}))
    _, status, usage = os.wait4(child.pid, 0)
    child.returncode = os.waitstatus_to_exitcode(status)
    tap.equal(child.returncode, 0, f"exit code of {arguments}")
    return usage.ru_maxrss / 1024


def test_a_hundred_times_the_pings_need_no_more_memory():
    program.need_device()
    peaks = {}
    with Folder() as folder:
        for pings in (10, 1000, 100000):  # the first may compile kernels, which takes more
            scene = folder.write(f"{pings}.yaml", SCENE.format(pings=pings))
            run = folder / f"run_{pings}"
            peaks[pings] = (peak_mib("run", scene, "-o", run), peak_mib("render", run, "--raw"))
            print(f"# {pings} pings: run {peaks[pings][0]:.1f} MiB, render {peaks[pings][1]:.1f} MiB")
    for few, many in zip(peaks[1000], peaks[100000]):
        if many > few + 16:  # levels of all pings alone would be 43 MiB
            raise AssertionError(peaks)


tap.main(globals())
