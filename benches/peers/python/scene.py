"""The scene that every Python peer runs, its command line, and the JSON line that it prints.

The scheme, in the symbols of the paper with m = K = 1:

    b_n     = beta (cos(w t_n) + rho e_n) - X_n
    S_n     = V_n + h b_n
    X_{n+1} = X_n + h V_n,   V_{n+1} = 0 if |S_n| <= h f_s, else S_n - h f_d sign(S_n)
    e_{n+1} = decay e_n + kick xi_n,  the exact transition of de = -e dt + dW

How sticks are counted: a stick begins at t_{n+1} if V_{n+1} = 0 and |b_{n+1}| <= f_s, and ends at
t_n, the last instant with V_n = 0. The stick at t = 0 is an initial condition and is not counted,
nor is a stick that has not ended at the end. A turn is a zero of the velocity within a slip.
"""

import json
import math
import sys
import time

beta, w, rho, f_s, f_d, x0 = 6.0, 0.25, 0.25, 1.2, 1.0, 6.0
h = 1e-3
decay, kick = math.exp(-h), math.sqrt(-math.expm1(-2 * h) / 2)

paths = int(sys.argv[1]) if len(sys.argv) > 1 else 10000
end = float(sys.argv[2]) if len(sys.argv) > 2 else 12.0
threads = int(sys.argv[3]) if len(sys.argv) > 3 else 1
option = sys.argv[4] if len(sys.argv) > 4 else ""
steps = round(end / h)


class Watch:
    """Wall-clock and processor time of the simulation. `report` takes that of the compilation."""

    def __init__(self):
        self.wall, self.cpu = time.perf_counter(), time.process_time()

    def stop(self):
        self.wall, self.cpu = time.perf_counter() - self.wall, time.process_time() - self.cpu

    def report(self, x, sticks, stick_time, turns, setup=0.0):
        """Print the JSON line. The arrays hold one number for each path."""
        print(
            json.dumps(
                {
                    "seconds": self.wall,
                    "cpu_seconds": self.cpu,
                    "setup_seconds": setup,
                    "paths": paths,
                    "steps": steps,
                    "threads": threads,
                    "sticks_per_path": float(sticks.sum()) / paths,
                    "stick_duration_mean": float(stick_time.sum() / sticks.sum()),
                    "turns_per_path": float(turns.sum()) / paths,
                    "displacement_end_mean": float(x.mean()),
                    "displacement_end_sd": float(x.std()),
                }
            )
        )
