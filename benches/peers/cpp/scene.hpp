// The scene that every C++ peer runs, its command line (paths, end, threads), and the JSON line
// that it prints.
//
// The scheme, in the symbols of the paper with m = K = 1:
//   b_n     = beta (cos(w t_n) + rho e_n) - X_n
//   S_n     = V_n + h b_n
//   X_{n+1} = X_n + h V_n,   V_{n+1} = 0 if |S_n| <= h f_s, else S_n - h f_d sign(S_n)
//   e_{n+1} = decay e_n + kick xi_n,  the exact transition of de = -e dt + dW
//
// How sticks are counted: a stick begins at t_{n+1} if V_{n+1} = 0 and |b_{n+1}| <= f_s, and ends
// at t_n, the last instant with V_n = 0. The stick at t = 0 is an initial condition and is not
// counted, nor is a stick that has not ended at the end.
#pragma once
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <vector>

struct Scene {
    long paths = 10000;
    double end = 12, h = 1e-3;
    int threads = 1;

    static constexpr double beta = 6, w = 0.25, rho = 0.25, f_s = 1.2, f_d = 1, x0 = 6;

    Scene(int count, char** words) {
        if (count > 1) paths = std::atol(words[1]);
        if (count > 2) end = std::atof(words[2]);
        if (count > 3) threads = std::atoi(words[3]);
    }

    long steps() const { return std::lround(end / h); }
    double decay() const { return std::exp(-h); }
    double kick() const { return std::sqrt(-std::expm1(-2 * h) / 2); }

    // beta cos(w t_n) at every grid time: the same for all paths.
    template <class Real> std::vector<Real> forcing() const {
        std::vector<Real> table(steps() + 1);
        for (long n = 0; n <= steps(); n++) table[n] = Real(beta * std::cos(w * h * n));
        return table;
    }
};

// Sums over paths. Stick time is in steps. A turn is a zero of the velocity within a slip.
struct Totals {
    double sticks = 0, stick_steps = 0, turns = 0, x = 0, x2 = 0;

    void end_of_path(double x_end) { x += x_end; x2 += x_end * x_end; }
    void add(const Totals& o) { sticks += o.sticks; stick_steps += o.stick_steps; turns += o.turns; x += o.x; x2 += o.x2; }
};

// Wall time and processor time of the simulation itself.
struct Watch {
    std::chrono::steady_clock::time_point wall = std::chrono::steady_clock::now();
    std::clock_t cpu = std::clock();

    void report(const Scene& s, const Totals& t) const {
        const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - wall).count();
        const double cpu_seconds = double(std::clock() - cpu) / CLOCKS_PER_SEC, n = double(s.paths), mean = t.x / n;
        std::printf("{\"seconds\": %.6f, \"cpu_seconds\": %.6f, \"setup_seconds\": 0, \"paths\": %ld, \"steps\": %ld, \"threads\": %d, "
                    "\"sticks_per_path\": %.6f, \"stick_duration_mean\": %.6f, \"turns_per_path\": %.6f, "
                    "\"displacement_end_mean\": %.6f, \"displacement_end_sd\": %.6f}\n",
                    seconds, cpu_seconds, s.paths, s.steps(), s.threads, t.sticks / n, t.stick_steps / t.sticks * s.h,
                    t.turns / n, mean, std::sqrt(t.x2 / n - mean * mean));
    }
};
