#!/bin/sh
# Rewrites the committed tables from their recipes, and the figures in README.md from the tables' headers.
# Needed after every change of the compiler that changes a byte; the test `committed_tables` says so.
set -eu
cd "$(dirname "$0")/.."
bytes=$(sed -n 's/^pub const SMALL_BYTES: u64 = \([0-9_]*\);$/\1/p' tables/src/lib.rs | tr -d _)
# The program includes the tables, so there must be something to include.
for recipe in tables/recipes/*.toml; do
    table="tables/$(basename "$recipe" .toml).fwt"
    [ -e "$table" ] || : >"$table"
done
cargo build --release --bin flangeway
flangeway="${CARGO_TARGET_DIR:-target}/release/flangeway"
rows=$(mktemp)
trap 'rm -f "$rows" "$rows.md"' EXIT
cat >"$rows" <<'HEAD'
| table | bytes | build, s | rms | median | 95 % | 99 % | continuity |
| --- | --- | --- | --- | --- | --- | --- | --- |
HEAD
for recipe in tables/recipes/*.toml; do
    name=$(basename "$recipe" .toml)
    report=$("$flangeway" compile "$recipe" --max-bytes "$bytes" -o "tables/$name.fwt" --json)
    seconds=$(printf '%s\n' "$report" | sed -n 's/^ *"seconds": \([.0-9e-]*\),*$/\1/p')
    "$flangeway" inspect "tables/$name.fwt" --json |
        sed -n 's/^ *"\(bytes\|force_rms\|force_median\|force_p95\|force_p99\|continuity\)": \([.0-9e-]*\),*$/\1 \2/p' |
        awk -v name="$name" -v seconds="$seconds" '{ v[$1] = 100 * $2 } END {
            printf "| %s | %d | %.0f | %.2f %% | %.3f %% | %.2f %% | %.2f %% | %.3f %% |\n", name, v["bytes"] / 100,
                seconds, v["force_rms"], v["force_median"], v["force_p95"], v["force_p99"], v["continuity"] }' >>"$rows"
done
awk -v rows="$rows" '/^<!-- end of figures/ { inside = 0 }
    !inside { print }
    /^<!-- figures/ { inside = 1; print ""; while ((getline row < rows) > 0) print row; print "" }' \
    tables/README.md >"$rows.md"
cat "$rows.md" >tables/README.md
cat "$rows"
