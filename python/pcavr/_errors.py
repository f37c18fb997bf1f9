# SPDX-FileCopyrightText: The pcavr authors
# SPDX-License-Identifier: Apache-2.0
"""The exception and the warning of the package."""


class Error(ValueError):
    """A problem with data from outside: arrays, files and folders.

    message  what is wrong, with the offending value
    file     the file or folder it is about; '' for arguments
    line     from 1; 0 where there are no lines
    place    the argument and row, or the key or column inside the file
    hint     what can be done about it

    str(error) is all of it in one line; empty parts are left out.
    """

    def __init__(self, text: str, message: str = "", file: str = "", line: int = 0,
                 place: str = "", hint: str = "") -> None:
        super().__init__(text, message, file, line, place, hint)
        self.message = message or text
        self.file = file
        self.line = line
        self.place = place
        self.hint = hint

    def __str__(self) -> str:
        return str(self.args[0])


class DataWarning(UserWarning):
    """Data that are doubtful or contradict each other, in a call that goes on."""
