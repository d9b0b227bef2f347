#!/usr/bin/env bash
# Installs a build to a temporary prefix and uses what lies there as a stranger would: both examples, built by
# pkg-config and by CMake, must say what `vkopple infer` says.   installed_test.sh BUILD
set -euo pipefail
build=$(realpath "$1")
source_root=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
prefix=$work/prefix
fail() { echo "installed_test: $*" >&2; exit 1; }

cmake --install "$build" --prefix "$prefix" >/dev/null
export PATH=$prefix/bin:$PATH
library_folder=$(dirname "$(find "$prefix" -name 'libvkopple.so')")
export PKG_CONFIG_PATH=$library_folder/pkgconfig

# Nothing but the interface, and all of it.
declared=$(grep -o '\bvkopple_[a-z_]*(' "$prefix/include/vkopple.h" | tr -d '(' | sort -u)
exported=$(nm -D --defined-only --without-symbol-versions "$library_folder/libvkopple.so" | awk '$2 != "A" { print $3 }' | sort -u)
[[ $declared == "$exported" ]] || fail "the library exports other symbols than its header declares:"$'\n'"$exported"

read -ra flags <<<"$(pkg-config --cflags --libs vkopple)"
"${CC:-cc}" -std=c99 -Wall -Wextra -pedantic -Werror "$source_root/examples/c/see.c" "${flags[@]}" \
  -Wl,-rpath,"$library_folder" -o "$work/see"
cmake -S "$source_root/examples/c" -B "$work/example" -DCMAKE_PREFIX_PATH="$prefix" >/dev/null
cmake --build "$work/example" >/dev/null

cat >"$work/config.json" <<'CONFIG'
{"model": {"height": 16, "width": 16, "slots": 2, "bins": 12, "code": 12, "depth_width": 2, "object_width": 4,
           "imagine_width": 1, "lstm": 4},
 "training": {"batch": 1}, "rooms": {"supersample": 1}}
CONFIG
vkopple train "$work/config.json" --data rooms:1 --steps 1 --eval-every 0 --out "$work/run" 2>/dev/null
{ printf 'P6\n23 31\n255\n'; yes 'some colours: 0123456789' | head -c $((3 * 23 * 31)); } >"$work/room.ppm" || true

vkopple infer "$work/run" "$work/room.ppm" --json --out "$work/seen" >"$work/infer.json"
"$work/see" "$work/run" "$work/room.ppm" >"$work/see.txt"
"$work/example/see" "$work/run" "$work/room.ppm" | cmp - "$work/see.txt"
[[ $(wc -l <"$work/see.txt") == 3 ]] || fail "the C example did not tell of two objects: $(cat "$work/see.txt")"
if "$work/see" /absent "$work/room.ppm" 2>"$work/refusal"; then fail "the C example read a model that is not there"; fi
grep -q /absent "$work/refusal"

# What the C example prints, as the program has it.
python=${VKOPPLE_PYTHON:-python3}
if ! command -v "$python" >/dev/null; then
  echo "installed_test: passed; not compared number by number, and without the Python example: there is no $python"
  exit 0
fi
"$python" - "$work/infer.json" "$work/see.txt" <<'COMPARE'
import json, sys
objects = json.load(open(sys.argv[1]))[0]["objects"]
lines = [line.split() for line in open(sys.argv[2])][1:]
told = [[float(v) for v in line[2:]] for line in lines]
wanted = [[o["share"], *o["location"], o["yaw"], o["yaw_probability"]] for o in objects]
assert told == wanted and len(told) == 2, (told, wanted)
COMPARE
if ! "$python" -c 'import numpy' 2>/dev/null; then
  echo "installed_test: passed without the Python example: $python has no numpy (VKOPPLE_PYTHON names another)"
  exit 0
fi
export VKOPPLE_LIBRARY=$library_folder/libvkopple.so.0
"$python" "$source_root/examples/python/see.py" "$work/run" "$work/room.ppm" --save "$work/arrays" >"$work/python.json"
"$python" - "$work" <<'COMPARE'
import json, sys
import numpy
work = sys.argv[1]
wanted, told = (json.load(open(f"{work}/{name}.json")) for name in ("infer", "python"))
assert told == wanted, (told, wanted)
arrays = numpy.load(f"{work}/arrays/room.npz")
shares = [float((arrays["mask"] == k).mean()) for k in range(3)]
assert shares == [o["share"] for o in wanted[0]["objects"]] + [wanted[0]["background"]["share"]], shares
depths = [float(v) for v in open(f"{work}/see.txt").readline().split()[1:]]
assert numpy.float32(depths).tolist() == [arrays["depth"].min(), arrays["depth"].max()], depths
COMPARE
echo "installed_test: passed"
