"""A file of each kind, opened with xarray and written by it again, is read as before.

    comes_back.py MC FILE...

Each file is written with both engines, as it is and compressed. `mc show` then prints the same numbers,
and `mc verify` finds the same values; a variable that was dropped is named. A verb that does not read
files of this kind says what it is.
"""

import json
import subprocess
import sys
import tempfile
from pathlib import Path

import xarray as xr

mc, *files = sys.argv[1:]


def call(*arguments):
    return subprocess.run([mc, *map(str, arguments)], capture_output=True, text=True)


def shown(file):
    """The numbers that are shown of a file: not its name, and no warning that it was changed."""
    done = call("show", file, "--json")
    assert done.returncode == 0, done.stderr
    numbers = json.loads(done.stdout)
    for name in ("file", "warnings", "provenance"):
        numbers.pop(name, None)
    return json.dumps(numbers).replace(str(file), "")


def same(file, folder):
    with xr.open_dataset(file, engine="netcdf4", decode_times=False) as opened:
        ds = opened.load()
    numbers = {name for name in ds.variables if ds[name].dtype.kind in "fiu" and ds[name].ndim}
    for engine in ("netcdf4", "h5netcdf"):
        for level in (0, 4):
            again = folder / f"{engine}-{level}.nc"
            encoding = {name: {"zlib": True, "complevel": level} for name in numbers} if level else {}
            ds.to_netcdf(again, engine=engine, encoding=encoding)
            assert shown(again) == shown(file), f"{file}, {engine}, level {level}"
            verified = call("verify", again, "--again")
            assert verified.returncode == 0 and "bit for bit" in verified.stdout, verified.stdout + verified.stderr
    variable = next(name for name in ("estimate", "rung_estimate") if name in ds.data_vars)
    ds.drop_vars(variable).to_netcdf(folder / "dropped.nc")
    dropped = call("show", folder / "dropped.nc")
    assert dropped.returncode == 1 and f"{variable} is missing" in dropped.stderr, (variable, dropped.stderr)
    assert "save all variables" in dropped.stderr


for file in map(Path, files):
    with tempfile.TemporaryDirectory() as folder:
        same(file, Path(folder))
    other = call("replay", file, "--path", 0, "-o", "/dev/null/nowhere.h5")
    is_run = "which is not what this verb reads" not in other.stderr
    print(f"{file.name} comes back" + ("" if is_run else ", and is no run"))
