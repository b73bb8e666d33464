"""How many triangles a mesh file holds, read apart from the library: no checks, no repairs.

A facet of n corners counts as n - 2. Returns (triangles, [(x, y, z) of every corner of a facet]);
raises ValueError or IndexError at what does not parse.
"""
import struct

NUMBERS = {"char": "b", "uchar": "B", "short": "h", "ushort": "H", "int": "i", "uint": "I",
           "float": "f", "double": "d", "int8": "b", "uint8": "B", "int16": "h", "uint16": "H",
           "int32": "i", "uint32": "I", "float32": "f", "float64": "d"}


def result(points, facets):
    return sum(len(f) - 2 for f in facets), [points[i] for f in facets for i in f]


def read_stl(content):
    count = struct.unpack("<I", content[80:84])[0] if len(content) >= 84 else -1
    if len(content) == 84 + 50 * count:
        corners = [struct.unpack("<3f", content[84 + 50 * i + 12 * k:][:12])
                   for i in range(count) for k in range(1, 4)]
        return count, corners
    words = content.decode().split()
    corners = [tuple(map(float, words[i + 1:i + 4])) for i, w in enumerate(words) if w == "vertex"]
    return words.count("facet"), corners


def read_obj(content):
    points, facets = [], []
    for line in content.decode("latin-1").replace("\\\r\n", " ").replace("\\\n", " ").splitlines():
        words = line.split()
        if words[:1] == ["v"]:
            points.append(tuple(map(float, words[1:4])))
        elif words[:1] == ["f"]:
            numbers = [int(word.split("/")[0]) for word in words[1:]]
            facet = [n - 1 if n > 0 else len(points) + n for n in numbers]
            apart = len(set(facet))
            if facet == facet[:apart] * (len(facet) // apart):  # gone round again and again
                facet = facet[:max(apart, 3)]
            facets.append(facet if apart > 2 else facet[:3])
    return result(points, facets)


def read_off(content):
    lines = [line.split("#")[0].split() for line in content.decode().splitlines()]
    lines = [line for line in lines if line]
    numbers = lines[1:] if len(lines[0]) == 1 else [lines[0][1:]] + lines[1:]
    count, facet_count = int(numbers[0][0]), int(numbers[0][1])
    points = [tuple(map(float, line[:3])) for line in numbers[1:1 + count]]
    facets = [list(map(int, line[1:1 + int(line[0])]))
              for line in numbers[1 + count:1 + count + facet_count]]
    return result(points, facets)


def ply_words(kind, body):
    """A function that takes the next value of a PLY type."""
    at = 0
    words = body.split() if kind == "ascii" else None

    def take(name):
        nonlocal at
        if words is not None:
            at += 1
            return float(words[at - 1])
        form = (">" if kind == "binary_big_endian" else "<") + NUMBERS[name]
        at += struct.calcsize(form)
        return struct.unpack(form, body[at - struct.calcsize(form):at])[0]
    return take


def read_ply(content):
    head, body = content.split(b"end_header", 1)
    body = body[body.index(b"\n") + 1:]
    elements, kind = [], None
    for words in (line.split() for line in head.decode("latin-1").splitlines()):
        if words[:1] == ["format"]:
            kind = words[1]
        elif words[:1] == ["element"]:
            elements.append((words[1], int(words[2]), []))
        elif words[:1] == ["property"]:
            elements[-1][2].append(words[1:])
    take, points, facets = ply_words(kind, body), [], []
    for name, count, properties in elements:
        for _ in range(count):
            row = {}
            for words in properties:
                if words[0] == "list":
                    row[words[-1]] = [take(words[2]) for _ in range(int(take(words[1])))]
                else:
                    row[words[-1]] = take(words[0])
            if name == "vertex":
                points.append((row["x"], row["y"], row["z"]))
            elif name == "face":
                indices = row["vertex_indices"] if "vertex_indices" in row else row["vertex_index"]
                facets.append([int(i) for i in indices])
    return result(points, facets)


def read(path):
    with open(path, "rb") as file:
        content = file.read()
    return {"stl": read_stl, "obj": read_obj, "off": read_off,
            "ply": read_ply}[str(path).rpartition(".")[2].lower()](content)
