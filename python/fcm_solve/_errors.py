"""Errors and warnings, in the words of the program."""


class Error(Exception):
    """What went wrong. The base class of all errors of fcm_solve."""


class InputError(Error, ValueError):
    """A scene or a parameter that is not allowed."""


class Caution(UserWarning):
    """What had better be otherwise. Not an error: results are those of the method."""
