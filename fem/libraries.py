"""Kernels that FFCx writes, compiled as plain libraries: cffi adds a wrapper for Python to each.

The wrapper, the headers of Python that it includes and setuptools take as long to compile as a
common kernel. The types of all kernels are compiled by cffi once; objects are found by address.
"""

from __future__ import annotations

import contextlib
import ctypes
import os
import re
import shlex
import subprocess
import sysconfig
import types
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

from ffcx.codegeneration import jit

SUFFIX = str(sysconfig.get_config_var("EXT_SUFFIX"))
"""How the name of a library ends."""
_KINDS = {
    "form": "ufcx_form",
    "expression": "ufcx_expression",
    "element": "ufcx_finite_element",
    "dofmap": "ufcx_dofmap",
}
"""Types of FFCx's objects by how it begins their names."""


def declarations() -> str:
    """The types of kernels for cffi: all that this FFCx declares."""
    given = {name: text for name, text in vars(jit).items() if re.fullmatch(r"UFC_\w+_DECL", name)}
    header = given.pop("UFC_HEADER_DECL").format("double")
    # these two have the others in them
    last = [given.pop(f"UFC_{name}_DECL") for name in ("FORM", "EXPRESSION")]
    return "\n".join([header, *given.values(), *last])


def compiler() -> list[str]:
    """The C compiler with its options, of the environment or of this Python."""
    given = os.environ.get("CC", "").split()
    return given or shlex.split(str(sysconfig.get_config_var("CC")))


class Builder:
    """What FFCx asks of `cffi.FFI`."""

    def set_source(
        self,
        name: str,
        code: str,
        include_dirs: Sequence[str],
        extra_compile_args: Sequence[str],
        libraries: Sequence[str] | None = None,
    ) -> None:
        """The C code of a library, and how it is compiled."""
        self._name, self._code = name, code
        self._flags = [*extra_compile_args, *(f"-I{folder}" for folder in include_dirs)]
        self._libraries = [f"-l{library}" for library in libraries or ()]

    def cdef(self, text: str) -> None:
        """Its objects; their types are known.

        Raises:
            NotImplementedError: an object of another type than its name says.
        """
        for kind, name in re.findall(r"extern (\w+) (\w+);", text):
            if _KINDS.get(name.partition("_")[0]) != kind:
                raise NotImplementedError(f"{kind} {name}: FFCx names its objects otherwise")

    def compile(self, tmpdir: str | Path, **_: Any) -> None:
        """Compile and link it.

        Raises:
            RuntimeError: no compiler, or it failed.
        """
        source = Path(tmpdir) / f"{self._name}.c"
        source.write_text(self._code, encoding="utf-8")
        target = source.with_name(f"{self._name}{SUFFIX}")
        # the user's own flags first, as everywhere: ours are what rounding was measured with
        own = shlex.split(os.environ.get("CFLAGS", ""))
        command = [*compiler(), "-shared", "-fPIC", "-DNDEBUG", *own, *self._flags]
        try:
            done = subprocess.run(
                [*command, "-o", str(target), str(source), *self._libraries],
                capture_output=True,
                text=True,
                errors="replace",
            )
        except OSError as error:
            raise RuntimeError(f"compiler {command[0]}: {error.strerror}") from error
        if done.returncode:
            said = [*done.stderr.splitlines(), f"exit code {done.returncode}"]
            errors = [line for line in said if "error" in line] or said
            raise RuntimeError(f"compiler {command[0]}: {errors[0]}")


@contextlib.contextmanager
def plain(ffi: Any) -> Iterator[None]:
    """FFCx compiles and loads plain libraries meanwhile.

    Args:
        ffi: of a module compiled with `declarations`.
    """

    def load(folder: Any, name: str, objects: Sequence[str]) -> tuple[list[Any], Any]:
        library = ctypes.CDLL(str(Path(folder) / f"{name}{SUFFIX}"))
        found = []
        for each in objects:
            address = ctypes.addressof(ctypes.c_char.in_dll(library, each))
            found.append(ffi.cast(f"{_KINDS[each.partition('_')[0]]} *", address)[0])
        return found, types.SimpleNamespace(ffi=ffi)

    def find(name: str, objects: Sequence[str], folder: Any, timeout: int) -> tuple[Any, Any]:
        source = Path(folder) / f"{name}.c"
        if source.with_name(f"{source.name}.cached").exists():
            return load(folder, name, objects)
        source.open("x").close()
        return None, None

    replaced = {
        "cffi": types.SimpleNamespace(FFI=Builder),
        "get_cached_module": find,
        "_load_objects": load,
    }
    original = {name: getattr(jit, name) for name in replaced}
    vars(jit).update(replaced)
    try:
        yield
    finally:
        vars(jit).update(original)


@contextlib.contextmanager
def together(forms: Sequence[Any]) -> Iterator[None]:
    """Forms that dolfinx has compiled one by one meanwhile come from one library of them all.

    What they share is written and compiled once: elements and their numbering, headers, the link.

    Args:
        forms: UFL forms; none else is compiled meanwhile.
    """
    original, made = jit.compile_forms, list[tuple[Any, ...]]()

    def compile_forms(wanted: Sequence[Any], **settings: Any) -> tuple[Any, ...]:
        if not made:
            made.append(original(list(forms), **settings))
        objects, *rest = made[0]
        (form,) = wanted
        place = next(i for i, each in enumerate(forms) if each is form)
        return ([objects[place]], *rest)

    jit.compile_forms = compile_forms
    try:
        yield
    finally:
        jit.compile_forms = original
