"""Writes triangle meshes as binary PLY: axes east, north, up in metres, facets counterclockwise
seen from outside."""
import struct


def write(path, vertices, triangles, comment):
    header = ('ply\nformat binary_little_endian 1.0\n'
              f'comment {comment}\n'
              f'element vertex {len(vertices)}\n'
              'property float x\nproperty float y\nproperty float z\n'
              f'element face {len(triangles)}\n'
              'property list uchar int vertex_indices\nend_header\n')
    with open(path, 'wb') as out:
        out.write(header.encode('ascii'))
        for vertex in vertices:
            # Millimetres: small differences between C libraries do not show.
            out.write(struct.pack('<3f', *(round(value, 3) for value in vertex)))
        for triangle in triangles:
            out.write(struct.pack('<B3i', 3, *triangle))


def sheet(rows):
    """Vertices and triangles of a height field: ROWS go north, their points east."""
    vertices = [point for row in rows for point in row]
    width = len(rows[0])
    triangles = []
    for r in range(len(rows) - 1):
        for c in range(width - 1):
            a = r * width + c
            b, d, e = a + 1, a + width, a + width + 1
            # Alternate the diagonals, so that the facets favour no direction.
            if (r + c) % 2:
                triangles += [(a, b, e), (a, e, d)]
            else:
                triangles += [(a, b, d), (b, e, d)]
    return vertices, triangles
