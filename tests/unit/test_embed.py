"""kernels/embed.py: includes once, #line names, dependencies, errors."""
import os
import subprocess
import sys
import tempfile

import tap

EMBED = sys.argv.pop(1)


def embed(files, entry="a.cl"):
    """Runs embed.py on FILES (name: text); returns exit code, C text, depfile, messages."""
    with tempfile.TemporaryDirectory() as root:
        for name, text in files.items():
            path = os.path.join(root, name)
            os.makedirs(os.path.dirname(path), exist_ok=True)
            with open(path, "w", encoding="utf-8") as file:
                file.write(text)
        done = subprocess.run(
            [sys.executable, EMBED, "--root", root, "--output", f"{root}/out.c",
             "--depfile", f"{root}/out.d", f"{root}/{entry}"],
            capture_output=True, text=True, check=False)
        texts = []
        for name in ("out.c", "out.d"):
            path = os.path.join(root, name)
            texts.append(open(path).read() if os.path.exists(path) else "")
        return done.returncode, texts[0], texts[1].replace(root + "/", ""), done.stderr


GUARDED = "#ifndef H\n#define H\nint {};\n#endif\n"


def test_include_is_placed_once_with_line_numbers():
    code, text, _, _ = embed({"a.cl": '#include "h.h"\n#include "h.h"\nint a;\n',
                              "h.h": GUARDED.format("from_h")})
    tap.equal(code, 0)
    tap.equal(text.count("from_h"), 1, "number of copies")
    lines = [line.strip('"').replace("\\n", "").replace('\\"', '"') for line in text.split("\n")]
    at = lines.index("int a;")
    tap.equal(lines[at - 1], '#line 3 "kernels/a.cl"')
    tap.equal(lines[lines.index("#ifndef H") - 1], '#line 1 "kernels/h.h"')


def test_include_in_a_folder_is_found_from_includer_and_root():
    code, text, _, _ = embed({"sub/a.cl": '#include "x.h"\n#include "top.h"\n',
                              "sub/x.h": GUARDED.format("x"), "top.h": GUARDED.format("top")},
                             entry="sub/a.cl")
    tap.equal(code, 0)
    tap.contains(text, '{"sub/a.cl",')
    tap.contains(text, "kernels/sub/x.h")
    tap.contains(text, "int top;")


def test_depfile_lists_every_file():
    _, _, dep, _ = embed({"a.cl": '#include "h.h"\n', "h.h": '#ifndef H\n#include "g.h"\n#endif\n',
                          "g.h": "\n"})
    tap.equal(dep.strip(), "out.c: a.cl g.h h.h")


def test_files_that_include_each_other_end():
    code, _, _, _ = embed({"a.cl": '#include "h.h"\n', "h.h": '#ifndef H\n#include "g.h"\n#endif\n',
                           "g.h": '#ifndef G\n#include "h.h"\n#endif\n'})
    tap.equal(code, 0)


def test_missing_include_is_named_with_its_line():
    code, _, _, err = embed({"a.cl": '\n#include "none.h"\n'})
    tap.equal(code, 1)
    tap.contains(err, 'kernels/a.cl:2: error: cannot find "none.h"')


def test_conditional_include_is_refused():
    code, _, _, err = embed({"a.cl": '#ifdef X\n#include "h.h"\n#endif\n', "h.h": ""})
    tap.equal(code, 1)
    tap.contains(err, "kernels/a.cl:2: error: #include under #if")


def test_host_includes_and_odd_characters_survive():
    code, text, _, _ = embed({"a.cl": '#ifndef D\n#include <math.h>\n#endif\nint a; // "?\\\té\n'})
    tap.equal(code, 0)
    tap.contains(text, '"#include <math.h>\\n"')
    tap.contains(text, '// \\"\\?\\\\\\011\\303\\251\\n"')


tap.main(globals())
