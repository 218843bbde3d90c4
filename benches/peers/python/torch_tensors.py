"""PyTorch: tensors over all paths, a Python loop over the steps."""

import math

import torch

import scene as s
from scene import h, paths

torch.set_default_dtype(torch.float64)
torch.set_num_threads(s.threads)
torch.manual_seed(1)


@torch.no_grad()
def run():
    x, v, e = torch.full((paths,), s.x0), torch.zeros(paths), torch.zeros(paths)
    b = s.beta - x
    stuck = b.abs() <= s.f_s
    entry, sticks, stick_steps, turns = (torch.zeros(paths) for _ in range(4))
    for n in range(s.steps):
        S = v + h * b
        v_next = torch.where(S.abs() <= h * s.f_s, 0.0, S - h * s.f_d * torch.sign(S))
        x = x + h * v
        e = s.decay * e + s.kick * torch.randn(paths)
        b = s.beta * math.cos(s.w * h * (n + 1)) + s.beta * s.rho * e - x

        zero = v_next == 0
        leaves = stuck & ~zero
        counted = leaves & (entry > 0)
        enters = ~stuck & zero & (b.abs() <= s.f_s)
        turns += ~stuck & ~enters & (v * v_next <= 0) & (v != 0)
        sticks += counted
        stick_steps += torch.where(counted, n - entry, 0.0)
        stuck = (stuck & zero) | enters
        entry = torch.where(enters, float(n + 1), entry)
        v = v_next
    return x, sticks, stick_steps * h, turns


watch = s.Watch()
results = run()
watch.stop()
watch.report(*results)
