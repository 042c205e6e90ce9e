"""What kinsim says when it is asked for something that cannot be."""


class InputError(ValueError):
    """Bad input: one line that names the place and the remedy.

    The command line prints it and exits with code 2; in Python it is an ordinary ``ValueError``.
    """


NO_MEMORY = "not enough memory; take fewer cells or velocity nodes"
"""Where memory gets short without a word of its own."""


def line_of(error: Exception) -> str:
    """What an error says."""
    return str(error) or NO_MEMORY
