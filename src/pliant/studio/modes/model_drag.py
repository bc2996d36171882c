"""A shape model by hand: sliders and landmarks move it, and what is most likely follows."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from pliant.errors import InvalidParameter
from pliant.mesh import Points
from pliant.scene.stack import Stack
from pliant.studio.dragging import Dragging
from pliant.studio.modes.shape_models import layers_above, model_layer
from pliant.studio.request import Client, Request
from pliant.studio.session import Session


class ModelDrag(Dragging):
    """Coefficients follow sliders, and landmarks the pointer."""

    def __init__(self, session: Session, client: Client, layer: str, key: str) -> None:
        super().__init__(session, client, layer, key)
        shape = model_layer(session.shown.scene.stack, layer)
        self._count, self._landmarks = shape.model.count, len(np.asarray(shape.vertices))
        self._drag = session.shown.binding.drag_layer(layer)
        self._controls = self._drag.controls

    def move(self, request: Request) -> tuple[NDArray[np.integer], Points, dict[str, NDArray[Any]]]:
        if "coefficients" in request.arrays:
            given = request.array("coefficients")
            if len(given) != self._count:
                raise InvalidParameter(f"the model has {self._count} coefficients; {len(given)} came")
            self._controls[: self._count] = given
        if "index" in request.arrays:
            index, positions = request.indices("index", self._landmarks), request.points("positions")
            if len(index) != len(positions):
                raise InvalidParameter(f"{len(index)} landmarks have {len(positions)} positions")
            below = layers_above(self._drag.stack, self.layer).inverse(positions)
            self._controls[self._count :].reshape(-1, 3)[index] = below
        return self._drag.update(self._controls), self._drag.points, {}

    @property
    def stack(self) -> Stack:
        return self._drag.stack
