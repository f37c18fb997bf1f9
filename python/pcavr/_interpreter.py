# SPDX-FileCopyrightText: The pcavr authors
# SPDX-License-Identifier: Apache-2.0
"""Refuses further interpreters of a process. The extension's classes belong to the main one, and a callback from
another one would wait for ever: so this is checked before the extension is loaded."""
import ctypes


def _is_main() -> bool:
    states = []
    for function in (ctypes.pythonapi.PyInterpreterState_Get, ctypes.pythonapi.PyInterpreterState_Main):
        function.restype = ctypes.c_void_p
        states.append(function())
    return bool(states[0] == states[1])


if not _is_main():
    raise ImportError("pcavr works in the main interpreter of a process alone; use multiprocessing for more")
