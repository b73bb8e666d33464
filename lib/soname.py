"""The name under which the loader finds a library: soname.py LIBRARY READELF COMPILER..."""
import re
import subprocess
import sys
import tempfile

with tempfile.NamedTemporaryFile(suffix=".so") as empty:
    library, readelf, *compiler = sys.argv[1:]
    subprocess.run([*compiler, "-shared", "-o", empty.name, "-x", "c", "/dev/null", "-Wl,--no-as-needed",
                    "-l" + library], check=True)
    listed = subprocess.run([readelf, "-d", empty.name], check=True, capture_output=True, text=True).stdout
print(re.search(rf"NEEDED.*\[(lib{re.escape(library)}\.so[^]]*)\]", listed).group(1))
