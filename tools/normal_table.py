#!/usr/bin/env python3
"""Write src/noise/normal_table.rs: the parabolas of the inverse normal CDF, and reference values to test them against.

usage: python3 -m venv v && v/bin/pip install mpmath==1.4.1 && v/bin/python tools/normal_table.py

z(y) = -Phi^{-1}(y 2^-64) = sqrt(2) erfc^{-1}(y 2^-63) for 1 <= y < 2^63. Each octave of y is cut into 128 equal cells; on a cell with
centre c, z is the parabola c0 + c1 t + c2 t^2 in t = y - c that interpolates it at the Chebyshev nodes, computed with 40
digits. y = 2^63, where z = 0, has a cell of its own.

Two 64-bit words hold the three coefficients: the first is c0; the second, read as a double, is c1, the bits of c2 being the end of its
mantissa; shifted left it is c2, a double whose missing mantissa bits are zero. So first c2 is rounded to the bits it has, then c1
and c0 are fitted to what is left.
"""
import struct

import mpmath as mp

mp.mp.dps = 40
OCTAVES, CELLS = 63, 128
C2_BITS = 28  # sign, 11 bits of exponent, 16 of mantissa


def z(y):
    d = mp.mpf(y) / mp.mpf(2) ** 63
    if d > mp.mpf(2) ** -3:
        return mp.sqrt(2) * mp.erfinv(1 - d)
    guess = mp.sqrt(-2 * mp.log(d / 2))
    return mp.findroot(lambda x: mp.log(mp.erfc(x / mp.sqrt(2))) - mp.log(d), guess)


def bits(x):
    return struct.unpack("<Q", struct.pack("<d", float(x)))[0]


def double(b):
    return struct.unpack("<d", struct.pack("<Q", b))[0]


def top(x, n):
    """The n upper bits of the double nearest x among those with zeros below."""
    return (bits(x) + (1 << (63 - n))) >> (64 - n)


def word(x, low, n):
    """The 64-bit word with `low` in its n lower bits that is nearest x as a double."""
    b = ((bits(x) >> n) << n) | low
    return min((b - (1 << n), b, b + (1 << n)), key=lambda b: abs(double(b) - x))


def fit(nodes, values, degree):
    """Coefficients of the polynomial in t that fits best at the nodes."""
    rows = mp.matrix(len(nodes), degree + 1)
    for i, t in enumerate(nodes):
        for k in range(degree + 1):
            rows[i, k] = t**k
    return mp.lu_solve(rows, mp.matrix(values))


def cell(o, i):
    """The two words of cell i of 2^o <= y < 2^{o+1}."""
    width = mp.mpf(2) ** o / CELLS
    centre = mp.mpf(2) ** o + (i + mp.mpf(1) / 2) * width
    nodes = [width / 2 * mp.cos(mp.pi * (2 * k + 1) / 6) for k in range(3)]
    values = [z(centre + t) for t in nodes]
    c2 = top(fit(nodes, values, 2)[2], C2_BITS)
    values = [v - double(c2 << (64 - C2_BITS)) * t**2 for v, t in zip(values, nodes)]
    w1 = word(fit(nodes, values, 1)[1], c2, C2_BITS)
    values = [v - double(w1) * t for v, t in zip(values, nodes)]
    return bits((max(values) + min(values)) / 2), w1


def place(o, i):
    """The low 13 bits of (bits of y) >> 45: exponent field 1023 + o and upper mantissa."""
    return ((1023 + o) * CELLS + i) % (64 * CELLS)


def rows(words):
    return [", ".join("0x%016x" % w for w in words[i : i + 6]) for i in range(0, len(words), 6)]


def write(f, name, doc, kind, rows, test=False, length=None):
    f.write("\n/// %s\n%s#[rustfmt::skip]\npub(super) static %s: [%s; %d] = [\n" % (doc, "#[cfg(test)]\n" if test else "", name, kind, length or len(rows)))
    for row in rows:
        f.write("    %s,\n" % row)
    f.write("];\n")


if __name__ == "__main__":
    words = [(0, 0)] * (64 * CELLS)
    for o in range(OCTAVES):
        for i in range(CELLS):
            words[place(o, i)] = cell(o, i)
    points = []
    for o in range(OCTAVES):
        for i in range(3, CELLS, 32):  # every 32nd cell, eight points in each; odd integers next to them
            points += [int(mp.mpf(2) ** o * (1 + (i + mp.mpf(k) / 8) / CELLS)) | 1 for k in range(8)] if o > 8 else []
    points += [1, 3, 5, 7, 9, 15, 33, 101]
    with open("src/noise/normal_table.rs", "w") as f:
        f.write("//! Parabolas of the inverse normal CDF; written by tools/normal_table.py, not by hand.\n")
        f.write("\n/// Bits of a word of `SLOPES` that hold c2.\npub(super) const C2_BITS: u32 = %d;\n" % C2_BITS)
        write(f, "LEVELS", "c0 of each cell.", "u64", rows([w[0] for w in words]), length=len(words))
        write(f, "SLOPES", "c1 of each cell, and c2 in the low bits.", "u64", rows([w[1] for w in words]), length=len(words))
        pairs = ["(%d, %r)" % (y, float(z(y))) for y in points]
        write(f, "REFERENCE", "(y, z(y)), 40 digits rounded: 32 points an octave, and the smallest y.", "(u64, f64)", pairs, True)
