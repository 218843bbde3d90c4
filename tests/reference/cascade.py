"""Exact cascades of noiseless scenes in 60-digit arithmetic, for tests/physics/event_driven.rs.

    python3 tests/reference/cascade.py > tests/reference/cascade.csv

Needs mpmath. The method differs from that of the engine: particular solutions and exponentials with
explicit coefficients, and zeros by a fine scan and bisection. In a critically damped case the two
eigenvalues are separated by 1e-22, and the additional digits keep the result exact. Columns: scene,
kind (0 stick entered, 1 slip started, 2 sub-phase boundary), t, x, b.
"""

from mpmath import mp, mpf, mpc, exp, sqrt, cos

mp.dps = 60
NUDGE = mpf(10) ** -22

# name: alpha, f_d, f_s, x0, harmonics (a, w, phi), t_end; m = K = 1, beta = 6 throughout.
SCENES = {
    "underdamped": ("0.125", "1", "1.2", "6", [("1", "0.25", "0")], 60),
    "critical": ("1", "0.5", "1.2", "6", [("1", "0.25", "0")], 60),
    "overdamped": ("3", "0.5", "1.2", "6", [("1", "0.25", "0")], 60),
    "resonant": ("0", "1", "1.2", "0", [("0.5", "1", "0.3")], 30),
    "near_resonant": ("0", "1", "1.2", "0", [("0.5", "1.000000001", "0.3")], 30),
    "two_harmonics_and_a_constant": (
        "0.05",
        "0.9",
        "1.1",
        "1",
        [("0.7", "0.25", "0.5"), ("0.3", "1.75", "-1"), ("0.2", "0", "0.4")],
        60,
    ),
    "starts_outside": ("0", "1", "1.2", "12", [("1", "0.25", "0")], 30),
    "no_dynamic_friction": ("0.05", "0", "1.2", "6", [("1", "0.25", "0")], 30),
    "equal_thresholds": ("0", "1", "1", "6", [("1", "0.25", "0")], 60),
}


def cascade(alpha, f_d, f_s, x0, harmonics, t_end):
    alpha, f_d, f_s, x0 = map(mpf, (alpha, f_d, f_s, x0))
    harmonics = [(6 * mpf(a), mpf(w), mpf(phi)) for a, w, phi in harmonics]

    def forcing(t):
        return sum(a * cos(w * t + phi) for a, w, phi in harmonics)

    root = sqrt(mpc(alpha * alpha - 1 - NUDGE))  # w0 is moved off critical damping
    l1, l2 = -alpha + root, -alpha - root

    def sub_phase(t0, x, eps):
        # x = c1 e^{l1 r} + c2 e^{l2 r} + Re sum A e^{i w r} - eps f_d
        modes = []
        for a, w, phi in harmonics:
            z = mpc(0, w + (3 * NUDGE if w == 1 else 0))
            modes.append((a * exp(mpc(0, w * t0 + phi)) / (z * z + 2 * alpha * z + 1 + NUDGE), z))
        p0 = sum(A.real for A, z in modes) - eps * f_d
        v0 = sum((A * z).real for A, z in modes)
        c1 = (-v0 - l2 * (x - p0)) / (l1 - l2)
        c2 = (l1 * (x - p0) + v0) / (l1 - l2)

        def at(r):
            e1, e2 = c1 * exp(l1 * r), c2 * exp(l2 * r)
            es = [(A * exp(z * r), z) for A, z in modes]
            position = (e1 + e2).real + sum(E.real for E, z in es) - eps * f_d
            velocity = (l1 * e1 + l2 * e2).real + sum((E * z).real for E, z in es)
            return position, velocity

        return at

    def first_zero(g, start, step, limit):
        low, value = start, g(start)
        assert value > 0
        while low < limit:
            high = low + step
            if g(high) <= 0:
                while high - low > mpf(10) ** -28:
                    middle = (low + high) / 2
                    low, high = (middle, high) if g(middle) > 0 else (low, middle)
                return high
            low = high
        return None

    t, x, sticking = mpf(0), x0, True
    b = forcing(t) - x
    if abs(b) > f_s:
        yield 1, t, x, b
        sticking, eps = False, (1 if b > 0 else -1)
    while True:
        if sticking:
            r = first_zero(lambda r: f_s - abs(forcing(t + r) - x), mpf(0), mpf("0.02"), t_end - t)
            if r is None or t + r > t_end:
                return
            t += r
            b = f_s if forcing(t) > x else -f_s
            yield 1, t, x, b
            sticking, eps = False, (1 if b > 0 else -1)
        else:
            at = sub_phase(t, x, eps)
            r = first_zero(lambda r: eps * at(r)[1], mpf("1e-6"), mpf("0.02"), t_end - t)
            if r is None or t + r > t_end:
                return
            t, x = t + r, at(r)[0]
            b = forcing(t) - x
            sticking = abs(b) <= f_s
            yield (0 if sticking else 2), t, x, b
            eps = 1 if b > 0 else -1


print("scene,kind,t,x,b")
for name, scene in SCENES.items():
    for kind, t, x, b in cascade(*scene):
        print(f"{name},{kind},{mp.nstr(t, 20)},{mp.nstr(x, 20)},{mp.nstr(b, 20)}")
