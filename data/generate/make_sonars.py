#!/usr/bin/env python3
"""Makes sonars/*.yaml: sonars on the market, and scenes/sonar_*.yaml: each in a small complete scene.

Usage: make_sonars.py [FOLDER]

Every value of a sonar names its source, a number in the file's first lines, or says "assumed": not
published, or not found. Apertures follow from the one-way -3 dB width W of a line aperture,
sinc(L sin(W / 2) / wavelength)^2 = 1/2, that is L = 0.443 wavelength / sin(W / 2). Bandwidths follow
from the range resolution, B = c / (2 resolution); what a maker calls so may be the spacing of samples.
"""
import math

import place

SOUND_SPEED_MPS = 1490.1
ASSUMED = 'assumed'
BLUEPRINT = 'Blueprint Subsea, Oculus M-series data sheet DA-148-P01443-10, as quoted by others'
LIBOCULUS = 'University of Washington, liboculus, Constants.h (beam widths by model and frequency)'
RTAC = 'ENSTA Bretagne, rtac_simulation, blueprint_oculus.cpp (0.4 degrees over 80 at 2.1 MHz)'
CHOI = 'Choi et al. 2021, Frontiers in Robotics and AI 8:706646; nps_uw_multibeam_sonar (the P900-45)'

# Sonars that see a few metres have the scene at a SCALE, and a bottom whose law knows no frequency.
CLOSE_BOTTOM = 'lambert_db: -25'

# Each value is (number, source): a source is the number of a line of 'sources', or ASSUMED.
FANS = [
    dict(title='BlueView P450-45', name='p450', sources=[], remarks=[
             'No public data sheet was found: every value is assumed after the P900. The paper names the',
             'P450-15E, whose sector is said to be 15 degrees: set sector_deg.'],
         khz=(450, ASSUMED), beams=(256, ASSUMED), sector=(45, ASSUMED), wide=(1, ASSUMED),
         high=(15, ASSUMED), resolution=(0.051, ASSUMED), rate=5, bin=0.25),
    dict(title='BlueView P900-45', name='p900', sources=[CHOI], remarks=[],
         khz=(900, 1), beams=(256, ASSUMED), sector=(45, 1), wide=(1, 1), high=(20, ASSUMED),
         resolution=(0.025, 1), rate=15, bin=0.1),
    dict(title='Oculus M750d, low frequency', name='m750d', sources=[BLUEPRINT, LIBOCULUS], remarks=[
             'Its 1.2 MHz mode: m1200d.yaml. Real beams are not evenly spaced: aris1200.yaml',
             'shows how a table of beams is written.'],
         khz=(750, 1), beams=(512, 1), sector=(130, 1), wide=(1, 2), high=(20, 1),
         resolution=(0.004, 1), rate=15, bin=0.1),
    dict(title='Oculus M1200d, low frequency', name='m1200d', sources=[BLUEPRINT, LIBOCULUS],
         remarks=['Its 2.1 MHz mode: m1200d_high.yaml.'],
         khz=(1200, 1), beams=(512, 1), sector=(130, 1), wide=(0.6, 2), high=(20, 1),
         resolution=(0.0025, 1), rate=20, bin=0.05, rays=400000),
    dict(title='Oculus M1200d, high frequency', name='m1200d_high', sources=[BLUEPRINT, LIBOCULUS, RTAC], remarks=[],
         khz=(2100, 2), beams=(512, 1), sector=(80, 3), wide=(0.4, 2), high=(12, 2), resolution=(0.0025, 1), rate=74,
         bin=0.02, blanking=0.2, scale=0.3, bottom=CLOSE_BOTTOM),
    dict(title='Gemini 720is', name='gemini720', sources=[
             'Tritech, Gemini 720is product manual 0703-SOM-00002, issues 1 and 7',
             'Tritech, Gemini 720is data sheet 0703-SOM-00001, issues 11 and 15, as quoted by others'],
         remarks=['Its elements look down by 10 degrees [1]: pitch_deg.'], pitch=10,
         khz=(720, 1), beams=(512, 2), sector=(120, 1), wide=(1, 1), high=(20, 1),
         resolution=(0.004, 2), rate=12, bin=0.1),
    dict(title='DIDSON, detection mode', name='didson', sources=[
             'Sound Metrics, www.soundmetrics.com/SONAR101/resolution.html, "DIDSON Resolution"',
             'BCO-DMO, www.bco-dmo.org/instrument/892128, "Dual Frequency Identification Sonar"',
             'Belcher et al. 2002, Oceans (1.0 MHz in early units, 1.1 MHz later)'],
         remarks=['An ideal aperture stands for the lens. The identification mode, 1.8 MHz, has 96 beams 0.3 degrees',
                  'apart and as wide [1].'],
         khz=(1000, 3), beams=(48, 1), sector=(28.8, '48 beams, 0.6 degrees apart: [1]'), wide=(0.4, 1),
         high=(14, 2), resolution=(0.04, ASSUMED), rate=20, bin=0.1),
    dict(title='ARIS Explorer 1200, low frequency', name='aris1200', sources=[
             'Sound Metrics, aris-file-sdk, beam-width-metrics/BeamWidths_ARIS1800_1200_48.h'],
         remarks=['A lens spreads its beams: 0.69 degrees apart in the middle, 0.43 at the sides. Their bearings',
                  'follow 16.432 u - 3.548 u^3 + 0.910 u^5 degrees, u = (beam - 23.5) / 24, which meets the',
                  'table of [1] within 0.01 degrees.'],
         khz=(700, ASSUMED), beams=(48, 1), sector=(28, 1), wide=(0.8, ASSUMED), high=(14, ASSUMED),
         resolution=(0.02, ASSUMED), rate=20, bin=0.1,
         bearing=lambda u: 16.432 * u - 3.548 * u**3 + 0.910 * u**5),
    dict(title='ARIS Explorer 3000, high frequency', name='aris3000', sources=[
             'Sound Metrics, aris-file-sdk, beam-width-metrics/BeamWidths_ARIS3000_128.h',
             'Ocean Networks Canada, wiki, "ARIS Sonar Data" (3 MHz, 128 beams, 28 x 14 degrees)'],
         remarks=['Bearings follow 15.169 u - 0.338 u^3 degrees, u = (beam - 63.5) / 64, which meets the table of [1]',
                  'within 0.07 degrees; the beams there, side by side, are 0.23 degrees wide.'],
         khz=(3000, 2), beams=(128, 1), sector=(28, 2), wide=(0.23, 1), high=(14, 2), resolution=(0.003, ASSUMED),
         rate=135, bin=0.01, blanking=0.2, scale=0.18, bottom=CLOSE_BOTTOM,
         bearing=lambda u: 15.169 * u - 0.338 * u**3),
]
HEADS = [
    dict(title='Blue Robotics Ping360', name='ping360', sources=[
             'Blue Robotics, ping-viewer, docs/device-settings-ping360.md (tuned to 750 kHz, 650 to 850)',
             'discuss.bluerobotics.com/t/understanding-the-ping-360-specifications/9124 (steps of 0.9 deg)',
             'Blue Robotics, Ping360 product page, as quoted by others'],
         remarks=[], khz=(750, 1), wide=(2, 2), high=(25, 3), resolution=(0.04, ASSUMED), rate=14, bin=0.1,
         scan=((360, ASSUMED), (0.9, 2))),
    dict(title='Imagenex 881L imaging, middle frequency', name='881l', sources=[
             'Imagenex, Model 881L imaging sonar 445-039, January 2006, revised May 2017'],
         remarks=['Its other frequencies: 310 kHz, 4 x 40 degrees; 1 MHz, 0.9 x 10 degrees [1].'],
         khz=(675, 1), wide=(1.8, 1), high=(20, 1), resolution=(0.03, ASSUMED), rate=14, bin=0.1,
         scan=((360, ASSUMED), (0.9, ASSUMED))),
    dict(title='A head like the Tritech Micron', name='micron', sources=[
             'McGill Robotics, ros-tritech-micron, cfg/Scan.cfg (steps of 32, 16, 8 and 4 sixteenths of a gradian)'],
         remarks=['No public data sheet was found: frequency and widths are assumed.'],
         khz=(700, ASSUMED), wide=(3, ASSUMED), high=(35, ASSUMED), resolution=(0.04, ASSUMED), rate=14, bin=0.1,
         scan=((90, ASSUMED), (0.9, 1))),
]

SONAR = """# {title}.
# In a scene: sonar: {{file: {name}.yaml}}; keys beside 'file' take the place of those here.
{remarks}# Widths are taken as one-way. Compare with the maker's current data sheet.
# Made by data/generate/make_sonars.py.
{sonar}
noise: {{enabled: true}}
"""
SCENE = """# {title}, over flat sand with a few things to see.
# Made by data/generate/make_sonars.py.
version: 1

environment: {{temperature_degc: 10, salinity_ppt: 35, wind_speed_kn: 5, particle_density: low}}

bottom: {{depth_m: 10, {bottom}}}

objects:
  - name: sphere
    sphere: {{radius_m: {radius:g}}}
    position_m: {sphere}
    material: {{impedance_mrayl: 45, roughness_rms_mm: 1, slope_rms: 0.2}}
  - name: box
    box: {{size_m: {sides}}}
    position_m: {box}
    rotation_deg: [0, 0, 20]
    material: {{impedance_mrayl: 8, roughness_rms_mm: 2, slope_rms: 0.3}}
  - name: pile
    cylinder: {{radius_m: {radius:g}, length_m: 10}}
    position_m: {pile}
    rotation_deg: [90, 0, 0]
    material: {{impedance_mrayl: 45, roughness_rms_mm: 2, slope_rms: 0.3}}

sonar: {{file: ../sonars/{name}.yaml}}

{mission}

sampling: {{rays: {rays}}}
"""
POSE = """mission:
  pose: {{position_m: [0, 0, {depth:g}], pitch_deg: -8}}     # {height:g} m above the bottom, bow down"""
POSE_LEVEL = """mission:
  pose: {{position_m: [0, 0, {depth:g}]}}                    # {height:g} m above the bottom"""


def aperture_m(khz, width_deg):
    wavelength = SOUND_SPEED_MPS / (1000 * khz)
    return 0.443 * wavelength / math.sin(math.radians(width_deg) / 2)


def cited(source):
    return f'[{source}]' if isinstance(source, int) else source


def noted(text, source):
    """A line of the file, with where its value comes from behind it."""
    return f'{text:<40} # {cited(source)}'


def aperture(fan, size_deg, indent):
    """The two sides of an aperture whose beam is so wide and high, each (degrees, source)."""
    return [noted(f'{indent}length_{side}_m: {aperture_m(fan["khz"][0], width):.5f}',
                  f'{width:g} deg: {cited(source)}')
            for side, (width, source) in zip('hv', size_deg)]


def receivers(fan):
    if 'bearing' not in fan:
        return ['  receivers:', '    fan:', noted(f'      count: {fan["beams"][0]}', fan['beams'][1]),
                noted(f'      sector_deg: {fan["sector"][0]}', fan['sector'][1]),
                *([f'      pitch_deg: {fan["pitch"]}'] if 'pitch' in fan else []),
                *aperture(fan, (fan['wide'], fan['high']), '      ')]
    size = ', '.join(f'length_{side}_m: {aperture_m(fan["khz"][0], fan[name][0]):.5f}'
                     for side, name in zip('hv', ('wide', 'high')))
    count = fan['beams'][0]
    bearings = [fan['bearing']((2 * i + 1 - count) / count) for i in range(count)]
    sources = ', '.join(dict.fromkeys(cited(fan[name][1]) for name in ('wide', 'high')))
    return [f'  receivers:  # bearings: [1]; {fan["wide"][0]} x {fan["high"][0]} degrees: {sources}',
            *(f'    - {{yaw_deg: {bearing:.3f}, {size}}}' for bearing in bearings)]


def head_beams(head):
    size = aperture(head, (head['wide'], head['high']), '    ')
    sector, step = head['scan']
    scan = ['  scan:', noted(f'    sector_deg: {sector[0]}', sector[1]), noted(f'    step_deg: {step[0]}', step[1])]
    return [*scan, '  transmitter:', '    pitch_deg: 8', *size, '  receivers:', '  - name: head', '    pitch_deg: 8', *size]


def fan_beams(fan):
    return ['  transmitter:', *([f'    pitch_deg: {fan["pitch"]}'] if 'pitch' in fan else []),
            *aperture(fan, (fan['sector'][:1] + ('the sector',), fan['high']), '    '), *receivers(fan)]


def listed(*numbers):
    return '[' + ', '.join(f'{number:g}' for number in numbers) + ']'


def things(sonar, mission):
    """What stands on the bottom in 10 m, and MISSION above it, at the sonar's scale."""
    scale = sonar.get('scale', 1)
    return {'bottom': sonar.get('bottom', 'type: sand'), 'radius': 0.3 * scale,
            'sphere': listed(14 * scale, scale, 10 - 0.5 * scale), 'sides': listed(2 * scale, 1.5 * scale, scale),
            'box': listed(20 * scale, -3 * scale, 10 - 0.5 * scale), 'pile': listed(27 * scale, 4 * scale, 5),
            'mission': mission.format(depth=10 - 3 * scale, height=3 * scale)}


def write(sonar, beams, mission, rays):
    resolution, source = sonar['resolution']
    remarks = [f'[{i}] {text}' for i, text in enumerate(sonar['sources'], 1)] + sonar['remarks']
    lines = [noted(f'  frequency_khz: {sonar["khz"][0]}', sonar['khz'][1]),
             noted(f'  bandwidth_khz: {SOUND_SPEED_MPS / (2 * resolution) / 1000:.3g}',
 f'{1000 * resolution:g} mm: {cited(source)}'),
             noted(f'  ping_rate_hz: {sonar["rate"]}', f'for a range of {SOUND_SPEED_MPS / 2 / sonar["rate"]:.0f} m'),
             noted('  source_level_db: 200', 'assumed: not published'),
             noted(f'  bin_length_m: {sonar["bin"]}', 'a choice'), f'  blanking_m: {sonar.get("blanking", 0.5)}', *beams]
    with open(place.path('sonars', f'{sonar["name"]}.yaml'), 'w', encoding='ascii') as out:
        out.write(SONAR.format(title=sonar['title'], name=sonar['name'], remarks=''.join(f'# {line}\n' for line in remarks),
                               sonar='\n'.join(line.removeprefix('  ') for line in lines)))
    with open(place.path('scenes', f'sonar_{sonar["name"]}.yaml'), 'w', encoding='ascii') as out:
        out.write(SCENE.format(title=sonar['title'], name=sonar['name'], rays=rays, **things(sonar, mission)))


def main():
    for fan in FANS:
        write(fan, fan_beams(fan), POSE_LEVEL if 'pitch' in fan else POSE, fan.get('rays', 200000))
    for head in HEADS:
        write(head, head_beams(head), POSE_LEVEL, 20000)


if __name__ == '__main__':
    main()
