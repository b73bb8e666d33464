"""Reads what asdic run writes, and compares levels."""
import csv
import math

COMPONENTS = ("bottom", "surface", "volume", "object", "multipath", "noise")


def number(text):
    return float(text) if text else None


def read_bins(folder):
    """bins.csv as {beam: [row of ping 0, bin 0, ...]}; levels are None where there is no energy."""
    beams = {}
    with open(f"{folder}/bins.csv", encoding="ascii", newline="") as table:
        for row in csv.DictReader(table):
            name = row.pop("beam")
            beams.setdefault(name, []).append({key: number(text) for key, text in row.items()})
    return beams


def direct_db(row):
    """The level of the direct echoes: without multipath and noise."""
    energy = sum(10 ** (row[f"{name}_db"] / 10) for name in COMPONENTS[:4]
                 if row[f"{name}_db"] is not None)
    return 10 * math.log10(energy) if energy > 0 else None


def differences_db(rows, expected_db, first=4):
    """Simulated less expected, dB, from bin FIRST on; both must have energy in the same bins."""
    result = []
    for n, (row, expected) in enumerate(zip(rows, expected_db, strict=True)):
        level = direct_db(row)
        if (level is None) != (expected is None):
            raise AssertionError(f"bin {n}: simulated {level} dB, expected {expected} dB")
        if n >= first and expected is not None:
            result.append(level - expected)
    return result


def rms(values):
    return math.sqrt(sum(value * value for value in values) / len(values))
