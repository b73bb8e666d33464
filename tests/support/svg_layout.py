"""Where the words and marks of an SVG picture lie, as cairo writes it."""
import re

import tap

NUMBER = r"-?\d+\.?\d*(?:e-?\d+)?"


def svg_marks(text):
    """Page, words, and what is drawn in ink of an SVG picture: corners of boxes, west and north before east and
    south. Of lines their parts along an edge of the page, of surfaces the whole."""
    def corners(d):
        return [tuple(map(float, pair)) for pair in re.findall(f"({NUMBER}) ({NUMBER})", d)]

    def box(points):
        x, y = zip(*points)
        return min(x), min(y), max(x), max(y)
    head, _, body = text.rpartition("</defs>")
    glyphs = {name: corners(d) for name, d in
              re.findall(r'<symbol[^>]*id="([^"]*)">\s*<path[^>]* d="([^"]*)"', head)}
    words, ink = [], []
    for word in re.findall(r'<g style="fill:[^>]*>(.*?)</g>', body, re.S):
        places = re.findall(r'href="#([^"]*)" x="([^"]*)" y="([^"]*)"', word)
        points = [(float(x) + u, float(y) + v) for name, x, y in places for u, v in glyphs[name]]
        words += [box(points)] if points else []
    for style, d, scale in re.findall(r'<path style="([^"]*)" d="([^"]*)"(?: transform="matrix\(([^,]*),)?', body):
        points = [(x * float(scale or 1), y * float(scale or 1)) for x, y in corners(d)]
        if "fill:rgb(12.5" in style:
            ink.append(box(points))
        elif "stroke:rgb(12.5" in style:
            ink += [box((a, b)) for a, b in zip(points, points[1:]) if a[0] == b[0] or a[1] == b[1]]
    return tuple(map(float, re.search(r'viewBox="([^"]*)"', text)[1].split())), words, ink


def check_layout(text, what):
    """Words are on the page, and none lies on another, on an axis or on an arrow."""
    (_, _, width, height), words, ink = svg_marks(text)
    tap.equal(len(words) > 20 and len(ink) > 10, True, f"{what}: {len(words)} words, {len(ink)} marks")
    outside = [w for w in words if min(w) < 0 or w[2] > width or w[3] > height]
    covered = [(a, b) for i, a in enumerate(words) for b in words[:i] + ink
               if a[0] <= b[2] and b[0] <= a[2] and a[1] <= b[3] and b[1] <= a[3]]
    tap.equal((outside, covered), ([], []), f"{what}: words off the page, on what is drawn")
