"""The binding is the headers: every public function, struct, enum and constant, with equal sizes, offsets
and values, as a C program that includes them prints."""
import glob
import os
import re
import subprocess
import tempfile

from package import ROOT
import tap

from asdic._native import ffi, lib

INCLUDE = os.path.join(ROOT, "lib", "include")
COMPILER = os.environ.get("CC", "cc").split()


def headers():
    """All public headers without their comments."""
    texts = []
    for path in sorted(glob.glob(os.path.join(INCLUDE, "asdic", "*.h"))):
        with open(path, encoding="utf-8") as file:
            texts.append(re.sub(r"/\*.*?\*/", "", file.read(), flags=re.S))
    return "\n".join(texts)


def printed(statements):
    """What a program of these statements prints, word by word."""
    with tempfile.TemporaryDirectory(prefix="asdic-test-") as folder:
        source, program = os.path.join(folder, "a.c"), os.path.join(folder, "a")
        with open(source, "w", encoding="ascii") as file:
            file.write("#include <asdic/asdic.h>\n#include <stddef.h>\n#include <stdio.h>\nint main(void) {\n"
                       + "\n".join(statements) + "\nreturn 0;\n}\n")
        subprocess.run([*COMPILER, "-std=gnu11", "-I", INCLUDE, source, "-o", program], check=True)
        return subprocess.run([program], check=True, capture_output=True, text=True).stdout.split()


def test_every_function():
    names = re.findall(r"ASDIC_API[^;{]*?\b(asdic_\w+)\(", headers())
    tap.equal(len(names) > 150, True, f"{len(names)} functions are found")
    tap.equal([name for name in names if not hasattr(lib, name)], [], "functions that Python lacks")


def test_every_struct():
    names = re.findall(r"typedef struct (asdic_\w+) \{", headers())
    tap.equal(len(names) > 50, True, f"{len(names)} structs are found")
    members = [(name, field) for name in names for field, _ in ffi.typeof(name).fields]
    said = printed([f'printf("%zu\\n", sizeof({name}));' for name in names] +
                   [f'printf("%zu %zu\\n", offsetof({name}, {field}), sizeof((({name} *)0)->{field}));'
                    for name, field in members])
    sizes = dict(zip(names, map(int, said)))
    tap.equal({name: ffi.sizeof(name) for name in names}, sizes, "sizes")
    found = [(int(a), int(b)) for a, b in zip(said[len(names)::2], said[len(names) + 1::2])]
    kinds = {(name, field): of for name in names for field, of in ffi.typeof(name).fields}
    tap.equal([(kinds[member].offset, ffi.sizeof(kinds[member].type)) for member in members], found, "fields")


def test_no_field_is_missing():
    """Declarators of each struct, counted in the header's text."""
    for name, body in re.findall(r"typedef struct (asdic_\w+) \{(.*?)\n\} \1;", headers(), re.S):
        declared = re.sub(r"\(\*(\w+)\)\([^)]*\)", r"\1", body)  # functions that it points to
        count = sum(len(line.split(",")) for line in declared.split(";") if line.strip())
        tap.equal(len(ffi.typeof(name).fields), count, f"fields of {name}")


def test_every_constant():
    names = re.findall(r"^#define (ASDIC_\w+) +[^\s\\(_][^\s\\]*$", headers(), re.M)
    for body in re.findall(r"\benum\b[^;{]*\{(.*?)\}", headers(), re.S):
        names += re.findall(r"\b(ASDIC_\w+)\b(?=\s*(?:=|,|$|\n|\Z))", body)
    names = [name for name in dict.fromkeys(names) if name != "ASDIC_API"]
    tap.equal(len(names) > 100, True, f"{len(names)} constants are found")
    said = [float(word) for word in printed(f'printf("%.17g\\n", (double){name});' for name in names)]
    tap.equal({name: float(getattr(lib, name)) for name in names}, dict(zip(names, said)), "constants")


tap.main(globals())
