#!/usr/bin/env python3
"""Write src/noise/normal_table.bin, the parabolas of the inverse normal CDF. Print the checksum and
the reference values that the tests in src/noise/normal.rs compare.

usage: python3 -m venv v && v/bin/pip install mpmath==1.4.1 && v/bin/python tools/normal_table.py

Z(y) = erfc^{-1}(y 2^-63) for 1 <= y < 2^63 is a standard normal over sqrt(2). Each octave of y is
divided into 128 equal cells, and t is the distance from the centre of a cell down to y, in widths
of the cell, -1/2 < t <= 1/2. Because Z'' = 2 Z Z'^2, a level A and a slope b > 0 determine the
parabola

    Z = A + s + A s^2,   s = b t,

whose error is only the cubic term. A and b are fitted with 40 digits, such that this error has the
same size at both ends and in between. y = 2^63, where Z = 0, has a cell of its own.

One 64-bit word holds both numbers: its lowest 22 bits are 2^21 plus b in units of 2^-28, and the
whole word, read as a double, is A. So b is rounded first, and then A is fitted. The cell of -y has
-A and -b, that is, the same upper bits except for the sign, and 2^21 minus b in the lower ones. So
A is fitted among the doubles with 2^21 in the lower bits, from which the two words differ by less
than 2^21 units in the last place.
"""

import struct

import mpmath as mp

mp.mp.dps = 40
OCTAVES, CELLS = 63, 128
# From the smallest y to the greatest that a double represents below 2^63.
POINTS = [1, 2, 3, 5, 101, 525] + [round(1.37 * 2**o) for o in range(13, 62, 4)] + [2**63 - 2048]
SLOPE_BITS, SLOPE_UNIT = 22, mp.mpf(2) ** -28
NO_SLOPE = 1 << (SLOPE_BITS - 1)


def erfc_inverse(y):
    """Z(y)"""
    d = mp.mpf(y) / mp.mpf(2) ** 63
    if d > mp.mpf(2) ** -3:
        return mp.erfinv(1 - d)
    return mp.findroot(lambda x: mp.log(mp.erfc(x)) - mp.log(d), mp.sqrt(-mp.log(d)))


def bits(x):
    return struct.unpack("<Q", struct.pack("<d", float(x)))[0]


def double(b):
    return struct.unpack("<d", struct.pack("<Q", b))[0]


def word(level, slope):
    """The word of a cell. Its upper bits are those with which a double that ends in NO_SLOPE is
    nearest to the level."""
    b = ((bits(level) >> SLOPE_BITS) << SLOPE_BITS) | NO_SLOPE
    step = 1 << SLOPE_BITS
    nearest = min((max(b - step, NO_SLOPE), b, b + step), key=lambda b: abs(double(b) - level))
    return nearest + slope


# The zeros of the Chebyshev polynomial T_3 on the cell, and its extrema.
NODES = [mp.cos(mp.pi * (2 * k + 1) / 6) / 2 for k in range(3)]
EXTREMA = [mp.cos(mp.pi * k / 3) / 2 for k in range(4)]


def cell(o, i):
    """The word of cell i of 2^o <= y < 2^{o+1}."""

    def at(t):
        return erfc_inverse(mp.mpf(2) ** o * (1 + (i + mp.mpf(1) / 2 - t) / CELLS))

    # The slope of the parabola through the nodes.
    slope = int(mp.nint((at(NODES[2]) - at(NODES[0])) / (NODES[2] - NODES[0]) / SLOPE_UNIT))
    assert 0 < slope < NO_SLOPE
    steps = [slope * SLOPE_UNIT * t for t in EXTREMA]
    levels = [(at(t) - s) / (1 + s**2) for t, s in zip(EXTREMA, steps)]
    return word((max(levels) + min(levels)) / 2, slope)


def error(o, i, w, sign):
    """The greatest error of the word of a cell at its ends and extrema, in standard deviations.
    With sign -1 it is that of the cell of -y."""
    slope = (w % (1 << SLOPE_BITS) - NO_SLOPE) * SLOPE_UNIT
    level = mp.mpf(double(w if sign > 0 else w - 2 * (w % (1 << SLOPE_BITS) - NO_SLOPE)))

    def at(t):
        s = slope * t
        return (
            level
            + s
            + level * s**2
            - erfc_inverse(mp.mpf(2) ** o * (1 + (i + mp.mpf(1) / 2 - t) / CELLS))
        )

    return mp.sqrt(2) * max(abs(at(t)) for t in EXTREMA)


def place(o, i):
    """The index of a cell beyond that of y = 1: (bits of y) >> 45, which is the exponent field 1023
    + o and the upper mantissa."""
    return o * CELLS + i


def fnv(data):
    """The checksum FNV-1a."""
    total = 0xCBF29CE484222325
    for byte in data:
        total = (total ^ byte) * 0x100000001B3 % 2**64
    return total


if __name__ == "__main__":
    words = [NO_SLOPE] * (64 * CELLS)
    for o in range(OCTAVES):
        for i in range(CELLS):
            words[place(o, i)] = cell(o, i)
    greatest = max(
        error(o, i, words[place(o, i)], sign)
        for o in range(OCTAVES)
        for i in range(CELLS)
        for sign in (1, -1)
    )
    print("greatest error: %.3g" % greatest)
    table = struct.pack("<%dQ" % len(words), *words)
    print("checksum: 0x%016x" % fnv(table))
    with open("src/noise/normal_table.bin", "wb") as f:
        f.write(table)
    for y in POINTS:
        print("(%d, %r)," % (y, float(mp.sqrt(2) * erfc_inverse(y))))
