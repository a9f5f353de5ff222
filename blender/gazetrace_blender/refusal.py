# SPDX-License-Identifier: Apache-2.0
"""What the add-on says where a scene asks for something that gazetrace cannot show as Blender does."""


class Refusal(Exception):
    """A scene that would be rendered otherwise than Blender shows it: what is in the way, and what to do about it."""

    def __init__(self, what_is_wrong: str, what_to_do: str) -> None:
        super().__init__(f"{what_is_wrong}; {what_to_do}")
