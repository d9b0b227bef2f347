# shellcheck shell=bash disable=SC2154,SC2034
# Sourced by tools/test-drivers, after fetch.sh: what is run on one driver.

test_shards=6
cores=$(nproc)

# Runs a command on a driver, with caches of its own, so that nobody's tuned choices count.
on_driver() { # name, command...
  local folder=$drivers/$1 path variables
  variables=(XDG_CACHE_HOME="$folder/cache" MESA_SHADER_CACHE_DIR="$folder/cache" VKOPPLE_DEVICE="$(device_of "$1")")
  if [[ $1 != gpu ]]; then
    # Older loaders know the second name alone.
    variables+=(VK_DRIVER_FILES="$folder/icd.json" VK_ICD_FILENAMES="$folder/icd.json")
    path=$(library_path "$1")
    [[ -z $path ]] || variables+=(LD_LIBRARY_PATH="$path")
  fi
  env "${variables[@]}" "${@:2}"
}

# Index of the device that a driver is tried on: an unpacked driver has one. Nothing where there is no GPU.
device_of() { # name
  [[ $1 == gpu ]] || { echo 0; return 0; }
  "$vkopple" devices --json 2>/dev/null |
    awk -F '[:, ]+' '/"index":/ { index_ = $3 } /"type": "(discrete|integrated|virtual)"/ && !found { print index_; found = 1 }'
}

# Whether a driver is there and has a device; otherwise the last line on standard error says why not.
have_driver() { # name
  if [[ $1 == gpu ]]; then
    mkdir -p "$drivers/gpu"
    [[ -n $(device_of gpu) ]] || { echo "no GPU is at hand" >&2; return 1; }
    return 0
  fi
  fetch_driver "$1" || return 1
  on_driver "$1" "$vkopple" devices >/dev/null
}

# A field of the device.
device_field() { # name, field
  on_driver "$1" "$vkopple" devices --json | sed -nE "s/^ *\"$2\": \"?([^\"]*)\"?,?\$/\1/p" | sed -n "$(($(device_of "$1") + 1))p"
}

# gtest's filter of suites that use a device: those of ops, kernels, models and training. What the host does alone, the commands'
# options and injected faults don't depend on the driver.
device_suites() {
  local files
  mapfile -t files < <(grep -rlE '_device\(|tiny_model|tiny_run' tests/graph tests/models tests/runtime tests/shaders tests/train \
    --include='*_test.cpp' --exclude=faults_test.cpp)
  sed -nE 's/^TEST(_F|_P)?\(([A-Za-z0-9_]+),.*/\2.*:*\/\2.*/p' "${files[@]}" | sort -u | paste -sd:
  echo ":Determinism.*"
}

count_in() { # log, PASSED|SKIPPED|FAILED: gtest's own counts of all processes
  sed -nE "s/^\[  $2  ?\] ([0-9]+) tests?.*/\1/p" "$1" | awk '{ sum += $1 } END { print sum + 0 }'
}

# Starts a command on a driver as soon as fewer run than there are cores, its output going to $logs/JOB.log and its exit code to
# $logs/JOB.code. Drivers compile on one thread each, which is most of the work.
start() { # name, job, command...
  while (($(jobs -rp | wc -l) >= cores)); do wait -n || true; done
  { on_driver "$1" "${@:3}" >"$logs/$2.log" 2>&1 && echo 0 >"$logs/$2.code" || echo "$?" >"$logs/$2.code"; } &
}

succeeded() { # job
  [[ $(cat "$logs/$1.code") == 0 ]]
}

# All that is run on one driver. Training once more comes last, when Mesa has kept the kernels, and with one thread of lavapipe in
# place of as many as there are cores.
run_jobs() { # name
  local shard fixture family access filter train
  train=("$vkopple" train tiny --set 'training.stages=[]' --data rooms:1 --seed 1 --batch "$batch" --steps "$steps"
    --eval-every "$steps" --checkpoint-every 0 --quiet --out)
  rm -rf "$drivers/$1"/{run,run-again}
  # All networks from the first step on, and an evaluation at the end.
  start "$1" train "${train[@]}" "$drivers/$1/run"
  local -x LP_NUM_THREADS=1
  if [[ -z $quick ]]; then
    filter=$(device_suites | tr -d '\n')
    # In several processes, since drivers keep what they compiled.
    for ((shard = 0; shard < test_shards; ++shard)); do
      start "$1" "tests-$shard" env GTEST_TOTAL_SHARDS=$test_shards GTEST_SHARD_INDEX=$shard "$root/build/$preset/vkopple_tests" --gtest_filter="$filter"
    done
    start "$1" gradcheck "$vkopple" gradcheck --all
  fi
  for fixture in "${fixtures[@]}"; do
    start "$1" "verify-$fixture" "$vkopple" verify "tests/fixtures/$fixture.safetensors"
  done
  # Every family on every access path, also those that the device would not choose.
  for family in "${families[@]}"; do
    for access in texel storage; do
      for fixture in "${family_fixtures[@]}"; do
        start "$1" "verify-$fixture-$family-$access" "$vkopple" verify "tests/fixtures/$fixture.safetensors" --kernels "$family" --access "$access"
      done
    done
  done
  start "$1" train-again "${train[@]}" "$drivers/$1/run-again"
  wait
}

judge_tests() { # sets `tests`
  local log=$logs/tests.log shard part died=""
  for ((shard = 0; shard < test_shards; ++shard)); do
    part=$logs/tests-$shard.log
    succeeded "tests-$shard" || [[ $broken == *" tests"* ]] || broken+=" tests"
    # A test that brings the program down leaves no counts.
    grep -q '^\[  PASSED  \]' "$part" || died+=" $(sed -nE 's/^\[ RUN      \] //p' "$part" | tail -n 1)"
  done
  cat "$logs"/tests-?.log >"$log"
  tests="$(count_in "$log" PASSED), $(count_in "$log" SKIPPED), $(count_in "$log" FAILED)"
  [[ -z $died ]] || tests+="; died in$died"
  echo "tests: $tests"
  sed -nE '/^\[  FAILED  \] [^0-9]/p' "$log" | sort -u
  echo "reasons of what was skipped or left out, if anything was:"
  { skip_reasons "$log"; grep -E '(has not what it takes): ' "$log" || true; } |
    sed -E 's/(has not what it takes): .*/\1/' | sort | uniq -c | sort -rn
  [[ $(skip_reasons "$log" | wc -l) == "$(count_in "$log" SKIPPED)" ]] || broken+=" skipped-without-a-reason"
}

# The first of each test that was skipped: one in two steps may say it twice.
skip_reasons() { # log
  awk '/^\[ RUN / { told = 0 } /: Skipped$/ { getline; if ($0 != "" && !told++) print }' "$1"
}

judge_fixtures() { # sets `verified`
  local fixture right=0
  for fixture in "${fixtures[@]}"; do
    if succeeded "verify-$fixture"; then
      right=$((right + 1))
    else
      broken+=" $fixture"
    fi
  done
  verified="$right of ${#fixtures[@]}"
  echo "fixtures: $verified"
}

judge_families() { # sets `forced`
  local family access fixture job right=0 refused=()
  for family in "${families[@]}"; do
    for access in texel storage; do
      for fixture in "${family_fixtures[@]}"; do
        job=verify-$fixture-$family-$access
        if succeeded "$job"; then
          right=$((right + 1))
        elif grep -qE "can't (run|be had) on" "$logs/$job.log"; then
          echo "$family, $access: $(tail -n 1 "$logs/$job.log")"
          refused+=("$family/$access")
          break
        else
          broken+=" $fixture:$family/$access"
        fi
      done
    done
  done
  forced="$right runs right"
  ((${#refused[@]} == 0)) || forced+="; refused: ${refused[*]}"
  echo "families: $forced"
}

judge_gradcheck() { # sets `gradients`
  gradients=right
  succeeded gradcheck || { gradients=WRONG; broken+=" gradcheck"; }
  echo "gradcheck: $gradients"
}

losses() { # run's folder: the total loss of every step
  sed -nE 's/.*"losses":\{[^}]*"total":([-+0-9.e]+).*/\1/p' "$1/log.jsonl"
}

# How far a run's total losses are from another's, as parts of these: in the first step, of the mean over all, and at most in any.
differences() { # two runs' folders
  paste -d' ' <(losses "$1") <(losses "$2") | awk '
    function size(x) { return x < 0 ? -x : x }
    { d = size(($1 - $2) / $2); a += $1; b += $2; if (NR == 1) first = d; if (!(d <= most)) most = d }
    END { printf "%.1e %.1e %.1e\n", first, size((a - b) / b), most }'
}

# Two runs of the same; sets `loss` and `bytes`, and `yardstick` by the first driver.
judge_training() { # name
  local run=$drivers/$1/run again=$drivers/$1/run-again first mean most
  loss=none
  bytes=none
  if ! succeeded train || [[ $(losses "$run" | wc -l) != "$steps" ]]; then
    broken+=" training"
    return 0
  fi
  loss=$(losses "$run" | tail -n 1)
  if [[ -z $yardstick ]]; then
    yardstick=$1
    loss+=", which others are compared with"
  else
    read -r first mean most < <(differences "$run" "$drivers/$yardstick/run")
    loss+=", from $yardstick $first, $mean, $most"
    awk "BEGIN { exit !($first <= $first_bound && $mean <= $mean_bound) }" || broken+=" loss"
  fi
  if succeeded train-again && cmp -s "$run/latest.safetensors" "$again/latest.safetensors" &&
    [[ $(times_aside "$run") == "$(times_aside "$again")" ]]; then
    bytes=yes
  else
    bytes=NO
    broken+=" bytes"
  fi
  echo "training: $loss; the same bytes twice: $bytes"
}

times_aside() { # run's folder: its log, evaluation included
  sed -E 's/"(data_)?seconds":[-+0-9.e]+,?//g' "$1/log.jsonl"
}

# Everything on one driver. Sets `row`, a line of the table, and `broken`, what failed.
test_driver() { # name
  local start=$SECONDS logs=$drivers/$1/logs tests="left out" gradients="left out" verified forced loss bytes version time
  broken=""
  rm -rf "$logs"
  mkdir -p "$logs"
  version=$(cat "$drivers/$1/version" 2>/dev/null || true)
  run_jobs "$1"
  judge_training "$1"
  judge_fixtures
  judge_families
  if [[ -z $quick ]]; then
    judge_gradcheck
    judge_tests
  fi
  time=$(printf '%d:%02d' $(((SECONDS - start) / 60)) $(((SECONDS - start) % 60)))
  row="| $1 | $(device_field "$1" driver)${version:+, package $version} | $(device_field "$1" name) | $tests | $verified | $forced | $gradients | $loss | $bytes | $time |"
  [[ -z $broken ]] || echo "FAILED:$broken"
}
