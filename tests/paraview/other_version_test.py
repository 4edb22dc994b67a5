"""A ParaView of another version is told its version and the one that is wanted, before anything is loaded."""

import importlib.util
import os
import sys
import types
import unittest


class OtherVersion(unittest.TestCase):
    def test_is_refused_with_both_versions(self):
        specification = importlib.util.spec_from_file_location("Plenoflame", os.environ["PLENOFLAME_PLUGIN"])
        for version in ("5.12.0", "5.1.1", "6.0.0"):
            sys.modules["paraview"] = types.SimpleNamespace(__version__=version)
            with self.assertRaises(ImportError) as caught:
                specification.loader.exec_module(importlib.util.module_from_spec(specification))
            self.assertEqual(str(caught.exception),
                             f"Plenoflame's plugin is made for ParaView 5.11; this is ParaView {version}")
        self.assertNotIn("plenoflame", sys.modules)


if __name__ == "__main__":
    unittest.main()
