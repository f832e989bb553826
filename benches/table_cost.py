#!/usr/bin/env python3
"""What a table costs: processor seconds and peak memory of `flangeway compile --jobs 1`, by solver and size.

For a quiet machine: table_cost.py [--recipe R.toml] [--bytes 65536,262144,1048576] [--normal hertz,semi-hertzian,half-space]
The Markdown table it prints is that of hosttools/CAMPAIGNS.md. Build first: cargo build --release --bin flangeway.
"""

import argparse
import os
import pathlib
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent


def compile_once(recipe, size, output):
    """Processor seconds, peak bytes and table bytes."""
    program = os.environ.get("FLANGEWAY", ROOT / "target/release/flangeway")
    command = [program, "compile", recipe, "--jobs", "1", "--max-bytes", str(size), "-o", output]
    child = subprocess.Popen(command, stderr=subprocess.PIPE, text=True)
    complaint = child.stderr.read()
    _, status, used = os.wait4(child.pid, 0)
    if status != 0:
        sys.exit(f"{' '.join(map(str, command))}\n{complaint}")
    # Linux counts the resident set in KiB.
    return used.ru_utime + used.ru_stime, 1024 * used.ru_maxrss, os.path.getsize(output)


def count(number):
    """Three digits of a number."""
    for limit, scale, unit in [(1e6, 1e6, " million"), (1e4, 1, "")]:
        if number >= limit:
            return f"{number / scale:.3g}{unit}" if unit else f"{round(number, -2):,.0f}"
    return f"{number:.3g}" if number < 1000 else f"{round(number, -1):,.0f}"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--recipe", default=ROOT / "tables/recipes/s1002_60e1_40.toml", type=pathlib.Path)
    parser.add_argument("--bytes", default="65536,262144,1048576")
    parser.add_argument("--normal", default="hertz,semi-hertzian,half-space")
    arguments = parser.parse_args()
    text = arguments.recipe.read_text()
    if "[solver]" in text:
        sys.exit(f"{arguments.recipe}: has a [solver] section of its own")
    print("| solver | bytes | seconds of one core | peak memory | tables an hour: 1 core | 64 cores | 4096 cores |")
    print("| --- | --- | --- | --- | --- | --- | --- |")
    with tempfile.TemporaryDirectory() as folder:
        for normal in arguments.normal.split(","):
            recipe = pathlib.Path(folder, "recipe.toml")
            recipe.write_text(f'{text}\n[solver]\nnormal = "{normal}"\n')
            for size in map(int, arguments.bytes.split(",")):
                seconds, peak, length = compile_once(recipe, size, pathlib.Path(folder, "table.fwt"))
                hourly = [count(3600 / seconds * cores) for cores in (1, 64, 4096)]
                row = [normal, f"{length:,}", f"{seconds:.1f}", f"{peak / 1e6:.0f} MB", *hourly]
                print("|", " | ".join(row), "|", flush=True)


if __name__ == "__main__":
    main()
