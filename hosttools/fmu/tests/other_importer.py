"""The wheelset unit under libcosim, the importer of the Open Simulation Platform: `python3 other_importer.py FMU`.

Its master sets inputs, steps and reads on its own; what comes out must be FMPy's. Not to the bit: libcosim takes the
length of a step as the difference of two times, which rounds.
"""

import shutil
import sys

from fmpy import extract, read_model_description
from fmpy.fmi2 import FMU2Slave
from libcosimpy.CosimExecution import CosimExecution
from libcosimpy.CosimManipulator import CosimManipulator
from libcosimpy.CosimObserver import CosimObserver
from libcosimpy.CosimSlave import CosimLocalSlave

fmu = sys.argv[1]
STEPS = 500
description = read_model_description(fmu)
references = {v.name: v.valueReference for v in description.modelVariables}
outputs = [references[name] for name in ("lateral", "yaw", "vertical", "spin", "right.wheel_load", "left.wheel_load")]
inputs = [references["track_curvature"], references["force_y"]]
values = [-5e-4, 1e3]

# Two instances in one run, the step in nanoseconds.
execution = CosimExecution.from_step_size(step_size=1_000_000)
units = [CosimLocalSlave(fmu_path=fmu, instance_name=f"unit{i}") for i in range(2)]
slaves = [execution.add_local_slave(unit) for unit in units]
observer, manipulator = CosimObserver.create_last_value(), CosimManipulator.create_override()
execution.add_observer(observer)
execution.add_manipulator(manipulator)
for slave in slaves:
    manipulator.slave_real_values(slave, inputs, values)
for _ in range(STEPS):
    assert execution.step()
found = [list(observer.last_real_values(slave, outputs)) for slave in slaves]
assert found[0] == found[1], found

folder = extract(fmu)


def under_fmpy(before_start):
    unit = FMU2Slave(
        guid=description.guid,
        unzipDirectory=folder,
        modelIdentifier=description.coSimulation.modelIdentifier,
        instanceName="unit",
    )
    unit.instantiate()
    unit.setupExperiment(startTime=0.0)
    unit.enterInitializationMode()
    if before_start:
        unit.setReal(inputs, values)
    unit.exitInitializationMode()
    for _ in range(STEPS):
        unit.setReal(inputs, values)
        unit.doStep(currentCommunicationPoint=0.0, communicationStepSize=1e-3)
    result = unit.getReal(outputs)
    unit.terminate()
    unit.freeInstance()
    return result


# Whether it sets inputs before or after the start is the master's choice.
references = [under_fmpy(True), under_fmpy(False)]
shutil.rmtree(folder, ignore_errors=True)
errors = [max(abs(x / y - 1.0) for x, y in zip(found[0], reference)) for reference in references]
assert min(errors) < 1e-9, (found[0], references)
print(f"libcosim: {STEPS} steps, two instances alike, within {min(errors):.1e} of FMPy")
