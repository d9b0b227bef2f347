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

# What an object's orientation is decides on what is told of it.
config() { # orientation
  cat <<CONFIG
{"model": {"height": 16, "width": 16, "slots": 2, "bins": 12, "code": 12, "depth_width": 2, "object_width": 4,
           "imagine_width": 1, "lstm": 4, "orientation": "$1"},
 "training": {"batch": 1}, "rooms": {"supersample": 1}}
CONFIG
}
{ printf 'P6\n23 31\n255\n'; yes 'some colours: 0123456789' | head -c $((3 * 23 * 31)); } >"$work/room.ppm" || true
for kind in yaw euler; do
  config $kind >"$work/$kind.json"
  vkopple train "$work/$kind.json" --data rooms:1 --steps 1 --eval-every 0 --out "$work/$kind" 2>/dev/null
  vkopple infer "$work/$kind" "$work/room.ppm" --json --out "$work/seen" >"$work/$kind.infer.json"
  "$work/see" "$work/$kind" "$work/room.ppm" >"$work/$kind.see.txt"
  [[ $(wc -l <"$work/$kind.see.txt") == 3 ]] || fail "the C example did not tell of two objects: $(cat "$work/$kind.see.txt")"
done
"$work/example/see" "$work/yaw" "$work/room.ppm" | cmp - "$work/yaw.see.txt"
if "$work/see" /absent "$work/room.ppm" 2>"$work/refusal"; then fail "the C example read a model that is not there"; fi
grep -q /absent "$work/refusal"

# What the C example prints, as the program has it.
python=${VKOPPLE_PYTHON:-python3}
if ! command -v "$python" >/dev/null; then
  echo "installed_test: passed; not compared number by number, and without the Python example: there is no $python"
  exit 0
fi
"$python" - "$work" <<'COMPARE'
import json, sys
for kind in "yaw", "euler":
    path = f"{sys.argv[1]}/{kind}"
    objects = json.load(open(f"{path}.infer.json"))[0]["objects"]
    lines = [line.split() for line in open(f"{path}.see.txt")][1:]
    told = [[float(v) for v in line[2:]] for line in lines]
    turned = [o["rotation"] if kind == "euler" else [o["yaw"], o["yaw_probability"]] for o in objects]
    wanted = [[o["share"], *o["location"], *t] for o, t in zip(objects, turned)]
    assert told == wanted and len(told) == 2, (kind, told, wanted)
COMPARE
if ! "$python" -c 'import numpy' 2>/dev/null; then
  echo "installed_test: passed without the Python example: $python has no numpy (VKOPPLE_PYTHON names another)"
  exit 0
fi
export VKOPPLE_LIBRARY=$library_folder/libvkopple.so.0
for kind in yaw euler; do
  "$python" "$source_root/examples/python/see.py" "$work/$kind" "$work/room.ppm" --save "$work/$kind.arrays" >"$work/$kind.python.json"
done
"$python" - "$work" <<'COMPARE'
import json, sys
import numpy
work = sys.argv[1]
for kind in "yaw", "euler":
    path = f"{work}/{kind}"
    wanted, told = (json.load(open(f"{path}.{name}.json")) for name in ("infer", "python"))
    assert told == wanted, (kind, told, wanted)
    arrays = numpy.load(f"{path}.arrays/room.npz")
    shares = [float((arrays["mask"] == k).mean()) for k in range(3)]
    assert shares == [o["share"] for o in wanted[0]["objects"]] + [wanted[0]["background"]["share"]], (kind, shares)
    depths = [float(v) for v in open(f"{path}.see.txt").readline().split()[1:]]
    assert numpy.float32(depths).tolist() == [arrays["depth"].min(), arrays["depth"].max()], (kind, depths)
COMPARE
echo "installed_test: passed"
