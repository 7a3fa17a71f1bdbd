"""A validator of JSON Schema accepts the scenes that the program provides and finds mistakes in them, as editors do."""

import json
import tomllib
import unittest

from jsonschema import Draft7Validator

from program import ROOT, run


class Schema(unittest.TestCase):
    def setUp(self):
        schema = json.loads(run(["schema"]))
        Draft7Validator.check_schema(schema)
        self.validator = Draft7Validator(schema)

    def scenes(self):
        for path in sorted((ROOT / "scenes").glob("*.toml")):
            with self.subTest(scene=path.stem):
                yield tomllib.loads(path.read_text())

    def test_scenes_are_valid(self):
        count = 0
        for count, scene in enumerate(self.scenes(), 1):
            self.validator.validate(scene)
        self.assertGreaterEqual(count, 11)

    def test_unknown_keys_are_found(self):
        for scene in self.scenes():
            self.assertFalse(self.validator.is_valid({**scene, "tmie": {}}))
            for name in [name for name, value in scene.items() if isinstance(value, dict)]:
                self.assertFalse(self.validator.is_valid({**scene, name: {**scene[name], "tmie": 1}}), name)

    def test_values_of_the_wrong_type_are_found(self):
        for scene in self.scenes():
            for name in scene:
                self.assertFalse(self.validator.is_valid({**scene, name: [[]]}), name)
