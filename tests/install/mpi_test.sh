#!/usr/bin/env bash
# Trains by two processes of mpirun and by one, and compares; then kills one of two.   mpi_test.sh VKOPPLE MPIRUN
set -euo pipefail
vkopple=$1 mpirun=$2
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
fail() { echo "mpi_test: $*" >&2; exit 1; }
# Processes of this test share what cores there are. The variables are those of Open MPI, 4 and from 5 on; MPICH needs
# none, and knows no such flags.
export LP_NUM_THREADS=1 OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1
export OMPI_MCA_rmaps_base_oversubscribe=1 PRTE_MCA_rmaps_default_mapping_policy=:oversubscribe
two=("$mpirun" -n 2 "$vkopple")

cat >"$work/config.json" <<'CONFIG'
{"model": {"height": 16, "width": 16, "slots": 2, "bins": 12, "code": 12, "depth_width": 2, "object_width": 4,
           "imagine_width": 1, "lstm": 4, "dropout": [0, 0, 0]},
 "training": {"batch": 4, "sync_batch_norm": true}, "rooms": {"supersample": 1}}
CONFIG
train=(train "$work/config.json" --data rooms:1 --eval-every 0)
"$vkopple" "${train[@]}" --steps 1 --out "$work/one" 2>/dev/null
"${two[@]}" "${train[@]}" --steps 1 --out "$work/two" 2>"$work/errors" || fail "$(cat "$work/errors")"
grep -q '"processes":2' "$work/two/log.jsonl" || fail "the log tells of no processes: $(cat "$work/two/log.jsonl")"
[[ $(wc -l <"$work/two/log.jsonl") == 1 ]] || fail "more than one process wrote the log"
[[ $(grep -c 'done after step' "$work/errors") == 1 ]] || fail "more than one process tells of progress: $(cat "$work/errors")"
loss() { sed -E 's/.*"total":([^,}]*).*/\1/' "$1/log.jsonl"; }
awk -v a="$(loss "$work/one")" -v b="$(loss "$work/two")" 'BEGIN { d = a - b; exit !(d * d <= 1e-8 * a * a) }' ||
  fail "losses differ: $(loss "$work/one") of one process, $(loss "$work/two") of two"

# Wrong use is told once, and ends both.
code=0
"${two[@]}" "${train[@]}" --batch 3 --steps 1 --out "$work/odd" 2>"$work/errors" >/dev/null || code=$?
[[ $code == 1 && $(grep -c 'a batch of 3 has no 2 equal parts' "$work/errors") == 1 ]] || fail "code $code: $(cat "$work/errors")"

# A process that is killed ends the run, which says how to go on.
"${two[@]}" "${train[@]}" --steps 1000000 --out "$work/killed" >"$work/errors" 2>&1 &
launcher=$!
for ((i = 0; i < 600; ++i)); do
  [[ -f $work/killed/log.jsonl && $(wc -l <"$work/killed/log.jsonl") -ge 2 ]] && break
  sleep 0.1
done
# Some launchers start processes by a helper, so that they are not their children.
victim=$(pgrep -f "$work/killed" | grep -vx "$launcher" | tail -1)
[[ -n $victim ]] || fail "there is no second process"
kill -KILL "$victim"
code=0
wait "$launcher" || code=$?
((code != 0)) || fail "a killed process passed for a success"
grep -qE 'signal 9|KILLED BY SIGNAL: 9' "$work/errors" || fail "the launcher does not tell of the killed process: $(cat "$work/errors")"
if grep -q 'BAD TERMINATION' "$work/errors"; then
  echo "mpi_test: passed; no advice asked of who remains, whom MPICH's launcher ends at once"
  exit 0
fi
grep -q 'go on from the last checkpoint with --resume' "$work/errors" || fail "no advice: $(cat "$work/errors")"
echo "mpi_test: passed"
