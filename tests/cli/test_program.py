"""The program itself: usage, help, suggestions, colours, output that cannot be written."""
import os
import signal
import subprocess

import tap
from program import PATH, Result, asdic, asdic_on_terminal


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
    for mistake, answer in (("-x", "unknown option '-x'"), ("-qx", "unknown option '-x'"),
                            ("--json=1", "option '--json' takes no value"),
                            ("--ver=2", "option '--verbose' takes no value")):
        tap.contains(asdic("devices", mistake).check(code=2, out="").err, answer)


def test_too_many_operands_are_refused():
    tap.contains(asdic("devices", "extra").check(code=2, out="").err, "does not take 'extra'")


def test_colours_are_for_terminals_only():
    tap.lacks(asdic("devcies").err, "\033")
    shown = asdic_on_terminal("devcies").check(code=2).err
    tap.contains(shown, "\033[1;31merror:\033[0m unknown command")
    tap.lacks(asdic_on_terminal("devcies", NO_COLOR="1").err, "\033")
    tap.contains(asdic_on_terminal("devcies", NO_COLOR="").err, "\033")
    tap.lacks(asdic_on_terminal("devcies", TERM="dumb").err, "\033")


def test_full_disk_is_noticed():
    if not os.path.exists("/dev/full"):
        raise tap.Skip("there is no /dev/full")
    with open("/dev/full", "w", encoding="utf-8") as full:
        done = subprocess.run([PATH, "help"], stdout=full, stderr=subprocess.PIPE, text=True,
                              check=False)
    Result(done.returncode, "", done.stderr).check(
        code=1, err="error: cannot write to standard output: No space left on device\n")


def with_closed_pipe(ignore):
    """'asdic help' when nobody reads its output; IGNORE: the parent ignores SIGPIPE."""
    reader, writer = os.pipe()
    os.close(reader)
    done = subprocess.run([PATH, "help"], stdout=writer, stderr=subprocess.PIPE, text=True,
                          check=False, restore_signals=False,
                          preexec_fn=lambda: signal.signal(
                              signal.SIGPIPE, signal.SIG_IGN if ignore else signal.SIG_DFL))
    os.close(writer)
    return Result(done.returncode, "", done.stderr)


def test_closed_pipe_ends_quietly():
    with_closed_pipe(ignore=True).check(code=141, err="")
    with_closed_pipe(ignore=False).check(code=-signal.SIGPIPE, err="")


tap.main(globals())
