# SPDX-License-Identifier: Apache-2.0
"""What can go wrong: one exception for the reports and for `gazetrace`, which shows it as gazetrace.Error."""

EXIT_CODES = {"usage": 2, "input": 2, "runtime": 3, "interrupted": 4, "nothing_to_do": 0}  # the program's


class Error(Exception):
    """Whatever the library refuses or fails at.

    `kind` is "usage" (options that contradict each other or name something unknown), "input" (a file that is missing,
    broken or does not fit the rest), "runtime" (the inputs were right, and something failed later), "nothing_to_do" or
    "interrupted". Options stand in the message in back quotes, under their Python names.
    """

    kind: str

    def __init__(self, message: str, kind: str = "usage"):
        super().__init__(message)
        self.kind = kind

    def __reduce__(self):
        return type(self), (str(self), self.kind)
