"""Base of the command-line tests: runs the command in a folder of its own."""

import json
import os
import resource
import signal
import subprocess
import sys
import tempfile
import unittest

COMMAND = os.environ.get("PLENOFLAME_COMMAND", "plenoflame")


class CommandTest(unittest.TestCase):
    """Each test starts in an empty temporary folder, self.folder."""

    def setUp(self):
        self._temporary = tempfile.TemporaryDirectory(prefix="plenoflame-cli-")
        self.folder = self._temporary.name
        self.addCleanup(self._temporary.cleanup)

    def path(self, name):
        return os.path.join(self.folder, name)

    def write(self, name, content):
        """Writes a file in the folder: text or bytes."""
        with open(self.path(name), "wb") as file:
            file.write(content.encode() if isinstance(content, str) else content)

    def read(self, name):
        with open(self.path(name), "rb") as file:
            return file.read()

    def files(self):
        """Names in the folder, hidden ones included, sorted."""
        return sorted(os.listdir(self.folder))

    def run_command(self, *arguments, largest_file=None, address_space=None, stdout=subprocess.PIPE, environment=None):
        """Runs to the end. largest_file: limit in bytes on the files that it writes; address_space: on its memory."""
        def limit():
            if largest_file is not None:
                signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
                resource.setrlimit(resource.RLIMIT_FSIZE, (largest_file, largest_file))
            if address_space is not None:
                resource.setrlimit(resource.RLIMIT_AS, (address_space, address_space))
        return subprocess.run([COMMAND, *arguments], cwd=self.folder, stdin=subprocess.DEVNULL, stdout=stdout,
                              stderr=subprocess.PIPE, text=True, timeout=120, preexec_fn=limit, check=False,
                              env=environment)

    def succeeds(self, *arguments, stderr=""):
        """Standard output of a run with status 0 and exactly this on standard error."""
        result = self.run_command(*arguments)
        self.assertEqual((result.returncode, result.stderr), (0, stderr), arguments)
        return result.stdout

    def json_of(self, *arguments):
        return json.loads(self.succeeds(*arguments, "--json"))

    def fails(self, status, *arguments, mentions, **options):
        """The run ends with this status, nothing on standard output, and one line on standard error
        that has every text of `mentions`."""
        self.is_failure(self.run_command(*arguments, **options), status, mentions)

    def is_failure(self, result, status, mentions):
        self.assertEqual(result.returncode, status, (result.args, result.stderr))
        self.assertEqual(result.stdout or "", "", result.args)
        self.assertRegex(result.stderr, r"\Aplenoflame: error: [^\n]+\n\Z")
        for text in [mentions] if isinstance(mentions, str) else mentions:
            self.assertIn(text, result.stderr)


def long(test):
    """Marks a test that runs with PLENOFLAME_LONG_TESTS=1 alone."""
    test.long = True
    return test


class Loader(unittest.TestLoader):
    """All tests, or those that are not long."""

    def getTestCaseNames(self, case):
        return [name for name in super().getTestCaseNames(case)
                if os.environ.get("PLENOFLAME_LONG_TESTS") or not hasattr(getattr(case, name), "long")]


def main():
    if not os.access(COMMAND, os.X_OK):
        sys.exit("set PLENOFLAME_COMMAND to the command that is tested")
    unittest.main(testLoader=Loader())
