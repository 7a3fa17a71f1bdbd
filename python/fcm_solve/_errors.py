"""Errors and warnings, with the messages of the program."""


class Error(Exception):
    """Base class of all errors of fcm_solve."""


class InputError(Error, ValueError):
    """A scene or a parameter that is not allowed."""


class Caution(UserWarning):
    """Warning about questionable parameters or results. Not an error: results are those of the method."""
