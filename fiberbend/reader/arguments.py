"""How a command line names a case and changes to it."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

from cyclopts import Parameter

CaseFile = Annotated[Path, Parameter(help="Case file, YAML.")]
Changes = Annotated[
    tuple[str, ...],
    Parameter(
        name="--set",
        metavar="PATH=VALUE",
        consume_multiple=False,
        show_default=False,
        help='Change the case, such as effects.0.pressure.to="150 kPa"; repeatable.',
    ),
]
