"""What a slip may change, and what it leaves alone."""
import pathlib

import slips
import tap

SOURCE = '''/* a < b */
#include <stdio.h>
#define LIMIT 1e-3 /* m */
#define MOST(a, b) ((a) > (b) ? (a) : (b))
static int *at(const int *p, double x) { // x + 1
    const char *text = "1 < 2";
    return !text[0] && x <= 2.5f ? p : p->next + 07u;
}
'''


def changes(source):
    return [(s.line, s.old, s.new) for s in slips.find("lib/a.c", source)]


def test_operators_and_constants():
    tap.equal(changes(SOURCE), [
        (3, "1e-3", "0.0011"),
        (7, "!", ""), (7, "0", "1"), (7, "&&", "||"), (7, "<=", "<"), (7, "<=", ">="), (7, "2.5f", "2.75f"),
        (7, "+", "-"), (7, "07u", "8u"), (7, "07u", "6u"),
    ])  # fmt: skip


def test_pointers_and_products():
    tap.equal(changes("int *a = &b, c = *d * *e;"), [(1, "*", "/")])


def test_the_greater_of_two_is_the_same_where_they_are_equal():
    tap.equal(changes("int c = a > b ? a : b;"), [(1, ">", "<")])
    tap.equal(changes("int c = a > b ? (int)a : (uint32_t)b;"), [(1, ">", "<")])
    tap.equal(changes("int c = n->most <= 7 ? 7 : n->most;"),
              [(1, "<=", ">="), (1, "7", "8"), (1, "7", "6"), (1, "7", "8"), (1, "7", "6")])  # fmt: skip
    tap.equal(changes("int c = a > b ? b : a + 1;")[:2], [(1, ">", ">="), (1, ">", "<")])
    tap.equal(changes("int c = a > b ? a : c;"), [(1, ">", ">="), (1, ">", "<")])
    tap.equal(changes("int c = x + a > b ? a : b;")[1:], [(1, ">", ">="), (1, ">", "<")])


def test_a_slip_is_known_again_when_lines_move():
    first = slips.find("lib/a.c", SOURCE)[4]
    moved = slips.find("lib/a.c", "\n\n" + SOURCE)[4]
    tap.equal(first.key(), moved.key())
    tap.equal(moved.line, first.line + 2)


def test_one_token_is_changed():
    for slip in slips.find("lib/a.c", SOURCE):
        changed = slip.apply(SOURCE)
        tap.equal(len(changed) - len(SOURCE), len(slip.new) - len(slip.old))
        tap.equal(changed[: slip.start], SOURCE[: slip.start])
        tap.equal(changed[slip.start + len(slip.new) :], SOURCE[slip.start + len(slip.old) :])


def test_every_source_has_slips_at_their_places():
    root = pathlib.Path(__file__).resolve().parents[2]
    for path in sorted((root / "lib").rglob("*.c")):
        source = path.read_text()
        for slip in slips.find(str(path), source):
            tap.equal(source[slip.start : slip.start + len(slip.old)], slip.old)
            tap.equal(source.count("\n", 0, slip.start) + 1, slip.line)


tap.main(globals())
