#!/usr/bin/env bash
# Completions and manual pages: what the shells that are here make of them.   shells_test.sh VKOPPLE
set -euo pipefail
vkopple=$1
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
fail() { echo "shells_test: $*" >&2; exit 1; }
skipped=()

"$vkopple" completion bash >"$work/vkopple.bash"
# shellcheck source=/dev/null
source "$work/vkopple.bash"
complete_words() { # words... → what bash offers for the last
  COMP_WORDS=("$@")
  COMP_CWORD=$(($# - 1))
  _vkopple
  echo "${COMPREPLY[*]}"
}
expect() { # what is offered, words...
  local got
  got=$(complete_words "${@:2}")
  [[ $got == "$1" ]] || fail "'${*:2}' offers '$got', not '$1'"
}
expect "train" vkopple tra
expect "--precision" vkopple train --prec
expect "float32 mixed" vkopple train --precision ""
expect "mixed" vkopple train --precision = m
expect "float32 mixed" vkopple infer --precision =
expect "" vkopple train --out ""
expect "step" vkopple bench s
expect "bash" vkopple completion b
expect "--version" vkopple --v
expect "" vkopple nonsense ""
# Everything that --help of every command knows.
for command in $(complete_words vkopple ""); do
  [[ $command == -* ]] && continue
  options=" $(complete_words vkopple "$command" -) "
  for option in $("$vkopple" "$command" --help | grep -oE '^ +(-[a-z],)?--[a-z-]+' | tr -d ' ' | sed 's/.*,//'); do
    [[ $options == *" $option "* ]] || fail "vkopple $command: $option is not completed"
  done
  "$vkopple" manual "$command" >"$work/$command.1"
  # Every example is a command line of the program.
  other=$(awk '/^\.SH/ { within = /EXAMPLES/ } within && first && !/vkopple/ { print } { first = /^\.nf/ }' "$work/$command.1")
  [[ -z $other ]] || fail "the manual of $command has examples without vkopple: $other"
done
grep -q '^\.SH NOTES' "$work/convert.1" || fail "the manual of convert lists no formats"
"$vkopple" manual >"$work/vkopple.1"

if command -v zsh >/dev/null; then
  "$vkopple" completion zsh >"$work/_vkopple"
  zsh -n "$work/_vkopple" || fail "zsh does not understand its completion"
  grep -q -- "'--precision\[.*(float32 mixed)'" "$work/_vkopple" || fail "zsh is not told of choices"
else
  skipped+=(zsh)
fi
if command -v fish >/dev/null; then
  "$vkopple" completion fish >"$work/vkopple.fish"
  offers() { HOME=$work fish --no-config -c "complete -c vkopple -e; source '$work/vkopple.fish'; complete -C '$1'" | cut -f1 | xargs; }
  [[ $(offers 'vkopple tra') == train ]] || fail "fish does not complete commands: $(offers 'vkopple tra')"
  [[ $(offers 'vkopple train --precision m') == mixed ]] || fail "fish does not complete choices: $(offers 'vkopple train --precision m')"
  [[ $(offers 'vkopple train --resu') == --resume ]] || fail "fish does not complete options: $(offers 'vkopple train --resu')"
else
  skipped+=(fish)
fi
if command -v mandoc >/dev/null; then
  for page in "$work"/*.1; do
    faults=$(mandoc -T lint -W warning "$page" | grep -v 'missing date' || true)
    [[ -z $faults ]] || fail "$faults"
  done
  mandoc -T ascii "$work/train.1" | col -b >"$work/train.txt"
  grep -q -- '--checkpoint-every UINT' "$work/train.txt" || fail "the manual of train: $(cat "$work/train.txt")"
  grep -q 'mpirun -n 4 vkopple train full' "$work/train.txt" || fail "examples are missing in the manual of train"
  mandoc -T ascii "$work/predict.1" | col -b >"$work/predict.txt"
  grep -qe '--frames 0,2,4 \\$' "$work/predict.txt" || fail "a long example of predict is not one command line"
else
  skipped+=(mandoc)
fi
echo "shells_test: passed${skipped[*]:+; not installed, and not tried: ${skipped[*]}}"
