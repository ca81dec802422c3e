#!/usr/bin/env bash
# Reads what a bundle gives to others with programs that are not ours: frictionless checks every field of every CSV against
# the data dictionary, cffconvert the citation, and the examples of the bundle's README are run as they stand there, by
# pandas and by R.
#
#   .ci/data-out.sh BUNDLE.zip|DIRECTORY...
#
# Needs python3 (3.10 or newer, with venv), the first time PyPI, and R (Debian: r-base-core), without which the examples in R are
# left out. What it installs stays under target/data-out. Exit code 0 where everything passes, 1 where something does not,
# 2 where the programs could not be had.
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
[ $# -ge 1 ] || { echo "usage: $0 BUNDLE.zip|DIRECTORY..." >&2; exit 2; }

tools=${DATA_OUT:-$(dirname "$here")/target/data-out}
setup() {
  python3 -m venv --clear "$tools/data" && python3 -m venv --clear "$tools/citation"
  "$tools/data/bin/pip" install --quiet --disable-pip-version-check -r "$here/requirements-data.txt"
  "$tools/citation/bin/pip" install --quiet --disable-pip-version-check --no-deps -r "$here/requirements-citation.txt"
  cat "$here"/requirements-{data,citation}.txt >"$tools/installed.txt"
}
mkdir -p "$tools"
# Installed again whenever the pins change.
cat "$here"/requirements-{data,citation}.txt | cmp -s - "$tools/installed.txt" || (setup) ||
  { echo "could not install the readers" >&2; exit 2; }

source "$here/steps.sh"
# The lines of a block in LANGUAGE, by default the first.
example() { # LANGUAGE FILE [NUMBER]
  awk -v fence='```'"$1" -v wanted="${3:-1}" '$0 == fence { on = ++n == wanted; next } /^```/ { if (on) exit } on' "$2"
}
# An example must run, and print a table with a line for every group rather than nothing.
run_example() { # FILE COMMAND...
  local file=$1
  shift
  [ -s "$file" ] || { echo "the README has no such example"; return 1; }
  (cd "$data" && "$@" "$file") | tee "$work/printed"
  [ "$(wc -l <"$work/printed")" -ge 3 ] || { echo "expected a table, printed less"; return 1; }
}
R=$(command -v Rscript || true)
[ -n "$R" ] || echo "skip  examples in R: there is no Rscript (Debian: apt-get install r-base-core)"

for bundle in "$@"; do
  echo "$bundle"
  folder=$bundle
  if [ ! -d "$bundle" ]; then
    folder=$work/unpacked
    rm -rf "$folder"
    python3 -m zipfile -e "$bundle" "$folder"
  fi
  data=$(dirname "$(find "$folder" -name datapackage.json | head -n 1)")
  [ -f "$data/datapackage.json" ] || { echo "FAIL  no datapackage.json"; failed=1; continue; }
  listed=$("$tools/data/bin/python" -c 'import json,sys; print("\n".join(sorted(r["path"] for r in json.load(open(sys.argv[1]))["resources"])))' "$data/datapackage.json")
  step "every CSV file is described" diff <(cd "$data" && find . -name '*.csv' | sed 's#^\./##' | LC_ALL=C sort) <(echo "$listed" | LC_ALL=C sort)
  # Limits off: whole studies have more rows and errors than a first look.
  step "every field is as the data dictionary says" "$tools/data/bin/frictionless" validate "$data/datapackage.json"
  step "citation" "$tools/citation/bin/cffconvert" --validate --infile "$data/CITATION.cff"
  step "deposit" python3 "$here/check_deposit.py" "$data/.zenodo.json"
  example python "$data/README.md" >"$work/example.py"
  step "question in Python" run_example "$work/example.py" "$tools/data/bin/python"
  example python "$data/README.md" 2 >"$work/example.py"
  step "example in Python" run_example "$work/example.py" "$tools/data/bin/python"
  if [ -n "$R" ]; then
    example r "$data/README.md" >"$work/example.R"
    step "example in R" run_example "$work/example.R" "$R"
  fi
  # Written for the quickstart; any bundle with a factor `prior` and milestones of coverage will do.
  if grep -q '^key,\(.*,\)\?prior,.*distance-m-at-90' "$data/results/trials.csv"; then
    example python "$here/../docs/data.md" >"$work/example.py"
    step "example of docs/data.md in Python" run_example "$work/example.py" "$tools/data/bin/python"
    if [ -n "$R" ]; then
      example r "$here/../docs/data.md" >"$work/example.R"
      step "example of docs/data.md in R" run_example "$work/example.R" "$R"
    fi
  fi
done
exit $failed
