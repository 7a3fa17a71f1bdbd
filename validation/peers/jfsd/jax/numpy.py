"""Arrays of numpy."""

from numpy import *  # noqa: F403
