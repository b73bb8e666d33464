"""Completions for a shell, from what `asdic help --json` prints.

    completions.py ASDIC bash|zsh|fish
"""
import re
import sys

from command_table import option_words, read_commands, takes_file, takes_files


def quoted(text):
    return "'" + text.replace("'", "'\\''") + "'"


def bash(commands):
    names = " ".join(c["name"] for c in commands)
    out = ["# bash completion of asdic", "# shellcheck shell=bash", "_asdic() {",
           "    local options values words= operands= files=",
           "    local current=${COMP_WORDS[COMP_CWORD]} previous=${COMP_WORDS[COMP_CWORD - 1]}",
           "    COMPREPLY=()", "    if [[ $COMP_CWORD -eq 1 ]]; then",
           f"        mapfile -t COMPREPLY < <(compgen -W '{names} --help --version' -- \"$current\")",
           "        return", "    fi", "    case ${COMP_WORDS[1]} in"]
    for c in commands:
        options = " ".join(f"--{o['name']}" for o in c["options"])
        out += [f"    {c['name']})", f"        options='{options}'",
                f"        operands='{' '.join(c['words'])}' files={'yes' if takes_files(c) else ''}",
                "        case $previous in"]
        for o in c["options"]:
            if o["arg"]:
                name = f"--{o['name']}" + (f" | -{o['letter']}" if o["letter"] else "")
                words = " ".join(option_words(o))
                out.append(f"        {name}) values={'file' if takes_file(o) else 'other'} "
                           f"words='{words}' ;;")
        out += ["        *) ;;", "        esac", "        ;;"]
    return [*out, "    *) return ;;", "    esac",
            "    case $values,$current in",
            "    other,*) operands=$words files= ;;",
            "    file,*) operands= files=yes ;;",
            "    ,-*) operands=$options files= ;;",
            "    esac",
            "    mapfile -t COMPREPLY < <(compgen -W \"$operands\" -- \"$current\")",
            "    if [[ -n $files ]]; then", "        compopt -o filenames",
            "        mapfile -t -O ${#COMPREPLY[@]} COMPREPLY < <(compgen -f -- \"$current\")",
            "    fi", "}", "complete -F _asdic asdic"]


def zsh_option(option):
    # In a specification brackets and colons have a meaning.
    text = re.sub(r"([\[\]:\\])", r"\\\1", option["help"])
    action = ""
    if option["arg"]:
        words = " ".join(option_words(option))
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
        if c["words"]:
            specs.append(quoted(f"1:operand:({' '.join(c['words'])})"))
        if takes_files(c):
            specs.append(quoted("*:file:_files"))
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
                if option_words(o):
                    line += f" -a {quoted(' '.join(option_words(o)))}"
            out.append(line)
        if c["words"] or not takes_files(c):
            out.append(f"complete -c asdic -n '__fish_seen_subcommand_from {c['name']}'"
                       + ("" if takes_files(c) else " -f")
                       + (f" -a {quoted(' '.join(c['words']))}" if c["words"] else ""))
    return out


def main():
    program, shell = sys.argv[1:3]
    print("\n".join({"bash": bash, "zsh": zsh, "fish": fish}[shell](read_commands(program))))


if __name__ == "__main__":
    main()
