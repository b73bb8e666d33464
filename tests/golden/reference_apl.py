"""Bottom and surface of APL-UW TR 9407, apart from the C code: prints lines of formulas.txt.

Equation by equation as the handbook's are published, in complex double precision, without the
rearrangements that the C code makes for small losses and small angles.
"""
import cmath
import math

NAMED = {'rough_rock': (2.5, 2.5, .01374, .002, 3.25, .20693),
         'rock': (2.5, 2.5, .01374, .002, 3.25, .01862),
         'cobble': (2.5, 1.8, .01374, .002, 3.25, .0156)}


def sediment(m):
    if m < 1:
        rho = .007797 * m**2 - .17057 * m + 2.3139
        nu = .002709 * m**2 - .056452 * m + 1.2778
    elif m < 5.3:
        rho = -.0165406 * m**3 + .2290201 * m**2 - 1.1069031 * m + 3.0455
        nu = -.0014881 * m**3 + .0213937 * m**2 - .1382798 * m + 1.3425
    else:
        rho, nu = -.0012973 * m + 1.1565, -.0024324 * m + 1.0019
    absorption = (.4556 if m < 0 else .4556 + .0245 * m if m < 2.6 else .1978 + .1245 * m
                  if m < 4.5 else 8.0399 - 2.5228 * m + .20098 * m**2 if m < 6
                  else .9431 - .2041 * m + .0117 * m**2 if m < 9.5 else .0601)
    h = (2.03846 - .26923 * m) / (1 + .076923 * m) if m < 5 else .5
    return (rho, nu, absorption * nu * 1.528 * math.log(10) / (40 * math.pi),
            .002 if m < 5.5 else .001, 3.25, .00207 * h**2)


def kirchhoff_at_normal(qc, al):
    """The integral over the relief's structure function, (1 / 8 pi) int e^(-qc u^(2 al)) u du, by steps of ln u."""
    last = math.log(60 / qc) / (2 * al)
    return sum(math.exp(2 * t - qc * math.exp(2 * al * t)) for t in (last - .01 * i for i in range(4000))) * .01 / (
        8 * math.pi)


def bottom_db(numbers, f_khz, c_mps, deg):
    rho, nu, delta, sigma2, gamma, w2 = numbers
    k = 2 * math.pi * 1e3 * f_khz / c_mps / 100
    al, kappa = gamma / 2 - 1, (1 + 1j * delta) / nu
    G, pi = math.gamma, math.pi

    def P(t):
        return cmath.sqrt(kappa**2 - math.cos(t)**2)

    def R(t):
        y = rho * math.sin(t) / P(t)
        return (y - 1) / (y + 1)

    t = math.radians(deg)
    ch2 = 2 * pi * w2 * G(2 - al) * 2**(-2 * al) / (al * (1 - al) * G(1 + al))
    qc = ch2 * 2**(1 - 2 * al) * k**(2 * (1 - al))
    a = (8 * al**2 * G(1 / (2 * al) + .5) / (G(.5) * G(1 / al) * G(1 / (2 * al))))**(2 * al)
    b = a**(.5 + 1 / (2 * al)) * G(1 / al) / (2 * al)
    r0 = abs(R(pi / 2))**2
    kr = (b * qc * r0 / (8 * pi)
          / (math.cos(t)**(4 * al) + a * qc**2 * math.sin(t)**4)**((1 + al) / (2 * al)))
    if deg == 90:
        kr = r0 * kirchhoff_at_normal(qc, al)
    s = math.sqrt((2 * pi * w2)**(1 / al) / (2 * (1 - al)) * (k**2 / al)**((1 - al) / al))

    def small(u):
        Y = ((rho - 1)**2 * math.cos(u)**2 + rho**2 - kappa**2) / (rho * math.sin(u) + P(u))**2
        K = math.sqrt(4 * k**2 * math.cos(u)**2 + (k / 10)**2)
        return 4 * k**4 * math.sin(u)**4 * abs(Y)**2 * w2 * K**-gamma

    def volume(u):
        return (5 * delta * sigma2 * abs(1 - R(u)**2)**2 * math.sin(u)**2
                / (nu * math.log(10) * abs(P(u))**2 * P(u).imag))

    x = math.tan(t) / s
    q = (math.exp(-x * x) / math.sqrt(pi) - x * (1 - math.erf(x))) / (4 * x) if x <= 2 else 0
    shadow = (1 - math.exp(-2 * q)) / (2 * q) if q else 1

    def average(f):
        return shadow / math.sqrt(pi) * sum(
            w * f(min(max(t - n * s, 0), pi / 2))
            for n, w in ((1.224745, .29541), (0, 1.181636), (-1.224745, .29541)))

    ths = math.degrees(s)
    thc = math.degrees(math.acos(1 / nu)) if nu >= 1.001 else 2.5613
    crit = 1 + .81 * thc**2 / deg**2
    s1 = (.04682 * s**1.25 * nu**3.25 * ((1 - 2 / rho) / nu**2 + 1)**2 / (1 + 3.54 * ths / thc))
    lr = (s1 * math.sin(math.radians(180 / crit))**(.7263 * s**(-1 / 3))
          + .026 * r0 / (s**2 * (1 + (deg - 90)**2 / (2.6 * ths**2))**1.9 * crit))

    def f(v):
        return 1 / (1 + math.exp(v))

    ck = (1 / (1000**(1 / (1 + al)) * (a * qc**2)**(1 / al)) + 4)**-.25
    w = f((math.cos(t) - ck) / .0125)
    smooth = w * kr + (1 - w) * average(small)
    v = f((math.degrees(math.atan(s)) - 7) / .5)
    loss_db = -20 * math.log10(abs(R(t)))
    return 10 * math.log10(v * smooth + (1 - v) * lr + average(volume)), loss_db


def surface_db(u, f_khz, deg):
    t = math.radians(deg)
    bv = 10**(-5.2577 + .4701 * min(u, 11)) * (f_khz / 25)**.85 * max(u / 11, 1)**3.5
    b = bv / math.sin(t)
    sb = (bv / (4 * math.pi) * .0136 / (.0255 * f_khz**(1 / 3))
          * (1 + 8 * b * math.exp(-2 * b) - math.exp(-4 * b)) / (2 * b))
    s2 = 4.6e-3 * math.log(2.1 * u * u) if u >= 1 else .0034

    def facets(d):
        g = math.radians(90 - d)
        return math.exp(-math.tan(g)**2 / s2) / (4 * math.pi * s2 * math.cos(g)**4)

    low, high = 1.0, 90.0
    for _ in range(100):
        mid = (low + high) / 2
        low, high = (mid, high) if facets(mid) < facets(90) * 10**-1.5 else (low, mid)
    f = 1 / (1 + math.exp(.524 * (low - deg)))
    sc = 1.3e-5 * u * u * math.tan(min(t, math.radians(85)))**4
    sbl = 1.26e-3 / math.sin(t) * f_khz**.85 * (u**1.57 if u >= 6 else
                                                6**1.57 * math.exp(1.2 * (u - 6)))
    return 10 * math.log10((f * facets(deg) + (1 - f) * sc) * 10**(-sbl / 10) + sb)


if __name__ == '__main__':
    CASES = [(f'sediment={name}', numbers) for name, numbers in NAMED.items()]
    CASES += [(f'grain_size_phi={m:g}', sediment(m))
              for m in (-1, 0, .99, 1, 2, 3.5, 4.2, 5, 5.29, 5.3, 5.5, 6, 7.5, 9)]
    for i, (key, numbers) in enumerate(CASES):
        for j, deg in enumerate((.5, 4, 15, 35, 44, 60, 82, 90)):
            f_khz, c_mps = (1, 10, 30, 100, 300, 1000)[(i + j) % 6], (1450, 1528)[(i + j) % 2]
            strength, loss = bottom_db(numbers, f_khz, c_mps, deg)
            tail = f'{key} f_khz={f_khz} c_mps={c_mps} grazing_deg={deg:g} ='
            print(f'apl-bottom {tail} {strength!r} 1e-03 0 # independent program')
            if j % 3 == 0:
                print(f'apl-bottom-loss {tail} {loss!r} 1e-08 1e-08 # independent program')
    for gamma in (2.4, 2.8, 3, 3.25, 3.5, 3.9):
        rho, nu, delta = sediment(1.5)[:3]
        strength = bottom_db((rho, nu, delta, .002, gamma, .00207), 100, 1528, 90)[0]
        print(f'apl-bottom grain_size_phi=1.5 spectral_exponent={gamma:g} spectral_strength_cm4=0.00207 f_khz=100 '
              f'c_mps=1528 grazing_deg=90 = {strength!r} 1e-03 0 # independent program')
    for i, u in enumerate((.2, 1, 3, 5.9, 6.1, 10.9, 12, 20, 30)):
        for j, deg in enumerate((.3, 5, 20, 50, 75, 86, 90)):
            f_khz = (1, 15, 70, 100, 1000)[(i + j) % 5]
            print(f'apl-surface wind_mps={u:g} f_khz={f_khz} grazing_deg={deg:g} = '
                  f'{surface_db(u, f_khz, deg)!r} 1e-06 0 # independent program')
