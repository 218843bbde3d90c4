/* Statistics of the noisy scene of the paper (scenarios/rho025.toml), from a program that shares no
   code with the crate, for the tests that compare with them (src/study/tests/reference.rs).

       cc -O2 -o noisy tests/reference/noisy.c -lm
       (./noisy limit 500000; ./noisy step 0.02 200000; ./noisy step 0.01 200000; \
        ./noisy step 0.001 40000) > tests/reference/noisy.csv

   writes noisy.csv in seven minutes on one core: the statistics of the model itself, and those of
   the discrete variational inequality with three steps, with their standard errors. `./noisy limit
   100000 2 0.25` has steps a quarter as long and another seed; its statistics agree.

   `limit` simulates each path with steps of varying length. In a stick the noise is drawn exactly,
   and the steps shrink with the square of the distance from the threshold, so that no crossing is
   missed; in the shortest steps a bridge decides whether the threshold was crossed. In a slip the
   motion under the forcing is exact, and the noise adds its integral and its double integral, which
   are drawn together with it. The steps shrink with the velocity V like V^(2/3), the time in which
   the noise could reverse it, so that zeros of V are approached and not stepped over. The shortest
   step is 1e-5, while ((f_s - f_d)/s)^2 = 0.018 is the time scale of the shortest slips.

   `step` is the formula of the paper in a loop over n, with sticks and slips defined as in
   docs/model.md. */
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* m = K = 1, no damping, T = cos(w t) + rho v, dv = -v dt + dW, b = 6 T - x = B + n - x. */
static const double F_S = 1.2, F_D = 1.0, W = 0.25, B0 = 6.0, S = 6.0 * 0.25, X0 = 6.0, END = 60.0;

/* Random numbers: sfc64 (C. Doty-Humphrey), normals by the polar method. */
static uint64_t ra, rb, rc, counter;
static int has_spare;
static double spare;

static uint64_t bits(void) {
    uint64_t t = ra + rb + counter++;
    ra = rb ^ (rb >> 11);
    rb = rc + (rc << 3);
    rc = ((rc << 24) | (rc >> 40)) + t;
    return t;
}

static double uniform(void) { return ((double)(bits() >> 11) + 0.5) / 9007199254740992.0; }

static double normal(void) {
    if (has_spare) {
        has_spare = 0;
        return spare;
    }
    double x, y, r;
    do {
        x = 2 * uniform() - 1;
        y = 2 * uniform() - 1;
        r = x * x + y * y;
    } while (r >= 1);
    double scale = sqrt(-2 * log(r) / r);
    has_spare = 1;
    spare = y * scale;
    return x * scale;
}

static void seed(uint64_t s) {
    ra = rb = rc = s;
    counter = 1;
    for (int i = 0; i < 20; i++) bits();
}

/* The sums of one path. */
enum { STICKS, DURATION, SLIPS, SUB_PHASES, MULTIPLE, JUMPS, STATIC, FIRST, X_END, SUMS };

typedef struct {
    double sum[SUMS];
    double entered, origin;
    int is_static, is_first, running;
} Path;

static void begin(Path *p) {
    memset(p, 0, sizeof *p);
    p->is_static = p->is_first = 1;
}

static void slip_starts(Path *p, double t, double x) {
    double duration = t - p->entered;
    p->sum[STATIC] += duration;
    if (p->is_first) p->sum[FIRST] = duration;
    else p->sum[STICKS] += 1, p->sum[DURATION] += duration;
    p->is_first = p->is_static = 0;
    p->origin = x;
    p->running = 1;
}

static void stick_starts(Path *p, double t, double x) {
    p->sum[SLIPS] += 1;
    p->sum[SUB_PHASES] += p->running;
    p->sum[MULTIPLE] += p->running > 1;
    p->sum[JUMPS] += fabs(x - p->origin);
    p->is_static = 1;
    p->entered = t;
}

static void end(Path *p, double x) {
    if (p->is_static) p->sum[STATIC] += END - p->entered;
    p->sum[X_END] = x;
}

/* The model itself. */
static double LONGEST = 0.02, NEAR = 0.08, FAST = 0.25, SHORTEST = 1e-5;

static double clip(double dt, double left) {
    dt = dt < SHORTEST ? SHORTEST : dt;
    dt = dt > LONGEST ? LONGEST : dt;
    return dt > left ? left : dt;
}

static void limit(Path *p) {
    double t = 0, x = X0, v = 0, n = 0, sign = 0;
    begin(p);
    while (t < END) {
        double forcing = B0 * cos(W * t), b = forcing + n - x;
        if (p->is_static) {
            double near = F_S - fabs(b);
            double dt = clip(NEAR * near * near / (S * S), END - t);
            double n1 = n * exp(-dt) + S * sqrt(-expm1(-2 * dt) / 2) * normal();
            double b1 = B0 * cos(W * (t + dt)) + n1 - x;
            double u = uniform(), at = 0;
            sign = 0;
            for (int side = 1; side >= -1; side -= 2) {
                double d0 = F_S - side * b, d1 = F_S - side * b1;
                double chance = d1 <= 0 ? 1 : exp(-2 * d0 * d1 / (S * S * dt));
                if (sign == 0 && u < chance) sign = side, at = d0 / (d0 + fabs(d1));
                else u = (u - chance) / (1 - chance);
            }
            t += sign == 0 ? dt : at * dt;
            n = n1;
            if (sign != 0) {
                n = sign * F_S + x - B0 * cos(W * t);
                v = 0;
                slip_starts(p, t, x);
            }
            continue;
        }
        double speed = sign * v, a = fabs(b - sign * F_D) + 1e-300;
        double noise_time = FAST * cbrt(speed / S * (speed / S)), force_time = FAST * speed / a;
        double dt = clip(noise_time < force_time ? noise_time : force_time, END - t), root = S * sqrt(dt);
        double n1 = n * exp(-dt) + S * sqrt(-expm1(-2 * dt) / 2) * normal();
        double excess = root * dt / sqrt(12) * normal();
        double once = dt * (n + n1) / 2 + excess;
        double twice = dt * dt * (n / 3 + n1 / 6) + dt * excess / 2 + root * dt * dt / sqrt(720) * normal();
        double p0 = B0 / (1 - W * W), t1 = t + dt, c = cos(dt), s = sin(dt);
        double y = x - p0 * cos(W * t) + sign * F_D, q = v + p0 * W * sin(W * t);
        double x1 = p0 * cos(W * t1) - sign * F_D + y * c + q * s + twice;
        double v1 = -p0 * W * sin(W * t1) - y * s + q * c + once;
        if (sign * v1 > 0) {
            t = t1, x = x1, v = v1, n = n1;
            continue;
        }
        /* The velocity is zero in one of the shortest steps. */
        double part = v / (v - v1);
        t += part * dt, x += part * (x1 - x), n += part * (n1 - n), v = 0;
        b = B0 * cos(W * t) + n - x;
        sign = b > 0 ? 1 : -1;
        if (fabs(b) <= F_S) stick_starts(p, t, x);
        else p->running++;
    }
    end(p, x);
}

/* The discrete variational inequality. */
static void step(Path *p, double h) {
    long steps = lround(END / h);
    double x = X0, v = 0, n = 0, decay = exp(-h), sd = S * sqrt(-expm1(-2 * h) / 2);
    begin(p);
    for (long i = 0; i < steps; i++) {
        double b = B0 * cos(W * (double)i * h) + n - x, s = v + h * b;
        double v1 = fabs(s) <= h * F_S ? 0 : s - h * F_D * (s > 0 ? 1 : -1);
        double x1 = x + h * v, n1 = decay * n + sd * normal();
        if (p->is_static) {
            if (v1 != 0) slip_starts(p, (double)i * h, x);
        } else if (v1 == 0) {
            double t1 = (double)(i + 1) * h;
            if (fabs(B0 * cos(W * t1) + n1 - x1) <= F_S) stick_starts(p, t1, x1);
            else p->running++;
        } else if (v * v1 < 0) p->running++;
        x = x1, v = v1, n = n1;
    }
    end(p, x);
}

/* A ratio of two means over paths and its standard error, from the sums of products. */
static double products[SUMS + 1][SUMS + 1];

static const char *which = "limit";

static void print(const char *name, int top, int bottom, double paths, double scale) {
    double r = products[top][SUMS] / products[bottom][SUMS];
    double spread = products[top][top] - 2 * r * products[top][bottom] + r * r * products[bottom][bottom];
    if (bottom == SUMS) spread = products[top][top] - r * r * paths;
    printf("%s,%s,%.7f,%.7f\n", which, name, r / scale, sqrt(spread) / products[bottom][SUMS] / scale);
}

int main(int count, char **argument) {
    int is_step = count > 3 && !strcmp(argument[1], "step");
    if (!is_step && (count < 3 || strcmp(argument[1], "limit"))) {
        fprintf(stderr, "usage: noisy limit PATHS [SEED [SHORTER]] | noisy step H PATHS [SEED]\n");
        return 2;
    }
    long paths = atol(argument[2 + is_step]);
    if (is_step) which = argument[2];
    seed(count > 3 + is_step ? strtoull(argument[3 + is_step], 0, 10) : 1);
    if (!is_step && count > 4) {
        double shorter = atof(argument[4]);
        LONGEST *= shorter, NEAR *= shorter, FAST *= shorter, SHORTEST *= shorter;
    }
    for (long i = 0; i < paths; i++) {
        Path p;
        if (is_step) step(&p, atof(argument[2]));
        else limit(&p);
        double values[SUMS + 1];
        memcpy(values, p.sum, sizeof p.sum);
        values[SUMS] = 1;
        for (int j = 0; j <= SUMS; j++)
            for (int k = 0; k <= SUMS; k++) products[j][k] += values[j] * values[k];
    }
    double n = (double)paths;
    print("stick_duration_mean", DURATION, STICKS, n, 1);
    print("first_stick_duration_mean", FIRST, SUMS, n, 1);
    print("sticks_per_path", STICKS, SUMS, n, 1);
    print("slips_per_path", SLIPS, SUMS, n, 1);
    print("sub_phases_mean", SUB_PHASES, SLIPS, n, 1);
    print("sub_phases_multiple_share", MULTIPLE, SLIPS, n, 1);
    print("sticking_fraction", STATIC, SUMS, n, END);
    print("displacement_end_mean", X_END, SUMS, n, 1);
    print("jump_abs_mean", JUMPS, SLIPS, n, 1);
    return 0;
}
