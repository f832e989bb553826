#!/usr/bin/env python3
"""Contact forces from Python without a build: ctypes and NumPy over the shared library.

    python3 lookup.py libflangeway_c.so TABLE.fwt [plot.svg]

A wheelset moves from flange to flange; both wheels are looked up in one call and their contact forces drawn.
"""

import ctypes
import sys

import numpy as np

# The header's structs. A NumPy array of such records is what the library reads and writes.
POSE = np.dtype([("lateral", "f8"), ("yaw", "f8"), ("vertical", "f8"), ("roll", "f8")])
WHEEL = np.dtype([("pose", POSE), ("side", "i4"), ("reserved", "i4")])
CONTACT = np.dtype(
    [
        ("normal_force", "f4"),
        ("indentation", "f4"),
        ("position", "f4", 3),
        ("angle", "f4"),
        ("rolling_radius", "f4"),
        ("wheel_coordinate", "f4"),
        ("semi_axes", "f4", 2),
        ("wheel_curvature", "f4"),
        ("rail_curvature", "f4"),
        ("slot", "i4"),
    ]
)
CONTACTS = np.dtype([("contact", CONTACT, 3), ("count", "i4"), ("flags", "u4")])
TABLE_BYTES = 8 * 512
INTERFACE_VERSION = 1
RIGHT, LEFT = 0, 1
SLOTS = ("tread", "flange root", "flange")


class Table:
    """A contact table. Keeps the image and the view, which must not move, for as long as it lives."""

    def __init__(self, library, path):
        self.library = ctypes.CDLL(library)
        self.library.flangeway_status_text.restype = ctypes.c_char_p
        if self.library.flangeway_interface_version() != INTERFACE_VERSION:
            raise RuntimeError(f"{library}: another version of the interface than this script's")
        self.image = np.fromfile(path, dtype=np.uint8)
        self.view = np.zeros(TABLE_BYTES, dtype=np.uint8)
        status = self.library.flangeway_table_load(
            _pointer(self.view), ctypes.c_size_t(self.view.nbytes), _pointer(self.image), ctypes.c_size_t(self.image.nbytes)
        )
        if status:
            text = ctypes.create_string_buffer(200)
            self.library.flangeway_table_problem(
                _pointer(self.image), ctypes.c_size_t(self.image.nbytes), text, ctypes.c_size_t(200)
            )
            raise ValueError(f"{path}: {text.value.decode()}")

    def contacts(self, wheels):
        """Contacts of an array of WHEEL records, as an array of CONTACTS."""
        wheels = np.ascontiguousarray(wheels, dtype=WHEEL)
        found = np.zeros(wheels.shape, dtype=CONTACTS)
        count = ctypes.c_size_t(wheels.size)
        status = self.library.flangeway_contacts_many(
            _pointer(self.view), _pointer(wheels), count, _pointer(found), count
        )
        if status:
            raise ValueError(self.library.flangeway_status_text(status).decode())
        return found


def _pointer(array):
    return ctypes.c_void_p(array.ctypes.data)


def main(library, path, plot=None):
    table = Table(library, path)
    lateral = np.linspace(-0.004, 0.004, 801)
    wheels = np.zeros((2, lateral.size), dtype=WHEEL)
    wheels["pose"]["lateral"] = lateral
    wheels["pose"]["vertical"] = 2e-4
    wheels["side"] = np.array([[RIGHT], [LEFT]])
    found = table.contacts(wheels)

    force = np.zeros((2, len(SLOTS), lateral.size))
    for place in range(3):
        contact = found["contact"][..., place]
        for slot in range(len(SLOTS)):
            force[:, slot] += np.where(contact["slot"] == slot, contact["normal_force"], 0.0)
    total = force.sum(axis=1)
    print(f"{lateral.size} poses, largest force of a wheel {1e-3 * total.max():.1f} kN")
    if plot:
        import matplotlib

        matplotlib.use("Agg")
        from matplotlib import pyplot

        figure, axes = pyplot.subplots(2, 1, sharex=True, figsize=(7, 6), layout="constrained")
        for side, name in ((RIGHT, "right wheel"), (LEFT, "left wheel")):
            for slot, label in enumerate(SLOTS):
                axes[side].plot(1e3 * lateral, 1e-3 * force[side, slot], label=label)
            axes[side].set(title=name, ylabel="normal force, kN")
            axes[side].grid(alpha=0.3)
        axes[0].legend()
        axes[1].set_xlabel("lateral displacement of the wheelset, mm (axle 0.2 mm below rest)")
        figure.savefig(plot)
    return lateral, total


if __name__ == "__main__":
    if len(sys.argv) not in (3, 4):
        sys.exit(__doc__)
    main(*sys.argv[1:])
