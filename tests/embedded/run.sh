#!/usr/bin/env bash
# The kernel on emulated microcontrollers: builds, runs and checks it on a Cortex-M7 and a Cortex-M4F, prints a line of
# JSON for each, then drives a board over its serial line (processor in the loop). Installs what is missing.
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
root=$(cd "$here/../.." && pwd)
cd "$here"
export CARGO_TERM_COLOR=never
targets="$here/target"
triple=thumbv7em-none-eabihf
# What must hold on the Cortex-M7: instructions a lookup, bytes of flash without the table; bytes of stack of a lookup and of
# the startup, on both.
most_instructions=3000 most_flash=24576 most_stack=2048
# Instructions that an emulated tick of the boards' timer takes.
tick=40
exchanges=10000 damage=0.01
machine() { [ "$1" = cortex-m7 ] && echo mps2-an500 || echo mps2-an386; }

work=$(mktemp -d)
board=
trap '[ -z "$board" ] || kill "$board" 2>/dev/null || true; rm -rf "$work"' EXIT
fail() { echo "tests/embedded/run.sh: $*" >&2; exit 1; }

install() {
  local sudo=
  [ "$(id -u)" = 0 ] || sudo=sudo
  $sudo apt-get update -qq && $sudo apt-get install -y --no-install-recommends "$@" >/dev/null
}
command -v qemu-system-arm >/dev/null || install qemu-system-arm
command -v size >/dev/null || install binutils

# The target by rustup; where it is not to be had, Debian's compiler builds `core` for it.
if [ "${EMBEDDED_TOOLCHAIN:-}" != debian ] && rustup target add $triple 2>"$work/rustup.log"; then
  firmware_cargo() { cargo "$@"; }
  linker=()
else
  echo "note: no target $triple by rustup; building it with Debian's rustc-web" >&2
  [ -n "$(dpkg -L rustc-web cargo-web rust-web-src 2>/dev/null | grep -m1 bin/rustc)" ] ||
    install rustc-web cargo-web rust-web-src
  debian_rustc=$(dpkg -L rustc-web | grep -m1 'bin/rustc$')
  debian_cargo=$(dpkg -L cargo-web | grep -m1 'bin/cargo$')
  lld=$(find "$(rustc --print sysroot)" -name rust-lld -type f 2>/dev/null | head -n 1)
  [ -n "$lld" ] || { install lld; lld=$(command -v ld.lld); }
  linker=(-C "linker=$lld")
  targets="$targets/debian"
  firmware_cargo() {
    local command=$1
    shift
    RUSTC_BOOTSTRAP=1 RUSTC="$debian_rustc" "$debian_cargo" "$command" -Z build-std=core "$@"
  }
fi

# firmware CPU COMMAND [CARGO ARGUMENTS]: cargo's command for a processor. One folder for both, so that what runs on the host
# (macros, build scripts) is built once; the programs are taken out of it before the next build.
firmware() {
  local cpu=$1 command=$2
  shift 2
  CARGO_TARGET_DIR="$targets" RUSTFLAGS="-C target-cpu=$cpu -C link-arg=-Tlink.x ${linker[*]}" \
    firmware_cargo "$command" --quiet --release --locked --target $triple "$@"
}
# bytes PROGRAM SECTIONS: their sum.
bytes() { size -A "$1" | awk -v names="$2" '$1 ~ "^\\.(" names ")$" { sum += $2 } END { print sum + 0 }'; }
table=$(stat -c %s "$root/tables/s1002_60e1_40.fwt")
flash() { echo $(($(bytes "$1" 'vector_table|text|rodata|data') - table)); }
# field NAME LINE: a number of a line of JSON.
field() { sed -nE "s/.*\"$1\": ([0-9]+).*/\1/p" <<<"$2"; }

# start CPU SERIAL PROGRAM: a board with its serial line there.
start() {
  qemu-system-arm -cpu "$1" -machine "$(machine "$1")" -display none -monitor none -icount shift=0 -serial "$2" \
    -kernel "$3" >"$work/board.log" 2>&1 &
  board=$!
}
stop() { kill "$board" && { wait "$board" || true; board=; }; }
# await PATTERN FILE: waits until a line says so, for five minutes: other programs may run beside.
await() {
  local i
  for ((i = 0; i < 3000; i++)); do
    if grep -qE "$1" "$2" 2>/dev/null; then return 0; fi
    sleep 0.1
  done
  fail "no \"$1\" within five minutes: $(cat "$2")"
}

CARGO_TARGET_DIR="$here/target" cargo build --quiet --release --locked -p flangeway-compare
compare="$here/target/release/compare"
"$compare" poses "$work/poses.bin"

for cpu in cortex-m7 cortex-m4; do
  firmware $cpu build -p flangeway-firmware -p flangeway-smallest -p flangeway-template
  programs="$work/$cpu"
  mkdir "$programs"
  cp "$targets/$triple/release/"{lookups,smallest,template,fixed-step} "$programs/"
  (cd "$work" && timeout 900 qemu-system-arm -cpu $cpu -machine "$(machine $cpu)" -display none -monitor none -serial none \
    -semihosting-config enable=on,target=native -icount shift=0 -kernel "$programs/lookups" >answers.bin) ||
    fail "$cpu: the firmware did not end well"
  sizes="\"flash_bytes\": $(flash "$programs/smallest"), \"static_bytes\": $(bytes "$programs/smallest" 'data|bss|uninit')"
  sizes="$sizes, \"template_flash_bytes\": $(flash "$programs/template")"
  line=$("$compare" check $cpu "$work/answers.bin" "$sizes") || { echo "$line"; fail "$cpu: other answers than the host's"; }
  echo "$line"
  [ "$(field poses "$line")" -ge 1000 ] || fail "$cpu: fewer than 1000 poses"
  [ "$(field thousand_nops "$line")" = 1000 ] || fail "$cpu: a thousand instructions are counted as others"
  ! grep -qE '"poses_by_contacts": \[.*\b[0-9]\b.*\]' <<<"$line" || fail "$cpu: a number of contacts is rare among the poses"
  for stack in stack_bytes startup_stack_bytes; do
    [ "$(field $stack "$line")" -lt $most_stack ] || fail "$cpu: $stack is $most_stack or more"
  done
  if [ $cpu = cortex-m7 ]; then
    for call in "" creep_ fastsim_; do
      [ "$(field ${call}instructions_min "$line")" = "$(field ${call}instructions_max "$line")" ] ||
        fail "$cpu: ${call}instructions are not the same for every case"
    done
    [ "$(field instructions_max "$line")" -le $most_instructions ] || fail "$cpu: more than $most_instructions instructions"
    [ "$(field flash_bytes "$line")" -lt $most_flash ] || fail "$cpu: $most_flash bytes of flash or more"
  fi

  # A second of the program that looks both wheels up in a timer's interrupt.
  start $cpu "file:$work/$cpu.steps" "$programs/fixed-step"
  await '"steps": 1000,.*}' "$work/$cpu.steps"
  stop
  steps=$(head -n 1 "$work/$cpu.steps")
  echo "fixed step, $cpu: $steps"
  [ "$(field late "$steps")" = 0 ] || fail "$cpu: steps began late"
  [[ "$(field hundredths "$steps")" =~ ^10[0-5]$ ]] || fail "$cpu: a thousand steps after the start took other than a second"
  [ "$(field normal_force "$steps")" -gt 0 ] || fail "$cpu: no contact in the timer's interrupt"
  if [ $cpu = cortex-m7 ]; then
    # Two lookups and as much again for all else.
    [ $(($(field ticks_max "$steps") * tick)) -le $((4 * most_instructions)) ] || fail "$cpu: the interrupt takes too long"
  fi
  if nm "$programs/template" "$programs/fixed-step" | grep -E '__rust_alloc|__rg_alloc'; then fail "$cpu: an allocator is linked"; fi
done

# The template with log messages builds too.
for program in template fixed-step; do
  firmware cortex-m7 rustc -p flangeway-template --features defmt --bin $program -- -C link-arg=-Tdefmt.x
done
template="$work/cortex-m7/template"

cargo build --quiet --release --locked --manifest-path "$root/Cargo.toml" --bin flangeway
flangeway="${CARGO_TARGET_DIR:-$root/target}/release/flangeway"

# A port that nobody listens at.
port=0
while [ $port = 0 ] || (: <"/dev/tcp/127.0.0.1/$port") 2>/dev/null; do port=$((20000 + RANDOM % 10000)); done
line="tcp:127.0.0.1:$port,server=on,wait=off,nodelay=on"
start cortex-m7 "$line" "$template"
for ((i = 0; i < 100; i++)); do
  if (: <"/dev/tcp/127.0.0.1/$port") 2>/dev/null; then break; fi
  sleep 0.1
done
"$flangeway" pil --port "tcp:127.0.0.1:$port" --exchanges $exchanges --damage $damage --seed 1 --json \
  >"$work/pil.json" 2>"$work/pil.log" &
host=$!
await "$((exchanges / 2)) of" "$work/pil.log"
stop
start cortex-m7 "$line" "$template"
wait $host || { cat "$work/pil.log"; fail "pil: it ended with another status than 0"; }
stop
cat "$work/pil.json"
pil=$(tr -d '\n' <"$work/pil.json")
[ "$(field exchanges "$pil")" = $exchanges ] && [ "$(field mismatches "$pil")" = 0 ] || fail "pil: not every answer is right"
[ "$(field board_restarted "$pil")" -ge 1 ] || fail "pil: the restart was not noticed"
[ "$(field retries "$pil")" -ge 100 ] || fail "pil: fewer frames were asked again than were damaged"
[ "$(field count_min "$pil")" -gt 0 ] || fail "pil: nothing was counted"

# The same over a serial device, here a pseudo-terminal.
start cortex-m7 pty "$template"
await 'redirected to /dev/' "$work/board.log"
device=$(sed -nE 's/.*redirected to ([^ ]+).*/\1/p' "$work/board.log")
"$flangeway" pil --port "$device:115200" --exchanges 200 --damage $damage 2>"$work/pil.log" || { cat "$work/pil.log"; fail "pil: the serial device"; }
tail -n 5 "$work/pil.log"
stop
echo "tests/embedded/run.sh: all holds"
