// C++: lanes of paths that are stepped together, which the compiler vectorises. This is the fastest
// way to write the scheme by hand that we know.
//
// -DREAL=float or double is the precision of the state. The normals have single precision in both
// cases, from 24-bit uniforms: xoshiro128+ and Giles' polynomial for erfinv ("Approximating the
// erfinv function", 2010), whose logarithm is that of the vector library of libm under -ffast-math.
// So a normal cannot exceed 5.4, and no path can be simulated again alone. The program counts
// sticks and their time, but no turning points within a slip, which is a little less work than the
// others do.
#include "scene.hpp"
#include <cstdint>

#ifndef REAL
#define REAL double
#endif
constexpr int lanes = 64;

// xoshiro128+, with one generator for each lane.
struct Generators {
    alignas(64) uint32_t s[4][lanes];

    explicit Generators(uint64_t block) {
        uint64_t key = block * 0xD1342543DE82EF95 + 1;
        for (auto& word : s)
            for (auto& w : word) {  // splitmix64
                uint64_t z = key += 0x9E3779B97F4A7C15;
                z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9;
                z = (z ^ (z >> 27)) * 0x94D049BB133111EB;
                w = uint32_t((z ^ (z >> 31)) >> 32);
            }
    }

    void normals(float* xi) {
        alignas(64) float y[lanes];
#pragma GCC ivdep
        for (int l = 0; l < lanes; l++) {
            const uint32_t out = s[0][l] + s[3][l], t = s[1][l] << 9;
            s[2][l] ^= s[0][l]; s[3][l] ^= s[1][l]; s[1][l] ^= s[2][l]; s[0][l] ^= s[3][l];
            s[2][l] ^= t;
            s[3][l] = (s[3][l] << 11) | (s[3][l] >> 21);
            y[l] = (float(int32_t(out >> 8)) + 0.5f) * 0x1p-23f - 1;
        }
#pragma GCC ivdep
        for (int l = 0; l < lanes; l++) {
            const float q = -logf((1 - y[l]) * (1 + y[l])), c = q - 2.5f, d = sqrtf(q) - 3;
            float centre = 2.81022636e-08f, tail = -0.000200214257f;
            for (float a : {3.43273939e-07f, -3.5233877e-06f, -4.39150654e-06f, 0.00021858087f, -0.00125372503f,
                            -0.00417768164f, 0.246640727f, 1.50140941f}) centre = a + centre * c;
            for (float a : {0.000100950558f, 0.00134934322f, -0.00367342844f, 0.00573950773f, -0.0076224613f,
                            0.00943887047f, 1.00167406f, 2.83297682f}) tail = a + tail * d;
            xi[l] = 1.41421356f * y[l] * (q < 5 ? centre : tail);
        }
    }
};

static Totals run(const Scene& s, const std::vector<REAL>& forcing, long block) {
    const REAL h = s.h, decay = s.decay(), kick = s.kick(), k_rho = s.beta * s.rho, hfs = s.h * s.f_s, hfd = s.h * s.f_d, f_s = s.f_s;
    const long steps = s.steps();
    Generators generators(block);
    alignas(64) float xi[lanes];
    alignas(64) REAL x[lanes], v[lanes], e[lanes], b[lanes], stuck[lanes], entry[lanes], sticks[lanes], stick_steps[lanes];
    for (int l = 0; l < lanes; l++) {
        x[l] = s.x0; v[l] = e[l] = entry[l] = sticks[l] = stick_steps[l] = 0;
        b[l] = forcing[0] - x[l];
        stuck[l] = 1;
    }
    for (long n = 0; n < steps; n++) {
        generators.normals(xi);
        const REAL f = forcing[n + 1], now = REAL(n);
#pragma GCC ivdep
        for (int l = 0; l < lanes; l++) {
            const REAL S = v[l] + h * b[l];
            const REAL v_next = std::fabs(S) <= hfs ? REAL(0) : S - (S > 0 ? hfd : -hfd);
            x[l] += h * v[l];
            e[l] = decay * e[l] + kick * REAL(xi[l]);
            b[l] = f + k_rho * e[l] - x[l];
            v[l] = v_next;
            const REAL leaves = stuck[l] > 0 && v_next != 0 ? REAL(1) : REAL(0);
            const REAL enters = stuck[l] == 0 && v_next == 0 && std::fabs(b[l]) <= f_s ? REAL(1) : REAL(0);
            const REAL counts = entry[l] > 0 ? leaves : REAL(0);
            sticks[l] += counts;
            stick_steps[l] += counts * (now - entry[l]);
            stuck[l] += enters - leaves;
            entry[l] = enters > 0 ? now + 1 : entry[l];
        }
    }
    Totals total;
    for (int l = 0; l < lanes && block * lanes + l < s.paths; l++) {
        total.sticks += sticks[l];
        total.stick_steps += stick_steps[l];
        total.end_of_path(x[l]);
    }
    return total;
}

int main(int count, char** words) {
    const Scene s(count, words);
    const auto forcing = s.forcing<REAL>();
    Watch watch;
    Totals total;
    const long blocks = (s.paths + lanes - 1) / lanes;
#pragma omp parallel for num_threads(s.threads) schedule(dynamic)
    for (long block = 0; block < blocks; block++) {
        const Totals own = run(s, forcing, block);
#pragma omp critical
        total.add(own);
    }
    watch.report(s, total);
}
