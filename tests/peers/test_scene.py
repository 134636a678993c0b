"""The actuator as other programs get it: its deck, its faces, its hoops and its angle."""

import re
from pathlib import Path

import numpy as np
import pytest

from bench.peers import calculix, scene
from bench.peers.arrays import Body, bending_angles, facet_functions, load_body, section_turn
from geometry.mesh.data import MeshData

_CORNERS = np.array([(x, y, z) for z in (-1, 1) for x, y in ((-1, -1), (1, -1), (1, 1), (-1, 1))])
"""Of a hexahedron as the manuals of Abaqus and CalculiX number them."""
_EDGES = (
    *((0, 1), (1, 2), (2, 3), (3, 0), (4, 5), (5, 6), (6, 7), (7, 4)),
    *((0, 4), (1, 5), (2, 6), (3, 7)),
)
_FACES = {
    "S1": (0, 1, 2, 3),
    "S2": (4, 7, 6, 5),
    "S3": (0, 4, 5, 1),
    "S4": (1, 5, 6, 2),
    "S5": (2, 6, 7, 3),
    "S6": (3, 7, 4, 0),
}


@pytest.fixture(scope="module")
def mesh() -> MeshData:
    return scene.meshed(1, 16.0)


@pytest.fixture(scope="module")
def body(mesh: MeshData) -> Body:
    return scene.body_of(mesh)


class Deck:
    """A deck of CalculiX as far as these tests read it."""

    def __init__(self, text: str) -> None:
        self.points: dict[int, np.ndarray] = {}
        self.solids: dict[int, list[int]] = {}
        self.springs: dict[int, list[int]] = {}
        self.stiffness: dict[str, float] = {}
        self.set_of: dict[int, str] = {}
        self.faces: dict[str, list[tuple[int, str]]] = {}
        for block in re.split(r"^(?=\*[A-Z])", text, flags=re.MULTILINE):
            head, *lines = block.splitlines() or [""]
            words = dict(re.findall(r"(\w+)=(\S+?)(?:,|$)", head))
            self._read(head.split(",")[0], words, lines)

    def _read(self, keyword: str, words: dict[str, str], lines: list[str]) -> None:
        if keyword == "*NODE":
            for line in lines:
                number, *x = line.split(",")
                self.points[int(number)] = np.array(x, dtype=float)
        elif keyword == "*ELEMENT":
            entries = [[int(w) for w in row.split(",")] for row in _joined(lines)]
            kind = self.springs if words["TYPE"] == "SPRINGA" else self.solids
            for label, *nodes in entries:
                kind[label], self.set_of[label] = nodes, words["ELSET"]
        elif keyword == "*SURFACE":
            pairs = [line.split(", ") for line in lines]
            self.faces[words["NAME"]] = [(int(cell), face) for cell, face in pairs]
        elif keyword == "*SPRING":
            assert lines[0] == ""
            self.stiffness[words["ELSET"]] = float(lines[1])


def _joined(lines: list[str]) -> list[str]:
    """Rows of an element, which go on after a comma at the end."""
    return re.sub(r",\n", ", ", "\n".join(lines)).splitlines()


@pytest.fixture(scope="module")
def deck(body: Body, tmp_path_factory: pytest.TempPathFactory) -> Deck:
    folder = tmp_path_factory.mktemp("deck")
    calculix.prepare(1, 16.0, body, "C3D20R", 0.1, folder)
    text = (folder / "run.inp").read_text()
    included = (folder / "mesh.inp").read_text()
    assert "TYPE=C3D20R, ELSET=wall" in included
    assert "TYPE=C3D20," not in included
    return Deck(text.replace("*INCLUDE, INPUT=mesh.inp\n", included))


def _serendipity(at: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Shape functions of C3D20 and their slopes at points, written down from its definition."""
    nodes = np.vstack([_CORNERS, [(_CORNERS[a] + _CORNERS[b]) / 2 for a, b in _EDGES]])
    step = 1e-6

    def values(x: np.ndarray) -> np.ndarray:
        columns = []
        for i, node in enumerate(nodes):
            shares = 1 + x * node
            if i < 8:
                columns.append(shares.prod(axis=1) * (x @ node - 2) / 8)
            else:
                bubble = np.where(node == 0, 1 - x**2, shares)
                columns.append(bubble.prod(axis=1) / 4)
        return np.column_stack(columns)

    slopes = [(values(at + step * e) - values(at - step * e)) / (2 * step) for e in np.eye(3)]
    return values(at), np.stack(slopes, axis=2)


def test_its_elements_have_the_volume_of_the_actuator(deck: Deck) -> None:
    one, weight = np.polynomial.legendre.leggauss(3)
    at = np.array([(x, y, z) for x in one for y in one for z in one])
    weights = np.array([a * b * c for a in weight for b in weight for c in weight])
    _, slopes = _serendipity(at)
    nodes = np.array([[deck.points[n] for n in cell] for cell in deck.solids.values()])
    assert nodes.shape[1:] == (20, 3)
    dets = np.linalg.det(np.einsum("qni,cnj->cqij", slopes, nodes))
    assert dets.min() > 0
    # half of: hemicircle of radius 11 on a floor of 2 + 1 mm, 190 mm long, less the chamber
    outline = np.pi * 11**2 / 2 + 22 * 3
    chamber = np.pi * 8**2 / 2 * 160
    assert (dets @ weights).sum() == pytest.approx((outline * 190 - chamber) / 2, rel=2e-3)


def test_the_pressure_pushes_the_chamber_open(deck: Deck) -> None:
    """CalculiX and Abaqus push against a face from outside the element: out of the chamber."""
    moment = 0.0
    for cell, face in deck.faces["chamber"]:
        nodes = np.array([deck.points[n] for n in deck.solids[cell]])
        corners = nodes[list(_FACES[face])]
        across = np.cross(corners[2] - corners[0], corners[3] - corners[1]) / 2
        into = nodes[:8].mean(axis=0) - corners.mean(axis=0)
        across *= np.sign(across @ into)
        moment += across @ corners.mean(axis=0)
    # ∮ x·n over the chamber but for its plane of symmetry, where x·n = 0, is 3 V; half of it
    assert moment / 3 == pytest.approx(np.pi * 8**2 / 4 * 160, rel=0.03)


def test_the_springs_are_hoops_of_the_winding_s_stiffness(deck: Deck, body: Body) -> None:
    assert min(deck.springs) == len(deck.solids) + 1
    assert len(deck.springs) == len(body.plain_hoops)
    per_length = 0.0
    for number, (first, second) in deck.springs.items():
        step = deck.points[second] - deck.points[first]
        assert abs(step[2]) < 1e-6
        length = float(np.linalg.norm(step))
        per_length += deck.stiffness[deck.set_of[number]] * length * length
    perimeter = 10 * np.pi / 2 + 10 + 2
    wanted = scene.hoop_stiffness() * perimeter * 160
    assert per_length == pytest.approx(wanted, rel=5e-3)


def test_hoops_carry_what_the_case_s_double_helix_does() -> None:
    kevlar = 31076 * np.pi * 0.095**2
    assert scene.hoop_stiffness() == pytest.approx(2 * kevlar / 3, rel=1e-3)


@pytest.mark.parametrize("degrees", [0.0, 30.0, 100.0, 250.0, 360.0])
def test_the_angle_of_a_turned_section(body: Body, degrees: float) -> None:
    states = []
    for part in np.linspace(0, 1, 5):
        turn = np.radians(degrees) * part * np.clip(body.points[:, 2:] / 160, 0, 1)
        y, z = body.points[:, 1:2], np.zeros_like(turn)
        x = np.hstack([body.points[:, :1], y * np.cos(turn), z + y * np.sin(turn)])
        states.append(x)
    for facets in (9, 8):
        root, tip = body.root[:, :facets], body.tip[:, :facets]
        angles = bending_angles(body.points, states, root, tip)
        assert np.degrees(angles[-1]) == pytest.approx(degrees, abs=1e-6)


def test_a_section_that_leans_toward_minus_y_has_turned_forward(body: Body) -> None:
    """Its normal, at first along z, points toward −y."""
    turn = np.radians(20)
    turned = np.array(
        [[1, 0, 0], [0, np.cos(turn), -np.sin(turn)], [0, np.sin(turn), np.cos(turn)]]
    )
    assert (turned @ (0, 0, 1))[1] < 0
    angle = section_turn(body.points, body.points @ turned.T, body.tip)
    assert angle == pytest.approx(turn, rel=1e-9)


@pytest.mark.parametrize("nodes", [8, 9])
def test_shape_functions_of_a_facet(nodes: int) -> None:
    places = np.array(
        [(-1, -1), (1, -1), (1, 1), (-1, 1), (0, -1), (1, 0), (0, 1), (-1, 0), (0, 0)]
    )
    values, _ = facet_functions(nodes, places[:nodes].astype(float))
    np.testing.assert_allclose(values, np.eye(nodes), atol=1e-14)
    at, step = np.array([[0.3, -0.6]]), 1e-6
    _, slopes = facet_functions(nodes, at)
    for axis in range(2):
        shift = step * np.eye(2)[axis]
        change = facet_functions(nodes, at + shift)[0] - facet_functions(nodes, at - shift)[0]
        np.testing.assert_allclose(slopes[:, :, axis], change / (2 * step), atol=1e-9)


def test_a_body_is_read_as_it_was_saved(body: Body, tmp_path: Path) -> None:
    body.save(tmp_path / "body.npz")
    again = load_body(tmp_path / "body.npz")
    np.testing.assert_array_equal(again.cells, body.cells)
    np.testing.assert_array_equal(again.plain_stiffness, body.plain_stiffness)


def test_increments_of_a_sta_file() -> None:
    text = """SUMMARY OF JOB INFORMATION
  STEP      INC     ATT  ITRS     TOT TIME     STEP TIME      INC TIME
     1          1     1U    3  0.000000E+00  0.000000E+00  0.500000E-01
     1          1     2     4  0.312500E-02  0.312500E-02  0.312500E-02
     1          2     1     5  0.625000E-02  0.625000E-02  0.312500E-02
"""
    assert calculix.increments(text) == [(False, 3), (True, 7), (True, 12)]


def test_displacements_of_a_dat_file(body: Body) -> None:
    """A rigid turn of the tip's ring, in CalculiX's own layout."""
    label = calculix.labels(body)
    turn = np.radians(12)
    text = ""
    for name, facets, angle in (("SECTION_ROOT", body.root, 0.0), ("SECTION_TIP", body.tip, turn)):
        text += f"\n displacements (vx,vy,vz) for set {name} and time  0.5000000E+00\n\n"
        for node in np.unique(facets[:, :8]):
            y = body.points[node, 1]
            u = (0.0, y * (np.cos(angle) - 1), y * np.sin(angle))
            text += f"{label[node]:10d}  " + " ".join(f"{value: .6E}" for value in u) + "\n"
    pressures, angles = calculix.curve(body, text, 0.1)
    np.testing.assert_allclose(pressures, [0.05])
    np.testing.assert_allclose(angles, [turn], atol=1e-6)
