"""What kinsim says when it is asked for something that cannot be."""


class InputError(ValueError):
    """Bad input: one line that names the place and the remedy.

    The command line prints it and exits with code 2; in Python it is an ordinary ``ValueError``.
    """
