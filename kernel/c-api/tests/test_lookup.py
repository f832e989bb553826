"""Tests of examples/lookup.py: `python3 test_lookup.py LIBRARY TABLE MOTIONS ANSWERS PLOT` (see test.sh)."""

import pathlib
import sys

import numpy as np

sys.path.insert(0, str(pathlib.Path(__file__).parent.parent / "examples"))
import lookup

library, path, motions, answers, plot = sys.argv[1:]

# The motions' poses give the bits that Rust gives.
table = lookup.Table(library, path)
poses = np.fromfile(motions, dtype="f8").reshape(-1, 11)[:, :4]
wheels = np.zeros((len(poses), 2), dtype=lookup.WHEEL)
wheels["pose"] = np.ascontiguousarray(poses).view(lookup.POSE).reshape(-1, 1)
wheels["side"] = [lookup.RIGHT, lookup.LEFT]
found = table.contacts(wheels)
lines = pathlib.Path(answers).read_text().splitlines()
rows = len(lines) // len(poses)
for pose in range(len(poses)):
    for side in range(2):
        answer = found[pose, side]
        words = [f"{answer['count']:x}", f"{answer['flags']:x}"]
        for contact in answer["contact"][: answer["count"]]:
            bits = np.frombuffer(contact.tobytes(), dtype="u4")
            words += [f"{word:08x}" for word in bits[:-1]] + [f"{bits[-1]:x}"]
        assert words == lines[rows * pose + side].split(), (pose, side)

# Mirror images, a picture, and errors in words.
lateral, total = lookup.main(library, path, plot)
assert np.array_equal(total[0], total[1][::-1]) and total.max() > 1e4
assert pathlib.Path(plot).stat().st_size > 5000
wheels["pose"]["yaw"][3, 1] = np.nan
try:
    table.contacts(wheels)
    raise AssertionError("NaN was taken")
except ValueError as error:
    assert "NaN" in str(error), error
try:
    lookup.Table(library, motions)
    raise AssertionError("a file that is no table was taken")
except ValueError as error:
    assert "not a contact table" in str(error), error
print("python: the bits of Rust, mirror images, errors in words")
