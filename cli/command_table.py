"""The table of commands as `asdic help --json` prints it, and the words in it that a shell can offer."""
import json
import re
import subprocess


def answer_of(program, *words):
    return json.loads(subprocess.run([program, *words], capture_output=True, check=True).stdout)


def read_commands(program):
    """Every command; to what the program prints is added "words", see first_operands."""
    commands = answer_of(program, "help", "--json")
    for command in commands:
        command["words"] = first_operands(program, command, commands)
    return commands


def first_operands(program, command, commands):
    """What the first operand may be where it is one of a few words: 'error|fan|loop', [COMMAND]."""
    first = (command["operands"].split() or [""])[0].strip("[]")
    if first == "COMMAND":
        return [other["name"] for other in commands]
    if first == "NAME":
        return [model["name"] for model in answer_of(program, command["name"], "--json")]
    return first.split("|") if re.fullmatch(r"[a-z]+(\|[a-z]+)+", first) else []


def takes_files(command):
    return re.search(r"SCENE|MESH|DIR", command["operands"]) is not None


def takes_file(option):
    return option["arg"] is not None and re.search(r"FILE|DIR", option["arg"]) is not None


def option_words(option):
    """The words an option takes where its help begins with them: 'auto, all, cpu ...', 'ca or os'. Parentheses do not count."""
    if option["arg"] in (None, "N") or takes_file(option):
        return []
    word = r"[a-z][a-z0-9-]+"
    text = re.sub(r" \([^)]*\)", "", option["help"])
    found = re.match(rf"(?:of )?((?:{word}, )+{word}(?: or {word})?|{word} or {word})", text)
    return re.split(", | or ", found.group(1)) if found else []
