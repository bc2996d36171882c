"""Layers in order, each with a name of its own. Every edit gives others, so that undoing one is keeping the old."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from dataclasses import replace as exchanged
from typing import Any, Self

from pliant.errors import InvalidParameter
from pliant.scene.layer import Layer


@dataclass(frozen=True, eq=False)
class Layers:
    """Layers in order, the first first.

    Parameters
    ----------
    layers
        With different names; none at all will do.

    Raises
    ------
    InvalidParameter
        Two layers of one name, something that is no layer.
    """

    layers: tuple[Layer, ...] = ()

    def __post_init__(self) -> None:
        object.__setattr__(self, "layers", tuple(self.layers))
        for layer in self.layers:
            if not isinstance(layer, Layer):
                raise InvalidParameter(f"a stack holds layers, not a {type(layer).__name__}: wrap it in Layer(name, …)")
        for name in self.names:
            if self.names.count(name) > 1:
                raise InvalidParameter(f"two layers are called {name!r}: rename one")

    def __len__(self) -> int:
        return len(self.layers)

    def __iter__(self) -> Iterator[Layer]:
        return iter(self.layers)

    def __getitem__(self, name: str) -> Layer:
        return self.layers[self.index(name)]

    @property
    def names(self) -> tuple[str, ...]:
        """What the layers are called, in order."""
        return tuple(layer.name for layer in self.layers)

    @property
    def active(self) -> tuple[Layer, ...]:
        """The layers that do something: not muted, solo where one is, an envelope that is not zero."""
        heard = [layer for layer in self.layers if not layer.muted]
        alone = [layer for layer in heard if layer.solo]
        return tuple(layer for layer in alone or heard if layer.envelope != 0.0)

    def index(self, name: str) -> int:
        """Where a layer stands.

        Parameters
        ----------
        name
            Of the layer.

        Raises
        ------
        InvalidParameter
            There is none of that name.
        """
        if name not in self.names:
            raise InvalidParameter(f"there is no layer {name!r}; there are: {', '.join(self.names) or 'none'}")
        return self.names.index(name)

    def replace(self, name: str, **changes: Any) -> Self:
        """The stack with some fields of a layer exchanged, as in ``replace("twist", muted=True)``.

        Parameters
        ----------
        name
            Of the layer.
        changes
            Fields of :class:`Layer`.

        Raises
        ------
        InvalidParameter
            There is no such layer.
        """
        return self._exchanged(name, self[name].changed(**changes))

    def insert(self, index: int, layer: Layer) -> Self:
        """The stack with one more layer before the one at ``index``; negative ones count from the end.

        Parameters
        ----------
        index
            Its place, 0 being the first that deforms.
        layer
            With a name that no other has.

        Raises
        ------
        InvalidParameter
            Another layer has its name.
        """
        layers = list(self.layers)
        layers.insert(index, layer)
        return self._with(layers)

    def append(self, layer: Layer) -> Self:
        """The stack with one more layer on top.

        Parameters
        ----------
        layer
            With a name that no other has.

        Raises
        ------
        InvalidParameter
            Another layer has its name.
        """
        return self._with((*self.layers, layer))

    def move(self, name: str, index: int) -> Self:
        """The stack with a layer at another place: ``index`` among all of them, 0 being the first.

        Parameters
        ----------
        name
            Of the layer.
        index
            Among all of them; negative ones count from the end.

        Raises
        ------
        InvalidParameter
            No such layer, or no such place.
        """
        if not -len(self) <= index < len(self):
            raise InvalidParameter(f"there is no place {index} among {len(self)} layers")
        layers = list(self.layers)
        layer = layers.pop(self.index(name))
        layers.insert(index % len(self), layer)
        return self._with(layers)

    def remove(self, name: str) -> Self:
        """The stack without a layer.

        Parameters
        ----------
        name
            Of the layer.

        Raises
        ------
        InvalidParameter
            There is no such layer.
        """
        at = self.index(name)
        return self._with((*self.layers[:at], *self.layers[at + 1 :]))

    def rename(self, name: str, new: str) -> Self:
        """The stack with another name for a layer.

        Parameters
        ----------
        name, new
            What it is called, and will be.

        Raises
        ------
        InvalidParameter
            There is no such layer, or another has the new name.
        """
        return self._exchanged(name, self[name].changed(name=new))

    def _exchanged(self, name: str, layer: Layer) -> Self:
        at = self.index(name)
        return self._with((*self.layers[:at], layer, *self.layers[at + 1 :]))

    def _with(self, layers: Iterable[Layer]) -> Self:
        return exchanged(self, layers=tuple(layers))
