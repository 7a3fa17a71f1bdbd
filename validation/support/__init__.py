"""Common parts of the validation cases."""
