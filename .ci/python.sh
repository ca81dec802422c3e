#!/usr/bin/env bash
# Builds the wheel and tries it as its users have it: in clean environments, on the oldest Python it supports and the newest here.
#
#   .ci/python.sh [--build-only]
#
# Needs Rust and PyPI; Python 3.9 and a newer one as `python3.N` or under ~/.pyenv/versions. The wheel is left in `target/wheels`.
# Exit code 77 where there is no Python to try it on.
set -euo pipefail
cd "$(dirname "$0")/.."
root=$PWD work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

# Every Python that there is, as `MINOR PATH`.
pythons() {
  local one
  for one in $(compgen -c python3. | grep -xE 'python3\.[0-9]+' | sort -u) "$HOME"/.pyenv/versions/3.*/bin/python; do
    "$one" -c 'import sys, venv; print(sys.version_info.minor, sys.executable)' 2>/dev/null || true
  done | sort -n -u
}
oldest=$(pythons | awk '$1 == 9 { print $2; exit }')
newest=$(pythons | awk '$1 > 9 { last = $2 } END { print last }')
[ -n "$newest" ] || { echo "SKIP  the Python package: no Python newer than 3.9" >&2; exit 77; }
environment() { # PYTHON NAME REQUIREMENTS...
  "$1" -m venv "$work/$2"
  "$work/$2/bin/pip" install --quiet --disable-pip-version-check "${@:3}"
}

# A binary for every Linux of the last ten years: linked for its glibc by a linker that knows it. Nothing here is compiled from C.
environment "$newest" build -r .ci/requirements-wheel.txt maturin==1.16.0
rm -rf target/wheels
(
  # shellcheck source=.ci/remap.sh
  source .ci/remap.sh
  export CARGO_TARGET_DIR=$root/target/release-build CARGO_INCREMENTAL=0 SOURCE_DATE_EPOCH=${SOURCE_DATE_EPOCH:-315532800}
  # The builder's own bill of materials names the folder it was built in.
  .ci/sbom python/Cargo.toml "$(rustc -vV | sed -n 's/^host: //p')" "$work/reenact-python.cdx.json"
  PATH=$work/build/bin:$PATH maturin build --locked --release --zig --compatibility manylinux2014 --manifest-path python/Cargo.toml \
    --sbom-include "$work/reenact-python.cdx.json" --out target/wheels
)
wheel=("$root"/target/wheels/*.whl)
"$work/build/bin/twine" check --strict "${wheel[0]}"
"$work/build/bin/auditwheel" show "${wheel[0]}"
[ "${1:-}" != --build-only ] || exit 0

# Nothing but the wheel: the command and the package work, and say what a frame would need.
environment "$newest" bare "${wheel[0]}"
"$work/bare/bin/reenact" verify --level 1 artifacts/quickstart-published.zip
"$work/bare/bin/python" - <<'EOT'
import reenact
assert reenact.verify("artifacts/quickstart-published.zip", 1)
try:
    reenact.Bundle("artifacts/quickstart-published.zip", level=1).trials()
except reenact.NotUnderstood as why:
    assert str(why) == "a data frame needs pandas or polars, and neither is installed: pip install pandas", why
else:
    raise SystemExit("expected to be told what to install")
EOT

[ -n "$oldest" ] || echo "SKIP  the oldest Python: no python3.9 on PATH or under ~/.pyenv/versions" >&2
for python in $oldest $newest; do
  name=$(basename "$(dirname "$(dirname "$python")")")
  environment "$python" "$name" -r .ci/requirements-python.txt "${wheel[0]}"
  # From another folder: what is tested is what is installed.
  (cd "$work" && "$work/$name/bin/python" -m pytest -q -rs -p no:cacheprovider "$root/python/tests")
  (cd python && MYPYPATH=tests "$work/$name/bin/mypy" --cache-dir "$work/mypy")
done
