# SPDX-License-Identifier: Apache-2.0
"""The parts of the wheel that CMake makes: the module _core, the library beside it, its plug-ins, and the stubs."""
import os
import pathlib
import re
import shutil
import subprocess
import sys

from setuptools import Extension, setup
from setuptools.command.build_ext import build_ext

ROOT = pathlib.Path(__file__).resolve().parent
VERSION = re.search(r"project\(sightglass VERSION ([\d.]+)", (ROOT / "CMakeLists.txt").read_text())[1]


class BuildWithCMake(build_ext):
    def build_extension(self, ext):
        made = pathlib.Path(os.environ.get("SIGHTGLASS_BUILD") or self.build_temp).resolve()
        if not os.environ.get("SIGHTGLASS_BUILD"):
            subprocess.run(["cmake", "-G", "Ninja", "-S", ROOT, "-B", made, "-DCMAKE_BUILD_TYPE=Release", "-DSG_BUILD_TESTS=OFF",
                            "-DSG_BUILD_BENCH=OFF", f"-DPython_EXECUTABLE={sys.executable}"], check=True)
        subprocess.run(["cmake", "--build", made, "--target", "sightglass_python"], check=True)
        package = pathlib.Path(self.get_ext_fullpath(ext.name)).resolve().parent
        package.mkdir(parents=True, exist_ok=True)
        module = pathlib.Path(self.get_ext_filename("sightglass._core")).name
        shutil.copy(made / "python" / "sightglass" / module, package / module)
        for stub in (made / "python" / "sightglass").glob("*.pyi"):
            shutil.copy(stub, package / stub.name)
        library = next(p for p in made.glob("libsightglass.so.*") if p.is_symlink())  # by the name that the module asks for
        shutil.copy(library, package / library.name)
        (package / "plugins").mkdir(exist_ok=True)
        for plugin in (made / "plugins").glob("*.so"):
            shutil.copy(plugin, package / "plugins" / plugin.name)
        # An installed package finds its library beside itself.
        subprocess.run(["cmake", f"-DFILE={package / module}", "-P", ROOT / "cmake" / "beside.cmake"], check=True)


# What is made on the way stays out of the sources, and of CMake's folder.
folder = ROOT / "build" / "wheel"
folder.mkdir(parents=True, exist_ok=True)
setup(options={"build": {"build_base": str(folder)}, "egg_info": {"egg_base": str(folder)}}, version=VERSION, ext_modules=[Extension("sightglass._core", [])], cmdclass={"build_ext": BuildWithCMake})
