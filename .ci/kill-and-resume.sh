#!/usr/bin/env bash
# Kills a run at a hundred random moments and resumes it: no finished trial may be lost, no stored byte may change, and
# every study that is run to its end must have the results of an undisturbed run.
#
#   .ci/kill-and-resume.sh REENACT [KILLS] [SEED]      default: 100 kills, a seed of its own, which is printed
#
# A study of twenty short trials is begun on an empty store and killed and begun again until it comes to its end; then the
# next one begins. Exit code 0 where all went well.
set -euo pipefail
cd "$(dirname "$0")/.."
[ $# -ge 1 ] || { echo "usage: $0 REENACT [KILLS] [SEED]" >&2; exit 2; }
reenact=$1 kills=${2:-100} seed=${3:-$(od -An -N2 -tu2 /dev/urandom | tr -d ' ')}
RANDOM=$seed
study=(run manifests/quickstart.yaml --trials 10 --set parameters.mission.time-limit-s=8 --jobs 2 --format json)

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
fail() { echo "kill $killed, seed $seed: $*" >&2 && exit 1; }
results_of() { sed -n 's/.*"results_digest":"\([^"]*\)".*/\1/p' "$1"; }
cached_of() { sed -n 's/.*"cached":\([0-9]*\).*/\1/p' "$1"; }
# Every whole line of every file of records. What a killed process had not finished has no end.
records() {
  local file
  for file in "$1"/segments/*.jsonl; do
    [ ! -f "$file" ] || head -n "$(wc -l <"$file")" "$file"
  done | { grep -E '^\{"key":"[0-9a-f]{64}","sha256":.*\}\}$' || true; } | LC_ALL=C sort -u
}

killed=0 kept=0 midway=0
"$reenact" "${study[@]}" --no-cache --out "$work/undisturbed" >"$work/undisturbed.json"
expected=$(results_of "$work/undisturbed.json")
echo "undisturbed: $expected (seed $seed)"

finished=0
while [ "$killed" -lt "$kills" ] || [ "$kept" -gt 0 ]; do
  store=$work/store-$finished out=$work/out-$finished kept=0
  mkdir "$store"
  : >"$work/before"
  while true; do
    REENACT_STORE=$store "$reenact" "${study[@]}" --out "$out" >"$work/run.json" 2>"$work/run.txt" &
    pid=$!
    if [ "$killed" -lt "$kills" ]; then
      sleep "0.$(printf %03d $((RANDOM % 400)))"
      kill -9 "$pid" 2>/dev/null || true
    fi
    code=0
    # The shell's own note about the killed process goes with it.
    wait "$pid" 2>/dev/null || code=$?
    records "$store" >"$work/after"
    # Whatever was whole before stands unchanged, and nothing of it is gone.
    [ -z "$(LC_ALL=C comm -23 "$work/before" "$work/after")" ] || fail "a finished trial was lost or changed"
    mv "$work/after" "$work/before"
    stored=$(wc -l <"$work/before")
    if [ "$code" -eq 0 ]; then
      [ "$(cached_of "$work/run.json")" -eq "$kept" ] || fail "$kept trials were stored, $(cached_of "$work/run.json") resumed"
      [ "$(results_of "$work/run.json")" = "$expected" ] || fail "resumed to other results: $(cat "$work/run.json")"
      [ "$(find "$out" -type f | wc -l)" -eq 1 ] || fail "expected one bundle: $(find "$out" -type f)"
      "$reenact" verify --level 3 "$out"/*.zip >"$work/verified.txt" || fail "$(cat "$work/verified.txt")"
      break
    fi
    [ "$code" -eq 137 ] || fail "the run ended with $code: $(cat "$work/run.txt")"
    killed=$((killed + 1))
    # Killed while it was sealing, it may leave a part under another name, never a bundle.
    [ -z "$(find "$out" -name '*.zip' 2>/dev/null)" ] || { "$reenact" verify --level 3 "$out"/*.zip >/dev/null || fail "half a bundle"; }
    find "$out" -name '.partial-*' -delete 2>/dev/null || true
    # A kill proves something where it came between the first trial and the last.
    [ "$stored" -eq 0 ] || [ "$stored" -eq 20 ] || midway=$((midway + 1))
    kept=$stored
  done
  finished=$((finished + 1)) kept=0
done
[ "$midway" -ge $((kills / 5)) ] || fail "only $midway of the kills came between the first trial and the last"
echo "$killed kills ($midway of them between the first trial and the last), $finished studies run to their end, every one with the undisturbed results"
