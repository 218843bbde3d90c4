"""Transition of (x, x', n) over a time h in extended precision, for tests/physics/event_driven.rs.

    python3 tests/reference/slip_transition.py > tests/reference/slip_transition.csv

Needs mpmath. dX = A X dt + (0, 0, 1) dW with A = [[0, 1, 0], [-w0^2, -2 alpha, 1], [0, 0, -theta]]
(m = 1), in 220 digits. The sums over pairs of eigenvalues below lose 5 log10(1/h) = 45 of them at h
= 1e-9, and 80 more where all three eigenvalues are equal and only a perturbation of 1e-40 makes the
matrix diagonalisable. Wherever |A| h is moderate the rows are compared with Van Loan's block
exponential (IEEE Trans. Autom. Control 23, 1978).
"""

from mpmath import mp, mpf, matrix, expm, exp, sqrt, mpc

mp.dps = 220


def spectral(w0, theta, alpha, h):
    root = sqrt(mpc(alpha * alpha - w0 * w0 * (1 + mpf(10) ** -40)))
    l1, l2, l3 = -alpha + root, -alpha - root, -theta
    # Impulse responses as sums of c e^{z r}: of x to x' (S), and of x to n (divided differences).
    # Derivatives have the factor z.
    s = [(1 / (l1 - l2), l1), (-1 / (l1 - l2), l2)]
    g = [
        (1 / ((l3 - l1) * (l3 - l2)), l3),
        (1 / ((l1 - l3) * (l1 - l2)), l1),
        (1 / ((l2 - l3) * (l2 - l1)), l2),
    ]
    slope = lambda f: [(c * z, z) for c, z in f]
    at = lambda f: sum(c * exp(z * h) for c, z in f).real
    S, dS = at(s), at(slope(s))
    phi = [dS + 2 * alpha * S, S, at(g), -w0 * w0 * S, dS, at(slope(g)), exp(-theta * h)]
    growth = lambda z: (exp(z * h) - 1) / z if z != 0 else h
    integral = lambda f, k: sum(c * d * growth(y + z) for c, y in f for d, z in k).real
    n, v = [(mpf(1), -theta)], slope(g)
    return phi + [
        integral(n, n),
        integral(n, v),
        integral(n, g),
        integral(v, v),
        integral(v, g),
        integral(g, g),
    ]


def van_loan(w0, theta, alpha, h):
    a = matrix([[0, 1, 0], [-w0 * w0, -2 * alpha, 1], [0, 0, -theta]])
    block = matrix(6, 6)
    for i in range(3):
        for j in range(3):
            block[i, j] = -a[i, j]
            block[3 + i, 3 + j] = a[j, i]
    block[2, 5] = 1
    e = expm(block * h)
    phi = e[3:6, 3:6].T
    q = phi * e[0:3, 3:6]
    return [
        phi[0, 0],
        phi[0, 1],
        phi[0, 2],
        phi[1, 0],
        phi[1, 1],
        phi[1, 2],
        phi[2, 2],
        q[2, 2],
        q[2, 1],
        q[2, 0],
        q[1, 1],
        q[1, 0],
        q[0, 0],
    ]


print("w0,theta,alpha,h,xx,xv,xn,vx,vv,vn,nn,cov_nn,cov_nv,cov_nx,cov_vv,cov_vx,cov_xx")
W0, THETA, RATIO = ("0.3", "1", "20"), ("0.01", "1", "50"), ("0", "0.1", "1", "3")
H = ("1e-9", "1e-6", "1e-3", "0.03", "0.5", "4", "30", "1000")
# Every pair of two values occurs in some row.
for i, ratio in enumerate(map(mpf, RATIO)):
    for j, h in enumerate(map(mpf, H)):
        w0, theta = mpf(W0[(i + j + i // 3) % 3]), mpf(THETA[(i + j // 3 + i // 3) % 3])
        # The inputs as the doubles that the test reads.
        alpha = mpf(float(ratio * w0))
        w0, theta, h = mpf(float(w0)), mpf(float(theta)), mpf(float(h))
        row = spectral(w0, theta, alpha, h)
        if (w0 + theta + 2 * alpha) * h < 20:
            for a, b in zip(row, van_loan(w0, theta, alpha, h)):
                assert abs(a - b) <= mpf(10) ** -25 * abs(b), (w0, theta, alpha, h, a, b)
        inputs = [repr(float(y)) for y in (w0, theta, alpha, h)]
        print(",".join(inputs + [mp.nstr(y, 13) for y in row]))
