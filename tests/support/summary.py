"""Counts the single tests in Meson's log and ends with "N passed, N failed, N skipped".

Test programs report one line per test, as cmocka or TAP; a program that reports none is one test.
What a program began but did not finish, and a program that ends badly with nothing failed in its
lines (a crash, a time-out, a leak), counts as failed.
"""
import json
import re
import sys

CMOCKA = re.compile(r"^\[ +(RUN|OK|SKIPPED|FAILED) +\] (\S+)$", re.MULTILINE)
TAP = re.compile(r"^(not )?ok \d+[^#\n]*(#\s*SKIP)?", re.MULTILINE | re.IGNORECASE)


def count_cmocka(text):
    """(passed, failed, skipped); the list of failures at the end of a group does not count."""
    counts = {"OK": 0, "FAILED": 0, "SKIPPED": 0}
    running = None
    for mark, name in CMOCKA.findall(text):
        if mark == "RUN":
            counts["FAILED"] += running is not None
            running = name
        elif name == running:
            counts[mark] += 1
            running = None
    counts["FAILED"] += running is not None
    return counts["OK"], counts["FAILED"], counts["SKIPPED"]


def count(program):
    """(passed, failed, skipped) of one entry of the log."""
    text = program.get("stdout", "") + "\n" + program.get("stderr", "")
    passed, failed, skipped = count_cmocka(text)
    for wrong, skip in TAP.findall(text):
        if wrong:
            failed += 1
        elif skip:
            skipped += 1
        else:
            passed += 1
    result = program["result"]
    if result == "SKIP":
        return 0, 0, passed + failed + skipped or 1
    if result not in ("OK", "EXPECTEDFAIL"):
        return passed, failed or 1, skipped
    if passed + failed + skipped == 0:
        passed = 1
    return passed, failed, skipped


def skipped_lines(program):
    """What was skipped, and why where the program says so."""
    text = program.get("stdout", "") + "\n" + program.get("stderr", "")
    if program["result"] == "SKIP":
        reason = [line for line in text.splitlines() if "skipped:" in line]
        return [reason[0].replace("skipped:", "").strip() if reason else "all of it"]
    names = [name for mark, name in CMOCKA.findall(text) if mark == "SKIPPED"]
    return list(dict.fromkeys(names)) + re.findall(r"^ok \d+ - (.*# SKIP.*)", text, re.MULTILINE)


def main():
    totals = [0, 0, 0]
    bad = []
    try:
        with open(sys.argv[1], encoding="utf-8") as log:
            programs = [json.loads(line) for line in log]
    except FileNotFoundError:
        sys.exit("the tests did not run")
    for program in programs:
        counts = count(program)
        totals = [a + b for a, b in zip(totals, counts)]
        if counts[1]:
            bad.append(program)
    for program in programs:
        for line in skipped_lines(program):
            print(f"skipped: {program['name']}: {line.replace(' # SKIP', ':')}")
    for program in bad:
        print(f"\n=== {program['name']}: {program['result']}")
        lines = (program.get("stdout", "") + program.get("stderr", "")).splitlines()
        print("\n".join(line for line in lines if not re.match(r"^\[ +(RUN|OK) +\]|^ok ", line)))
    print("\n{} passed, {} failed, {} skipped".format(*totals))
    sys.exit(1 if totals[1] or totals[0] == 0 else 0)


if __name__ == "__main__":
    main()
