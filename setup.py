"""What pyproject.toml cannot say: a wheel has what the source has now."""

import shutil

from setuptools import setup
from setuptools.command.build_py import build_py


class FromNothing(build_py):
    """Without what an earlier build has left in build/lib of modules that are no more."""

    def run(self) -> None:
        """Clear the folder, then fill it."""
        if not self.editable_mode:
            shutil.rmtree(self.build_lib, ignore_errors=True)
        super().run()


setup(cmdclass={"build_py": FromNothing})
