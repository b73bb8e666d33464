"""Scenes that several tests share."""

# 100 kHz, 10 pings a second.
SONAR = "frequency_khz: 100, bandwidth_khz: 10, ping_rate_hz: 10, source_level_db: 200, speckle: rayleigh"


def ball_over_sand(sonar, rays, mission="{pose: {position_m: [0, 0, 7]}}", more=""):
    """A ball of half a metre, 15 m ahead and 3 m above sand, and what SONAR says beside its place."""
    return f"""version: 1
bottom: {{depth_m: 12, type: sand}}
objects:
  - {{name: ball, sphere: {{radius_m: 0.5}}, position_m: [15, 1, 9], material: {{impedance_mrayl: 45}}}}
sonar: {{{sonar}}}
mission: {mission}
sampling: {{rays: {rays}}}
{more}"""


# K speckle over a calm sea and a smooth rock: more than half of a far bin comes by way of mirrors.
MIRRORED = """version: 1
environment: {wind_speed_kn: 0}
bottom: {depth_m: 12, type: rock}
sonar:
  frequency_khz: 100
  bandwidth_khz: 1
  ping_rate_hz: 12
  source_level_db: 200
  receivers: [{name: ahead}]
  speckle: k
  speckle_shape: 0.5
mission: {pose: {position_m: [0, 0, 7]}}
sampling: {rays: 6000, multipath: boundaries}
detector: {pfa: 1.0e-2}
output: {images: []}
"""
