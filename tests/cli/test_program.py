"""The program itself: usage, help, suggestions, colours, output that cannot be written."""
import json
import os
import re
import signal
import subprocess

import tap
from program import PATH, Folder, Result, asdic, asdic_on_terminal, need_device
from run_folder import same


def test_no_command_is_a_usage_error():
    tap.contains(asdic().check(code=2, out="").err, "usage: asdic COMMAND")


def test_version_and_help_go_to_stdout():
    words = asdic("--version").check(code=0, err="").out.split()
    tap.equal(words[0], "asdic")
    tap.equal(len(words[1].split(".")), 3, "parts of the version")
    for arguments in (["--help"], ["-h"], ["help"]):
        tap.contains(asdic(*arguments).check(code=0, err="").out, "devices")


def test_every_command_has_help_within_80_columns():
    listing = asdic("help").out.split("commands:\n")[1].split("\n\n")[0]
    names = [line.split()[0] for line in listing.splitlines() if line[2] != " "]
    tap.equal({"devices", "help"} <= set(names), True, "commands are found")
    for name in names:
        text = asdic(name, "--help").check(code=0, err="").out
        tap.contains(text, f"usage: asdic {name} ")
        tap.equal(asdic("help", name).out, text, f"help {name}")
        for line in text.splitlines():
            if len(line) > 80 and not line.startswith("usage"):
                raise AssertionError(f"{name}: {line!r} is longer than 80 columns")
        if "--force" in text:
            tap.contains(text, "-f, --force")
    if len(asdic("bench", "--help").out.splitlines()) > 45:
        raise AssertionError("the help of bench does not fit a screen")


def rows_of(block):
    """(head, lines of text) of each row of a table of help; the text begins in the column 26."""
    rows = []
    for line in block.splitlines():
        head, text = line[:26], line[26:]
        tap.equal(head[:2], "  ", f"the margin of {line!r}")
        if head[24:].strip():
            rows.append((line, []))  # a long head has a line of its own
        elif head.strip():
            rows.append((head, [text] if text else []))
        else:
            rows[-1][1].append(text)
    return rows


def test_help_is_aligned_and_its_lines_are_full():
    """A word goes to the next line where it would end beyond the column 78, and only there."""
    for command in [[], ["run"], ["detect"], ["trial"], ["view"], ["bench"], ["serve"]]:
        text = asdic(*command, "--help").out
        title = "options" if command else "commands"
        for head, lines in rows_of(text.split(f"\n{title}:\n")[1].split("\n\n")[0]):
            tap.equal(bool(lines), True, f"{head} is explained")
            for line, after in zip(lines, [*lines[1:], None]):
                tap.equal(line, " ".join(line.split()), f"{command}: {head}: blanks")
                tap.equal(26 + len(line) <= 78, True, f"{command}: {line!r} is short enough")
                if after:
                    tap.equal(26 + len(line) + 1 + len(after.split()[0]) > 78, True, f"{line!r} is full")


def test_an_option_before_the_command_is_told_apart():
    for option in ("-x", "-o", "--device"):
        told = asdic(option, "run").check(code=2, out="").err
        tap.equal(told, f"error: '{option}' stands before a command; 'asdic --help' shows the usage\n")


def test_unknown_command_is_answered_with_the_nearest():
    asdic("devcies").check(code=2, out="",
                           err="error: unknown command 'devcies'; did you mean 'devices'?\n")
    tap.lacks(asdic("zzzzzz").check(code=2, out="").err, "did you mean")
    asdic("help", "devcies").check(code=2, out="")
    asdic("--verbose", "devices").check(code=2, out="")


def test_unknown_option_is_answered_with_the_nearest():
    text = asdic("devices", "--jsom").check(code=2, out="").err
    tap.contains(text, "error: unknown option '--jsom'; did you mean '--json'?\n")
    tap.contains(text, "'asdic devices --help' shows how it is used\n")
    tap.equal(text.count("jsom"), 1, text)  # the C library has its own words for it
    for mistake, answer in (("-x", "unknown option '-x'"), ("-qx", "unknown option '-x'"),
                            ("--json=1", "option '--json' takes no value"),
                            ("--ver=2", "option '--verbose' takes no value")):
        tap.contains(asdic("devices", mistake).check(code=2, out="").err, answer)


def test_operands_are_as_many_as_said():
    """What stands in brackets may be left out; dots are for any number."""
    for command in json.loads(asdic("help", "--json").check(code=0).out):
        name, operands = command["name"], command["operands"]
        if re.sub(r"\[.*\]", "", operands):
            tap.contains(asdic(name).check(code=2, out="").err, f"'{name}' needs {operands}\n")
        if "..." not in operands:
            many = [*operands.split(), "extra"]
            tap.contains(asdic(name, *many).check(code=2, out="").err, "does not take 'extra'")
        tap.equal([o for o in command["options"] if o["letter"] and not o["letter"].isalpha()], [], name)


def test_options_that_would_do_nothing_are_refused():
    """Before anything is read: there is no such scene."""
    for words, told in ((("check", "--track", "t.csv", "--json"), "--track writes a table of poses, not --json"),
                        (("view", "--y4m", "-", "--least-rays", "100"), "--least-rays goes with a display"),
                        (("view", "--snapshot", "1", "--least-rays", "100"), "--least-rays goes with a display"),
                        (("trial", "--replay", "3", "--json"), "--replay goes without --json"),
                        (("trial", "--replay", "3", "--shard", "1/2"), "--replay goes without --shard"),
                        (("trial", "--replay", "3", "--resume"), "--replay goes without --resume"),
                        (("trial", "--replay", "3", "--workers", "2"), "--replay goes without --workers"),
                        (("trial", "--runs", "3", "--replay", "3"), "run 3 is none of the 3 runs, 0 to 2")):
        done = asdic(words[0], "none.yaml", *words[1:]).check(code=2, out="")
        tap.contains(done.err, told)
    for words in ("plan", "none.yaml"), ("bench", "error", "none.yaml"), ("bench", "pings", "none.yaml"):
        tap.contains(asdic(*words, "--picture", "-").check(code=2, out="").err,
                     "--picture -: a picture goes to a file of its own")
        for other in "p.jpg", "a.png/p.tiff":
            tap.contains(asdic(*words, "--picture", other).check(code=2, out="").err,
                         f"--picture {other}: a picture is a file in .png, .pdf or .svg")
    tap.contains(asdic("bench", "pings", "none.yaml", "-o", "a.csv", "--picture", "a.csv").check(code=2).err,
                 "--picture a.csv: a picture goes to a file of its own")
    tap.contains(asdic("roc", "-", "--vary", "sonar.source_level_db=1,2").check(code=2, out="").err,
                 "the scene is read for every design of --vary; it must be a file")
    for kind in "error", "honest", "loop", "pings":
        tap.contains(asdic("bench", kind, "none.yaml", "--kernel", "scalar").check(code=2, out="").err,
                     "--kernel is of rays alone")


SMALL = """version: 1
bottom: {depth_m: 12}
objects: [{name: far, sphere: {radius_m: 0.5}, position_m: [95, 1, 9]}]
sonar: {frequency_khz: 100, max_range_m: 30, receivers: {fan: {count: 5, sector_deg: 90}}}
mission: {pose: {position_m: [0, 0, 7]}, pings: 4}
sampling: {rays: 500}
output: {images: []}
"""
REFUSED = {  # what is said of it, in whole
    "run s.yaml -o x --pings 2:5": "--pings goes beyond the mission's 4 pings (0..3)",
    "expect s.yaml -o - --ping 4": "--ping 4: the mission has 4 pings (0..3)",
    "roc s.yaml -o x --ping 4": "ping 4 of a mission of 4",
    "roc s.yaml -o x --object far": "object 'far' is beyond the sonar's range of 30 m",
    "render r --ping 4 --images fan -o x.png": "no ping 4; there are 0 to 3",
    "render r --ping 2 --images waterfall -o x.png":
        "ping 2: A-scopes and fans are of one ping; neither is asked for",
    "render r --images ascope -o x.png":
        "one picture can go to 'x.png', but these are 2; choose one kind, and one beam or ping of it",
    "render p --ping 1 --images fan -o x.png": "no ping 1; there are 2 to 2",
    "merge r p -o m": "'r' ends before ping 4, but 'p' begins with ping 2",
}


def test_refusals_say_their_numbers():
    need_device()
    with Folder() as folder:
        folder.write("s.yaml", SMALL)
        for arguments in ["-o", "r"], ["-o", "p", "--pings", "2:3"]:
            asdic("run", "s.yaml", "-q", *arguments, cwd=folder.path).check(code=0)
        for arguments, said in REFUSED.items():
            done = asdic(*arguments.split(), cwd=folder.path)
            told = [line for line in done.err.splitlines() if line.startswith("error: ")]
            tap.equal((done.code != 0, told), (True, ["error: " + said]), arguments)
        tap.equal(sorted(os.listdir(folder.path)), ["p", "r", "s.yaml"], "left behind")


def test_colours_are_for_terminals_only():
    tap.lacks(asdic("devcies").err, "\033")
    shown = asdic_on_terminal("devcies").check(code=2).err
    tap.contains(shown, "\033[1;31merror:\033[0m unknown command")
    tap.lacks(asdic_on_terminal("devcies", NO_COLOR="1").err, "\033")
    tap.contains(asdic_on_terminal("devcies", NO_COLOR="").err, "\033")
    tap.lacks(asdic_on_terminal("devcies", TERM="dumb").err, "\033")


SCENE = """version: 1
bottom: {depth_m: 12}
sonar: {frequency_khz: 100, source_level_db: 0, receivers: [{name: a}]}
mission: {pose: {position_m: [0, 0, 5]}, pings: 3}
sampling: {rays: 1000}
"""
# Commands that write to stdout: little, much, by way of a file of the library, line by line.
WRITERS = (["help"], ["schema"], ["expect", "s.yaml", "-o", "-"], ["run", "s.yaml", "-o", "-"],
           ["serve", "s.yaml"])


def write_to(stdout, command, folder, ignore=False):
    """COMMAND with that STDOUT, None: closed; IGNORE: the parent ignores SIGPIPE."""
    def prepare():
        signal.signal(signal.SIGPIPE, signal.SIG_IGN if ignore else signal.SIG_DFL)
        if stdout is None:
            os.close(1)
    done = subprocess.run([PATH, *command], stdout=stdout, stderr=subprocess.PIPE, text=True,
                          input="0,0,0,5,0,0,0\n", check=False, cwd=folder.path,
                          restore_signals=False, preexec_fn=prepare)
    return Result(done.returncode, "", done.stderr)


def writers():
    has_device = asdic("devices").code == 0
    return [words for words in WRITERS if has_device or words[0] not in ("run", "serve")]


def test_a_folder_is_announced_with_its_size():
    """What goes to stdout is none."""
    if asdic("devices").code:
        raise tap.Skip("there is no device")
    with Folder() as folder:
        folder.write("s.yaml", SCENE)
        for where, told in ("./r", 1), ("-", 0):
            done = asdic("run", "s.yaml", "-o", where, cwd=folder.path).check(code=0)
            tap.equal(done.err.count("kB a ping, "), told, done.err)


def test_full_disk_is_noticed():
    if not os.path.exists("/dev/full"):
        raise tap.Skip("there is no /dev/full")
    with Folder() as folder, open("/dev/full", "w", encoding="utf-8") as full:
        folder.write("s.yaml", SCENE)
        for command in writers():
            done = write_to(full, command, folder).check(code=1)
            tap.contains(done.err, "error: cannot write ")
            tap.equal(done.err.endswith(": No space left on device\n"), True, f"{command}: {done.err}")
            tap.equal(done.err.count("\n"), 1, f"sentences of {command}")


def test_closed_pipe_ends_quietly():
    reader, writer = os.pipe()
    os.close(reader)
    with Folder() as folder:
        folder.write("s.yaml", SCENE)
        for command in writers():
            write_to(writer, command, folder, ignore=True).check(code=141, err="")
            write_to(writer, command, folder).check(code=-signal.SIGPIPE, err="")
    os.close(writer)


def test_closed_stdout_is_noticed():
    with Folder() as folder:
        folder.write("s.yaml", SCENE)
        for command in writers():
            done = write_to(None, command, folder).check(code=1)
            tap.contains(done.err, ": Bad file descriptor\n")


def test_closed_streams_do_not_become_files():
    need_device()
    with Folder() as folder:
        path = folder.write("s.yaml", SCENE)
        asdic("run", path, "-o", folder / "whole").check(code=0)
        for name, redirection in (("out", ">&-"), ("err", "2>&-"), ("all", "<&- >&- 2>&-")):
            run = folder / name
            done = subprocess.run(["sh", "-c", f'"$0" run "$1" -v -o "$2" {redirection}', PATH,
                                   path, run], check=False, capture_output=True)
            tap.equal(done.returncode, 0, f"exit code with {redirection}")
            same(folder, "whole", name)


tap.main(globals())
