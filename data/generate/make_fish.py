#!/usr/bin/env python3
"""Makes tracks/fish.csv: a school of fish that swims across the way of scenes/survey.yaml at
0.5 m/s, a little up and down, for 150 s. Usage: make_fish.py [FOLDER]"""
import math

import place


def main():
    with open(place.path('tracks', 'fish.csv'), 'w', encoding='ascii') as out:
        out.write('time_s,x_m,y_m,z_m,roll_deg,pitch_deg,yaw_deg\n')
        for i in range(76):
            t = 2.0 * i
            out.write(f'{t:.0f},{70 - 0.1 * t:.2f},{-30 + 0.5 * t:.2f},'
                      f'{24 + math.sin(t / 12):.2f},0,0,101.31\n')


if __name__ == '__main__':
    main()
