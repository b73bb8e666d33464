"""asdic(1), the manual page of the program, from what `asdic help --json` prints.

    program_man.py ASDIC VERSION > asdic.1
"""
import json
import subprocess
import sys

from scene_man import escape

DESCRIPTION = """\
asdic simulates the pings of a forward-looking sonar: it traces rays on any OpenCL 1.2 device,
follows published laws of propagation, scattering and noise, and gives calibrated levels in dB re
1 uPa per beam and range bin. A scene file says all that a simulation depends on, see
asdic-scene(5); the same scene and seed give the same bytes.

Data goes to files, or to standard output where a command says so; messages and a progress bar go
to standard error, the bar only when that is a terminal. A file is written under its name with
.part behind it and renamed when it is complete."""

EXIT_STATUS = [
    ("0", "Done."),
    ("1", "Failed while running: input or output, memory, a device that was lost."),
    ("2", "The command line is wrong."),
    ("3", "An input file is missing, malformed or out of range."),
    ("4", "There is no usable device, or its compiler refused the kernels."),
    ("130, 143", "Interrupted by SIGINT, SIGTERM. The first one lets the ping finish and leaves a "
                 "run that --resume continues; the second ends the program at once."),
    ("141", "Nobody reads standard output."),
]

ENVIRONMENT = [
    ("ASDIC_DEVICE", "What --device takes when it is not given."),
    ("NO_COLOR", "When set and not empty, messages have no colour."),
    ("POCL_CACHE_DIR", "Where PoCL, the driver for processors, keeps compiled kernels."),
    ("ASDIC_KERNEL_DIR", "A folder to read the kernel sources from, for those who change them."),
]


def paragraphs(text):
    return escape(text).replace("\n\n", "\n.PP\n")


def print_pairs(pairs):
    for name, text in pairs:
        print(f".TP\n.B {escape(name)}\n{escape(text)}")


def print_option(option):
    names = [f"-{option['letter']}"] if option["letter"] else []
    names.append(f"--{option['name']}")
    arg = f" \\fI{escape(option['arg'])}\\fR" if option["arg"] else ""
    print(".TP\n" + ", ".join(f"\\fB{escape(name)}\\fR" for name in names) + arg)
    words = option["help"]
    if words.split()[0].isalpha():  # not a list of values
        words = words[0].upper() + words[1:]
    print(escape(words) + ".")


def print_command(command, common):
    operands = f" \\fI{escape(command['operands'])}\\fR" if command["operands"] else ""
    print(f".SS \\fBasdic {escape(command['name'])}\\fR [\\fIoption\\fR...]{operands}")
    summary = command["summary"]
    print(escape(summary[0].upper() + summary[1:]) + ".")
    if command["details"]:
        print(".PP\n" + paragraphs(command["details"]))
    for option in command["options"]:
        if option not in common:
            print_option(option)


def main():
    program, version = sys.argv[1:3]
    done = subprocess.run([program, "help", "--json"], capture_output=True, check=True)
    commands = json.loads(done.stdout)
    common = [o for o in commands[0]["options"] if all(o in c["options"] for c in commands)]
    print(f'.TH ASDIC 1 "" "asdic {version}" "User commands"')
    print(".SH NAME\nasdic \\- simulate forward\\-looking sonar on any OpenCL device")
    print(".SH SYNOPSIS\n\\fBasdic\\fR \\fIcommand\\fR [\\fIoption\\fR...] [\\fIoperand\\fR...]")
    print(".br\n\\fBasdic \\-\\-version\\fR")
    print(".SH DESCRIPTION\n" + paragraphs(DESCRIPTION))
    print(".SH COMMANDS")
    for command in commands:
        print_command(command, common)
    print(".SH OPTIONS\nEvery command takes")
    for option in common:
        print_option(option)
    print(".SH EXIT STATUS")
    print_pairs(EXIT_STATUS)
    print(".SH ENVIRONMENT")
    print_pairs(ENVIRONMENT)
    print(".SH SEE ALSO\n.BR asdic\\-scene (5),\n.BR clinfo (1)")


if __name__ == "__main__":
    main()
