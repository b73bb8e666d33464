#!/usr/bin/env python3
"""Makes tracks/turn.csv: a vehicle at 7 m depth that turns once on the spot in 16 s, which is how a
mechanically scanned head is simulated. Usage: make_turn.py [FOLDER]"""
import place


def main():
    with open(place.path('tracks', 'turn.csv'), 'w', encoding='ascii') as out:
        out.write('time_s,x_m,y_m,z_m,roll_deg,pitch_deg,yaw_deg\n')
        for i in range(9):  # eighths: angles are interpolated the shorter way round
            out.write(f'{2.0 * i:.1f},0,0,7,0,0,{45 * i - 180}\n')


if __name__ == '__main__':
    main()
