# SPDX-License-Identifier: Apache-2.0
"""What a program waits for before its first line: nothing that only some programs need."""
import subprocess
import sys


def told_by(script):
    return subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True).stdout.split()


def test_importing_the_package_imports_nothing_else_beyond_numpy():
    added = told_by("import numpy, sys; before = set(sys.modules); import sightglass; print(*set(sys.modules) - before)")
    assert added and {name.partition(".")[0] for name in added} == {"sightglass"}


def test_importing_the_package_loads_no_library_for_text_before_there_is_text():
    script = """
import sightglass as sg
loaded = lambda: "libpangocairo" in open("/proc/self/maps").read()
print(loaded())
data = sg.gyroid(size=8).contour()
print(loaded())
data.plot(size=(64, 48))
print(loaded())
"""
    assert told_by(script) == ["False", "False", "True"]


def test_a_program_that_does_not_log_works_without_the_module_for_it():
    assert told_by("import sys, sightglass as sg; print(len(sg.gyroid(size=8).contour().notes), 'logging' in sys.modules)") == ["1", "False"]
