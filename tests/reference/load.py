"""Cascades of noiseless scenes whose friction has a load, for tests/physics/load.rs, or whose force
or load has an input, for tests/physics/inputs.rs.

    python3 tests/reference/load.py > tests/reference/load.csv

Needs Python alone. The method differs from that of the engine: Gauss collocation of order 10 at a
fixed step that also ends at kinks, and events by bisection of the last step. Each direction has its own equation, f_s and
f_d times the load as they are defined. Halving the step changes the 12th digit. Columns: scene,
kind (0 stick entered, 1 slip started, 2 sub-phase boundary), t, x, b.
"""

from math import cos, sin, sqrt, tanh

# Nodes of Gauss on [0, 1].
R1, R2 = sqrt(5 - 2 * sqrt(10 / 7)) / 3, sqrt(5 + 2 * sqrt(10 / 7)) / 3
NODES = [(1 - R2) / 2, (1 - R1) / 2, 0.5, (1 + R1) / 2, (1 + R2) / 2]


def integral(i, upto):
    """The integral of the i-th Lagrange polynomial of the nodes."""
    poly = [1.0]
    for j, node in enumerate(NODES):
        if j != i:
            scale = 1 / (NODES[i] - node)
            poly = [
                scale * ((poly[k - 1] if k else 0) - node * (poly[k] if k < len(poly) else 0))
                for k in range(len(poly) + 1)
            ]
    return sum(c * upto ** (k + 1) / (k + 1) for k, c in enumerate(poly))


A = [[integral(i, node) for i in range(5)] for node in NODES]
B = [integral(i, 1.0) for i in range(5)]


def step(acceleration, t, x, v, h):
    k = [acceleration(t, x, v)] * 5
    for _ in range(60):
        vs = [v + h * sum(a * q for a, q in zip(row, k)) for row in A]
        xs = [x + h * sum(a * w for a, w in zip(row, vs)) for row in A]
        new = [acceleration(t + c * h, y, w) for c, y, w in zip(NODES, xs, vs)]
        done = max(abs(a - b) for a, b in zip(new, k)) < 1e-15
        k = new
        if done:
            break
    vs = [v + h * sum(a * q for a, q in zip(row, k)) for row in A]
    return x + h * sum(b * w for b, w in zip(B, vs)), v + h * sum(b * q for b, q in zip(B, k))


# name: (m x'' without friction (t, x, v, e), load (t, x, v, e), f_s and f_d by direction, x0, end)
def driven(t, x, v, e):
    return 3 * cos(0.5 * t) - x


# The coarse samples of an input.
KNOTS = [
    (0.0, 0.0), (1.3, 2.6), (2.1, -0.4), (3.7, -2.9), (4.4, 1.1), (6.2, 2.4), (7.7, -1.8),
    (9.1, 2.2), (11.4, -2.7), (12.0, 0.3), (14.3, 3.1), (16.8, -2.2), (18.5, 1.9), (20.0, -0.6),
]


def lines(t):
    (t0, a), (t1, b) = next((p, q) for p, q in zip(KNOTS, KNOTS[1:]) if t <= q[0] or q is KNOTS[-1])
    return a + (b - a) * (t - t0) / (t1 - t0)


SCENES = {
    "load in time": (driven, lambda t, x, v, e: 1 + 0.3 * cos(0.7 * t), (1.2, 1.2), (1.0, 1.0), 0.0, 60),
    "belt with patches": (
        lambda t, x, v, e: 0.3 * t - x,
        lambda t, x, v, e: 1 + 0.3 * sin(2 * x),
        (1.2, 1.2),
        (1.0, 1.0),
        0.0,
        60,
    ),
    "asymmetric foot": (driven, lambda t, x, v, e: 1.0, (1.2, 1.4), (1.0, 1.1), 0.0, 60),
    "pendulum": (
        lambda t, x, v, e: 0.7 * cos(0.5 * t) - sin(x),
        lambda t, x, v, e: cos(x) + v * v,
        (0.5, 0.5),
        (0.4, 0.4),
        0.3,
        60,
    ),
    "clutch": (
        lambda t, x, v, e: 2 * cos(0.5 * t) - x - 0.2 * v,
        lambda t, x, v, e: (1 + 0.2 * e) * (1 - 0.3 * tanh(v * v)) * (1 + 0.5 * tanh(t - 20)),
        (1.0, 1.0),
        (0.8, 0.8),
        0.5,
        60,
    ),
    "direction in the force": (
        lambda t, x, v, e: driven(t, x, v, e) - 0.3 * e * (1 + 0.5 * sin(t)),
        lambda t, x, v, e: 1.0,
        (1.0, 1.0),
        (0.8, 0.8),
        0.0,
        60,
    ),
    "input in the force": (
        lambda t, x, v, e: lines(t) - x, lambda t, x, v, e: 1.0, (1.2, 1.2), (1.0, 1.0), 0.0, 20,
        [t for t, _ in KNOTS],
    ),
    "input in the load": (
        driven, lambda t, x, v, e: 1 + 0.25 * lines(t), (1.2, 1.2), (1.0, 1.0), 0.0, 20,
        [t for t, _ in KNOTS],
    ),
}
H, FINE = 0.02, 1e-14


def cascade(force, load, f_s, f_d, x, end, kinks=()):
    of = {1: 0, -1: 1}

    def to_kink(t, h):
        return min([h] + [kink - t for kink in kinks if kink > t + 1e-12])

    def excess(t, x, e):
        return e * force(t, x, 0.0, e) - f_s[of[e]] * load(t, x, 0.0, e)

    def at_rest(t, x):
        return next((e for e in (1, -1) if excess(t, x, e) > 0), None)

    def told(t, x):
        return 0.5 * (force(t, x, 0.0, 1) + force(t, x, 0.0, -1))

    t, e = 0.0, at_rest(0.0, x)
    if e:
        yield 1, t, x, told(t, x)
    while True:
        if e is None:
            h = H / 4
            while at_rest(t + h, x) is None:
                t += h
                if t > end:
                    return
            low, high = 0.0, h
            while high - low > FINE * 10:
                middle = (low + high) / 2
                low, high = (low, middle) if at_rest(t + middle, x) else (middle, high)
            t += high
            e = at_rest(t, x)
            yield 1, t, x, told(t, x)
        else:
            def push(t, x, v):
                assert load(t, x, v, e) >= 0
                return force(t, x, v, e) - e * f_d[of[e]] * load(t, x, v, e)

            v = 0.0
            while True:
                h = to_kink(t, H)
                y, w = step(push, t, x, v, h)
                if e * w <= 0:
                    break
                t, x, v = t + h, y, w
                if t > end:
                    return
            low, high = 0.0, h
            while high - low > FINE:
                middle = (low + high) / 2
                low, high = (middle, high) if e * step(push, t, x, v, middle)[1] > 0 else (low, middle)
            x, t = step(push, t, x, v, high)[0], t + high
            if t > end:
                return
            e = at_rest(t, x)
            yield 2 if e else 0, t, x, told(t, x)


if __name__ == "__main__":
    print("scene,kind,t,x,b")
    for name, scene in SCENES.items():
        for kind, t, x, b in cascade(*scene):
            print(f"{name},{kind},{t!r},{x!r},{b!r}")
