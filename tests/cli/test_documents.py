"""Manual pages and completions, made from the command table."""
import json
import os
import re
import shutil
import subprocess

import tap
from program import PATH, asdic

BUILD = os.path.dirname(PATH)
COMMANDS = json.loads(asdic("help", "--json").check(code=0, err="").out)


def read(name):
    with open(os.path.join(BUILD, name), encoding="utf-8") as file:
        return file.read()


def need(program):
    if not shutil.which(program):
        raise tap.Skip(f"there is no {program}")


def syntax_only(*command):
    need(command[0])
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    tap.equal((done.returncode, done.stderr), (0, ""), "exit code and messages")


def test_table_has_every_command_of_help():
    listed = asdic("help").out
    tap.equal({"devices", "help"} <= {c["name"] for c in COMMANDS}, True, "commands are found")
    for command in COMMANDS:
        tap.contains(listed, f"\n  {command['name']} ")
        tap.contains(json.dumps(command["options"]), '"help"')


def pages():
    return ["asdic.1", "asdic-scene.5"] + [f"asdic-{c['name']}.1" for c in COMMANDS]


def test_every_command_has_a_page_with_every_option():
    program = read("asdic.1").replace("\\-", "-")
    for command in COMMANDS:
        text = read(f"asdic-{command['name']}.1").replace("\\-", "-")
        tap.contains(text, f"\\fBasdic {command['name']}\\fR")
        tap.contains(text.lower(), command["summary"].lower())
        for option in command["options"]:
            tap.contains(text, f"--{option['name']}\\fR")
        for part in ("COMMANDS", "SEE ALSO"):
            section = program.split(f".SH {part}\n")[1].split(".SH")[0]
            tap.contains(section, f".BR asdic-{command['name']} (1)")
        tap.equal(len(command["details"]) > 40, True, "there is something to read")
        section = text.split(".SH EXAMPLES\n")[1].split(".SH")[0]
        tap.contains(section, f"asdic {command['name']}")
        tap.equal(command["details"] in program, False, "text of a command stands twice")


def test_examples_use_options_that_exist():
    for command in COMMANDS:
        for line in command["examples"].splitlines():
            for words in re.findall(r"asdic (\w[^|&;<>]*)", line):
                name, *rest = words.split()
                options = {f"--{o['name']}": o for c in COMMANDS if c["name"] == name for o in c["options"]}
                options |= {f"-{o['letter']}": o for o in options.values()}
                tap.equal([word for word in rest if word.startswith("-") and word[1:2].isalpha() | (word[:2] == "--")
                           and word.split("=")[0] not in options], [], line)


def test_a_word_that_is_to_be_typed_keeps_its_case():
    tap.contains(read("asdic-detect.1"), "\nca or os:")
    tap.contains(read("asdic-expect.1"), "\ncorrected or printed")


def test_every_page_that_is_named_exists():
    for page in pages():
        for name, section in re.findall(r"(asdic[-a-z]*) ?\((\d)\)", read(page).replace("\\-", "-")):
            tap.contains(pages(), f"{name}.{section}")


def test_manuals_render_without_a_warning():
    for name, *lint in (["groff", "-man", "-ww", "-Tutf8"], ["mandoc", "-Tlint", "-Wwarning"]):
        if name == "groff":
            need(name)
        elif not shutil.which(name):
            continue
        for page in pages():
            done = subprocess.run([name, *lint, os.path.join(BUILD, page)], capture_output=True,
                                  text=True, check=False)
            complaints = [line for line in (done.stderr + ("" if name == "groff" else done.stdout)).splitlines()
                          if "missing date" not in line]
            tap.equal((done.returncode if name == "groff" else 0, complaints), (0, []), f"{name} on {page}")


def complete(*words):
    """What bash offers for the last of WORDS."""
    need("bash")
    script = ('source "$0"; COMP_WORDS=("$@"); COMP_CWORD=$(($# - 1)); compopt() { :; }; _asdic; '
              'printf "%s\\n" "${COMPREPLY[@]}"')
    done = subprocess.run(["bash", "-c", script, os.path.join(BUILD, "completions", "asdic"),
                           *words], capture_output=True, text=True, check=False)
    tap.equal(done.stderr, "", "messages of bash")
    return done.stdout.split()


def test_bash_completes_commands_options_and_values():
    tap.equal(complete("asdic", "dev"), ["devices"])
    tap.equal(complete("asdic", "devices", "--j"), ["--json"])
    tap.equal(complete("asdic", "model", "--device", "c"), ["cpu"])
    tap.equal(complete("asdic", "help", "dev"), ["devices"])
    tap.equal(complete("asdic", "run", "--sampler", ""), ["adaptive", "beam", "uniform-sphere"])
    tap.equal(complete("asdic", "run", "--kernel", "f"), ["frustum64"])
    tap.equal(complete("asdic", "detect", "--cfar", ""), ["ca", "os"])
    for command in ("run", "expect", "plan"):
        tap.equal(complete("asdic", command, "--refraction", ""), ["full", "layer", "off"])
    tap.equal(complete("asdic", "detect", "--background", ""), ["auto", "flat", "simulated", "cfar"])
    tap.equal(complete("asdic", "bench", "--kernel", "p"), ["pkt16"])
    tap.equal(complete("asdic", "roc", "--target", "swerling3"), ["swerling3"])
    tap.equal(complete("asdic", "serve", "--format", "")[-1:], ["raw"])
    tap.equal(complete("asdic", "bench", "--threads", ""), [], "a number")
    tap.contains(complete("asdic", "check", BUILD + "/comp"), BUILD + "/completions")
    tap.equal(complete("asdic", "bench", "lo"), ["loop"])
    tap.contains(complete("asdic", "bench", "loop", BUILD + "/comp"), BUILD + "/completions")
    tap.equal(complete("asdic", "model", "absor"), ["absorption"])
    tap.equal(complete("asdic", "devices", ""), [], "no operand")


def test_fish_completes():
    need("fish")
    script = "source $argv[1]; complete -C $argv[2]"
    for line, expected in (("asdic ren", "render"), ("asdic run --sam", "--sampler"), ("asdic help mod", "model"),
                           ("asdic roc --target swerling2", "swerling2"), ("asdic bench lo", "loop"),
                           ("asdic model absor", "absorption")):
        done = subprocess.run(["fish", "-c", script, os.path.join(BUILD, "completions", "asdic.fish"), line],
                              capture_output=True, text=True, check=False)
        tap.equal([offer.split("\t")[0] for offer in done.stdout.splitlines()], [expected], line)


def test_bash_zsh_and_fish_accept_their_completions():
    syntax_only("bash", "-n", os.path.join(BUILD, "completions", "asdic"))
    for shell, name in (("zsh", "_asdic"), ("fish", "asdic.fish")):
        if shutil.which(shell):
            syntax_only(shell, "-n", os.path.join(BUILD, "completions", name))


tap.main(globals())
