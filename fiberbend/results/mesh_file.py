"""The mesh of a case's model as a file for other programs."""

from __future__ import annotations

import os
from collections.abc import Iterator
from pathlib import Path

from fiberbend.case import convert
from fiberbend.case.case import Case
from fiberbend.models.choice import MODELS, choose_model
from fiberbend.models.model import MeshedModel
from fiberbend.process import remains
from fiberbend.schema.problems import CaseError, Problem
from fiberbend.states.snapshot import ModelMesh

OPTION = "--out"


def check_target(path: Path, overwrite: bool) -> None:
    """Refuse a file that cannot be written, before anything is meshed.

    Args:
        path: the file.
        overwrite: it may be there.

    Raises:
        CaseError: an ending that is none of `ENDINGS`, no folder, or a file that is there.
    """
    from fiberbend.states.mesh_file import ENDINGS

    if path.suffix not in ENDINGS:
        wanted = f"{', '.join(ENDINGS[:-1])} or {ENDINGS[-1]}"
        shown = f"the ending {path.suffix!r}" if path.suffix else "no ending"
        raise CaseError([Problem(OPTION, f"{path.name} has {shown}, expected {wanted}")])
    if not path.parent.is_dir():
        raise CaseError([Problem(str(path.parent), "no such folder, expected one that exists")])
    if path.is_dir():
        raise CaseError([Problem(str(path), "is a folder, expected a file")])
    if path.exists() and not overwrite:
        raise CaseError([Problem(str(path), "exists, expected a new file, or --overwrite")])


def write_mesh_file(case: Case, path: Path, overwrite: bool = False) -> list[str]:
    """Write the mesh of the model that solves a case, with regions, surfaces and fibers.

    A section is its quadrilaterals, a cell its slice, a body its hexahedra or tetrahedra; of a
    model of one half it is that half. Lengths are in mm.

    Args:
        case: the case.
        path: the file; its ending says the format, see `fiberbend.states.mesh_file.ENDINGS`.
        overwrite: replace a file that is there.

    Returns:
        What was written, and what the file leaves out, a line each.

    Raises:
        CaseError: a file that cannot be written, a model without elements, or gmsh failed.
    """
    from fiberbend.states.mesh_file import write_mesh
    from geometry.mesh.errors import MeshError

    check_target(path, overwrite)
    model = choose_model(case)[0]
    if case.zones is not None and not model.ends:
        text = f"each has a mesh of its own in model {model.name}, expected model body"
        raise CaseError([Problem("zones", text)])
    elements = model.elements()
    if elements is None:
        names = [name for name, other in MODELS.items() if other.elements() is not None]
        text = f"{model.name} has no elements, expected {', '.join(names[:-1])} or {names[-1]}"
        raise CaseError([Problem("model", text)])
    try:
        model_mesh = mesh_of(case, elements)
    except MeshError as error:
        raise CaseError([Problem("mesh", str(error))]) from None
    try:
        handle, part = remains.begin(path)
    except OSError as error:
        raise CaseError([Problem(str(path), f"{error.strerror}, expected a file")]) from None
    os.close(handle)
    whole = Path(part).with_suffix(path.suffix)
    try:
        os.replace(part, whole)
        remarks = write_mesh(model_mesh, whole)
        remains.let_others_read(whole)
        os.replace(whole, path)
    except OSError as error:
        raise CaseError([Problem(str(path), f"{error.strerror}, expected a file")]) from None
    finally:
        Path(part).unlink(missing_ok=True)
        whole.unlink(missing_ok=True)
    return [*_lines(case, elements, model_mesh, path), *remarks]


def mesh_of(case: Case, model: MeshedModel) -> ModelMesh:
    """Mesh, materials and fibers of a model, as a run begins with them."""
    from fiberbend.models.parts import build

    mesh = model.mesh(case)
    parts = build(case, mesh, model)
    return ModelMesh(
        mesh=mesh,
        materials=parts.materials,
        fibers=parts.fibers,
        smeared=parts.smeared,
        title=case.title,
        uniform=model.repeats(case),
        families=convert.looks(case),
    )


def _lines(case: Case, model: MeshedModel, model_mesh: ModelMesh, path: Path) -> Iterator[str]:
    mesh = model_mesh.mesh
    what = f"{len(mesh.cells)} {model.size(case).kind}, {len(mesh.nodes)} nodes, lengths in mm"
    yield f"{path}: {what}: {model.name} model"
    if mesh.half:
        yield f"half: x ≥ 0 only{_for_all_of_it(case, model)}"
    there = {*mesh.cell_region.tolist()}
    yield f"regions: {', '.join(name for name, n in mesh.regions.items() if n in there)}"
    yield f"surfaces: {', '.join(name for name, pairs in mesh.facets.items() if len(pairs))}"
    if model_mesh.lines is not None:
        count = len({*model_mesh.lines.curve.tolist()})
        yield f"fibers: {count} curve{'s' if count > 1 else ''} with nodes of their own"
    elif model_mesh.fibers is not None:
        yield "fibers: none, the winding is spread over the surface 'winding'"


def _for_all_of_it(case: Case, model: MeshedModel) -> str:
    mesh = case.mesh.model_copy(update={"symmetry": "full"})
    half = model.half(case.model_copy(update={"mesh": mesh}))[0]
    return "" if half else ', all of it with --set mesh.symmetry="full"'
