# SPDX-FileCopyrightText: The pcavr authors
# SPDX-License-Identifier: Apache-2.0
"""Errors are exceptions with file, line, place and hint."""
import pickle
import subprocess
import sys

import pytest

import pcavr


def test_error_names_file_and_hint(tmp_path):
    with pytest.raises(pcavr.Error) as raised:
        pcavr.read_recording(tmp_path / "absent")
    assert str(tmp_path / "absent") in raised.value.file
    assert raised.value.message and raised.value.message in str(raised.value)


def test_error_names_line_and_place(tmp_path):
    file = tmp_path / "parameters.yaml"
    file.write_text("box:\n  mass: 1.0\n  colour: red\n")
    with pytest.raises(pcavr.Error) as raised:
        pcavr.read_parameters(file)
    assert (raised.value.file, raised.value.line) == (str(file), 3)
    assert "colour" in str(raised.value)


def test_error_is_a_value_error_that_pickles():
    error = pcavr.Error("all of it", "message", "file", 7, "place", "hint")
    copy = pickle.loads(pickle.dumps(error))
    assert isinstance(copy, ValueError)
    assert (copy.message, copy.file, copy.line, copy.place, copy.hint) == (
        "message", "file", 7, "place", "hint")
    assert str(copy) == "all of it"


def test_file_name_that_is_not_utf8(tmp_path):
    with pytest.raises(pcavr.Error) as raised:
        pcavr.read_recording(bytes(tmp_path) + b"/\xff")
    assert raised.value.file.encode("utf-8", "surrogateescape").endswith(b"\xff")


@pytest.mark.parametrize("path", [None, 3, 1.5, ["a"]])
def test_path_of_another_type(path):
    with pytest.raises(TypeError, match="path"):
        pcavr.read_recording(path)


def test_path_with_a_zero_byte():
    with pytest.raises(ValueError):
        pcavr.read_recording("a\0b")


def test_without_numpy_the_import_works_and_arrays_are_an_import_error():
    script = ("import sys; sys.modules.update({'numpy': None, 'numpy.core.multiarray': None})\n"
              "import pcavr\n"
              "try:\n    pcavr.World([], [0.0, 0.0, 1.0])\n"
              "except ImportError:\n    print('no numpy')\n")
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=False)
    assert (done.returncode, done.stdout) == (0, "no numpy\n"), done.stderr


@pytest.mark.parametrize("is_loaded_before", [True, False])
def test_another_interpreter_of_the_process_is_refused(is_loaded_before):
    script = (("import pcavr\n" if is_loaded_before else "") +
              "import _xxsubinterpreters as interpreters\n"
              "other = interpreters.create()\n"
              "try:\n    interpreters.run_string(other, 'import pcavr')\n"
              "except interpreters.RunFailedError as error:\n    print(error)\n"
              "import pcavr\nprint(pcavr.World([], [0.0, 0.0, 1.0]).now)\n")
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    refusal, used = done.stdout.splitlines()
    assert "ImportError" in refusal and "main interpreter" in refusal and used == "0.0"
