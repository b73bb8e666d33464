"""Manual pages and completions, made from the command table."""
import json
import os
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


def test_manual_names_every_command_and_option():
    text = read("asdic.1").replace("\\-", "-")
    for command in COMMANDS:
        tap.contains(text, f"\\fBasdic {command['name']}\\fR")
        for option in command["options"]:
            tap.contains(text, f"--{option['name']}\\fR")


def test_manuals_render_without_a_warning():
    need("groff")
    for page in ("asdic.1", "asdic-scene.5"):
        done = subprocess.run(["groff", "-man", "-ww", "-Tutf8", os.path.join(BUILD, page)],
                              capture_output=True, text=True, check=False)
        tap.equal((done.returncode, done.stderr), (0, ""), f"groff on {page}")
        tap.contains(done.stdout, "asdic")


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
    tap.contains(complete("asdic", "check", BUILD + "/comp"), BUILD + "/completions")


def test_bash_zsh_and_fish_accept_their_completions():
    syntax_only("bash", "-n", os.path.join(BUILD, "completions", "asdic"))
    for shell, name in (("zsh", "_asdic"), ("fish", "asdic.fish")):
        if shutil.which(shell):
            syntax_only(shell, "-n", os.path.join(BUILD, "completions", name))


tap.main(globals())
