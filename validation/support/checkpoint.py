"""The part of checkpoints that runs stopped in different ways must share."""

import json


def state_of(checkpoint):
    """The contents of a checkpoint without its scene, whose end and output may differ, and without the checksum of the file."""
    start = len(b"fcm-solve checkpoint 1\n") + 8
    content = checkpoint.read_bytes()
    end = start + int.from_bytes(content[start - 8 : start], "little")
    header = json.loads(content[start:end])
    del header["scene"]
    return header, content[end:-8]
