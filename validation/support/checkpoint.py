"""Checkpoints, as far as runs that were stopped in different ways have to share them."""

import json


def state_of(checkpoint):
    """The contents of a checkpoint but for its scene, whose end and output may have been changed, and for the checksum of the whole."""
    start = len(b"fcm-solve checkpoint 1\n") + 8
    content = checkpoint.read_bytes()
    end = start + int.from_bytes(content[start - 8 : start], "little")
    header = json.loads(content[start:end])
    del header["scene"]
    return header, content[end:-8]
