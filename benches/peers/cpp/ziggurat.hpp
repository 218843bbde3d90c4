// Fast scalar normals: xoshiro256++ (Blackman and Vigna) and the ziggurat with 256 layers (Marsaglia
// and Tsang).
#pragma once
#include <cmath>
#include <cstdint>

class Ziggurat {
    uint64_t s[4];

    // Layers of equal area v under f(x) = exp(-x^2/2), with the tail beyond r:
    // x[0] = v / f(r) > x[1] = r > ... > x[256] = 0.
    struct Layers {
        static constexpr double r = 3.6541528853610088, v = 0.00492867323399;
        double x[257], f[257];
        Layers() {
            x[0] = v / std::exp(-0.5 * r * r);
            x[1] = r;
            for (int i = 2; i < 256; i++) x[i] = std::sqrt(-2 * std::log(v / x[i - 1] + std::exp(-0.5 * x[i - 1] * x[i - 1])));
            x[256] = 0;
            for (int i = 0; i <= 256; i++) f[i] = std::exp(-0.5 * x[i] * x[i]);
        }
    };
    static inline const Layers layers;

    static uint64_t rotate(uint64_t a, int k) { return (a << k) | (a >> (64 - k)); }

    uint64_t next() {
        const uint64_t out = rotate(s[0] + s[3], 23) + s[0], t = s[1] << 17;
        s[2] ^= s[0]; s[3] ^= s[1]; s[1] ^= s[2]; s[0] ^= s[3];
        s[2] ^= t;
        s[3] = rotate(s[3], 45);
        return out;
    }

    double uniform() { return (double(next() >> 11) + 0.5) * 0x1p-53; }

public:
    explicit Ziggurat(uint64_t path) {
        for (auto& word : s) {  // splitmix64
            uint64_t z = path += 0x9E3779B97F4A7C15;
            z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9;
            z = (z ^ (z >> 27)) * 0x94D049BB133111EB;
            word = z ^ (z >> 31);
        }
    }

    double operator()() {
        for (;;) {
            const uint64_t bits = next();
            const int i = bits & 255;
            const double u = double(int64_t(bits) >> 11) * 0x1p-52, x = u * layers.x[i];  // u in [-1, 1)
            if (std::fabs(x) < layers.x[i + 1]) return x;
            if (i == 0) {
                double a, b;
                do {
                    a = -std::log(uniform()) / Layers::r;
                    b = -std::log(uniform());
                } while (b + b < a * a);
                return std::copysign(Layers::r + a, u);
            }
            if (layers.f[i + 1] + (layers.f[i] - layers.f[i + 1]) * uniform() < std::exp(-0.5 * x * x)) return x;
        }
    }
};
