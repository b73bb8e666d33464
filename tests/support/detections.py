"""What tests of 'asdic detect' share."""
import csv
import pathlib

DATA = pathlib.Path(__file__).resolve().parents[2] / "data"
# Where nothing is asked of the map.
COARSE = "--cell", "4"


def rows(path):
    with open(path, newline="", encoding="ascii") as file:
        return list(csv.DictReader(file))


# Eight beams of one degree, a quarter of a degree apart, and nothing to see.
EMPTY = """version: 1
bottom: {depth_m: 12, type: sand}
sonar:
  frequency_khz: 100
  bandwidth_khz: 10
  ping_rate_hz: 40
  bin_length_m: 0.0745
  source_level_db: 200
  speckle: rayleigh
  receivers: {fan: {count: 8, sector_deg: 1.75, length_h_m: 0.75, length_v_m: 0.05}}
mission: {pose: {position_m: [0, 0, 7]}, pings: 600}
sampling: {rays: 20000}
detector: {pfa: 3.0e-3}
output: {images: [], csv: none}
"""
