"""Completions for a shell, from what `asdic help --json` prints.

    completions.py ASDIC bash|zsh|fish
"""
import json
import re
import subprocess
import sys


def quoted(text):
    return "'" + text.replace("'", "'\\''") + "'"


def words_of(option):
    """The words an option takes where its help begins with them: 'auto, all, cpu ...', 'ca or os'."""
    if option["arg"] in (None, "N") or takes_file(option):
        return []
    word = r"[a-z][a-z0-9-]+"
    found = re.match(rf"(?:{word}, )+{word}(?: or {word})?|{word} or {word}", option["help"])
    return re.split(", | or ", found.group(0)) if found else []


def takes_file(option):
    return option["arg"] is not None and re.search(r"FILE|DIR", option["arg"]) is not None


def bash(commands):
    names = " ".join(c["name"] for c in commands)
    out = ["# bash completion of asdic", "# shellcheck shell=bash", "_asdic() {", "    local options values words=",
           "    local current=${COMP_WORDS[COMP_CWORD]} previous=${COMP_WORDS[COMP_CWORD - 1]}",
           "    COMPREPLY=()", "    if [[ $COMP_CWORD -eq 1 ]]; then",
           f"        mapfile -t COMPREPLY < <(compgen -W '{names} --help --version' -- \"$current\")",
           "        return", "    fi", "    case ${COMP_WORDS[1]} in"]
    for c in commands:
        options = " ".join(f"--{o['name']}" for o in c["options"])
        out += [f"    {c['name']})", f"        options='{options}'", "        case $previous in"]
        for o in c["options"]:
            if o["arg"]:
                name = f"--{o['name']}" + (f" | -{o['letter']}" if o["letter"] else "")
                words = " ".join(words_of(o))
                out.append(f"        {name}) values={'file' if takes_file(o) else 'other'} "
                           f"words='{words}' ;;")
        out += ["        *) ;;", "        esac", "        ;;"]
    names = " ".join(c["name"] for c in commands)
    out += ["    *) return ;;", "    esac",
            "    if [[ ${COMP_WORDS[1]} == help ]]; then", f"        options=\"$options {names}\"",
            "    fi",
            "    if [[ $values == other ]]; then",
            "        mapfile -t COMPREPLY < <(compgen -W \"$words\" -- \"$current\")",
            "    elif [[ -z $values && ( $current == -* || ${COMP_WORDS[1]} == help ) ]]; then",
            "        mapfile -t COMPREPLY < <(compgen -W \"$options\" -- \"$current\")",
            "    else",
            "        compopt -o filenames",
            "        mapfile -t COMPREPLY < <(compgen -f -- \"$current\")",
            "    fi", "}", "complete -F _asdic asdic"]
    return out


def zsh_option(option):
    # In a specification brackets and colons have a meaning.
    text = re.sub(r"([\[\]:\\])", r"\\\1", option["help"])
    action = ""
    if option["arg"]:
        words = " ".join(words_of(option))
        arg = re.sub(r"([\[\]:\\])", r"\\\1", option["arg"])
        action = f":{arg}:" + (f"({words})" if words else "_files" if takes_file(option) else "")
    names = [f"--{option['name']}"] + ([f"-{option['letter']}"] if option["letter"] else [])
    return [quoted(f"{name}[{text}]{action}") for name in names]


def zsh(commands):
    out = ["#compdef asdic", "_asdic() {", "  if (( CURRENT == 2 )); then",
           "    local -a commands=("]
    out += [f"      {quoted(c['name'] + ':' + c['summary'])}" for c in commands]
    out += ["    )", "    _describe command commands", "    return", "  fi",
            "  local command=$words[2]", "  shift words", "  (( CURRENT-- ))",
            "  case $command in"]
    for c in commands:
        out.append(f"    {c['name']})")
        specs = [spec for option in c["options"] for spec in zsh_option(option)]
        specs.append(quoted("*:operand:" + (f"({' '.join(x['name'] for x in commands)})"
                                            if c["name"] == "help" else "_files")))
        out.append("      _arguments \\\n        " + " \\\n        ".join(specs) + " ;;")
    out += ["  esac", "}", '_asdic "$@"']
    return out


def fish(commands):
    out = ["# fish completion of asdic", "complete -c asdic -n __fish_use_subcommand -f"]
    for c in commands:
        out.append(f"complete -c asdic -n __fish_use_subcommand -a {c['name']} "
                   f"-d {quoted(c['summary'])}")
        for o in c["options"]:
            line = (f"complete -c asdic -n '__fish_seen_subcommand_from {c['name']}' "
                    f"-l {o['name']} -d {quoted(o['help'])}")
            if o["letter"]:
                line += f" -s {o['letter']}"
            if o["arg"]:
                line += " -r" if takes_file(o) else " -x"
                if words_of(o):
                    line += f" -a {quoted(' '.join(words_of(o)))}"
            out.append(line)
    names = " ".join(c["name"] for c in commands)
    return [*out, f"complete -c asdic -n '__fish_seen_subcommand_from help' -f -a {quoted(names)}"]


def main():
    program, shell = sys.argv[1:3]
    done = subprocess.run([program, "help", "--json"], capture_output=True, check=True)
    print("\n".join({"bash": bash, "zsh": zsh, "fish": fish}[shell](json.loads(done.stdout))))


if __name__ == "__main__":
    main()
