# SPDX-FileCopyrightText: The pcavr authors
# SPDX-License-Identifier: Apache-2.0
"""Builds the extension by CMake, for pip. PCAVR_BUILD_DIR names a build folder of CMake to use; by
default it is build/wheel of the repository, configured for users."""
import os
import pathlib
import re
import subprocess
import sys

from setuptools import Extension, setup
from setuptools.command.build_ext import build_ext

ROOT = pathlib.Path(__file__).resolve().parent.parent
BUILD = pathlib.Path(os.environ.get("PCAVR_BUILD_DIR", ROOT / "build" / "wheel")).resolve()
FOR_USERS = ["-DCMAKE_BUILD_TYPE=Release", "-DPCAVR_WARNINGS_AS_ERRORS=OFF", "-DPCAVR_BUILD_APPS=OFF",
             "-DPCAVR_BUILD_TESTS=OFF", "-DPCAVR_BUILD_SAMPLES=OFF", "-DCMAKE_UNITY_BUILD=ON"]


class BuildByCMake(build_ext):
    """Copies what CMake has built to where setuptools wants it."""

    def build_extension(self, ext: Extension) -> None:
        if not (BUILD / "CMakeCache.txt").exists():
            subprocess.run(["cmake", "-S", ROOT, "-B", BUILD, "-G", "Ninja", *FOR_USERS,
                            "-DPCAVR_BUILD_PYTHON=ON", f"-DPython3_EXECUTABLE={sys.executable}"], check=True)
        subprocess.run(["cmake", "--build", BUILD, "--target", "pcavr_python"], check=True)
        target = pathlib.Path(self.get_ext_fullpath(ext.name))
        self.copy_file(str(BUILD / "python" / "package" / "pcavr" / target.name), str(target))


def project_version() -> str:
    found = re.search(r"project\(pcavr VERSION ([\d.]+)", (ROOT / "CMakeLists.txt").read_text())
    assert found, "CMakeLists.txt states no version"
    return found[1]


work = BUILD / "python" / "wheel"
work.mkdir(parents=True, exist_ok=True)
setup(version=project_version(), packages=["pcavr"], package_data={"pcavr": ["py.typed", "*.pyi"]},
      ext_modules=[Extension("pcavr._pcavr", sources=[])], cmdclass={"build_ext": BuildByCMake},
      # Nothing is written beside the sources.
      options={"build": {"build_base": str(work)}, "egg_info": {"egg_base": str(work)}})
