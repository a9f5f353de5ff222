# SPDX-License-Identifier: Apache-2.0
"""The parts that make_courtyard.py builds the courtyard from. Standard library only."""
