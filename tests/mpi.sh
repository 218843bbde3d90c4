#!/usr/bin/env bash
# One run in several processes, by MPI. The file of 1, 2, 3 and 4 ranks equals that of threads, byte
# by byte. A rank that is lost ends all ranks, and what was finished is continued by another number
# of ranks, or by threads. The script installs what it needs.
set -euo pipefail
cd "$(dirname "$0")/.."

missing=()
command -v mpirun >/dev/null || missing+=(openmpi-bin)
command -v mpicc >/dev/null || missing+=(libopenmpi-dev)
command -v clang >/dev/null || missing+=(clang libclang-dev)
if [ "${#missing[@]}" -gt 0 ]; then
    as_root=()
    [ "$(id -u)" -eq 0 ] || as_root=(sudo)
    echo "installing: ${missing[*]}"
    "${as_root[@]}" apt-get update -q >/dev/null
    "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get install -y -q --no-install-recommends "${missing[@]}" >/dev/null
fi
cargo clippy --release --quiet --package stick-slip-mpi --all-targets -- -D warnings
cargo test --release --quiet --package stick-slip-mpi
cargo build --release --quiet --package stick-slip-mpi

folder=$(mktemp -d)
trap 'kill $(jobs -p) 2>/dev/null || true; rm -rf "$folder"' EXIT
cp target/release/mc "$folder/mc"
scene=$PWD/scenarios/rho025.toml
cd "$folder"
# A container has few processors, and its user is root.
export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1 OMPI_MCA_rmaps_base_oversubscribe=1 OMPI_MCA_btl_vader_single_copy_mechanism=none

fail() { echo "FAILED: $*" >&2; exit 1; }
ranks() { timeout 120 mpirun -n "$1" ./mc "${@:2}" --threads 1 --quiet 2>messages; }
same() { cmp -s "$1" "$2" || fail "$3"; echo "same: $3"; }

# Runs of every kind.
compare() { # COUNTS ARGUMENTS...
    ./mc run "$scene" "${@:2}" --quiet -o threads.h5 2>/dev/null
    for count in $1; do
        ranks "$count" run "$scene" "${@:2}" -o ranks.h5 || fail "$count ranks: $(cat messages)"
        same threads.h5 ranks.h5 "$count ranks, ${*:2}"
        rm ranks.h5
    done
    rm threads.h5
}
compare '1 2 3 4' --paths 29000 --set record.events=true --set record.trajectories=1300 --set time.output_step=5
compare 3 --paths 20000 --until 'stick_duration_mean < 1%'
compare 3 --paths 5000 --scheme event-driven
compare 2 --paths 20000 --set ensemble.antithetic=true --set record.paths=false
compare 4 --paths 100

# The file of a part contains how long it took, so that no two such files are equal.
ranks 3 run "$scene" --paths 20000 --part 2/3 -o part.h5 || fail "$(cat messages)"
./mc verify part.h5 --blocks all 2>/dev/null | grep -q 'every statistic' || fail 'a part of a run'
echo 'same: a part of a run'

# There is one table and one progress for any number of ranks: three ranks print what one prints, but
# for times.
shown() { # RANKS
    rm -f shown.h5
    timeout 60 mpirun -n "$1" ./mc run "$scene" --paths 200000 --no-bias --threads 1 -o shown.h5 >table 2>messages || fail "$(cat messages)"
    # How many lines about finished paths are printed depends on time, so they are not counted.
    { grep -c '^stick_duration_mean' table; grep -cv 'paths' messages || true; } | xargs
}
[ "$(shown 1)" = "$(shown 3)" ] || fail "three ranks print something else than one: $(cat table messages)"
sort messages | uniq -d | grep . && fail 'a line of progress is printed twice'
[ "$(grep -c '^stick_duration_mean' table)" -eq 1 ] || fail "the table is not there once: $(cat table)"
echo 'one table and one progress, however many ranks there are'
if timeout 60 mpirun -n 2 ./mc show shown.h5 >/dev/null 2>messages; then fail 'mc show with several ranks'; fi
grep -q 'leave out mpirun' messages || fail "no reason: $(cat messages)"

# Waiting ranks sleep, and messages take little: the CPU time of ranks without work, and that of 4
# ranks beside 4 threads. The bounds are wide, because the machine may be busy.
cpu() { # COMMAND...: CPU seconds of it and its children
    local TIMEFORMAT='%U %S'
    { time "$@" 2>/dev/null; } 2>used
    awk '{ print $1 + $2 }' used
}
start=$(cpu ranks 4 run "$scene" --paths 256 --no-bias --set record.paths=false -o start.h5)
long=(run "$scene" --paths 256 --step 0.00001 --no-bias --set time.output_step=5)
alone=$(cpu ./mc "${long[@]}" --threads 1 --quiet -o alone.h5)
together=$(cpu ranks 4 "${long[@]}" -o together.h5)
echo "CPU time of one block: $alone s alone, $together s on 4 ranks, of which 3 wait; $start s are the start of MPI"
awk "BEGIN { exit !($together < 1.25 * $alone + 1.5) }" || fail 'waiting takes CPU time'
many=(run "$scene" --paths 600000 --no-bias --force)
# A busy machine can make one measurement longer by a third, so the best of three counts.
for attempt in 1 2 3; do
    threads=$(cpu ./mc "${many[@]}" --threads 4 --quiet -o threads.h5)
    ranks=$(cpu ranks 4 "${many[@]}" -o ranks.h5)
    same threads.h5 ranks.h5 '600000 paths on 4 ranks'
    echo "CPU time of 600000 paths: $threads s on 4 threads, $ranks s on 4 ranks"
    ! awk "BEGIN { exit !($ranks - $start < 1.25 * $threads) }" || break
    [ "$attempt" -lt 3 ] || fail 'messages take CPU time'
done
rm -f ./*.h5

# Each rank writes its rows to a log if the ranks share a disk. If a log cannot be written, all end
# with a message, and nothing that was saved is lost.
mpirun -n 3 ./mc run "$scene" --paths 600000 --no-bias --threads 1 --quiet -o logs.h5 2>messages &
launcher=$!
until [ -e logs.h5.partial/state ]; do sleep 0.05; done
[ -s logs.h5.partial/rows ] && [ -s logs.h5.partial/rows.1 ] && [ -s logs.h5.partial/rows.2 ] || fail "no logs: $(ls logs.h5.partial)"
kill -TERM "$launcher"; wait "$launcher" || true
ranks 3 run "$scene" --paths 600000 --no-bias -o logs.h5 && fail 'an unfinished run is overwritten'
mkdir -p logs.h5.partial/rows.3
if ranks 2 resume logs.h5; then fail 'a log that cannot be written'; fi
grep -q 'rank 1 could not write its rows' messages || fail "no reason: $(cat messages)"
rmdir logs.h5.partial/rows.3
ranks 2 resume logs.h5 || fail "$(cat messages)"
[ ! -e logs.h5.partial ] || fail 'something is left of a finished run'
./mc run "$scene" --paths 600000 --no-bias --quiet -o whole.h5 2>/dev/null
same whole.h5 logs.h5 'logs of 3 ranks, then of 2'
rm -f ./*.h5

# A rank that panics ends all with its message. A worker of another version of the program panics,
# because it must not simulate.
hash=$(./mc --version | sed 's/.*(\([0-9a-f]*\).*/\1/')
# The compiler cuts the text into words of eight bytes.
LC_ALL=C sed "s/${hash:0:8}/00000000/g" mc >other
chmod +x other
code=0
args=(run "$scene" --paths 600000 --no-bias --threads 1 --quiet -o panic.h5)
timeout 60 mpirun -n 1 ./mc "${args[@]}" : -n 1 ./other "${args[@]}" 2>messages || code=$?
[ "$code" -ne 0 ] && [ "$code" -ne 124 ] || fail "a rank that panics: exit code $code"
grep -q 'cannot do what rank 0 asks' messages || fail "no message of the rank that panics: $(cat messages)"
[ ! -e panic.h5 ] || fail 'a file of a run that has failed'
echo "ended: a worker panics, exit code $code"

# Lost ranks and signals: all ranks end, and what was finished is continued.
paths=(--paths 600000 --no-bias)
./mc run "$scene" "${paths[@]}" --quiet -o whole.h5 2>/dev/null
lost() { # WHAT SIGNAL RANK: 0 to 2, or `launcher`
    rm -rf lost.h5*
    mpirun -n 3 ./mc run "$scene" "${paths[@]}" --threads 1 --quiet -o lost.h5 2>messages &
    local launcher=$! start=$SECONDS to code=0
    until [ -e lost.h5.partial/state ]; do
        [ $((SECONDS - start)) -lt 60 ] || fail "$1: nothing was saved"
        sleep 0.05
    done
    to=$launcher
    [ "$3" = launcher ] || to=$(pgrep -P "$launcher" | sed -n "$(($3 + 1))p")
    kill -"$2" "$to"
    start=$SECONDS
    wait "$launcher" || code=$?
    [ "$code" -ne 0 ] || fail "$1: exit code 0"
    [ $((SECONDS - start)) -lt 20 ] || fail "$1: all took $((SECONDS - start)) s to end"
    [ ! -e lost.h5 ] || fail "$1: a file of an unfinished run"
    [ -z "$(pgrep -P "$launcher")" ] || fail "$1: a rank is left"
    ./mc show lost.h5 2>/dev/null | grep -q 'interrupted' || fail "$1: nothing to show"
    echo "ended: $1, exit code $code"
}
lost 'a worker is killed' KILL 1
cp -r lost.h5.partial again.h5.partial
ranks 2 resume lost.h5 || fail "$(cat messages)"
same whole.h5 lost.h5 'a run of 3 ranks, of which one was killed, continued by 2'
./mc resume again.h5 --quiet 2>/dev/null
same whole.h5 again.h5 'the same, continued by threads'
lost 'rank 0 is killed' KILL 0
ranks 4 resume lost.h5 || fail "$(cat messages)"
same whole.h5 lost.h5 'a run of 3 ranks, of which the first was killed, continued by 4'
lost 'the launcher gets SIGTERM' TERM launcher
ranks 1 resume lost.h5 || fail "$(cat messages)"
same whole.h5 lost.h5 'a run of 3 ranks that was stopped, continued by 1'

echo "all of it: $SECONDS s"
