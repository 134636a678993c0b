"""What the values of a material must fulfil together."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from fiberbend.case import convert
from fiberbend.case.case import MaterialSpec
from fiberbend.schema.problems import Problem, found, meant
from materials.laws.table import LAWS


def material_problems(path: str, material: MaterialSpec) -> Iterator[Problem]:
    """What is wrong with a material of a case.

    Args:
        path: of the material.
        material: valid by its single values.
    """
    from materials.named.table import SOLIDS, hint

    given = material.coefficients
    yield from _idle(path, {"upto": material.upto}, "without data")
    own: dict[str, object] = {"law": material.law, "young": material.young, **given}
    own["poisson"] = material.poisson
    if material.name is not None:
        if material.name not in SOLIDS:
            wanted = f"expected {hint(material.name, SOLIDS)}, or a law"
            near = meant(material.name, SOLIDS)
            yield Problem(path, f"{found(material.name)}, {wanted}{near}")
        own |= {"tested": material.tested, "source": material.source}
        yield from _idle(path, own, "on a named material")
        return
    if material.young is not None:
        del own["young"], own["poisson"]
        yield from _idle(path, own | {"bulk": material.bulk}, "beside young")
        return
    if material.law is None:
        text = "neither name nor law, expected one of them, or young, or data"
        yield Problem(path, text)
        return
    yield from _idle(path, {"poisson": material.poisson}, "without young")
    law = LAWS[material.law]
    problems = [
        *((key, f"missing, expected a coefficient of {law.name}") for key in law.missing(given)),
        *((key, f"no effect on {law.name}, expected no value") for key in law.unknown(given)),
        *((key, f"no effect without {term}, expected no value") for key, term in law.idle(given)),
        *law.refusals(given),
    ]
    for key, text in problems:
        yield Problem(f"{path}.{key}", text)
    if not problems:
        try:
            convert.material(material)
        except ValueError as error:
            yield Problem(path, str(error))


def _idle(path: str, values: Mapping[str, object], where: str) -> Iterator[Problem]:
    """Values that have no effect."""
    for key, value in values.items():
        if value is not None:
            yield Problem(f"{path}.{key}", f"no effect {where}, expected no value")
