#!/usr/bin/env bash
# Builds the FMUs and runs them under importers: FMPy (validation, the bits of `flangeway simulate`, instances side by
# side, kept states, every error, cost) and libcosim. Sets up what it needs (pip); exits non-zero on any failure.
set -euo pipefail
cd "$(dirname "$0")/../.."
export CARGO_TERM_COLOR=never
target=${CARGO_TARGET_DIR:-$PWD/target}
tools=${FLANGEWAY_TOOLS:-$target/fmu-tools}
scenario=tables/scenarios/wheelset_r1000.toml
table=tables/simplified_pair.fwt
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
step() { printf -- '-- %s\n' "$*"; }

step "tools"
python3 -c 'import ensurepip' 2>/dev/null || {
  sudo=; [ "$(id -u)" = 0 ] || sudo=sudo
  $sudo apt-get install -y --no-install-recommends python3-venv >/dev/null
}
if ! "$tools/bin/python3" -c 'import fmpy' 2>/dev/null; then
  python3 -m venv "$tools"
  "$tools/bin/pip" install --quiet fmpy==0.3.32
fi

step "program and library"
cargo build --release --locked -p flangeway-host --bin flangeway
cargo build --release --locked -p flangeway-fmu --lib --example curve
cargo build --release --locked --manifest-path kernel/c-api/Cargo.toml --target-dir kernel/c-api/target
flangeway=$target/release/flangeway
wanted=34
found=$(nm -D --defined-only "$target/release/libflangeway_fmu.so" | grep -c ' T fmi2')
[ "$found" = $wanted ] || { echo "the library has $found functions of FMI, not $wanted" >&2; exit 1; }

step "the command: bad input is one line and exit status 2, and nothing is written"
refuse() { # WORDS ARGUMENTS...
  local words=$1 status=0
  shift
  "$flangeway" fmu "$@" 2>"$work/log" || status=$?
  if [ $status != 2 ] || [ "$(wc -l <"$work/log")" != 1 ] || ! grep -q "$words" "$work/log"; then
    echo "fmu $*: status $status, $(cat "$work/log")" >&2
    exit 1
  fi
}
head -c 5000 $table >"$work/cut.fwt"
refuse "no/such.fwt" no/such.fwt -o "$work/x.fmu"
refuse "truncated" "$work/cut.fwt" -o "$work/x.fmu"
refuse "not a contact table" Cargo.toml -o "$work/x.fmu"
refuse "does not exist" $table -o "$work/no/x.fmu"
refuse "no/such.so" $table -o "$work/x.fmu" --library no/such.so
mkdir "$work/alone" && cp "$flangeway" "$work/alone/" # without its library
flangeway=$work/alone/flangeway refuse "cargo build --release -p flangeway-fmu" $table -o "$work/x.fmu"
[ ! -e "$work/x.fmu" ]

step "FMPy"
"$tools/bin/python3" hosttools/fmu/tests/importer.py "$flangeway" "$target/release/examples/curve" $scenario $table \
  "$PWD/kernel/c-api/target/release/libflangeway_c.so" "$work"

step "libcosim"
if "$tools/bin/python3" -c 'import libcosimpy' 2>/dev/null || "$tools/bin/pip" install --quiet libcosimpy==0.0.6; then
  "$tools/bin/python3" hosttools/fmu/tests/other_importer.py "$work/wheelset.fmu" >"$work/log" 2>&1 ||
    { tail -n 20 "$work/log" >&2; exit 1; }
  grep '^libcosim:' "$work/log"
else
  echo "note: no libcosim for this platform; FMPy alone"
fi
echo "the FMUs hold"
