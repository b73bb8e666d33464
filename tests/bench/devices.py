"""The rows of the table of speeds in docs/devices.md: rays and pings a second on every device there is.

usage: devices.py ASDIC SCENE [ROUNDS]   the best of 5 ROUNDS of `asdic bench`, since others may use the cores
"""
import json
import os
import subprocess
import sys

# Mesa shows its processor device only when it is asked to.
ENVIRONMENT = {"RUSTICL_ENABLE": "llvmpipe", **os.environ}
LIMIT_S = 600


def ask(*command):
    """What COMMAND prints, which is JSON; None where it fails or takes too long."""
    try:
        done = subprocess.run(command, env=ENVIRONMENT, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL,
                              timeout=LIMIT_S, check=False)
        return json.loads(done.stdout) if done.returncode == 0 else None
    except (subprocess.TimeoutExpired, ValueError):
        return None


def best(rounds, key, value, *commands):
    """The largest VALUE by KEY of the rows that ROUNDS of each of COMMANDS print."""
    found = {}
    for command in rounds * commands:
        for row in (ask(*command) or {"rows": []})["rows"]:
            found[row[key]] = max(found.get(row[key], 0.0), row[value])
    return found


def digits(value, unit=1.0):
    return "-" if value is None else f"{float(f'{value / unit:.2g}'):g}"


def main():
    asdic, scene = sys.argv[1:3]
    rounds = int(sys.argv[3]) if len(sys.argv) > 3 else 5
    print("| device | units | Mrays/s, cone | Mrays/s, random | pings/s |\n|---|---|---|---|---|")
    for device in ask(asdic, "devices", "--json") or []:
        where = ["--quick", "--json", "--device", device["device"]]
        units = device["compute_units"]
        bench = [asdic, "bench", "rays", *where]
        # Some cannot be split, and some are slower so; PoCL takes one thread where nothing is said.
        rays = best(rounds, "set", "rays_per_s", bench, [*bench, "--threads", str(units)])
        pings = best(rounds, "scene", "pings_per_s", [asdic, "bench", "pings", *where, scene])
        columns = [digits(rays.get(s), 1e6) for s in ("cone-dense", "sphere-random")]
        columns.append(digits(next(iter(pings.values()), None)))
        print(f"| {device['name']}, {device['driver']} | {units} | " + " | ".join(columns) + " |", flush=True)


if __name__ == "__main__":
    main()
