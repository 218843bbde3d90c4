// C++: one path at a time in double precision, with the generator and the normals of the standard
// library, as in a textbook.
//
// With -DFAST_NORMALS it uses xoshiro256++ and a ziggurat instead, as somebody would who has
// profiled the textbook loop.
#include "scene.hpp"
#include <random>
#ifdef FAST_NORMALS
#include "ziggurat.hpp"
#endif

static Totals run(const Scene& s, const std::vector<double>& forcing, long first, long last) {
    const double h = s.h, decay = s.decay(), kick = s.kick(), k_rho = s.beta * s.rho;
    const long steps = s.steps();
    Totals total;
    for (long path = first; path < last; path++) {
#ifdef FAST_NORMALS
        Ziggurat normal(path);
        auto draw = [&] { return normal(); };
#else
        std::mt19937_64 generator(path);
        std::normal_distribution<double> normal;
        auto draw = [&] { return normal(generator); };
#endif
        double x = s.x0, v = 0, e = 0, b = forcing[0] - x;
        bool stuck = std::fabs(b) <= s.f_s;
        long entry = 0;
        for (long n = 0; n < steps; n++) {
            const double S = v + h * b;
            const double v_next = std::fabs(S) <= h * s.f_s ? 0 : S - std::copysign(h * s.f_d, S);
            x += h * v;
            e = decay * e + kick * draw();
            b = forcing[n + 1] + k_rho * e - x;
            if (stuck) {
                if (v_next != 0) {
                    stuck = false;
                    if (entry > 0) { total.sticks += 1; total.stick_steps += double(n - entry); }
                }
            } else if (v_next == 0 && std::fabs(b) <= s.f_s) {
                stuck = true;
                entry = n + 1;
            } else if (v * v_next <= 0 && v != 0) {
                total.turns += 1;
            }
            v = v_next;
        }
        total.end_of_path(x);
    }
    return total;
}

int main(int count, char** words) {
    const Scene s(count, words);
    const auto forcing = s.forcing<double>();
    Watch watch;
    Totals total;
#pragma omp parallel for num_threads(s.threads) schedule(static)
    for (int part = 0; part < s.threads; part++) {
        const Totals own = run(s, forcing, s.paths * part / s.threads, s.paths * (part + 1) / s.threads);
#pragma omp critical
        total.add(own);
    }
    watch.report(s, total);
}
