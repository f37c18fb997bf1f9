# SPDX-FileCopyrightText: The pcavr authors
# SPDX-License-Identifier: Apache-2.0
"""The stubs state what the extension has, and the examples have right types."""
import ast
import os
import pathlib
import re
import subprocess
import sys

import pcavr
from conftest import EXAMPLES
from pcavr import _pcavr

PACKAGE = pathlib.Path(pcavr.__file__).parent
STUBS = ast.parse((PACKAGE / "_pcavr.pyi").read_text())


def run_mypy(program, *arguments, cwd):
    environment = {**os.environ, "MYPYPATH": str(PACKAGE.parent)}
    done = subprocess.run([sys.executable, "-m", program, *map(str, arguments)], cwd=cwd, env=environment,
                          capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr


def stated_functions(body, owner=None):
    """{qualified name: names of its parameters} of functions and methods, without properties."""
    found = {}
    for node in body:
        if isinstance(node, ast.ClassDef):
            found.update(stated_functions(node.body, node.name))
        elif isinstance(node, ast.FunctionDef) and not node.decorator_list:
            arguments = node.args.posonlyargs + node.args.args + node.args.kwonlyargs
            name = f"{owner}.{node.name}" if owner else node.name
            found[name] = [each.arg for each in arguments]
    return found


def function_of(name):
    found = _pcavr
    for part in name.split("."):
        found = getattr(found, part)
    return found


# pybind11's metaclass, and its constructors: their parameters are compared below.
OF_PYBIND11 = r"pcavr\._pcavr\.[A-Z]\w+(\.__init__)?"


def test_stubs_name_what_the_module_has(tmp_path):
    (tmp_path / "allowed.txt").write_text(OF_PYBIND11)
    run_mypy("mypy.stubtest", "--allowlist", "allowed.txt", "pcavr._pcavr", cwd=tmp_path)
    stated = {node.name for node in STUBS.body if isinstance(node, (ast.ClassDef, ast.FunctionDef))}
    assert stated == {name for name in vars(_pcavr) if not name.startswith("_")}


def test_stubs_name_the_parameters_of_each_function():
    for name, stated in stated_functions(STUBS.body).items():
        if name.endswith("__") and not name.endswith("__init__"):
            continue
        signature = function_of(name).__doc__.splitlines()[0]
        named = re.findall(r"[(,] ?(\w+): ", signature)
        assert named == stated, f"{name}: {signature}"


def test_everything_is_public_and_described():
    assert set(pcavr.__all__) - {"Error", "DataWarning"} == {
        name for name in vars(_pcavr) if not name.startswith("_")}
    for name in pcavr.__all__:
        each = getattr(pcavr, name)
        assert each.__doc__, name
        for member, value in vars(each).items() if isinstance(each, type) else []:
            is_plain = not member.startswith("_") and (callable(value) or isinstance(value, property))
            assert not is_plain or value.__doc__, f"{name}.{member}"


def test_examples_are_strictly_typed(tmp_path):
    assert (PACKAGE / "py.typed").exists()
    run_mypy("mypy", "--strict", "--cache-dir", tmp_path, *sorted(EXAMPLES.glob("*.py")), cwd=tmp_path)
