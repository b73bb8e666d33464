#!/usr/bin/env python3
"""Draws pictures/laws.svg: the expected level of scenes/scenario1.yaml over a bottom of four laws, with
the error that the source of a law states. Usage: draw_laws.py ASDIC [FOLDER]"""
import csv
import math
import os
import re
import subprocess
import sys
import tempfile

ASDIC = sys.argv.pop(1)

import place  # pylint: disable=wrong-import-position  # reads the folder from what is left

# Name, keys of the bottom, colour.
LAWS = [('type: sand', 'type: sand', '#404040'),
        ('Lambert, &#8722;27 dB', 'lambert_db: -27', '#009e73'),
        ('medium_sand', 'sediment: medium_sand', '#0072b2'),
        ('rough_rock', 'sediment: rough_rock', '#d55e00')]
LEFT, TOP, WIDTH, HEIGHT = 70, 62, 720, 380
# What the pictures of asdic say below their title.
FACTS = '100 kHz, bandwidth 10 kHz &#183; bins of 0.5 m &#183; levels re an SL of 0 dB'
RANGES, LEVELS = (5.0, 75.0), (-120.0, -40.0)


def expected(law):
    """Rows of range, level, and the levels with the bottom off by the stated error; that error."""
    here = os.path.dirname(os.path.abspath(__file__))
    with open(os.path.join(here, '..', 'scenes', 'scenario1.yaml'), encoding='ascii') as file:
        text = re.sub('^  type: sand$', f'  {law}', file.read(), flags=re.M)
    with tempfile.TemporaryDirectory() as folder:
        scene, table = os.path.join(folder, 'scene.yaml'), os.path.join(folder, 'out.csv')
        with open(scene, 'w', encoding='ascii') as file:
            file.write(text)
        done = subprocess.run([ASDIC, 'expect', scene, '-o', table], check=True,
                              capture_output=True, text=True)
        told = re.search('model_uncertainty_db: bottom ([0-9.]+)', done.stderr)
        error = float(told.group(1)) if told else 0.0
        rows = []
        with open(table, newline='', encoding='ascii') as file:
            for row in csv.DictReader(file):
                if not row['bottom_db'] or float(row['range_m']) < RANGES[0]:
                    continue
                total, bottom = (10**(float(row[k]) / 10) for k in ('total_db', 'bottom_db'))
                off = [10 * math.log10(total + bottom * (10**(e / 10) - 1)) for e in (-error, error)]
                rows.append((float(row['range_m']), float(row['total_db']), *off))
        return rows, error


def at(range_m, level_db):
    x = LEFT + WIDTH * (range_m - RANGES[0]) / (RANGES[1] - RANGES[0])
    y = TOP + HEIGHT * (LEVELS[1] - level_db) / (LEVELS[1] - LEVELS[0])
    return f'{x:.1f},{y:.1f}'


def axes():
    box = f'x="{LEFT}" y="{TOP}" width="{WIDTH}" height="{HEIGHT}"'
    yield f'<clipPath id="in"><rect {box}/></clipPath>'
    yield f'<rect {box} fill="none" stroke="#808080"/>'
    for range_m in range(10, 80, 10):
        x, y = at(range_m, LEVELS[0]).split(',')
        yield f'<path d="M{x},{TOP}V{y}" stroke="#e0e0e0"/>'
        yield f'<text x="{x}" y="{TOP + HEIGHT + 18}" text-anchor="middle">{range_m}</text>'
    for level in range(int(LEVELS[0]), int(LEVELS[1]) + 1, 10):
        x, y = at(RANGES[0], level).split(',')
        yield f'<path d="M{x},{y}h{WIDTH}" stroke="#e0e0e0"/>'
        yield f'<text x="{LEFT - 6}" y="{float(y) + 4}" text-anchor="end">{level}</text>'.replace('>-', '>&#8722;')
    yield f'<text x="{LEFT + WIDTH / 2}" y="{TOP + HEIGHT + 38}" text-anchor="middle">range (m)</text>'
    yield (f'<text transform="translate(18 {TOP + HEIGHT / 2}) rotate(-90)" text-anchor="middle">'
           'expected level (dB re 1 &#181;Pa)</text>')


def main():
    out = ['<svg xmlns="http://www.w3.org/2000/svg" width="820" height="492" fill="#202020" '
           'font-family="sans-serif" font-size="13">', '<rect width="820" height="492" fill="white"/>',
           f'<text x="{LEFT}" y="26" font-size="16" font-weight="bold">scenario1: expected levels over '
           'four bottoms</text>', f'<text x="{LEFT}" y="46" font-size="11" fill="#606060">{FACTS}</text>']
    out += axes()
    for i, (name, law, colour) in enumerate(LAWS):
        rows, error = expected(law)
        if error:
            edge = [at(r[0], r[3]) for r in rows] + [at(r[0], r[2]) for r in reversed(rows)]
            out.append(f'<polygon points="{" ".join(edge)}" fill="{colour}" fill-opacity="0.2" '
                       'clip-path="url(#in)"/>')
        line = ' '.join(at(r[0], r[1]) for r in rows)
        out.append(f'<polyline points="{line}" fill="none" stroke="{colour}" stroke-width="2" '
                   'clip-path="url(#in)"/>')
        y = TOP + 24 + 20 * i
        stated = f', {error:g} dB either way' if error else ', no error stated'
        out.append(f'<path d="M{LEFT + 410},{y - 4}h28" stroke="{colour}" stroke-width="2"/>')
        out.append(f'<text x="{LEFT + 446}" y="{y}">{name}{stated}</text>')
    with open(place.path('pictures', 'laws.svg'), 'w', encoding='ascii') as file:
        file.write('\n'.join(out) + '\n</svg>\n')


if __name__ == '__main__':
    main()
