"""Slips: single operators and constants of C and OpenCL C that somebody may get wrong.

A slip is one token replaced by another. Comments, strings, preprocessor lines other than the value of a
#define, and declarations at file scope of types are left alone.
"""
import re
from dataclasses import dataclass

TOKEN = re.compile(
    r"""(?P<space>\s+)
  | (?P<comment>/\*.*?\*/ | //[^\n]*)
  | (?P<string>"(?:\\.|[^"\\\n])*" | '(?:\\.|[^'\\\n])*')
  | (?P<number>0[xX][0-9a-fA-F]+[uUlL]* | (?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?[fFuUlL]*)
  | (?P<name>[A-Za-z_]\w*)
  | (?P<operator><<=|>>=|->|\+\+|--|<<|>>|<=|>=|==|!=|&&|\|\||[-+*/%&|^]=|[-+*/%<>=!&|^~?:;,.(){}\[\]\#])
  | (?P<other>.)""",
    re.VERBOSE | re.DOTALL,
)

SWAPS = {
    "<": ["<=", ">"], "<=": ["<", ">="], ">": [">=", "<"], ">=": [">", "<="],
    "==": ["!="], "!=": ["=="], "&&": ["||"], "||": ["&&"],
    "+": ["-"], "-": ["+"], "*": ["/"], "/": ["*"],
    "+=": ["-="], "-=": ["+="], "*=": ["/="], "/=": ["*="], "<<": [">>"], ">>": ["<<"],
    "!": [""], "true": ["false"], "false": ["true"],
}  # fmt: skip


@dataclass(frozen=True)
class Slip:
    path: str  # from the root
    start: int  # offset of the token
    old: str
    new: str
    line: int
    text: str  # the line, stripped
    nth: int  # of the same tokens in that line, from 0

    def apply(self, source):
        assert source.startswith(self.old, self.start)
        return source[: self.start] + self.new + source[self.start + len(self.old) :]

    def name(self):
        return f"{self.path}:{self.line}: '{self.old}' to '{self.new}'"

    def key(self):
        """By which a slip is known again when lines move."""
        return self.path, self.text, self.old, self.new, str(self.nth)


def other_numbers(token):
    """What a constant may become by mistake: one more, one less; a tenth more."""
    if re.fullmatch(r"0[xX][0-9a-fA-F]+[uUlL]*|\d+[uUlL]*", token):
        body = token.rstrip("uUlL")
        suffix = token[len(body) :]
        octal = len(body) > 1 and body.isdigit() and body[0] == "0"
        value = int(body, 8 if octal else 0)
        return [f"{other}{suffix}" for other in (value + 1, value - 1) if other >= 0]
    body = token.rstrip("fFlL")
    other = repr(1.1 * float(body) or 1.0)  # always with a point or an exponent
    return [other + token[len(body) :]]


def _kept(source):
    """Tokens outside comments, strings and preprocessor lines, each as (kind, text, start)."""
    directive = False  # inside a preprocessor line that is no #define
    at_line_start = True
    tokens = []
    for match in TOKEN.finditer(source):
        kind, text = match.lastgroup, match.group()
        if kind == "space":
            if "\n" in text:
                continued = source[: match.start()].endswith("\\")
                directive = directive and continued
                at_line_start = not continued
            continue
        if kind == "comment":
            continue
        if text == "#" and at_line_start:
            directive = not re.match(r"#\s*define\s+\w+\s+[^(\s]", source[match.start() :])
        at_line_start = False
        if not directive:
            tokens.append((kind, text, match.start()))
    return tokens


CHOICE = re.compile(r"\s*(?P<right>[^\s?:;&|]+(?:\([^()]*\))?)\s*\?\s*(?P<yes>[^?:;]+?)\s*:\s*(?P<no>[^?:;]+)")
CAST = re.compile(r"\((?:\w+_t|double|float|int|unsigned)\)")
CALLED = re.compile(r"[\w.>\[\]-]+(?:\([^()]*\))?$")


def is_same_choice(source, start, old, new):
    """Whether only equal sides tell them apart, and these are what is chosen: a < b ? a : b is a <= b ? a : b."""
    if {old, new} not in ({"<", "<="}, {">", ">="}):
        return False
    before = source[max(0, start - 80) : start].rstrip()
    left = CALLED.search(before)
    choice = CHOICE.match(CAST.sub("", source[start + len(old) : start + 160]))
    if not left or not choice or not re.search(r"([=(,:?]|&&|\|\||return)$", before[: left.start()].rstrip()):
        return False  # part of a sum, say
    a, b = left.group().lstrip("-"), choice["right"]
    no = choice["no"].strip()
    ends = [no[: len(side)] == side and not re.match(r"\s*[\w.(*/%+-]", no[len(side) :]) for side in (a, b)]
    return choice["yes"] == a and ends[1] or choice["yes"] == b and ends[0]


def find(path, source):
    """Every slip of a file, in its order; not those that change nothing whatever the values are."""
    starts = [0] + [m.end() for m in re.finditer("\n", source)]
    slips, line, seen = [], 0, {}
    for kind, text, start in _kept(source):
        while line + 1 < len(starts) and starts[line + 1] <= start:
            line += 1
        if kind == "number":
            others = other_numbers(text)
        elif text == "*" and source[start + 1 : start + 2] not in " \n":
            continue  # a pointer: clang-format puts spaces around products
        else:
            others = SWAPS.get(text, []) if kind in ("operator", "name") else []
        nth = seen[line, text] = seen.get((line, text), -1) + 1
        end = source.find("\n", start)
        whole = source[starts[line] : end if end >= 0 else None].strip()
        slips += [Slip(path, start, text, new, line + 1, whole, nth) for new in others
                  if not is_same_choice(source, start, text, new)]  # fmt: skip
    return slips
