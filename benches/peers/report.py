"""The table, and the same as CSV in results/, one file for each machine.

The ratio is the median over the runs of a peer of its time divided by the mean of our two runs
beside it, with the range: of processor times on one thread, of wall-clock times on several. The
times in ns are the least of all runs, so their quotient need not equal the ratio.
"""

import csv
import math
import statistics

from lineup import here

SIGMAS = 4  # two correct programs differ by more than this once in 16000 comparisons


def summary(peer, clock):
    """One line of the table. The means are those of the last run of the peer; since seeds are
    fixed, all its runs have the same."""
    ratios = [
        result[clock] / ((before[clock] + after[clock]) / 2) for before, result, after in peer.runs
    ]
    best = {key: min(result[key] for _, result, _ in peer.runs) for key in ("wall", "cpu", "setup")}
    before, result, _ = peer.runs[-1]
    return {
        "ratio": statistics.median(ratios),
        "ratio_low": min(ratios),
        "ratio_high": max(ratios),
        **best,
        "sticks": result["sticks"],
        "duration": result["duration"],
        "agrees": agrees(before, result),
    }


def agrees(ours, result):
    """Whether both means differ by no more than the noise of two independent ensembles explains."""
    growth = math.sqrt(1 + ours["paths"] / result["paths"])
    return all(
        abs(result[name] - ours[name]["estimate"]) <= SIGMAS * growth * ours[name]["standard_error"]
        for name in ("sticks", "duration")
    )


def our_runs(peers):
    return [run for peer in peers for before, _, after in peer.runs for run in (before, after)]


def show(peers, threads, cores, machine):
    clock = "cpu" if threads == 1 else "wall"
    print(*machine, sep="\n")
    print(
        f"{threads} thread{'s' * (threads > 1)}, {'not pinned' if cores is None else f'pinned to core {cores}'}; "
        f"ratio by {'processor time' if threads == 1 else 'the clock'}\n"
    )
    row = "{:<38} {:<16} {:>8} {:>8} {:>7} {:>15} {:>8} {:>7} {:>8}  {}"
    print(
        row.format(
            "",
            "precision",
            "ns clock",
            "ns cpu",
            "ratio",
            "(range)",
            "setup s",
            "sticks",
            "duration",
            "agrees",
        )
    )
    ours = our_runs(peers)
    if ours:
        low, high = min(run[clock] for run in ours), max(run[clock] for run in ours)
        print(
            row.format(
                "mc run, all statistics, file",
                "f64",
                f"{min(run['wall'] for run in ours):.2f}",
                f"{min(run['cpu'] for run in ours):.2f}",
                "1",
                "",
                "0.0",
                f"{ours[0]['sticks']['estimate']:.3f}",
                f"{ours[0]['duration']['estimate']:.4f}",
                "",
            )
        )
    for peer in peers:
        if not peer.runs:
            print(f"{peer.name:<38} {peer.precision:<16} absent: {peer.absent}")
            continue
        s = summary(peer, clock)
        print(
            row.format(
                peer.name,
                peer.precision,
                f"{s['wall']:.2f}",
                f"{s['cpu']:.2f}",
                f"{s['ratio']:.1f}",
                f"({s['ratio_low']:.1f} - {s['ratio_high']:.1f})",
                f"{s['setup']:.1f}",
                f"{s['sticks']:.3f}",
                f"{s['duration']:.4f}",
                "yes" if s["agrees"] else "NO: MEANS DIFFER",
            )
        )
    if ours:
        share = statistics.median(run["cpu"] / run["wall"] for run in ours) / threads
        print(
            f"\nnoise: {len(ours)} runs of mc took {low:.2f} to {high:.2f} ns, median "
            f"{statistics.median(run[clock] for run in ours):.2f}; it had {min(share, 1):.0%} of its cores"
        )


def keep(peers, threads, slug):
    """Replace the rows of this number of threads in the CSV file, and keep the others."""
    clock = "cpu" if threads == 1 else "wall"
    columns = [
        "threads",
        "peer",
        "precision",
        "wall",
        "cpu",
        "ratio",
        "ratio_low",
        "ratio_high",
        "setup",
        "sticks",
        "duration",
        "agrees",
        "absent",
    ]
    path = here / "results" / f"{slug}.csv"
    rows = (
        [row for row in csv.DictReader(path.open()) if row["threads"] != str(threads)]
        if path.exists()
        else []
    )
    ours = our_runs(peers)
    if ours:
        rows.append(
            {
                "threads": threads,
                "peer": "mc run",
                "precision": "f64",
                "ratio": 1,
                "setup": 0,
                "wall": round(min(run["wall"] for run in ours), 4),
                "cpu": round(min(run["cpu"] for run in ours), 4),
                "sticks": round(ours[0]["sticks"]["estimate"], 4),
                "duration": round(ours[0]["duration"]["estimate"], 4),
            }
        )
    for peer in peers:
        values = summary(peer, clock) if peer.runs else {"absent": peer.absent}
        rows.append(
            {
                "threads": threads,
                "peer": peer.name,
                "precision": peer.precision,
                **{
                    key: round(value, 4) if isinstance(value, float) else value
                    for key, value in values.items()
                },
            }
        )
    path.parent.mkdir(exist_ok=True)
    with path.open("w", newline="") as file:
        writer = csv.DictWriter(file, columns, lineterminator="\n")
        writer.writeheader()
        writer.writerows(sorted(rows, key=lambda row: int(row["threads"])))
    print(f"kept in {path.relative_to(here.parent.parent)}")
