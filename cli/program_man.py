"""Makes the manual pages of the program, asdic(1) and asdic-COMMAND(1) for every command, from
what `asdic help --json` prints.

    program_man.py ASDIC VERSION FOLDER
"""
import os
import sys

from command_table import option_words, read_commands
from scene_man import escape

DESCRIPTION = """\
asdic simulates the pings of a forward-looking sonar. It traces rays on any OpenCL 1.2 device,
follows published laws of propagation, scattering and noise, and gives calibrated levels in dB re
1 uPa for each beam and range bin. A scene file holds everything that a simulation depends on, see
asdic-scene(5). The same scene and seed give the same bytes.

Data goes to files, or to standard output where a command says so. Messages and a progress bar go
to standard error, the bar only if that is a terminal. A file is written as NAME.part and renamed
when it is complete."""

EXIT_STATUS = [
    ("0", "Done."),
    ("1", "Failed while running: input or output, memory, or a lost device."),
    ("2", "The command line is wrong."),
    ("3", "An input file is missing, malformed or out of range."),
    ("4", "No device is usable, or its compiler refused the kernels."),
    ("130, 143", "Interrupted by SIGINT or SIGTERM. The first signal lets the ping finish and leaves "
                 "a run that --resume continues; a second one ends the program at once."),
    ("141", "The reader of standard output has closed it."),
]

ENVIRONMENT = [
    ("ASDIC_DEVICE", "The default of --device."),
    ("NO_COLOR", "If set and not empty, messages have no colour."),
    ("POCL_CACHE_DIR", "Where PoCL, the driver for processors, keeps compiled kernels."),
    ("ASDIC_KERNEL_DIR", "A folder from which the kernel sources are read, for those who change them."),
]


def paragraphs(text):
    return escape(text).replace("\n\n", "\n.PP\n")


def pairs(rows):
    return [f".TP\n.B {escape(name)}\n{escape(text)}" for name, text in rows]


def head(name, about, version):
    return [f'.TH {escape(name.upper())} 1 "" "asdic {version}" "User commands"',
            f".SH NAME\n{escape(name)} \\- {escape(about)}"]


def option_rows(options):
    rows = []
    for option in options:
        names = [f"-{option['letter']}"] if option["letter"] else []
        names.append(f"--{option['name']}")
        arg = f" \\fI{escape(option['arg'])}\\fR" if option["arg"] else ""
        words = option["help"]
        if words.split()[0].isalpha() and not option_words(option):
            words = words[0].upper() + words[1:]
        rows.append(".TP\n" + ", ".join(f"\\fB{escape(name)}\\fR" for name in names) + arg +
                    f"\n{escape(words)}.")
    return rows


def see_also(pages):
    return ".SH SEE ALSO\n" + ",\n".join(f".BR {escape(name)} ({section})" for name, section in pages)


def page_name(command):
    return f"asdic-{command['name']}"


def program_page(commands, version):
    common = [o for o in commands[0]["options"] if all(o in c["options"] for c in commands)]
    return [*head("asdic", "simulate forward-looking sonar on any OpenCL device", version),
            ".SH SYNOPSIS\n\\fBasdic\\fR \\fIcommand\\fR [\\fIoption\\fR...] [\\fIoperand\\fR...]",
            ".br\n\\fBasdic \\-\\-version\\fR",
            ".SH DESCRIPTION\n" + paragraphs(DESCRIPTION),
            ".SH COMMANDS",
            *(f".TP\n.BR {escape(page_name(c))} (1)\n{escape(c['summary'][0].upper() + c['summary'][1:])}."
              for c in commands),
            ".SH OPTIONS\nEvery command takes these options.", *option_rows(common),
            ".SH EXIT STATUS", *pairs(EXIT_STATUS),
            ".SH ENVIRONMENT", *pairs(ENVIRONMENT),
            see_also([(page_name(c), 1) for c in commands] + [("asdic-scene", 5), ("clinfo", 1)])]


def command_page(command, commands, version):
    operands = f" \\fI{escape(command['operands'])}\\fR" if command["operands"] else ""
    text = command["details"]
    words = text + command["examples"] + "".join(option["help"] for option in command["options"])
    named = [other for other in commands if other is not command and f"asdic {other['name']}" in words]
    return [*head(page_name(command), command["summary"], version),
            f".SH SYNOPSIS\n\\fBasdic {escape(command['name'])}\\fR [\\fIoption\\fR...]{operands}",
            ".SH DESCRIPTION\n" + paragraphs(text),
            ".SH OPTIONS", *option_rows(command["options"]),
            ".SH EXAMPLES\n.nf\n" + escape(command["examples"]) + "\n.fi",
            ".SH EXIT STATUS\nThe same for every command, see\n.BR asdic (1).",
            see_also([("asdic", 1), *((page_name(c), 1) for c in named), ("asdic-scene", 5)])]


def write(folder, name, parts):
    with open(os.path.join(folder, name), "w", encoding="utf-8") as out:
        out.write("\n".join(parts) + "\n")


def main():
    program, version, folder = sys.argv[1:4]
    commands = read_commands(program)
    write(folder, "asdic.1", program_page(commands, version))
    for command in commands:
        write(folder, f"{page_name(command)}.1", command_page(command, commands, version))


if __name__ == "__main__":
    main()
