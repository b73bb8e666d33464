#!/usr/bin/env python3
"""Makes tracks/mission.csv: north towards the ridge, a turn to starboard, and south again, as one
strip of a lawn mower. Usage: make_track.py [FOLDER]

The vehicle keeps its altitude above the highest sea floor within reach ahead, so it climbs before
the bank comes; its depth follows through a first-order lag, as a real depth controller's does.
"""
import math

import place
import seafloor

SPEED_MPS, STEP_S = 2.5, 0.5
ALTITUDE_M, LAG_M = 6.0, 10.0
NORTH_LEG_M, TURN_RADIUS_M, SOUTH_LEG_M = 150.0, 15.0, 103.0
TURN_M = math.pi * TURN_RADIUS_M


def point(s):
    """North, east, heading in radians and turn rate in 1/m after S metres of way."""
    if s < NORTH_LEG_M:
        return s, 0.0, 0.0, 0.0
    if s < NORTH_LEG_M + TURN_M:
        angle = (s - NORTH_LEG_M) / TURN_RADIUS_M
        return (NORTH_LEG_M + TURN_RADIUS_M * math.sin(angle),
                TURN_RADIUS_M * (1 - math.cos(angle)), angle, 1 / TURN_RADIUS_M)
    return NORTH_LEG_M - (s - NORTH_LEG_M - TURN_M), 2 * TURN_RADIUS_M, math.pi, 0.0


def wanted_depth_m(s):
    """ALTITUDE_M above the shallowest point from here to 20 m further along the way."""
    return min(seafloor.depth_m(*point(s + ahead)[:2]) for ahead in range(0, 21, 2)) - ALTITUDE_M


def main():
    length = NORTH_LEG_M + TURN_M + SOUTH_LEG_M
    count = int(length / (SPEED_MPS * STEP_S))
    depth, bank = wanted_depth_m(0.0), 0.0
    path = place.path('tracks', 'mission.csv')
    with open(path, 'w', encoding='ascii') as out:
        out.write('time_s,x_m,y_m,z_m,roll_deg,pitch_deg,yaw_deg\n')
        for i in range(count + 1):
            time = i * STEP_S
            way = SPEED_MPS * time
            north, east, heading, rate = point(way)
            share = SPEED_MPS * STEP_S / LAG_M
            climb = (depth - wanted_depth_m(way)) * share
            depth -= climb
            bank += (rate * TURN_RADIUS_M - bank) * share
            pitch = math.degrees(math.atan2(climb, SPEED_MPS * STEP_S))
            # A slight swing, of periods that do not repeat together.
            pitch += 0.5 * math.sin(1.1 * time)
            roll = 8.0 * bank + 1.0 * math.sin(0.83 * time + 1.0)
            yaw = math.degrees(heading) + 0.7 * math.sin(0.61 * time)
            out.write(f'{time:.2f},{north:.3f},{east:.3f},{depth:.3f},{roll:.2f},{pitch:.2f},'
                      f'{yaw:.2f}\n')
    print(f'{path}: {count + 1} points, {count * STEP_S:.1f} s')


if __name__ == '__main__':
    main()
