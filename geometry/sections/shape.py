"""What a section shape is: a subclass of `ShapedActuator` in a file of this folder.

A new shape is one such file and its line in `geometry.sections.table`.
"""

from __future__ import annotations

import abc
import dataclasses
from collections.abc import Iterator, Mapping

from geometry.actuator import Actuator
from geometry.sections.blocks import Layout
from geometry.sections.size import MeshSize, Strips


@dataclasses.dataclass(frozen=True, kw_only=True)
class ShapedActuator(Actuator):
    """An actuator with a section of one shape, which can be laid out in blocks.

    The dimensions that a shape needs are its fields without a default; those that it may have are
    None unless given. Its docstring gives their place.

    Raises:
        ValueError: dimensions that do not go together, see `contradictions`.
    """

    def __post_init__(self) -> None:
        super().__post_init__()
        given = {field.name: getattr(self, field.name) for field in dataclasses.fields(self)}
        for name, text in self.contradictions(given):
            raise ValueError(f"{name}: {text}")

    @abc.abstractmethod
    def layout(self, size: MeshSize, strips: Strips | None) -> Layout:
        """The side x ≥ 0 in blocks.

        Args:
            size: fineness.
            strips: strips of roof and post; they add the names "roof" and "post".
        """

    def one_material(self) -> frozenset[str]:
        """Regions that, of one material, make the section its own image turned upside down.

        Returns:
            Their names; none where the section is no such image whatever they are made of.
        """
        return frozenset()

    @classmethod
    def contradictions(cls, given: Mapping[str, float | None]) -> Iterator[tuple[str, str]]:
        """Dimensions that this shape cannot have together, though each is valid by itself.

        Args:
            given: the dimensions by name, those that the shape needs among them.

        Yields:
            Name of a dimension and what is wrong with it.
        """
        yield from ()

    @classmethod
    def inconsistencies(cls, given: Mapping[str, float | None]) -> Iterator[tuple[str, str]]:
        """Dimensions that are missing, without effect on this shape, or contradict each other.

        Args:
            given: dimensions by name, valid one by one; None where one is absent.

        Yields:
            Name of a dimension and what is wrong with it.
        """
        own = {field.name: field for field in dataclasses.fields(cls)}
        complete = True
        for name in dict.fromkeys([*given, *own]):
            value = given.get(name)
            if value is None and name in own and own[name].default is dataclasses.MISSING:
                complete = False
                yield name, f"missing, expected the {name} of a {cls.section}, above zero"
            if value is not None and name not in own:
                yield name, f"no effect on a {cls.section}, expected no value"
        if complete:
            yield from cls.contradictions(given)
