"""The page docs/materials.md, from the table of named materials."""

from __future__ import annotations

from fiberbend.api import materials as known
from materials.named.entry import Entry, Kind
from materials.named.table import alike, disagreements, of_kind

HEAD = """# Materials

<!-- Written by `make docs` from materials/named; do not edit by hand. -->

A part of a case is made of a named material, of a law with coefficients, of Young's modulus with
Poisson's ratio, of the tests of your own rubber, or of a file of your own:

```yaml
materials:
  wall: dragon-skin-30
  floor: {law: yeoh, c1: 7.9 MPa}
  layer: {young: 50 MPa, poisson: 0.49}
  sheath: my-rubber.yaml
```

`fiberbend materials` prints the names below, with a name one material whole, and its stress over
its stretch beside the tests. In Python it is `fiberbend.materials()`. An editor suggests the names
where the case file names its schema.

```console
$ fiberbend materials --kind thread
$ fiberbend materials dragon-skin-10 --plot dragon-skin-10.png
```

**Young's modulus.** `{young: 1 MPa, poisson: 0.5}` is a neo-Hookean rubber that keeps its volume,
of the shear modulus young/3. With a smaller Poisson's ratio ν it has the shear modulus young/(2
(1 + ν)) and the bulk modulus young/(3 (1 − 2 ν)). At small strains a bar has exactly this modulus
and this ratio; what lies beyond small strains, two numbers do not say.

**Tests of your own.** `{data: tensile.csv, law: yeoh-2, upto: 2}` fits the law to a tensile test,
a CSV file beside the case with columns such as `engineering strain [%]` and `engineering stress
[MPa]`, up to the stretch 2. Further tests of the same rubber go beside it: `data: {uniaxial:
bar.csv, pure-shear: sheet.csv, equibiaxial: bubble.csv}`. The law is one of the laws of [the case
file](case_file.md), or one with a number of its terms. Coefficients are fitted when the case is
read, such that the law is stable as far as the tests go; a run keeps them in its
case.resolved.yaml with a line on where they come from.

**A file of your own** has the keys of a material of a case, and is seen from the case file:

<!-- file: my-rubber.yaml -->
```yaml
law: ogden
mu1: 0.0423 MPa
alpha1: 3.13
density: 1070 kg/m^3
tested: [1, 3]          # least and greatest stretch of the tests
source: my tensile test of March
```

```console
$ fiberbend validate cases/section.yaml --set materials.wall=my-rubber.yaml
```

A thread is `modulus`, `diameter` and `radius_factor` (`fiber: my-thread.yaml`), a fabric
`modulus` and `thickness` (`fabric: my-fabric.yaml` of a strip).

**Beyond the tests.** Where a run stretches a rubber further than its tests did, a warning says
so: beyond them a law is a guess. A rubber that was only pulled is not known when it is pressed or
sheared.

**A new entry** is one entry in one file of `materials/named/`. Without a source and a licence it
does not load. Coefficients that are fitted here are fitted again by `python -m bench.rubbers`.
"""
KINDS: dict[Kind, tuple[str, str]] = {
    "rubber": ("Rubbers", "Of walls, floors, sheaths and layers. At rest: Young's modulus."),
    "thread": (
        "Threads",
        "Of windings, `fiber: kevlar`. One of any diameter is given with it, "
        "`fiber: {name: nylon, diameter: 0.3 mm}`; the diameter is that of the material itself, "
        "without air between its filaments.",
    ),
    "fabric": ("Fabrics", "Of strips, and of layers."),
    "paper": (
        "Papers",
        "Of strips, `fabric: printer-paper`, with the thickness. As a layer a sheet is a solid of "
        "its Young's modulus that keeps its volume; the layer has the thickness of the case.",
    ),
}
DISAGREE = (
    "Entries of one product whose stiffness at rest differs by more than a tenth. Batches, rates "
    "of loading, and how strain is measured differ; compute both."
)
_COLUMNS = ("name", "numbers", "at rest", "density", "tests", "source", "licence")


def page() -> str:
    """The page."""
    lines = [HEAD]
    for kind, (title, words) in KINDS.items():
        entries = of_kind(kind)
        lines += [f"## {title}", "", words, ""]
        if not entries:
            lines += ["None so far: no published one was found that says its numbers exactly.", ""]
            continue
        lines += [_row(_COLUMNS), _row(["---"] * len(_COLUMNS)), *map(_entry, entries), ""]
    lines += ["## Where sources disagree", "", DISAGREE, ""]
    lines += [_row(["product", "name", "at rest", "tests"]), _row(["---"] * 4)]
    for entry in sorted(of_kind(None), key=lambda e: (e.product, e.name)):
        if alike(entry) and any(disagreements(entry)):
            cells = (entry.product, f"`{entry.name}`", known.stiffness(entry), known.tests(entry))
            lines.append(_row(cells))
    return "\n".join(lines) + "\n"


def _entry(entry: Entry) -> str:
    density = "–" if entry.density is None else f"{entry.density:g} kg/m³, {entry.density_source}"
    tests = known.tests(entry) + (f"; {entry.note}" if entry.note else "")
    cells = (f"`{entry.name}`, {entry.product}", known.numbers(entry), known.stiffness(entry))
    return _row((*cells, density, tests, str(entry.source), entry.licence))


def _row(cells: object) -> str:
    assert isinstance(cells, list | tuple)
    return f"| {' | '.join(str(cell).replace('|', '/') for cell in cells)} |"
