"""``pliant model``: shape models made, drawn from, conditioned and fitted."""

from __future__ import annotations

from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

import typer

from pliant.cli import options as opt
from pliant.cli.session import Session

if TYPE_CHECKING:
    from pliant.io.report import LossReport
    from pliant.shape.model import ShapeModel

app = typer.Typer(no_args_is_help=True, rich_markup_mode=None, help="Shape models: make, draw from, condition, fit.")


class Method(StrEnum):
    """How fields are made of a kernel."""

    cholesky = "cholesky"
    nystrom = "nystrom"


class Pose(StrEnum):
    """How a model may move as a whole."""

    none = "none"
    rigid = "rigid"
    similarity = "similarity"


POSES: dict[Pose, Literal["rigid", "similarity"] | None] = {
    Pose.none: None,
    Pose.rigid: "rigid",
    Pose.similarity: "similarity",
}

ModelArgument = Annotated[Path, typer.Argument(metavar="MODEL", show_default=False, help="A model, .h5 or .h5.json.")]
OutputOption = Annotated[Path, typer.Option("--output", "-o", metavar="FILE", help="Where to write the result.")]
RankOption = Annotated[int | None, typer.Option(help="At most so many fields.", min=1, show_default=False)]


@app.command()
def build(
    reference: opt.MeshArgument,
    kernel: Annotated[str, typer.Option(metavar="KERNEL", help='As "gaussian(sigma=50, scale=10) + bspline(20, 2)".')],
    output: OutputOption,
    rank: RankOption = None,
    tolerance: Annotated[float, typer.Option(help="Part of the variance that may be missing.", min=0, max=0.99)] = 0.0,
    method: Annotated[Method, typer.Option(help="How the fields are found.")] = Method.cholesky,
    json: opt.JsonOption = False,
    quiet: opt.QuietOption = False,
) -> None:
    """Make a model of a mesh whose displacements have a covariance."""
    with Session(json=json, quiet=quiet) as session:
        from pliant.io.meshes import read
        from pliant.shape.kernel_text import parse_kernel
        from pliant.shape.model import ShapeModel

        if rank is None and not tolerance:
            rank = 100
        found = ShapeModel.from_kernel(
            read(reference), parse_kernel(kernel), rank=rank, tolerance=tolerance, method=method.value
        )
        _write(session, found, output)


@app.command()
def pca(
    meshes: Annotated[list[Path], typer.Argument(metavar="MESHES...", show_default=False, help="In correspondence.")],
    output: OutputOption,
    rank: RankOption = None,
    align: Annotated[bool, typer.Option(help="Take positions and rotations out first.")] = True,
    scale: Annotated[bool, typer.Option("--scale", help="Take sizes out too.")] = False,
    json: opt.JsonOption = False,
    quiet: opt.QuietOption = False,
) -> None:
    """Learn a model from examples with the same vertices."""
    with Session(json=json, quiet=quiet) as session:
        from pliant.io.meshes import read
        from pliant.shape.pca import learn_model

        _write(session, learn_model([read(path) for path in meshes], align=align, scale=scale, rank=rank), output)


@app.command()
def sample(
    model: ModelArgument,
    output: Annotated[Path, typer.Option("--output", "-o", metavar="FILE", help="As shape.ply: a number is added.")],
    count: Annotated[int, typer.Option("--count", "-n", help="How many shapes.", min=1, max=100_000)] = 1,
    seed: Annotated[int, typer.Option(help="The same seed, the same shapes.", min=0)] = 0,
    json: opt.JsonOption = False,
    quiet: opt.QuietOption = False,
) -> None:
    """Write random shapes of a model as meshes."""
    with Session(json=json, quiet=quiet) as session:
        from pliant.io.meshes import write
        from pliant.io.models import read_model

        found = read_model(model)
        digits, files = len(str(count)), []
        for number, points in enumerate(found.sample(count, seed=seed), start=1):
            name = output if count == 1 else output.with_stem(f"{output.stem}-{number:0{digits}}")
            write(found.reference.with_points(points), name)
            files.append(str(name))
        session.say(f"wrote {files[0]}" + (f" to {files[-1]}" if count > 1 else ""))
        session.result(model=model, outputs=files, seed=seed)


@app.command()
def posterior(
    model: ModelArgument,
    landmarks: Annotated[
        tuple[Path, Path], typer.Option(metavar="ON_MODEL SEEN", help="Landmarks on the reference, and where they are.")
    ],
    output: OutputOption,
    noise: Annotated[
        float | None,
        typer.Option(help="Standard deviation of the landmarks, a length; 0.1 % of the size if not given."),
    ] = None,
    json: opt.JsonOption = False,
    quiet: opt.QuietOption = False,
) -> None:
    """Write the model that knows where some landmarks are, matched by name."""
    with Session(json=json, quiet=quiet) as session:
        from pliant.errors import InvalidParameter
        from pliant.io.landmarks import read_landmarks
        from pliant.io.models import read_model

        found = read_model(model)
        names, places, seen = read_landmarks(landmarks[0]).common(read_landmarks(landmarks[1]))
        if not names:
            raise InvalidParameter(f"{landmarks[0]} and {landmarks[1]} have no landmark name in common")
        spread = 1e-3 * found.reference.diagonal if noise is None else noise
        session.say(f"{len(names)} landmarks: {', '.join(names)}")
        session.result(landmarks=list(names))
        _write(session, found.posterior(places, seen, noise=spread), output)


@app.command()
def fit(
    model: ModelArgument,
    target: Annotated[Path, typer.Argument(metavar="TARGET", show_default=False, help="A mesh of any topology.")],
    output: OutputOption,
    iterations: Annotated[int, typer.Option(help="At most so many rounds.", min=1, max=100_000)] = 50,
    noise: Annotated[
        float | None,
        typer.Option(help="Standard deviation of the target's points, a length; 0.1 % of the size if not given."),
    ] = None,
    pose: Annotated[Pose, typer.Option(help="How the model may move as a whole.")] = Pose.rigid,
    json: opt.JsonOption = False,
    quiet: opt.QuietOption = False,
) -> None:
    """Fit a model to a mesh and write the shape found, with the reference's faces."""
    with Session(json=json, quiet=quiet) as session, session.patience():
        from pliant.io.meshes import read, write
        from pliant.io.models import read_model

        found = read_model(model)
        fitted = found.fit(read(target), iterations=iterations, noise=noise, pose=POSES[pose])
        report = write(found.reference.with_points(fitted.points), output)
        _tell(session, report)
        session.say(f"mean distance {fitted.distance:.4g}, {fitted.status} after {fitted.iterations} rounds")
        session.result(
            model=model,
            target=target,
            output=output,
            distance=fitted.distance,
            status=fitted.status,
            iterations=fitted.iterations,
            pose=fitted.pose,
            coefficients=fitted.coefficients,
        )


@app.command()
def info(model: ModelArgument, json: opt.JsonOption = False, quiet: opt.QuietOption = False) -> None:
    """Tell what a model holds."""
    with Session(json=json, quiet=quiet) as session:
        from pliant.io.models import read_model

        facts = _facts(read_model(model))
        session.result(file=model, **facts)
        session.table({name.replace("_", " "): _shown(value) for name, value in facts.items()})


@app.command()
def convert(
    model: ModelArgument,
    output: Annotated[Path, typer.Argument(metavar="OUT", show_default=False, help="A name in .h5 or .h5.json.")],
    json: opt.JsonOption = False,
    quiet: opt.QuietOption = False,
) -> None:
    """Write a model as HDF5 or as HDF5-JSON, number by number."""
    with Session(json=json, quiet=quiet) as session:
        from pliant.io.models import read_model

        _write(session, read_model(model), output)


def _write(session: Session, model: ShapeModel, output: Path) -> None:
    from pliant.io.models import write_model

    _tell(session, write_model(model, output))
    session.result(output=output, **_facts(model))


def _tell(session: Session, report: LossReport) -> None:
    session.tell_losses(report)
    session.say(f"wrote {report.path} ({report.format})")


def _facts(model: ShapeModel) -> dict[str, Any]:
    kind = "tetrahedra" if model.cells is not None else "faces" if len(model.reference.faces) else "points"
    return {
        "kind": kind,
        "points": len(model.mean),
        "faces": len(model.reference.faces),
        "rank": model.rank,
        "coefficients": model.count,
        "deviation": float(model.uncertainty.mean()),
        "variances": model.variances[:5].tolist(),
    }


def _shown(value: Any) -> str:
    if isinstance(value, list):
        return " ".join(f"{each:.4g}" for each in value)
    return f"{value:,}" if isinstance(value, int) else f"{value:.6g}" if isinstance(value, float) else str(value)
