"""The notebook as a page of the documentation: run, and written as Markdown with its pictures."""

from __future__ import annotations

import base64
import logging
import os
import sys
import tempfile
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parent.parent
NOTEBOOK = ROOT / "examples" / "first_actuator.ipynb"
PAGE = ROOT / "docs" / "_generated" / f"{NOTEBOOK.stem}.md"
SECONDS = 300
"""Longest time of a cell."""


def executed(notebook: Path = NOTEBOOK) -> Any:
    """Run a notebook by this Python, in an empty folder; nothing of it is written beside it.

    Args:
        notebook: its file.

    Returns:
        The notebook with its outputs, a `nbformat.NotebookNode`.

    Raises:
        nbclient.exceptions.CellExecutionError: a cell that failed, with its traceback.
    """
    import nbformat
    from ipykernel.kernelspec import write_kernel_spec
    from jupyter_client.kernelspec import KernelSpecManager
    from nbclient import NotebookClient

    cells = nbformat.read(notebook, as_version=4)
    with tempfile.TemporaryDirectory() as folder:
        kernels = Path(folder) / "kernels"
        # this Python's kernel, whatever kernels the user has
        write_kernel_spec(str(kernels / "python3"))
        specs = KernelSpecManager(kernel_dirs=[str(kernels)], ensure_native_kernel=False)
        here = Path(folder) / "work"
        here.mkdir()
        path = os.pathsep.join(filter(None, [str(ROOT), os.environ.get("PYTHONPATH")]))
        client = NotebookClient(
            cells,
            kernel_name="python3",
            timeout=SECONDS,
            resources={"metadata": {"path": str(here)}},
            store_widget_state=False,
        )
        client.log.setLevel(logging.ERROR)
        # made by the client, which then stops the kernel as well
        manager = client.create_kernel_manager()
        manager.kernel_spec_manager = specs
        # sockets in this folder instead of ports that the machine could listen to
        manager.transport = "ipc"
        manager.connection_file = str(Path(folder) / "kernel.json")
        client.execute(env=os.environ | {"PYTHONPATH": path, "IPYTHONDIR": folder})
    return cells


def markdown(cells: Any, folder: Path) -> str:
    """A notebook that was run as Markdown; its pictures go to a folder.

    Args:
        cells: the notebook.
        folder: folder of the page.
    """
    lines: list[str] = []
    pictures = 0
    for cell in cells.cells:
        if cell.cell_type == "markdown":
            lines += [cell.source, ""]
            continue
        lines += ["```python", cell.source, "```", ""]
        for output in cell.outputs:
            data = output.get("data", {})
            if "image/png" in data:
                pictures += 1
                name = f"{NOTEBOOK.stem}_{pictures}.png"
                (folder / name).write_bytes(base64.b64decode(data["image/png"]))
                size = output.metadata.get("image/png", {})
                wide = f"{{width={size['width']}px}}" if size else ""
                lines += [f"![result {pictures}]({name}){wide}", ""]
                continue
            if "text/html" in data:
                lines += ["```{raw} html", data["text/html"], "```", ""]
                continue
            text = output.get("text") or data.get("text/plain")
            if text:
                lines += ["```text", text.rstrip("\n"), "```", ""]
    return "\n".join(lines)


def write(page: Path = PAGE) -> None:
    """Run the notebook and write its page."""
    page.parent.mkdir(parents=True, exist_ok=True)
    page.write_text(markdown(executed(), page.parent), encoding="utf-8")


if __name__ == "__main__":
    write(Path(sys.argv[1]) if len(sys.argv) > 1 else PAGE)
