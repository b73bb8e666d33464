"""The sea floor of the demonstration mission, as a function of place: depth_m(north, east).

The mesh, the rocks on it, the wreck and the vehicle's track are all made from this one function. It
is deterministic: the noise is hashed from integer coordinates.
"""
import math


def _hash(ix, iy, seed):
    """A number in [-1, 1) from integers, by the mixing steps of MurmurHash3's finaliser."""
    h = (ix * 0x27d4eb2d + iy * 0x165667b1 + seed * 0x9e3779b1) & 0xffffffff
    h = ((h ^ (h >> 16)) * 0x85ebca6b) & 0xffffffff
    h = ((h ^ (h >> 13)) * 0xc2b2ae35) & 0xffffffff
    return (h ^ (h >> 16)) / 2.0**31 - 1.0


def noise(x, y, seed):
    """Smooth noise of wavelength 1 in [-1, 1]."""
    ix, iy = math.floor(x), math.floor(y)
    fx, fy = x - ix, y - iy
    sx, sy = fx**3 * (fx * (6 * fx - 15) + 10), fy**3 * (fy * (6 * fy - 15) + 10)
    near = _hash(ix, iy, seed) * (1 - sx) + _hash(ix + 1, iy, seed) * sx
    far = _hash(ix, iy + 1, seed) * (1 - sx) + _hash(ix + 1, iy + 1, seed) * sx
    return near * (1 - sy) + far * sy


def fractal(x, y, wavelength_m, octaves, gain, seed):
    """Octaves of noise, each half the wavelength and GAIN times the height of the one before."""
    total, height = 0.0, 1.0
    for k in range(octaves):
        # Turned a little from octave to octave, which hides the lattice.
        c, s = math.cos(0.7 * k), math.sin(0.7 * k)
        total += height * noise((c * x - s * y) / wavelength_m, (s * x + c * y) / wavelength_m,
                                seed + k)
        wavelength_m /= 2
        height *= gain
    return total


def ramp(value, lo, hi):
    """0 below LO, 1 above HI, smooth between."""
    t = min(max((value - lo) / (hi - lo), 0.0), 1.0)
    return t * t * (3 - 2 * t)


def ridge_share(north, east):
    """1 on the rocky ridge that crosses the north of the area, 0 on the sand."""
    line = 232 + 0.25 * east + 14 * noise(east / 70, 0.5, 90)
    return ramp(north, line - 50, line)


def depth_m(north, east):
    rock = ridge_share(north, east)
    depth = 31.0 - 1.8 * fractal(north, east, 75.0, 3, 0.5, 10)
    # A bank that the vehicle climbs over, and a channel behind it.
    depth -= 3.2 * math.exp(-((north - 62 - 0.2 * east) / 16) ** 2)
    depth += 2.0 * math.exp(-((north - 118) / 18) ** 2)
    # Sand waves, steeper to the north, that fade in and out.
    phase = (north + 0.35 * east + 5 * noise(north / 40, east / 40, 50)) / 9.5
    wave = math.sin(2 * math.pi * phase) + 0.3 * math.sin(4 * math.pi * phase)
    depth -= 0.30 * (1 - rock) * (0.6 + 0.4 * noise(north / 60, east / 60, 60)) * wave
    depth -= 0.12 * fractal(north, east, 6.0, 3, 0.6, 20)
    # The ridge: eleven metres high, built of sharp crests.
    crest = 0.0
    for k in range(5):
        scale = 34.0 / 2**k
        sharp = 1 - abs(noise(north / scale, east / scale, 30 + k))
        crest += (sharp * sharp - 0.4) * 3.4 / 1.9**k
    return depth - rock * (8.5 + crest)
