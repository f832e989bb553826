#!/usr/bin/env bash
# Builds the C interface and everything around it, and checks all of it: the header against cbindgen, strict C99 and C++,
# sanitisers and valgrind, bits against Rust, every error code, threads, the examples, Python, cost against Rust.
# Sets up what it needs (apt, cargo install, pip); exits non-zero on any failure.
set -euo pipefail
cd "$(dirname "$0")"
export CARGO_TERM_COLOR=never
cbindgen_version=0.29.2
tools=${FLANGEWAY_TOOLS:-$PWD/target/tools}
table=../../tables/s1002_60e1_40.fwt
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
step() { printf -- '-- %s\n' "$*"; }

step "tools"
missing=()
for package in gcc g++ valgrind python3-venv; do
  dpkg -s "$package" >/dev/null 2>&1 || missing+=("$package")
done
command -v gcc >/dev/null && command -v g++ >/dev/null && command -v valgrind >/dev/null &&
  python3 -c 'import ensurepip' 2>/dev/null && missing=()
if [ ${#missing[@]} -gt 0 ]; then
  sudo=; [ "$(id -u)" = 0 ] || sudo=sudo
  $sudo apt-get install -y --no-install-recommends "${missing[@]}" >/dev/null
fi
if [ "$("$tools/bin/cbindgen" --version 2>/dev/null)" != "cbindgen $cbindgen_version" ]; then
  # Not optimised: it runs for a moment.
  cargo install cbindgen --version "$cbindgen_version" --locked --debug --root "$tools" --quiet
fi
if [ ! -x "$tools/python/bin/python3" ] || ! "$tools/python/bin/python3" -c 'import numpy, matplotlib' 2>/dev/null; then
  python3 -m venv "$tools/python"
  "$tools/python/bin/pip" install --quiet numpy matplotlib
fi

step "library: format, lints, no std below it, the version of the other crates"
cargo fmt --all --check -- --config-path ../../rustfmt.toml
cargo clippy --workspace --all-targets --locked --release -- -D warnings
cargo clippy --lib --features cost --locked --release -- -D warnings
RUSTDOCFLAGS="-D warnings" cargo doc --no-deps --locked --quiet
if cargo tree -e normal,features --locked | grep -E 'feature "(std|alloc|use-std)"'; then
  echo "a dependency asks for std or alloc" >&2
  exit 1
fi
version() { sed -n '/^\[workspace.package\]/,/^$/s/^version = //p' "$1"; }
[ "$(version Cargo.toml)" = "$(version ../../Cargo.toml)" ]
cargo build --release --locked --features cost
cp target/release/libflangeway_c.a "$work/with-cost.a"
cargo build --workspace --release --locked
static=target/release/libflangeway_c.a
if rustup target list --installed 2>/dev/null | grep -q thumbv7em-none-eabihf; then
  cargo rustc --release --locked --target thumbv7em-none-eabihf --lib --crate-type staticlib
else
  echo "note: target thumbv7em-none-eabihf is not installed here; the library for firmware is left to machines that have it"
fi
shared=$PWD/target/release/libflangeway_c.so

step "header: as cbindgen writes it"
"$tools/bin/cbindgen" --quiet --config cbindgen.toml --output "$work/flangeway.h" .
diff -u include/flangeway.h "$work/flangeway.h"

step "programs: C99, every warning an error"
strict=(-std=c99 -Wall -Wextra -Werror -pedantic -Iinclude -Itests)
compile() { gcc "${strict[@]}" "$@"; }
echo '#include "flangeway.h"' >"$work/header.cpp"
g++ -std=c++11 -Wall -Wextra -Werror -pedantic -Iinclude -fsyntax-only "$work/header.cpp"
for program in bits errors; do
  compile -O2 tests/$program.c $static -o "$work/$program"
  compile -g -O1 -fsanitize=address,undefined -fno-sanitize-recover=all tests/$program.c $static -o "$work/$program-sanitised"
done
compile -O2 tests/threads.c $static -pthread -o "$work/threads"
compile -g -O1 -fsanitize=address,undefined -fno-sanitize-recover=all tests/threads.c $static -pthread -o "$work/threads-sanitised"
compile -O2 examples/loop_1khz.c $static -lm -o "$work/loop_1khz"
compile -Itests/stubs -g -O1 -fsanitize=address,undefined -fno-sanitize-recover=all examples/sfun_flangeway.c $static -lm -o "$work/sfun"
compile -O2 tests/bits.c "$shared" -Wl,-rpath,"$(dirname "$shared")" -o "$work/bits-shared"
if nm "$work/errors" | grep -E ' [A-Za-z] .*(__rust_alloc|__rg_alloc)'; then
  echo "an allocator is linked" >&2
  exit 1
fi

step "surroundings: memory functions and nothing else"
roots=$(nm -D --defined-only "$shared" | awk '$3 ~ /^flangeway_/ { printf "-Wl,-u,%s ", $3 }')
# shellcheck disable=SC2086
gcc -nostdlib -nostartfiles -static -Wl,--gc-sections -Wl,-e,flangeway_contacts $roots $static -o "$work/bare" \
  2>"$work/log" || true
wants=$(grep -o 'undefined reference to .*' "$work/log" | tr -d "\`'" | awk '{ print $4 }' | sort -u | xargs)
echo "the library wants: $wants"
for name in $wants; do
  case $name in memcpy | memset | memmove | memcmp | bcmp) ;; *) echo "$name is not a memory function" >&2; exit 1 ;; esac
done

step "bits: C against Rust, plain, from the shared library, sanitised"
for name in s1002_60e1_40 urban_metre_gauge; do
  file=../../tables/$name.fwt
  target/release/flangeway-c-golden "$file" "$work/$name.motions" "$work/$name.answers"
  for program in bits bits-shared bits-sanitised; do
    "$work/$program" "$file" "$work/$name.motions" >"$work/answers"
    cmp "$work/answers" "$work/$name.answers"
  done
  grep -q "^3 " "$work/answers" # some wheels have three contacts
  echo "$name: $(wc -l <"$work/answers") lines of bits the same"
done

step "errors, threads: plain, sanitised, under valgrind (which sees into the library)"
"$work/errors" $table
"$work/errors-sanitised" $table
"$work/threads" $table
"$work/threads-sanitised" $table
valgrind --quiet --error-exitcode=3 "$work/errors" $table
head -c $((88 * 100)) "$work/s1002_60e1_40.motions" >"$work/few"
valgrind --quiet --error-exitcode=3 "$work/bits" $table "$work/few" >/dev/null

step "examples"
"$work/loop_1khz" $table 0.5
"$work/sfun" $table
if "$work/loop_1khz" Cargo.toml 2>"$work/log"; then exit 1; fi
grep -q "not a contact table" "$work/log"
"$tools/python/bin/python3" tests/test_lookup.py "$shared" $table \
  "$work/s1002_60e1_40.motions" "$work/s1002_60e1_40.answers" "${FLANGEWAY_PLOT:-$work/forces.svg}"

# What C adds to each of the 2,000 lookups, about 70 instructions, is held; the ratio and the time are printed.
step "cost: instructions by callgrind, and time"
compile -O2 tests/cost.c "$work/with-cost.a" -o "$work/cost"
valgrind --tool=callgrind --callgrind-out-file="$work/callgrind" "$work/cost" $table count 2>/dev/null
callgrind_annotate --inclusive=yes "$work/callgrind" 2>/dev/null | tr -d , | awk '
  /cost_c_loop/ && !c { c = $1 } /cost_rust_loop/ && !rust { rust = $1 }
  END {
    more = (c - rust) / 2000
    printf "instructions: C over Rust %.4f, %.1f a lookup\n", c / rust, more
    exit !(rust > 0 && c > rust / 2 && more < 80)
  }'
"$work/cost" $table
echo "the C interface holds"
