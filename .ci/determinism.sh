#!/usr/bin/env bash
# Runs short studies on every platform and schedule that the determinism contract names, and compares the results digests.
# Catches whatever makes bits depend on the optimiser, debug checks, threads, order of trials, directory, locale, time zone, the
# CPU's instruction set or the architecture. Among the trials: mapping and navigation, a particle filter, a planner that solves
# constrained Markov decision processes with what its calibration measured.
#
#   .ci/determinism.sh [PLATFORM...]      default: all of them but `chromium`, cheapest first
#
# `wasm32` needs node and `rustup target add wasm32-unknown-unknown`; `chromium` also a Chromium, and in BROWSER_PYTHON a Python with
# what .ci/requirements-browser.txt lists; `qemu64` needs qemu-x86_64 and `aarch64` needs qemu-aarch64 (Debian: qemu-user) and
# `rustup target add aarch64-unknown-linux-musl`; one whose tools are missing counts as failed, never as passed.
# Exit code 0 where all digests are equal, 1 where one differs or could not be had.
set -euo pipefail
cd "$(dirname "$0")/.."
root=$PWD
target=${CARGO_TARGET_DIR:-$root/target}
case $target in /*) ;; *) target=$root/$target ;; esac
default=(release jobs-1 jobs-2 shuffled elsewhere wasm32 dev opt0 qemu64 aarch64)
all=("${default[@]}" chromium)
[ $# -gt 0 ] || set -- "${default[@]}"

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

# The manifests, with so few passages of the calibration that emulated processors drive them in minutes.
mkdir "$work/studies"
cp -r manifests robots worlds "$work/studies/"
passages=$work/studies/manifests/deadline-calibration.yaml
sed -i 's/^trials: 2000/trials: 10/' "$passages"
grep -q '^trials: 10' "$passages" || { echo "expected \`trials: 2000\` in manifests/deadline-calibration.yaml" >&2 && exit 1; }

# Prints one digest of the results of all studies; the arguments are the command that runs the program, from the manifests' folder.
digest() {
  local run=("$@") out=(--out "$work/out" --format json)
  {
    "${run[@]}" quickstart.yaml deadline-calibration.yaml --trials 2 "${out[@]}" &&
      "${run[@]}" prior-tables-11-12.yaml --trials 1 --only environment=house --only prior=none "${out[@]}" &&
      "${run[@]}" deadline.yaml --trials 1 --only start=A --only deadline-s=272 --only strategy=frontier,complete-corridor "${out[@]}"
  } >"$work/said" || return 1
  sed -n 's/.*"results_digest":"sha256:\([^"]*\)".*/\1/p' "$work/said" >"$work/digests"
  # One each, or a study is missing.
  [ "$(wc -l <"$work/digests")" -eq 4 ] || return 1
  sha256sum <"$work/digests" | cut -d' ' -f1
}
studies() { cd "$work/studies/manifests"; }
keep() { # NAME FILE: binaries of several profiles land in one place, so each is copied away
  cp "$2" "$work/reenact-$1"
}
ensure_release() {
  [ -x "$work/reenact-release" ] || { cargo build --release --quiet && keep release "$target/release/reenact"; }
}

release() { ensure_release && studies && digest "$work/reenact-release" run --no-cache; }
jobs-1() { ensure_release && studies && digest "$work/reenact-release" run --no-cache --jobs 1; }
jobs-2() { ensure_release && studies && digest "$work/reenact-release" run --no-cache --jobs 2; }
# The second condition first, then one trial of the first, then the whole study from what the store has and has not.
shuffled() {
  ensure_release
  local run=(env "REENACT_STORE=$work/store" "$work/reenact-release" run)
  studies
  "${run[@]}" quickstart.yaml --trials 2 --only prior=floor-plan --out "$work/parts" >"$work/log" || return 1
  "${run[@]}" quickstart.yaml --trials 1 --only prior=none --out "$work/parts" >>"$work/log" || return 1
  digest "${run[@]}"
}
# Another directory and other ways to write numbers, letters and hours.
elsewhere() {
  ensure_release
  mkdir -p "$work/başka yer"
  cp -r "$work"/studies/* "$work/başka yer/"
  (cd "$work/başka yer/manifests" &&
    LC_ALL=tr_TR.UTF-8 LANG=tr_TR.UTF-8 TZ=Asia/Kathmandu digest "$work/reenact-release" run --no-cache)
}
# Another machine altogether, with 32-bit addresses and no threads: the module of `verify.html`, in Node and in a browser.
page() { [ -f "$work/page" ] || { .ci/page >"$work/page" || { rm "$work/page" && return 1; }; }; }
wasm32() {
  command -v node >/dev/null || { echo "no node on the PATH" >&2 && return 1; }
  page && studies && digest node "$root/page/node.mjs" run "$target/page/reenact_page.wasm"
}
chromium() {
  [ -n "${BROWSER_PYTHON:-}" ] || { echo "BROWSER_PYTHON does not say where playwright is" >&2 && return 1; }
  page && studies && digest "$BROWSER_PYTHON" "$root/.ci/browse_verify.py" run "$target/page/verify.html"
}
# Built as a side effect of a test, whose dependencies are those that `cargo test` has built already; `cargo build` would
# select other features and build them again.
build_dev() { cargo test --quiet --no-run --test integration; }
# Optimised a little, with debug assertions and overflow checks.
dev() {
  build_dev && keep dev "$target/debug/reenact" && studies && digest "$work/reenact-dev" run --no-cache
}
# Our code not optimised at all. The dependencies keep the dev profile's optimisation, so they are not built again.
opt0() {
  CARGO_PROFILE_DEV_OPT_LEVEL=0 build_dev && keep opt0 "$target/debug/reenact" &&
    studies && digest "$work/reenact-opt0" run --no-cache
}
# An x86-64 CPU of 2003: no FMA, AVX or SSE4.
qemu64() { ensure_release && studies && digest qemu-x86_64 -cpu qemu64 "$work/reenact-release" run --no-cache; }
# Another architecture and another C library, linked without a cross compiler.
aarch64() {
  CARGO_TARGET_AARCH64_UNKNOWN_LINUX_MUSL_LINKER=rust-lld cargo build --release --quiet --target aarch64-unknown-linux-musl &&
    studies && digest qemu-aarch64 "$target/aarch64-unknown-linux-musl/release/reenact" run --no-cache
}

expected=
failed=0
for platform in "$@"; do
  case " ${all[*]} " in *" $platform "*) ;; *) echo "no platform \`$platform\`: one of ${all[*]}" >&2 && exit 2 ;; esac
  began=$SECONDS
  found=$("$platform" 2>"$work/errors") || found=
  : "${expected:=$found}"
  word=same
  if [ -z "$found" ]; then
    word=FAILED failed=1
    sed 's/^/    /' "$work/errors" >&2
  elif [ "$found" != "$expected" ]; then
    word=DIFFERENT failed=1
  fi
  printf '%-10s %-72s %5d s  %s\n' "$platform" "${found:-none}" $((SECONDS - began)) "$word"
done
exit $failed
