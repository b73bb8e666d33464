#!/usr/bin/env python3
"""Makes scenes/sonar_*.yaml: sonars on the market, each in a small complete scene.

Usage: make_sonars.py [FOLDER]

Each scene names where its beam widths, sectors, numbers of beams and frequencies were read; what was
only remembered of a maker's data sheet is marked so: compare with the current sheet. Apertures
follow from the one-way -3 dB width W of a line aperture, sinc(L sin(W / 2) / wavelength)^2 = 1/2,
that is L = 0.443 wavelength / sin(W / 2). Source levels are not published: 200 dB is assumed.
Bandwidths follow from the stated range resolution, B = c / (2 resolution).
"""
import math

import place

SOUND_SPEED_MPS = 1490.1

# Name; file; kHz; beams; sector, horizontal and vertical width in degrees; range resolution in m;
# ping rate in Hz, bin length in m; remarks.
FANS = [
    ('BlueView P450-45', 'p450', 450, 256, 45, 1, 15, 0.051, 5, 0.25,
     ['From memory of the data sheet of the BlueView P series: 450 kHz, 45 degrees, 256 beams of',
      '1 x 15 degrees 0.18 degrees apart, range resolution 51 mm (2 inches).',
      'The paper names the P450-15E, whose sector is said to be 15 degrees: set sector_deg.']),
    ('BlueView P900-45', 'p900', 900, 256, 45, 1, 20, 0.025, 15, 0.1,
     ['Sources: the P900-45 as Choi et al. 2021 simulate it in nps_uw_multibeam_sonar (900 kHz, 29.5',
      'kHz, range resolution 25 mm, 45 degrees, beams of 1 degree); 256 beams of 20 degrees 0.18',
      'degrees apart from memory of the data sheet.']),
    ('Oculus M750d, low frequency', 'm750d', 750, 512, 130, 1, 20, 0.004, 15, 0.1,
     ['Sources: Oculus M-Series user manual (two frequencies; up to 130 x 20 degrees); 512 beams of 1',
      'degree and 4 mm from memory of the data sheet. Its 1.2 MHz mode: sonar_m1200d.yaml. Real beams',
      'are not evenly spaced: a list of receivers with yaw_deg gives any table of beams.']),
    ('Oculus M1200d, low frequency', 'm1200d', 1000, 512, 130, 0.6, 20, 0.0025, 20, 0.05,
     ['Sources: Oculus M-Series user manual (two frequencies; up to 130 x 20 degrees); 512 beams of 0.6',
      'degrees and 2.5 mm from memory of the data sheet. The sonar works at 1.2 MHz, but absorption',
      'and bottom law end at 1 MHz, at which this scene keeps its beam widths: echoes are then',
      'absorbed less, by about 0.12 dB per metre and way. The 2.1 MHz mode is beyond the model.']),
    ('Gemini 720is', 'gemini720', 720, 512, 120, 1, 20, 0.008, 15, 0.1,
     ['Sources: Gemini 720is product manual 0703-SOM-00002, issue 7 (720 kHz, 120 degrees, 1.0 degree',
      'acoustic and 0.25 effective, 20 degrees vertical); 512 beams and 8 mm from memory.']),
    ('DIDSON 300, detection mode', 'didson', 1000, 48, 29, 0.8, 14, 0.04, 20, 0.1,
     ['Sources: BCO-DMO instrument 892128 (48 or 96 beams of 0.3 to 0.8 x 14 degrees over 29 degrees);',
      'Belcher et al. 2002, Oceans (1.0 MHz in early units, 1.1 MHz later). The lens gives about 0.6',
      'degrees two-way, hence 0.8 one-way here; an ideal aperture stands for the lens. The',
      'identification mode, 1.8 MHz, is beyond the bottom law.']),
]
HEADS = [
    ('Blue Robotics Ping360', 'ping360', 750, 2, 25, 0.04, 14, 0.1,
     ['Sources: Blue Robotics ping-protocol (650 to 850 kHz practical, up to 1200 samples), the makers\'',
      'forum (2 degrees wide, steps of 0.9, to 50 m, pulses of 1 to 1000 us); 750 kHz and 25 degrees',
      'from memory of the data sheet. The bandwidth is assumed.']),
    ('Imagenex 881L profiling', '881l', 675, 1.8, 1.8, 0.03, 14, 0.1,
     ['From memory of data sheets, which differ: 600 kHz to 1 MHz, a conical beam of about 1.4 degrees',
      'at 1 MHz and 2.4 at 600 kHz; 1.8 at 675 kHz is assumed, as is the bandwidth.']),
]

SCENE = """# {title}, over flat sand with a few things to see.
{remarks}
# Widths are taken as one-way; the source level is assumed; compare with the maker's current sheet.
# Made by data/generate/make_sonars.py.
version: 1

environment: {{temperature_degc: 10, salinity_ppt: 35, wind_speed_kn: 5, particle_density: low}}

bottom: {{depth_m: 10, type: sand}}

objects:
  - name: sphere
    sphere: {{radius_m: 0.3}}
    position_m: [14, 1, 9.5]
    material: {{impedance_mrayl: 45, roughness_rms_mm: 1, slope_rms: 0.2}}
  - name: box
    box: {{size_m: [2, 1.5, 1]}}
    position_m: [20, -3, 9.5]
    rotation_deg: [0, 0, 20]
    material: {{impedance_mrayl: 8, roughness_rms_mm: 2, slope_rms: 0.3}}
  - name: pile
    cylinder: {{radius_m: 0.3, length_m: 10}}
    position_m: [27, 4, 5]
    rotation_deg: [90, 0, 0]
    material: {{impedance_mrayl: 45, roughness_rms_mm: 2, slope_rms: 0.3}}

sonar:
  frequency_khz: {khz}
  bandwidth_khz: {band:.3g}
  ping_rate_hz: {rate}
  source_level_db: 200
  bin_length_m: {bin}
  blanking_m: 0.5
{beams}
  noise: {{enabled: true}}

{mission}

sampling: {{rays: {rays}}}
"""
POSE = """mission:
  pose: {position_m: [0, 0, 7], pitch_deg: -8}     # 3 m above the bottom, bow down"""
TURN = """mission:
  track: ../tracks/turn.csv          # the head turns: here the vehicle does, once round"""


def aperture_m(khz, width_deg):
    wavelength = SOUND_SPEED_MPS / (1000 * khz)
    return 0.443 * wavelength / math.sin(math.radians(width_deg) / 2)


def write(name, **fields):
    with open(place.path('scenes', f'sonar_{name}.yaml'), 'w', encoding='ascii') as out:
        out.write(SCENE.format(**fields))


def main():
    for title, name, khz, beams, sector, wide, high, resolution, rate, width, remarks in FANS:
        vertical = aperture_m(khz, high)
        write(name, title=title, remarks='\n'.join('# ' + line for line in remarks), khz=khz,
              band=SOUND_SPEED_MPS / (2 * resolution) / 1000, rate=rate, bin=width, mission=POSE,
              rays=200000,
              beams=f'  transmitter: {{length_h_m: {aperture_m(khz, sector):.5f}, '
                    f'length_v_m: {vertical:.5f}}}\n'
                    f'  receivers:\n    fan: {{count: {beams}, sector_deg: {sector}, '
                    f'length_h_m: {aperture_m(khz, wide):.4f}, length_v_m: {vertical:.5f}}}')
    for title, name, khz, wide, high, resolution, rate, width, remarks in HEADS:
        size = (f'length_h_m: {aperture_m(khz, wide):.4f}, '
                f'length_v_m: {aperture_m(khz, high):.5f}')
        write(name, title=title, remarks='\n'.join('# ' + line for line in remarks), khz=khz,
              band=SOUND_SPEED_MPS / (2 * resolution) / 1000, rate=rate, bin=width, mission=TURN,
              rays=20000,
              beams=f'  transmitter: {{pitch_deg: 8, {size}}}\n'
                    f'  receivers:\n    - {{name: head, pitch_deg: 8, {size}}}')


if __name__ == '__main__':
    main()
