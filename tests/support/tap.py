"""Tests in Python: every function test_* of a module becomes one line, ok or not ok (TAP).

    import tap
    def test_something():
        tap.equal(1 + 1, 2)
    tap.main(globals())
"""
import concurrent.futures
import sys
import traceback


class Skip(Exception):
    """Raised by a test that cannot run here, with the reason."""


def equal(actual, expected, what="value"):
    if actual != expected:
        raise AssertionError(f"{what} is {actual!r}, expected {expected!r}")


def contains(text, part):
    if part not in text:
        raise AssertionError(f"{text!r} does not contain {part!r}")


def lacks(text, part):
    if part in text:
        raise AssertionError(f"{text!r} contains {part!r}")


def main(module, at_once=1):
    """Exit code 0 when all pass or skip, 77 when all skip, else 1. Arguments select by name. AT_ONCE: as many tests
    run in threads of their own, for tests that wait for most of their time."""
    tests = [(name, f) for name, f in module.items() if name.startswith("test_") and callable(f)]
    if len(sys.argv) > 1:
        tests = [(name, f) for name, f in tests if name in sys.argv[1:]]
    failed = skipped = 0
    print(f"1..{len(tests)}")
    if at_once > 1:
        pool = concurrent.futures.ThreadPoolExecutor(at_once)
        tests = [(name, pool.submit(function).result) for name, function in tests]
    for number, (name, function) in enumerate(tests, 1):
        title = name[5:].replace("_", " ")
        try:
            function()
            print(f"ok {number} - {title}")
        except Skip as reason:
            skipped += 1
            print(f"ok {number} - {title} # SKIP {reason}")
        except Exception:  # a test may fail in any way
            failed += 1
            print(f"not ok {number} - {title}")
            print("# " + traceback.format_exc().strip().replace("\n", "\n# "))
        sys.stdout.flush()
    sys.exit(1 if failed or not tests else 77 if skipped == len(tests) else 0)
